#pragma once

#include <vector>

#include "groundscale/camera/camera.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// Omnidirectional camera of Scaramuzza, Martinelli and Siegwart (2006), as OCamCalib writes it, in our axes. A pixel's
/// affine part undone, (x, y) from the centre of distortion, x right, y down:
///   col = cx + x + e y,  row = cy + d x + c y
///   ray ~ (x, y, F(rho)),  rho = |(x, y)|,  F(rho) = -(a0 + a1 rho + a2 rho^2 + ...).
/// The toolbox has rows first and its third axis backwards, hence the sign: a0 is negative.
struct OcamParameters {
  std::vector<double> polynomial;  ///< a0, a1, ...; px, 1, px^-1, ...
  double cx = 0.0, cy = 0.0;       ///< px: column and row of the centre of distortion
  double c = 1.0, d = 0.0, e = 0.0;
};

/// Valid out to where the angle to the axis stops growing with rho, at most half as far again as the furthest corner.
///
/// Projection inverts the polynomial itself; the toolbox's inverse polynomial, which is good to a tenth of a pixel, is
/// not used.
class OcamCamera final : public Camera {
 public:
  /// @return kBadInput, naming the parameter, where a number isn't finite, the polynomial is empty or a0 isn't
  /// negative,
  ///         the affine part can't be undone, or the image's centre has no ray.
  static Result<CameraPtr> create(const OcamParameters& parameters, int width, int height);

  std::string_view model() const override { return "ocam"; }
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray) const override;
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray,
                                         Eigen::Matrix<double, 2, 3>* pixel_by_ray) const override;
  std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const override;
  double focal_px() const override { return -parameters_.polynomial.front(); }

  const OcamParameters& parameters() const { return parameters_; }
  /// Largest angle to the axis that has a pixel.
  double max_angle_rad() const { return max_angle_rad_; }

 private:
  OcamCamera(const OcamParameters& parameters, int width, int height);

  double forward(double rho) const;        ///< F
  double forward_slope(double rho) const;  ///< dF/drho
  /// rho of the direction (lateral, forward).
  double rho_of(double lateral, double z) const;

  OcamParameters parameters_;
  Eigen::Matrix2d affine_;  ///< (col, row) by (x, y)
  Eigen::Matrix2d affine_inverse_;
  double max_rho_ = 0.0;
  double max_angle_rad_ = 0.0;
};

}  // namespace groundscale
