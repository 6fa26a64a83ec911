#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/scale/scale_keeper.hpp"

namespace groundscale {

/// What a made-up SLAM system is told to do.
struct ForeignDrive {
  int frames = 200;
  double step_m = 0.8;
  double dt_s = 0.1;
  std::function<double(double along_m)> curvature_per_m = [](double) { return 0.0; };
  /// log(metres per map unit), by the way driven.
  std::function<double(double along_m)> log_unit = [](double) { return 0.0; };
  double road_noise_m = 0.005;  ///< Of the points' heights.
  std::uint64_t seed = 1;
};

/// The map of such a system: a level camera over a level road, poses and road points in units that change along the
/// way.
class ForeignMap {
 public:
  static constexpr double kHeightM = 1.65;

  explicit ForeignMap(const ForeignDrive& drive) : drive_(drive) {
    Rng rng(drive.seed);
    const Eigen::Vector3d normal = Eigen::Vector3d::UnitY();
    RigidTransform pose;
    const int beyond = static_cast<int>(std::ceil(kAheadM / drive.step_m));
    for (int k = 0; k < drive.frames + beyond; ++k) {
      const double along = k * drive.step_m;
      const double unit_m = std::exp(drive.log_unit(along));
      poses_.push_back(pose);
      unit_m_.push_back(unit_m);
      const int count = static_cast<int>(std::lround(kPointsPerM * (along + drive.step_m))) -
                        static_cast<int>(std::lround(kPointsPerM * along));
      std::vector<Eigen::Vector3d> points;
      for (int i = 0; i < count; ++i) {
        const Eigen::Vector3d in_cam(rng.uniform(-2.0, 2.0), kHeightM - drive.road_noise_m * rng.normal(),
                                     rng.uniform(0.0, drive.step_m));
        points.emplace_back(pose * Eigen::Vector3d(in_cam / unit_m));
      }
      points_.push_back(std::move(points));
      const double turn = drive.curvature_per_m(along) * drive.step_m;
      const Eigen::Matrix3d half = exp_so3(0.5 * turn * normal);
      pose.translation += pose.rotation * half * Eigen::Vector3d(0.0, 0.0, drive.step_m / unit_m);
      pose.rotation = pose.rotation * half * half;
    }
  }

  int frames() const { return drive_.frames; }
  double metres_per_unit(int frame) const { return unit_m_[static_cast<std::size_t>(frame)]; }
  const std::vector<RigidTransform>& poses() const { return poses_; }

  /// What the system hands over at a frame: 20 m of poses, and the road from 10 m behind to 15 m ahead.
  ScaleKeeper::Input input(int frame) const {
    ScaleKeeper::Input input;
    input.time_s = frame * drive_.dt_s;
    const int first = std::max(0, frame - static_cast<int>(20.0 / drive_.step_m));
    input.world_from_cam.assign(poses_.begin() + first, poses_.begin() + frame + 1);
    const int from = std::max(0, frame - static_cast<int>(10.0 / drive_.step_m));
    const int to = std::min(static_cast<int>(points_.size()), frame + static_cast<int>(kAheadM / drive_.step_m));
    for (int k = from; k < to; ++k) {
      const auto& points = points_[static_cast<std::size_t>(k)];
      input.road_points_in_world.insert(input.road_points_in_world.end(), points.begin(), points.end());
    }
    return input;
  }

  /// The whole map, lambda times as large: what a correction does.
  void scale(double lambda) {
    const Similarity scaling = scaling_about(Eigen::Vector3d(3.0, -1.0, 7.0), lambda);
    for (RigidTransform& pose : poses_) pose.translation = scaling * pose.translation;
    for (auto& points : points_) {
      for (Eigen::Vector3d& point : points) point = scaling * point;
    }
    for (double& unit_m : unit_m_) unit_m /= lambda;
  }

 private:
  static constexpr double kAheadM = 15.0;
  static constexpr double kPointsPerM = 12.0;
  ForeignDrive drive_;
  std::vector<RigidTransform> poses_;  ///< world_from_cam, map units.
  std::vector<double> unit_m_;
  std::vector<std::vector<Eigen::Vector3d>> points_;  ///< In the world, by the frame they lie beneath.
};

}  // namespace groundscale
