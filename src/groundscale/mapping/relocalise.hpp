#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/image.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/mapping/resection.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

/// An image of a map that was lost, and the landmarks that it shows.
struct MapView {
  struct Landmark {
    TrackId id = 0;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
    Eigen::Vector3d point_in_world = Eigen::Vector3d::Zero();
  };
  Image image;
  std::vector<Landmark> landmarks;
};

struct Relocalised {
  Resection pose;
  std::vector<TrackPoint> sights;  ///< Landmarks that agree, where the image shows them; ids ascending.
};

/// Pose of an image in a map from views of it taken before. Corners of the image and its reductions are matched with
/// the landmarks by ORB's descriptor, taken upright (Rublee et al. 2011), so that up to twice as near a landmark is
/// known again; `resect` finds the pose; what agrees is followed from its view into the image for a part of a pixel.
/// Images may differ in exposure.
/// @return Errors as those of resect. Deterministic for a given rng. O(landmarks * corners): some 10 ms; meant for
///         frames that tracking has lost.
Result<Relocalised> relocalise(const std::vector<MapView>& views, const Image& image, const Camera& camera,
                               const RigidTransform& cam_from_world_guess, const ResectionOptions& options, Rng& rng);

}  // namespace groundscale
