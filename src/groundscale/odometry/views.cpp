#include "groundscale/odometry/views.hpp"

#include <utility>

#include "groundscale/estimation/robust.hpp"

namespace groundscale {

void Views::push(View view) {
  views_.push_back(std::move(view));
  while (static_cast<int>(views_.size()) > options_.max_frames) views_.pop_front();
}

Pair Views::pair_with(const std::vector<TrackPoint>& points, const Camera& camera, bool standing) {
  Pair best;
  const double share = standing ? kShareAtHalt : 0.75;
  double best_parallax = -1.0;
  for (auto view = views_.rbegin(); view != views_.rend(); ++view) {
    Matches matches = match_by_id(view->points, points);
    if (best.view != nullptr && static_cast<int>(matches.size()) < options_.min_matches) break;
    std::vector<RayPair> rays = ray_pairs(matches, camera);
    const bool latest = view == views_.rbegin();
    if (latest && has_stood_still(rays, camera.focal_px(), motion_, share)) {
      best = {{view->result, std::move(rays), {}}, &*view, std::move(matches)};
      best.motion.state = MotionState::kStill;
      return best;
    }
    const double parallax = rays.empty() ? 0.0 : fit_rotation(rays, camera.focal_px()).parallax_px;
    if (parallax > best_parallax) {
      best_parallax = parallax;
      best = {{view->result, std::move(rays), {}}, &*view, std::move(matches)};
    }
    if (parallax >= options_.min_parallax_px) break;
  }
  return best;
}

}  // namespace groundscale
