#include "groundscale/odometry/run_writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

std::string verdict(double per_100m, double sd) {
  ScaleSlope slope;
  slope.per_100m = per_100m;
  slope.sd_per_100m = sd;
  return calibration_verdict(slope);
}

TEST(CalibrationVerdict, SaysWhatTheSlopeCanTell) {
  EXPECT_EQ(verdict(0.01, 0.005), "no sign of a wrong calibration");
  EXPECT_EQ(verdict(0.01, 0.2), "too uncertain to say anything about the calibration");
  EXPECT_THAT(verdict(-0.08, 0.04), testing::StartsWith("perhaps "));
  for (const double slope : {0.1, -0.1}) EXPECT_THAT(verdict(slope, 0.01), testing::HasSubstr("groundscale calibrate"));
}

}  // namespace
}  // namespace groundscale
