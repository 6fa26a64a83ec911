#include "groundscale/simulation/sensor.hpp"

#include <cmath>
#include <numeric>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

Radiance even(float value) { return {200, 100, std::vector<float>(200 * 100, value)}; }

struct Statistics {
  double mean = 0.0;
  double sd = 0.0;
};

/// The first image of a camera that sees nothing but this light.
Image first_image(float light, const SensorOptions& options) {
  Rng rng(1);
  return expose(even(light), Exposure(options).follow(light, 0.1), options, rng);
}

Statistics statistics_of(const Image& image) {
  const int count = image.width() * image.height();
  Statistics s;
  for (int k = 0; k < count; ++k) s.mean += image.data()[k];
  s.mean /= count;
  for (int k = 0; k < count; ++k) s.sd += std::pow(image.data()[k] - s.mean, 2);
  s.sd = std::sqrt(s.sd / count);
  return s;
}

SensorOptions plain() {
  return {.vignetting = 0.0, .target = 0.4, .adaptation_s = 0.5, .full_well_e = 0.0, .read_noise_e = 0.0, .gamma = 2.0};
}

TEST(Sensor, TheFirstFrameIsExposedToTheTarget) {
  for (const float light : {0.02F, 0.5F, 3.0F}) {
    EXPECT_NEAR(statistics_of(first_image(light, plain())).mean, 0.4 * 255.0, 0.5);
  }
}

TEST(Sensor, ExposureFollowsWithALag) {
  Exposure exposure(plain());
  const double first = exposure.follow(0.2, 0.1);
  // A gain for a fourth is wanted; after 0.5 s 1 / e of the way in the logarithm is left.
  EXPECT_NEAR(exposure.follow(0.8, 0.0), first, 1e-12);
  EXPECT_NEAR(exposure.follow(0.8, 0.5), first / 4.0 * std::pow(4.0, std::exp(-1.0)), 1e-12);
}

TEST(Sensor, ShotAndReadNoiseHaveTheirSize) {
  SensorOptions options = plain();
  options.gamma = 1.0;
  options.full_well_e = 10000.0;
  options.read_noise_e = 30.0;
  const Statistics s = statistics_of(first_image(1.0F, options));
  // 4000 electrons: sd sqrt(4000 + 900) = 70 of 10000; and 1/12 of a squared grey level from rounding.
  EXPECT_NEAR(s.sd, std::sqrt(std::pow(255.0 * 70.0 / 10000.0, 2) + 1.0 / 12.0), 0.03);
  EXPECT_NEAR(s.mean, 0.4 * 255.0, 0.1);
}

TEST(Sensor, CornersLoseLightByVignetting) {
  SensorOptions options = plain();
  options.gamma = 1.0;
  options.vignetting = 0.5;
  const Image image = first_image(1.0F, options);
  EXPECT_NEAR(image.at(0, 0) / static_cast<double>(image.at(100, 50)), 0.5, 0.01);
}

}  // namespace
}  // namespace groundscale
