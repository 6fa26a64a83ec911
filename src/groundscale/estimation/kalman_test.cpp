#include "groundscale/estimation/kalman.hpp"

#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

using Scalar = Eigen::Matrix<double, 1, 1>;

Gaussian<1> scalar(double mean, double variance) { return {Scalar(mean), Scalar(variance)}; }

TEST(Kalman, PredictsAScalarAsWorkedOutByHand) {
  const Gaussian<1> next = predict<1>(scalar(3.0, 4.0), Scalar(0.5), Scalar(2.0));
  EXPECT_DOUBLE_EQ(next.mean(0), 1.5);
  EXPECT_DOUBLE_EQ(next.covariance(0, 0), 3.0);  // 0.25 * 4 + 2
}

TEST(Kalman, UpdatesAScalarAsWorkedOutByHand) {
  // Variance 3 against 1: gain 3/4, residual 4.
  const Gaussian<1> after = update<1, 1>(scalar(1.0, 3.0), Scalar(1.0), Scalar(4.0), Scalar(1.0));
  EXPECT_DOUBLE_EQ(after.mean(0), 4.0);
  EXPECT_DOUBLE_EQ(after.covariance(0, 0), 0.75);
}

TEST(Kalman, InnovationIsMeasuredInItsOwnSpread) {
  const auto innovation = innovation_of<1, 1>(scalar(1.0, 3.0), Scalar(2.0), Scalar(4.0), Scalar(4.0));
  EXPECT_DOUBLE_EQ(innovation.covariance(0, 0), 16.0);  // 4 * 3 + 4
  EXPECT_DOUBLE_EQ(innovation.squared_length(), 1.0);
}

TEST(Kalman, UpdateOfCorrelatedNumbersAddsInformation) {
  Gaussian<2> state;
  state.mean << 1.0, -2.0;
  state.covariance << 2.0, 0.6, 0.6, 1.0;
  const Eigen::RowVector2d row(1.0, 0.5);
  const Gaussian<2> after = update<2, 1>(state, row, Scalar(0.7), Scalar(0.3));
  // P'^-1 = P^-1 + H^T R^-1 H, and the mean moves by P' H^T R^-1 r. Exact but for rounding.
  const Eigen::Matrix2d information = state.covariance.inverse() + row.transpose() * row / 0.3;
  EXPECT_LT((after.covariance - information.inverse()).norm(), 1e-12);
  EXPECT_LT((after.mean - state.mean - information.inverse() * row.transpose() * (0.7 / 0.3)).norm(), 1e-12);
}

TEST(Kalman, SmootherEqualsBatchLeastSquaresOnARandomWalk) {
  constexpr int kCount = 6;
  constexpr double kStart = 2.0, kWalk = 0.4, kNoise = 0.9;  // variances
  using Batch = Eigen::Matrix<double, kCount, kCount>;
  Rng rng(5);
  std::array<double, kCount> measured{};
  for (double& z : measured) z = rng.normal();

  Batch information = Batch::Zero();
  Eigen::Matrix<double, kCount, 1> vector = Eigen::Matrix<double, kCount, 1>::Zero();
  information(0, 0) += 1.0 / kStart;
  for (int k = 0; k < kCount; ++k) {
    information(k, k) += 1.0 / kNoise;
    vector(k) += measured[static_cast<std::size_t>(k)] / kNoise;
    if (k == 0) continue;
    information.block<2, 2>(k - 1, k - 1) += (Eigen::Matrix2d() << 1.0, -1.0, -1.0, 1.0).finished() / kWalk;
  }
  const Batch covariance = information.inverse();
  const Eigen::Matrix<double, kCount, 1> mean = covariance * vector;

  std::vector<Gaussian<1>> predicted, filtered;
  for (const double z : measured) {
    predicted.push_back(filtered.empty() ? scalar(0.0, kStart)
                                         : predict<1>(filtered.back(), Scalar(1.0), Scalar(kWalk)));
    const double residual = z - predicted.back().mean(0);
    filtered.push_back(update<1, 1>(predicted.back(), Scalar(1.0), Scalar(residual), Scalar(kNoise)));
  }
  Gaussian<1> later = filtered.back();
  for (int k = kCount - 1; k >= 0; --k) {
    const auto i = static_cast<std::size_t>(k);
    if (k < kCount - 1) later = smooth<1>(filtered[i], predicted[i + 1], later, Scalar(1.0));
    EXPECT_NEAR(later.mean(0), mean(k), 1e-12) << k;
    EXPECT_NEAR(later.covariance(0, 0), covariance(k, k), 1e-12) << k;
  }
}

TEST(GaussMarkov, KeepsItsVariance) {
  const GaussMarkov process{0.7, 2.0};
  for (const double dt : {0.01, 0.1, 3.0}) {
    const double decay = process.decay(dt);
    EXPECT_NEAR(decay * decay * 0.49 + process.noise_variance(dt), 0.49, 1e-15);
  }
}

TEST(GaussMarkov, TwoStepsAreOneOfTwiceTheLength) {
  const GaussMarkov process{0.7, 2.0};
  const double decay = process.decay(0.3);
  EXPECT_NEAR(decay * decay, process.decay(0.6), 1e-15);
  EXPECT_NEAR(decay * decay * process.noise_variance(0.3) + process.noise_variance(0.3), process.noise_variance(0.6),
              1e-15);
}

TEST(GaussMarkov, StandsStillWithoutTimeAndForgetsAfterLong) {
  const GaussMarkov process{0.7, 2.0};
  EXPECT_EQ(process.decay(0.0), 1.0);
  EXPECT_EQ(process.noise_variance(0.0), 0.0);
  EXPECT_NEAR(process.decay(2.0), std::exp(-1.0), 1e-15);
  EXPECT_LT(process.decay(200.0), 1e-40);
  EXPECT_NEAR(process.noise_variance(200.0), 0.49, 1e-15);
}

}  // namespace
}  // namespace groundscale
