#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/road/road_tracker.hpp"
#include "groundscale/tracking/matches.hpp"
#include "groundscale/tracking/stereoscan.hpp"

namespace groundscale {

/// Features of the part of an image in which the road is looked for.
struct RoadFeatures {
  FeatureSet features;
  Eigen::Vector2i corner = Eigen::Vector2i::Zero();  ///< Of that part in the image.
};

/// Of the rectangle that holds the region (not 0) and a margin about it. Empty where the region has no pixels.
RoadFeatures find_road_features(const Image& image, const Image& region, const StereoScanOptions& options);

/// Those within the region, in pixels of the image, strongest first.
std::vector<Eigen::Vector2d> places_in(const RoadFeatures& features, const Image& region);

/// Road points of one image in another by features of both, the second image warped as the road is expected to move,
/// so that like looks alike and lies near. As `track_on_road`, with features in place of image alignment.
/// @return A match for each point whose feature (the nearest that is matched) was found forth and back.
Matches match_on_road(const RoadFeatures& first, const Image& second, const std::vector<TrackPoint>& points,
                      const RoadWarp& warp, const Camera& camera, const StereoScanOptions& options);

}  // namespace groundscale
