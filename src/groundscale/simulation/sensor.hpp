#pragma once

#include <optional>

#include "groundscale/core/image.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/simulation/renderer.hpp"

namespace groundscale {

/// What the camera makes of light.
struct SensorOptions {
  double vignetting = 0.25;     ///< Loss of light in the corner.
  double target = 0.42;         ///< Mean of the image that the exposure aims at, 1 = full.
  double adaptation_s = 0.5;    ///< Time in which the exposure makes up for most of a change.
  double full_well_e = 8000.0;  ///< Electrons of a full pixel: shot noise is the root of their number. 0: no noise.
  double read_noise_e = 14.0;   ///< Electrons, sd.
  double gamma = 1.0;           ///< Grey level = light^(1 / gamma).
};

/// The gain of each image: it follows the scene with a lag.
class Exposure {
 public:
  explicit Exposure(const SensorOptions& options) : options_(options) {}

  /// @param mean_light  Of the image, about: a part of its pixels will do.
  /// @param dt_s        Since the frame before; of no account for the first.
  double follow(double mean_light, double dt_s);

 private:
  SensorOptions options_;
  std::optional<double> gain_;
};

/// Turns light into an 8-bit image at a gain.
Image expose(const Radiance& light, double gain, const SensorOptions& options, Rng& rng);

}  // namespace groundscale
