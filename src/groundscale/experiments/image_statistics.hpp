#pragma once

#include <array>
#include <optional>
#include <string>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// What the images of a drive are like, in grey levels.
struct ImageStatistics {
  static constexpr int kBands = 8;  ///< Of 32 grey levels each.

  double mean = 0.0;
  double sd = 0.0;
  double dark_share = 0.0;    ///< Of pixels up to 15,
  double bright_share = 0.0;  ///< and from 250.
  double gradient = 0.0;      ///< Mean over pixels of its length.
  /// Noise by the brightness of its place: of all patches of 5 x 5 pixels that are flat (tilted by less than 0.6 a
  /// pixel) the sd that remains beside the tilt, its 5 % quantile, over 0.749, which is that quantile of the sd of pure
  /// noise with 22 degrees of freedom. Empty where there are fewer than 200 flat patches.
  std::array<std::optional<double>, kBands> noise;
};

/// Over every tenth image of a drive. @return kBadInput where an image can't be read.
Result<ImageStatistics> image_statistics(const std::string& drive_folder, int frames);

/// Two images one above the other, for looking at. @return kBadInput where one can't be read; kIo.
Result<void> write_pair(const std::string& upper, const std::string& lower, const std::string& output);

}  // namespace groundscale
