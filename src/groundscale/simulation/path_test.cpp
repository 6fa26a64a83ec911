#include "groundscale/simulation/path.hpp"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

constexpr double kRightAngle = std::numbers::pi / 2.0;

TEST(Path, AStraightPieceLeadsForward) {
  const Path path = Path::of_pieces({{100.0, 0.0}}, {});
  EXPECT_DOUBLE_EQ(path.length_m(), 100.0);
  const PathPoint point = path.at(37.51);
  EXPECT_NEAR((point.position - Eigen::Vector3d(0.0, 0.0, 37.51)).norm(), 0.0, 1e-9);
  EXPECT_EQ(point.heading_rad, 0.0);
  EXPECT_EQ(point.curvature_per_m, 0.0);
}

TEST(Path, AnArcIsACircle) {
  // Curvature changes at once where a piece is short: a quarter circle of 10 m to the right ends at (10, 10).
  const Path path = Path::of_pieces({{1e-6, 0.1}, {10.0 * kRightAngle, 0.1}}, {});
  const PathPoint end = path.at(path.length_m());
  // Chords of 5 cm are short by (0.1 x 0.05)^2 / 24 of their length.
  EXPECT_NEAR(end.position.x(), 10.0, 1e-4);
  EXPECT_NEAR(end.position.z(), 10.0, 1e-4);
  EXPECT_NEAR(end.heading_rad, kRightAngle, 1e-6);
}

TEST(Path, ATurnHasItsAngleAndItsMirrorImage) {
  const Path right = Path::of_pieces(turn_pieces(kRightAngle, 8.0, 5.0), {});
  const Path left = Path::of_pieces(turn_pieces(-kRightAngle, 8.0, 5.0), {});
  const PathPoint right_end = right.at(right.length_m());
  const PathPoint left_end = left.at(left.length_m());
  EXPECT_NEAR(right_end.heading_rad, kRightAngle, 1e-9);
  EXPECT_NEAR(left_end.heading_rad, -kRightAngle, 1e-9);
  EXPECT_NEAR(right_end.position.x(), -left_end.position.x(), 1e-9);
  EXPECT_NEAR(right_end.position.z(), left_end.position.z(), 1e-9);
  EXPECT_NEAR(right_end.position.x(), right_end.position.z(), 1e-3);  // symmetric about its middle
}

TEST(Path, SlopeIsTheDerivativeOfTheRise) {
  const Path path = Path::of_pieces({{200.0, 0.0}}, {{3.0, 120.0, 0.4}, {0.5, 33.0, 2.0}});
  EXPECT_NEAR(path.at(0.0).position.y(), 0.0, 1e-12);
  for (const double s : {10.0, 55.5, 120.3}) {
    constexpr double kStep = 0.1;
    const double rise = path.at(s - kStep).position.y() - path.at(s + kStep).position.y();  // y looks down
    EXPECT_NEAR(path.at(s).slope, rise / (2.0 * kStep), 1e-4);
  }
}

TEST(Path, BeyondItsEndsItGoesOnStraight) {
  const Path path = Path::of_pieces(turn_pieces(kRightAngle, 8.0, 5.0), {});
  EXPECT_NEAR((path.at(-3.0).position - Eigen::Vector3d(0.0, 0.0, -3.0)).norm(), 0.0, 1e-12);
  const PathPoint end = path.at(path.length_m());
  const PathPoint beyond = path.at(path.length_m() + 4.0);
  EXPECT_NEAR((beyond.position - end.position - Eigen::Vector3d(4.0, 0.0, 0.0)).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace groundscale
