#pragma once

#include <deque>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "groundscale/core/rng.hpp"
#include "groundscale/mapping/local_map.hpp"
#include "groundscale/mapping/relocalise.hpp"
#include "groundscale/odometry/bridge.hpp"

namespace groundscale {

/// What a map looked like that carries frames no more. For 5 s frames may find it again by that.
class LostMap {
 public:
  LostMap(CameraPtr camera, const ResectionOptions& options) : camera_(std::move(camera)), options_(options) {}

  /// The camera is another one from now on, in the same axes.
  void use_camera(CameraPtr camera) { camera_ = std::move(camera); }

  /// Takes views of the map for a frame that has lost it.
  /// @param recent   Latest frames with an image.
  /// @param located  Index of the last frame that the map has located.
  void remember(const LocalMap& map, const std::deque<TrackedFrame>& recent, int located);
  /// The map carries no frames from now on.
  void wait(double time_s) { since_s_ = time_s; }
  /// Whether there is such a map.
  bool waiting() const { return since_s_.has_value(); }
  void forget();

  /// Pose of a frame by the views, and the landmarks that it shows (`relocalise`). Nothing where it isn't found; after
  /// too long it is forgotten.
  /// @param cam_from_world_guesses  Tried in this order.
  std::optional<Relocalised> find(const TrackedFrame& present, std::span<const RigidTransform> cam_from_world_guesses,
                                  Rng& rng);

 private:
  CameraPtr camera_;
  ResectionOptions options_;
  std::optional<double> since_s_;
  std::vector<MapView> views_;
};

}  // namespace groundscale
