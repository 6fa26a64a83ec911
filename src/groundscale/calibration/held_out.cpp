#include "groundscale/calibration/held_out.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <utility>

namespace groundscale {
namespace {

bool takes_part(const DriveTracks::Track& track) { return track.id % 3 != 0; }

}  // namespace

DriveTracks without_held_out(const DriveTracks& drive) { return tracks_of(drive, takes_part); }

HeldOut compare_held_out(const std::vector<DrivePass>& passes, const CameraPtr& before, const CameraPtr& after,
                         const BatchOptions& options) {
  HeldOut result;
  std::array<double, 2> sums{};
  int sights = 0;
  for (const DrivePass& pass : passes) {
    const DriveTracks rest = tracks_of(pass.tracks, std::not_fn(takes_part));
    std::array<std::vector<TrackError>, 2> errors;
    for (const std::size_t which : {0, 1}) {
      const CameraPtr& camera = which == 0 ? before : after;
      const auto poses = adjust_batch(without_held_out(pass.tracks), camera, {}, options);
      if (!poses) continue;
      errors[which] = reprojection_errors(rest, poses->cam_from_world, *camera, options);
      auto& map = which == 0 ? result.residuals_before : result.residuals_after;
      ResidualMap own = residual_map(rest, poses->cam_from_world, *camera, options);
      if (map) map->merge(own);
      if (!map) map = std::move(own);
    }
    // A drive that one of them can't place says nothing.
    for (std::size_t i = 0; i < std::min(errors[0].size(), errors[1].size()); ++i) {
      const TrackError& a = errors[0][i];
      const TrackError& b = errors[1][i];
      if (a.sights == 0 || b.sights == 0 || std::min(a.rms_px, b.rms_px) > options.max_error_px) continue;
      sums[0] += a.loss;
      sums[1] += b.loss;
      sights += a.sights;
      ++result.tracks;
    }
  }
  if (sights == 0) return result;
  result.before_px = std::sqrt(2.0 * sums[0] / sights);
  result.after_px = std::sqrt(2.0 * sums[1] / sights);
  return result;
}

}  // namespace groundscale
