#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/ground_plane.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/motion/two_view.hpp"
#include "groundscale/plane/observations.hpp"

namespace groundscale {

/// What a pair of views is made up in: a level road beneath a camera, and anything beside it.
struct SyntheticWorld {
  CameraPtr camera;
  GroundPlane metric_road{Eigen::Vector3d::UnitY(), 1.65};
  int scene_points = 300;  ///< Drawn over the whole image, those that leave it among them.
  double nearest_m = 5.0;  ///< Their depths, log-uniform; those that would lie beneath the road lie on it.
  double farthest_m = 80.0;
};

/// Matches of a pair of views with known truth (Zhou et al. 2019, section VI-A): of road features x1, x2 = H x1 with
/// H = R + t n^T / h, and Gaussian noise on x2. One trial has the same scene and the same noise, scaled, whatever
/// motion and noise level it is looked at with, so that curves over either are comparable.
class SyntheticTrial {
 public:
  /// @param features  Pixels of road points in view 1.
  SyntheticTrial(const SyntheticWorld& world, const std::vector<Eigen::Vector2d>& features, std::uint64_t seed);

  /// Observations with the true motion, |t| = 1; points whose true x2 lies outside the image are left out. `points`
  /// are the road's features, `scene` these and all others.
  RoadObservations observe(const RigidTransform& metric_cam2_from_cam1, double noise_px) const;

 private:
  struct Point {
    Eigen::Vector2d pixel1;
    Eigen::Vector3d in_cam1_m;
    Eigen::Vector2d unit_noise;
    bool road = false;
  };

  SyntheticWorld world_;
  std::vector<Point> points_;
};

/// The same observations with the motion as it is measured from the noisy matches of the whole scene; nothing where
/// that fails.
std::optional<RoadObservations> with_estimated_motion(RoadObservations observations, const MotionOptions& options,
                                                      Rng& rng);

}  // namespace groundscale
