#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "groundscale/core/image.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/odometry.hpp"

namespace groundscale {

/// Writes one frame with what was measured in it as `<folder>/<frame, six digits>.png`.
///
/// The image is not the frame's own but that of the pair's earlier view, in which the region lies: region (tinted),
/// matches of the whole image (green inliers, red outliers, drawn to where the point went), road matches (yellow
/// inliers, magenta outliers; outliers are crosses, inliers circles), and the plane as a grid on the road, 2 m across
/// and 5 m along. Frames without a pair show the image and the reason.
/// @return kIo where the file can't be written.
Result<void> write_overlay(const std::string& folder, const Frame& frame, const Odometry& odometry,
                           const Camera& camera);

/// What a picture of a frame is drawn from, at the size at which it will be: made fast, to be drawn later or never.
struct OverlayParts {
  struct Line {
    Eigen::Vector2d from, to;
  };
  struct Match {
    Line line;
    bool road = false;
    bool fits = false;
  };
  Image image;  ///< Grey.
  Image region;
  std::vector<Line> plane;
  std::vector<Match> matches;  ///< In the order in which they are drawn.
};

/// @param most_width_px  A wider image is made smaller, and images are copies; 0: they are as they are, and shared.
OverlayParts overlay_parts(const Frame& frame, const Odometry& odometry, const Camera& camera, int most_width_px);

/// The picture of write_overlay without its line of text, as the bytes of a JPEG file. @return "" where it can't be
/// made.
std::string overlay_jpeg(const OverlayParts& parts);

}  // namespace groundscale
