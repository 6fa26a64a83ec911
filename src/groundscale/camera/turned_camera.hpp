#pragma once

#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"

namespace groundscale {

/// A camera in axes other than its own: ray_in_axes = R^T ray_in_camera. So the numbers of a camera can change while
/// what was measured with it stays where it is.
class TurnedCamera final : public Camera {
 public:
  /// @param camera_from_axes  R, a rotation.
  TurnedCamera(CameraPtr camera, const Eigen::Matrix3d& camera_from_axes);

  std::string_view model() const override { return camera_->model(); }
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray) const override;
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray,
                                         Eigen::Matrix<double, 2, 3>* pixel_by_ray) const override;
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const override;
  double focal_px() const override { return camera_->focal_px(); }

 private:
  CameraPtr camera_;
  Eigen::Matrix3d camera_from_axes_;
};

/// The smallest rotation camera_from_axes with which `camera` sees the pixel of the optical axis of `axes` where `axes`
/// sees it; the identity where it doesn't see it at all.
Eigen::Matrix3d turn_between(const Camera& axes, const Camera& camera);

}  // namespace groundscale
