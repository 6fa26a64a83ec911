#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {

struct KltOptions {
  int window_px = 16;  ///< OpenCV adds up eight pixels at a time: 16 costs two thirds of 15.
  int levels = 4;      ///< Reductions used, at most those of the pyramid.
  int max_iterations = 20;
  double min_step_px = 0.02;       ///< An iteration ends where its step is smaller.
  double max_round_trip_px = 0.5;  ///< Forward-backward check (Kalal et al. 2010).
};

/// Follows points from one image to the other (Lucas, Kanade 1981; Bouguet 2000) and back again.
/// @param guesses  Where the points are expected in the second image; as long as `points`.
/// @return A point each; nothing where it was lost or came back elsewhere.
std::vector<std::optional<Eigen::Vector2d>> track_points(const Pyramid& first, const Pyramid& second,
                                                         const std::vector<Eigen::Vector2d>& points,
                                                         const std::vector<Eigen::Vector2d>& guesses,
                                                         const KltOptions& options);

}  // namespace groundscale
