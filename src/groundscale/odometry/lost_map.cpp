#include "groundscale/odometry/lost_map.hpp"

#include <algorithm>
#include <array>

namespace groundscale {

void LostMap::remember(const LocalMap& map, const std::deque<TrackedFrame>& recent, int located) {
  views_.clear();
  constexpr std::array<int, 3> kFramesBack{0, 5, 15};
  for (const int back : kFramesBack) {
    const auto seen = std::find_if(recent.rbegin(), recent.rend(), [located, back](const TrackedFrame& frame) {
      return frame.index <= located - back;
    });
    if (seen == recent.rend()) break;
    MapView view{seen->frame.image, {}};
    for (const TrackPoint& track : seen->tracked.points) {
      const Eigen::Vector3d* point = map.point_of(track.id);
      if (point != nullptr) view.landmarks.push_back({track.id, track.pixel, *point});
    }
    views_.push_back(std::move(view));
  }
}

void LostMap::forget() {
  since_s_.reset();
  views_.clear();
}

std::optional<Relocalised> LostMap::find(const TrackedFrame& present,
                                         std::span<const RigidTransform> cam_from_world_guesses, Rng& rng) {
  constexpr double kLongestS = 5.0;
  if (since_s_ && present.frame.time_s - *since_s_ > kLongestS) forget();
  constexpr std::size_t kLeastTracks = 30;  // else there is nothing to see
  if (views_.empty() || present.frame.image.empty() || present.tracked.points.size() < kLeastTracks) {
    return std::nullopt;
  }
  for (const RigidTransform& guess : cam_from_world_guesses) {
    auto found = relocalise(views_, present.frame.image, *camera_, guess, options_, rng);
    if (found) return std::move(*found);
  }
  return std::nullopt;
}

}  // namespace groundscale
