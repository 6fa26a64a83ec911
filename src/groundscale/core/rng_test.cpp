#include "groundscale/core/rng.hpp"

#include <cmath>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

TEST(Rng, SameSeedGivesTheSameNumbersAndAnotherSeedOthers) {
  Rng first(7);
  Rng again(7);
  Rng other(8);
  bool differs = false;
  for (int k = 0; k < 100; ++k) {
    const std::uint64_t value = first.next();
    EXPECT_EQ(value, again.next());
    differs |= value != other.next();
  }
  EXPECT_TRUE(differs);
}

TEST(Rng, UniformAndIndexStayInTheirRangesAndFillThem) {
  Rng rng(1);
  int seen[5] = {};
  double sum = 0.0;
  constexpr int kDraws = 10000;
  for (int k = 0; k < kDraws; ++k) {
    const double u = rng.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    ++seen[rng.index(5)];
  }
  EXPECT_NEAR(sum / kDraws, 0.5, 5.0 * std::sqrt(1.0 / 12.0 / kDraws));                           // five sigma
  for (const int count : seen) EXPECT_NEAR(count, kDraws / 5.0, 5.0 * std::sqrt(kDraws * 0.16));  // five sigma
}

TEST(Rng, NormalHasMeanZeroAndVarianceOne) {
  Rng rng(2);
  double sum = 0.0;
  double squares = 0.0;
  constexpr int kDraws = 20000;
  for (int k = 0; k < kDraws; ++k) {
    const double value = rng.normal();
    sum += value;
    squares += value * value;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 5.0 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 1.0, 5.0 * std::sqrt(2.0 / kDraws));
}

}  // namespace
}  // namespace groundscale
