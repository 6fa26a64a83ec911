#include "groundscale/camera/turned_camera.hpp"

#include <utility>

#include <Eigen/Geometry>

namespace groundscale {

TurnedCamera::TurnedCamera(CameraPtr camera, const Eigen::Matrix3d& camera_from_axes)
    : Camera(camera->width(), camera->height()), camera_(std::move(camera)), camera_from_axes_(camera_from_axes) {}

std::optional<Eigen::Vector2d> TurnedCamera::project(const Eigen::Vector3d& ray) const {
  return camera_->project(camera_from_axes_ * ray);
}

std::optional<Eigen::Vector2d> TurnedCamera::project(const Eigen::Vector3d& ray,
                                                     Eigen::Matrix<double, 2, 3>* pixel_by_ray) const {
  const auto pixel = camera_->project(camera_from_axes_ * ray, pixel_by_ray);
  if (pixel && pixel_by_ray != nullptr) *pixel_by_ray *= camera_from_axes_;
  return pixel;
}

std::optional<Eigen::Vector3d> TurnedCamera::ray(const Eigen::Vector2d& pixel) const {
  const auto ray = camera_->ray(pixel);
  if (!ray) return std::nullopt;
  return camera_from_axes_.transpose() * *ray;
}

Eigen::Matrix3d turn_between(const Camera& axes, const Camera& camera) {
  const auto pixel = axes.project(Eigen::Vector3d::UnitZ());
  const auto ray = pixel ? camera.ray(*pixel) : std::nullopt;
  if (!ray) return Eigen::Matrix3d::Identity();
  return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), *ray).toRotationMatrix();
}

}  // namespace groundscale
