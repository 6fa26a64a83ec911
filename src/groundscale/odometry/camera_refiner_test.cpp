#include "groundscale/odometry/camera_refiner.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

constexpr double kRow = 180.0;

CameraPtr camera_of(double row, double k1) {
  return *PinholeCamera::create({.fx = 700, .fy = 700, .cx = 600, .cy = row, .k1 = k1}, 1240, 370);
}

CameraRefineOptions online() {
  CameraRefineOptions options;
  options.refine = CameraRefinement::kOnline;
  return options;
}

/// A drive of half-metre steps through a cloud of points: straight for 20 m, a turn over 25 m, straight on.
class Drive {
 public:
  Drive(CameraPtr truth, double turn_deg) : truth_(std::move(truth)), turn_deg_(turn_deg) {
    Rng rng(7);
    for (int k = 0; k < 6000; ++k) {
      points_.emplace_back(rng.uniform(-80.0, 80.0), rng.uniform(-8.0, 3.0), rng.uniform(-10.0, 110.0));
    }
  }

  /// So many frames more, with the poses that are true.
  void go(int frames, CameraRefiner& refiner) {
    for (int k = 0; k < frames; ++k) {
      const double turned = std::clamp((way_m_ - 20.0) / 25.0, 0.0, 1.0) * turn_deg_ * std::numbers::pi / 180.0;
      const RigidTransform world_from_cam{exp_so3(Eigen::Vector3d(0.0, turned, 0.0)), centre_};
      refiner.add({.frame = frame_, .cam_from_world = world_from_cam.inverse(), .step_m = frame_ > 0 ? kStepM : 0.0},
                  seen(world_from_cam.inverse()));
      centre_ += kStepM * (world_from_cam.rotation * Eigen::Vector3d::UnitZ());
      way_m_ += kStepM;
      ++frame_;
    }
  }

 private:
  static constexpr double kStepM = 0.5;

  std::vector<TrackPoint> seen(const RigidTransform& cam_from_world) {
    std::vector<TrackPoint> tracks;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3d point = cam_from_world * points_[i];
      if (point.z() < 2.0 || point.z() > 40.0) continue;
      const auto pixel = truth_->project(point);
      if (!pixel || !truth_->contains(*pixel)) continue;
      tracks.push_back({static_cast<TrackId>(i), *pixel + 0.1 * Eigen::Vector2d(noise_.normal(), noise_.normal())});
    }
    return tracks;
  }

  CameraPtr truth_;
  double turn_deg_;
  std::vector<Eigen::Vector3d> points_;
  Rng noise_{9};
  Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
  double way_m_ = 0.0;
  int frame_ = 0;
};

CameraSetup setup_of(double row, double k1) {
  CameraSetup setup;
  setup.camera = camera_of(row, k1);
  return setup;
}

TEST(CameraRefiner, FindsRowAndRadialCoefficientInATurn) {
  const CameraSetup setup = setup_of(kRow + 3.0, 0.0);
  CameraRefiner refiner(setup, online());
  Drive drive(camera_of(kRow, 0.012), 90.0);
  drive.go(130, refiner);
  const auto camera = refiner.next();
  ASSERT_TRUE(camera.has_value());
  ASSERT_EQ(refiner.events().size(), 1U);
  const CameraEvent& event = refiner.events().front();
  EXPECT_NEAR(event.values.at("cy").value, kRow, 2.0 * event.values.at("cy").sd);
  EXPECT_NEAR(event.values.at("k1").value, 0.012, 2.0 * event.values.at("k1").sd);
  EXPECT_LT(std::abs(value_of(CameraParameter::kRow, **camera) - kRow), 1.5);
  EXPECT_LT(std::abs(value_of(CameraParameter::kRadial, **camera) - 0.012), 0.006);
  EXPECT_FALSE(refiner.next().has_value()) << "nothing new has been seen";
}

TEST(CameraRefiner, ChangesNothingOnAStraight) {
  const CameraSetup setup = setup_of(kRow + 3.0, 0.0);
  CameraRefiner refiner(setup, online());
  Drive drive(camera_of(kRow, 0.012), 0.0);
  drive.go(150, refiner);
  EXPECT_FALSE(refiner.next().has_value());
  EXPECT_TRUE(refiner.events().empty());
}

TEST(CameraRefiner, KeepsNearWhatTheCameraFileIsSureOf) {
  CameraSetup setup = setup_of(kRow + 3.0, 0.0);
  setup.parameter_sds = {{CameraParameter::kRow, 0.05}, {CameraParameter::kRadial, 1e-5}};
  CameraRefiner refiner(setup, online());
  Drive drive(camera_of(kRow, 0.012), 90.0);
  drive.go(130, refiner);
  EXPECT_FALSE(refiner.next().has_value());
}

TEST(CameraRefiner, BeginsAnewWithAnotherMap) {
  const CameraSetup setup = setup_of(kRow + 3.0, 0.0);
  CameraRefiner refiner(setup, online());
  Drive drive(camera_of(kRow, 0.012), 90.0);
  drive.go(60, refiner);  // into the turn
  refiner.restart();
  drive.go(70, refiner);  // less than a window
  EXPECT_FALSE(refiner.next().has_value());
}

}  // namespace
}  // namespace groundscale
