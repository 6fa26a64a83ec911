#pragma once

#include <algorithm>
#include <iterator>
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

/// The drive with the tracks alone that `keep` says.
template <class Keep>
DriveTracks tracks_of(const DriveTracks& drive, Keep keep) {
  DriveTracks part{drive.views, {}};
  std::copy_if(drive.tracks.begin(), drive.tracks.end(), std::back_inserter(part.tracks), keep);
  return part;
}

}  // namespace groundscale
