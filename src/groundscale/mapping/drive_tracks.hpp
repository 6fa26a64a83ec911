#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/tracking/matches.hpp"

namespace groundscale {

/// A drive as its tracks saw it: some of its frames, and the pixels of points that were followed through them.
struct DriveTracks {
  struct View {
    int frame = 0;  ///< In the source.
    RigidTransform cam_from_world;
  };
  struct Sight {
    int view = 0;
    Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  };
  struct Track {
    TrackId id = 0;
    std::vector<Sight> sights;  ///< Views ascending.
  };
  std::vector<View> views;    ///< Frames ascending.
  std::vector<Track> tracks;  ///< Ids ascending.
};

}  // namespace groundscale
