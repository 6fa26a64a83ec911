#pragma once

#include <string>

#include "groundscale/core/result.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/odometry.hpp"

namespace groundscale {

/// Writes one frame with what was measured in it as `<folder>/<frame, six digits>.png`.
///
/// The image is not the frame's own but that of the pair's earlier view, in which the region lies: region (tinted),
/// matches of the whole image (green inliers, red outliers, drawn to where the point went), road matches (yellow
/// inliers, magenta outliers), and the plane as a grid on the road, 2 m across and 5 m along. Frames without a pair
/// show the image and the reason.
/// @return kIo where the file can't be written.
Result<void> write_overlay(const std::string& folder, const Frame& frame, const Odometry& odometry,
                           const Camera& camera);

/// The same picture without its line of text as the bytes of a JPEG file, made smaller where it is wider than that.
/// @return "" where it can't be made.
std::string overlay_jpeg(const Frame& frame, const Odometry& odometry, const Camera& camera, int most_width_px);

}  // namespace groundscale
