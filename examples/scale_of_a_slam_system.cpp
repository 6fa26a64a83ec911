// A SLAM system of one's own hands over its poses and the road points of its map, frame by frame, and is told how much
// its scale has drifted. Here the system is made up: it drives along a street with two turns and loses 15 % of its
// scale in 100 m. Twice: once its map stays as it is and gets metres (`filtered`), once its local map is scaled where
// it has drifted too far (`triggered`, Algorithm 2 of Zhou, Dai, Li 2019).
#include <cmath>
#include <cstdio>
#include <vector>

#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/scale/scale_keeper.hpp"

namespace {

using namespace groundscale;

constexpr double kCameraHeightM = 1.65;
constexpr double kStepM = 0.8;  // 8 m/s at 10 frames a second
constexpr double kDriftPerM = 0.15 / 100.0;
constexpr int kFrames = 380;
constexpr int kAhead = 12;  // frames' worth of road that the camera sees before it

/// The true drive, in metres: straight, right, straight, left, straight.
std::vector<RigidTransform> street() {
  std::vector<RigidTransform> world_from_cam(1);
  for (int k = 1; k < kFrames + kAhead + 1; ++k) {
    const double driven_m = k * kStepM;
    constexpr double kRadiusM = 14.0;
    constexpr double kArcM = 22.0;  // 90 degrees
    double turn = 0.0;
    if (driven_m > 80.0 && driven_m < 80.0 + kArcM) turn = kStepM / kRadiusM;
    if (driven_m > 180.0 && driven_m < 180.0 + kArcM) turn = -kStepM / kRadiusM;
    const RigidTransform step{exp_so3({0.0, turn, 0.0}), {0.0, 0.0, kStepM}};
    world_from_cam.push_back(world_from_cam.back() * step);
  }
  return world_from_cam;
}

/// The system: it knows no metres. What it adds to its map is smaller and smaller.
class SlamSystem {
 public:
  explicit SlamSystem(std::vector<RigidTransform> truth) : truth_(std::move(truth)) { see(0); }

  void advance(int frame) {
    metres_per_unit_ *= 1.0 + kDriftPerM * kStepM;
    RigidTransform step = before(frame).inverse() * truth_[static_cast<std::size_t>(frame)];
    step.translation /= metres_per_unit_;
    poses_.push_back(poses_.back() * step);
    see(frame);
  }

  /// What a ScaleKeeper wants of it. Level camera, so that the road's normal is (0, 1, 0) within a degree.
  ScaleKeeper::Input road_and_poses(int frame) const {
    ScaleKeeper::Input input;
    input.time_s = 0.1 * frame;
    input.world_from_cam.assign(poses_.begin() + static_cast<std::ptrdiff_t>(first_local()), poses_.end());
    for (std::size_t k = first_local(); k < road_.size(); ++k) {
      input.road_points_in_world.insert(input.road_points_in_world.end(), road_[k].begin(), road_[k].end());
    }
    return input;
  }

  /// Scales the local map, the last 25 m of it, about the centre of its oldest pose; what it adds next fits to that.
  void scale(double lambda) {
    const Similarity scaling = scaling_about(poses_[first_local()].translation, lambda);
    for (std::size_t k = first_local(); k < poses_.size(); ++k) {
      poses_[k].translation = scaling * poses_[k].translation;
      for (Eigen::Vector3d& point : road_[k]) point = scaling * point;
    }
    metres_per_unit_ /= lambda;
  }

  double last_step() const { return (poses_.back().translation - poses_[poses_.size() - 2].translation).norm(); }

  /// Of the trajectory as it is now, in its own units.
  double length() const {
    double sum = 0.0;
    for (std::size_t k = 1; k < poses_.size(); ++k) sum += (poses_[k].translation - poses_[k - 1].translation).norm();
    return sum;
  }

 private:
  static constexpr std::size_t kLocal = 31;

  const RigidTransform& before(int frame) const { return truth_[static_cast<std::size_t>(frame - 1)]; }
  std::size_t first_local() const { return poses_.size() > kLocal ? poses_.size() - kLocal : 0; }

  /// Maps road points up to 10 m ahead, each good for a centimetre.
  void see(int frame) {
    const RigidTransform cam_from_world = truth_[static_cast<std::size_t>(frame)].inverse();
    std::vector<Eigen::Vector3d> points;
    for (int i = 0; i < 12; ++i) {
      const int there = frame + 3 + rng_.index(kAhead - 2);
      const Eigen::Vector3d beside(rng_.uniform(-2.0, 2.0), kCameraHeightM + 0.01 * rng_.normal(), 0.0);
      const Eigen::Vector3d in_cam = cam_from_world * (truth_[static_cast<std::size_t>(there)] * beside);
      points.emplace_back(poses_.back() * Eigen::Vector3d(in_cam / metres_per_unit_));
    }
    road_.push_back(std::move(points));
  }

  std::vector<RigidTransform> truth_;
  double metres_per_unit_ = 1.05;  // as good as a start can be
  std::vector<RigidTransform> poses_ = std::vector<RigidTransform>(1);
  std::vector<std::vector<Eigen::Vector3d>> road_;  // by the frame that mapped them
  Rng rng_{1};
};

/// Length of the drive in metres by the system with a keeper.
double drive(ScaleCorrection correction) {
  SlamSystem slam(street());
  ScaleKeeper keeper(kCameraHeightM, correction, {});
  keeper.start(/*metres_per_unit=*/1.0, /*sd=*/0.1);
  keeper.advance(slam.road_and_poses(0));
  double length_m = 0.0;
  for (int k = 1; k < kFrames; ++k) {
    slam.advance(k);
    const ScaleReport report = keeper.advance(slam.road_and_poses(k));
    length_m += report.held * slam.last_step();
    if (k % 50 == 0 && report.drift_ratio) {
      std::printf("  %5.1f m: one unit is held for %.3f m, measured %.3f, drift ratio %.3f\n", kStepM * k, report.held,
                  *report.measured, *report.drift_ratio);
    }
    if (report.correction) {
      std::printf("  %5.1f m: the local map is scaled by %.3f\n", kStepM * k, *report.correction);
      slam.scale(*report.correction);
      keeper.corrected(*report.correction);
    }
  }
  // Filtered: each step with the metres of its time. Else the map, as it was scaled, with the metres that are held.
  return correction == ScaleCorrection::kFiltered ? length_m : keeper.held() * slam.length();
}

}  // namespace

int main() {
  constexpr double kTrueM = kStepM * (kFrames - 1);
  const auto error_of = [](const char* name, ScaleCorrection correction) {
    std::printf("%s\n", name);
    const double error = drive(correction) / kTrueM - 1.0;
    std::printf("  length of the drive: %+.1f %%\n", 100.0 * error);
    return error;
  };
  error_of("scale of the start", ScaleCorrection::kNone);
  const double filtered = error_of("filtered", ScaleCorrection::kFiltered);
  const double triggered = error_of("triggered", ScaleCorrection::kTriggered);
  return std::abs(filtered) < 0.02 && std::abs(triggered) < 0.02 ? 0 : 1;
}
