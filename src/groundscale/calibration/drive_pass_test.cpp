#include "groundscale/calibration/drive_pass.hpp"

#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

DrivePass with_steps(std::vector<double> steps_m) {
  DrivePass pass;
  pass.ground_steps_m = std::move(steps_m);
  return pass;
}

std::vector<double> steps(std::size_t count, double step_m) { return std::vector<double>(count, step_m); }

TEST(LengthChange, IsTheMedianRatioOfStepsLessOne) {
  std::vector<double> before, after;
  for (int k = 0; k < 41; ++k) {
    before.push_back(0.5 + 0.01 * k);
    after.push_back(before.back() * (1.0 + 0.001 * (k - 20) + 0.02));  // about 2 %
  }
  after[3] = 9.0;  // one that is far off
  EXPECT_NEAR(length_change({with_steps(before)}, {with_steps(after)}).value(), 0.021, 1e-12);
  EXPECT_NEAR(length_change({with_steps(steps(20, 0.8))}, {with_steps(steps(20, 0.8))}).value(), 0.0, 1e-15);
}

TEST(LengthChange, ComparesFramesThatBothMeasured) {
  std::vector<double> before = steps(60, 1.0);
  std::vector<double> after = steps(60, 1.03);
  for (std::size_t k = 0; k < 20; ++k) before[k] = 0.0;
  for (std::size_t k = 40; k < 60; ++k) after[k] = 0.0;
  // Twenty are left, the fewest there may be.
  EXPECT_NEAR(length_change({with_steps(before)}, {with_steps(after)}).value(), 0.03, 1e-12);
  after[39] = 0.0;
  EXPECT_FALSE(length_change({with_steps(before)}, {with_steps(after)}));
}

TEST(LengthChange, TakesAllDrivesTogether) {
  const std::vector<DrivePass> before = {with_steps(steps(15, 1.0)), with_steps(steps(16, 2.0))};
  const std::vector<DrivePass> after = {with_steps(steps(15, 0.9)), with_steps(steps(16, 1.9))};
  EXPECT_NEAR(length_change(before, after).value(), -0.05, 1e-12);
  EXPECT_FALSE(length_change({before[0]}, {after[0]}));
  EXPECT_FALSE(length_change({}, {}));
}

}  // namespace
}  // namespace groundscale
