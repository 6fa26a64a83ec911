#pragma once

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// Fisheye camera of Kannala and Brandt (2006), in the form and order of OpenCV's fisheye module. With r = |(X, Y)| and
/// theta = atan2(r, Z), the angle to the optical axis:
///   theta_d = theta (1 + k1 theta^2 + k2 theta^4 + k3 theta^6 + k4 theta^8)
///   u = fx theta_d X / r + cx, v = fy theta_d Y / r + cy.
struct KannalaBrandtParameters {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< px
  double k1 = 0.0, k2 = 0.0, k3 = 0.0, k4 = 0.0;
};

/// Valid up to the angle where theta_d stops growing, at most pi.
class KannalaBrandtCamera final : public Camera {
 public:
  /// @return kBadInput, naming the parameter, where a number isn't finite, a focal length isn't positive, or the
  ///         middle of an edge of the image lies beyond the valid angle. Corners may lie beyond: a fisheye's image
  ///         often is a circle.
  static Result<CameraPtr> create(const KannalaBrandtParameters& parameters, int width, int height);

  std::string_view model() const override { return "kannala_brandt"; }
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray) const override;
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray,
                                         Eigen::Matrix<double, 2, 3>* pixel_by_ray) const override;
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const override;
  double focal_px() const override { return 0.5 * (parameters_.fx + parameters_.fy); }

  const KannalaBrandtParameters& parameters() const { return parameters_; }
  /// Largest angle to the optical axis that has a pixel.
  double max_angle_rad() const { return max_angle_rad_; }

 private:
  KannalaBrandtCamera(const KannalaBrandtParameters& parameters, int width, int height);

  KannalaBrandtParameters parameters_;
  double max_angle_rad_;
  double max_distorted_;  ///< theta_d there.
};

}  // namespace groundscale
