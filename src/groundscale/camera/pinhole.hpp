#pragma once

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// Pinhole with Brown-Conrady distortion (OpenCV's order k1, k2, p1, p2, k3). With (x, y) = (X/Z, Y/Z), r^2 = x^2 +
/// y^2:
///   x_d = x (1 + k1 r^2 + k2 r^4 + k3 r^6) + 2 p1 x y + p2 (r^2 + 2 x^2)
///   y_d = y (1 + k1 r^2 + k2 r^4 + k3 r^6) + p1 (r^2 + 2 y^2) + 2 p2 x y
///   u = fx x_d + cx, v = fy y_d + cy.
struct PinholeParameters {
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  ///< px
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;
};

class PinholeCamera final : public Camera {
 public:
  /// @return kBadInput, naming the parameter, where a number isn't finite, a focal length isn't positive, or the
  ///         distortion folds back inside the image (no pixel there has one ray).
  static Result<CameraPtr> create(const PinholeParameters& parameters, int width, int height);

  std::string_view model() const override { return "pinhole"; }
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray) const override;
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray,
                                         Eigen::Matrix<double, 2, 3>* pixel_by_ray) const override;
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const override;
  double focal_px() const override { return 0.5 * (parameters_.fx + parameters_.fy); }

  const PinholeParameters& parameters() const { return parameters_; }

 private:
  PinholeCamera(const PinholeParameters& parameters, int width, int height);

  PinholeParameters parameters_;
  bool distorted_;
  double max_radius_squared_;  ///< of (x, y): beyond, the distortion isn't monotonic.
};

}  // namespace groundscale
