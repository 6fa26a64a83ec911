#include "groundscale/simulation/sensor.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace groundscale {

double Exposure::follow(double mean_light, double dt_s) {
  constexpr double kDarkest = 1e-3;
  // The mean grey level is to be the target: light = grey^gamma.
  const double wanted = std::pow(options_.target, options_.gamma) / std::max(kDarkest, mean_light);
  if (!gain_) gain_ = wanted;
  const double share = options_.adaptation_s > 0.0 ? 1.0 - std::exp(-dt_s / options_.adaptation_s) : 1.0;
  *gain_ *= std::pow(wanted / *gain_, share);
  return *gain_;
}

Image expose(const Radiance& light, double gain, const SensorOptions& options, Rng& rng) {
  Image image(light.width, light.height);
  const double centre_x = 0.5 * (light.width - 1);
  const double centre_y = 0.5 * (light.height - 1);
  const double corner_squared = std::max(1.0, centre_x * centre_x + centre_y * centre_y);
  std::uint8_t* pixel = image.data();
  const float* value = light.values.data();
  for (int y = 0; y < light.height; ++y) {
    for (int x = 0; x < light.width; ++x, ++pixel, ++value) {
      const double radius_squared =
          ((x - centre_x) * (x - centre_x) + (y - centre_y) * (y - centre_y)) / corner_squared;
      double share_of_full = gain * *value * (1.0 - options.vignetting * radius_squared);
      if (options.full_well_e > 0.0) {
        const double electrons = std::max(0.0, share_of_full * options.full_well_e);
        const double sd = std::sqrt(electrons + options.read_noise_e * options.read_noise_e);
        share_of_full = (electrons + sd * rng.normal()) / options.full_well_e;
      }
      const double linear = std::clamp(share_of_full, 0.0, 1.0);
      const double grey = options.gamma == 1.0 ? linear : std::pow(linear, 1.0 / options.gamma);
      *pixel = static_cast<std::uint8_t>(std::lround(255.0 * grey));
    }
  }
  return image;
}

}  // namespace groundscale
