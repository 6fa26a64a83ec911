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
  Rng rng(1);
  for (const float light : {0.02F, 0.5F, 3.0F}) {
    EXPECT_NEAR(statistics_of(Sensor(plain(), rng).expose(even(light), 0.1)).mean, 0.4 * 255.0, 0.5);
  }
}

TEST(Sensor, ExposureFollowsWithALag) {
  Rng rng(1);
  Sensor sensor(plain(), rng);
  sensor.expose(even(0.2F), 0.1);
  // Four times the light is twice the grey level at gamma 2; after 0.5 s 1 / e of it in the logarithm is left.
  EXPECT_NEAR(statistics_of(sensor.expose(even(0.8F), 0.0)).mean, 0.8 * 255.0, 0.6);
  EXPECT_NEAR(statistics_of(sensor.expose(even(0.8F), 0.5)).mean, 0.4 * std::pow(2.0, std::exp(-1.0)) * 255.0, 0.6);
}

TEST(Sensor, ShotAndReadNoiseHaveTheirSize) {
  Rng rng(1);
  SensorOptions options = plain();
  options.gamma = 1.0;
  options.full_well_e = 10000.0;
  options.read_noise_e = 30.0;
  const Statistics s = statistics_of(Sensor(options, rng).expose(even(1.0F), 0.1));
  // 4000 electrons: sd sqrt(4000 + 900) = 70 of 10000; and 1/12 of a squared grey level from rounding.
  EXPECT_NEAR(s.sd, std::sqrt(std::pow(255.0 * 70.0 / 10000.0, 2) + 1.0 / 12.0), 0.03);
  EXPECT_NEAR(s.mean, 0.4 * 255.0, 0.1);
}

TEST(Sensor, CornersLoseLightByVignetting) {
  Rng rng(1);
  SensorOptions options = plain();
  options.gamma = 1.0;
  options.vignetting = 0.5;
  const Image image = Sensor(options, rng).expose(even(1.0F), 0.1);
  EXPECT_NEAR(image.at(0, 0) / static_cast<double>(image.at(100, 50)), 0.5, 0.01);
}

}  // namespace
}  // namespace groundscale
