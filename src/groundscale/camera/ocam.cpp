#include "groundscale/camera/ocam.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "groundscale/camera/checks_internal.hpp"

namespace groundscale {

OcamCamera::OcamCamera(const OcamParameters& parameters, int width, int height)
    : Camera(width, height), parameters_(parameters) {
  const OcamParameters& p = parameters_;
  affine_ << 1.0, p.e, p.d, p.c;
  affine_inverse_ = affine_.inverse();
  double furthest = 0.0;
  for (const double column : {-0.5, width - 0.5}) {
    for (const double row : {-0.5, height - 0.5}) {
      const Eigen::Vector2d corner = affine_inverse_ * Eigen::Vector2d(column - p.cx, row - p.cy);
      furthest = std::max(furthest, corner.norm());
    }
  }
  constexpr double kBeyond = 1.5;
  constexpr int kSteps = 2000;
  const double step = kBeyond * furthest / kSteps;
  // The angle atan2(rho, F) grows where F - rho F' > 0; it must stay well above zero, or a pixel says little.
  constexpr double kMinGrowth = 0.01;
  for (int k = 1; k <= kSteps; ++k) {
    const double rho = k * step;
    const double f = forward(rho);
    if (!(f - rho * forward_slope(rho) > kMinGrowth * std::hypot(rho, f))) break;
    max_rho_ = rho;
  }
  max_angle_rad_ = std::atan2(max_rho_, forward(max_rho_));
}

Result<CameraPtr> OcamCamera::create(const OcamParameters& parameters, int width, int height) {
  const OcamParameters& p = parameters;
  const auto refuse = [](std::string message) { return Error{ErrorCode::kBadInput, std::move(message)}; };
  if (auto size = internal::check_image_size(width, height); !size) return size.error();
  if (p.polynomial.empty()) return refuse("the polynomial has no coefficients");
  for (const double value : p.polynomial) {
    if (auto finite = internal::check_finite({{"a coefficient of the polynomial", value}}); !finite) {
      return finite.error();
    }
  }
  const auto finite = internal::check_finite({{"cx", p.cx}, {"cy", p.cy}, {"c", p.c}, {"d", p.d}, {"e", p.e}});
  if (!finite) return finite.error();
  if (!(p.polynomial.front() < 0.0)) {
    return refuse(
        fmt::format("the polynomial begins with {}, it must be negative: minus the focal length in the middle",
                    p.polynomial.front()));
  }
  constexpr double kMinDeterminant = 0.1;  // 1 for square pixels
  if (!(p.c - p.d * p.e > kMinDeterminant)) {
    return refuse(fmt::format("the affine part c = {}, d = {}, e = {} can't be undone", p.c, p.d, p.e));
  }
  std::shared_ptr<const OcamCamera> camera(new OcamCamera(parameters, width, height));
  if (!camera->ray({0.5 * (width - 1), 0.5 * (height - 1)})) {
    return refuse(fmt::format("the polynomial folds back inside the image: {} px from the centre of distortion",
                              camera->max_rho_));
  }
  return CameraPtr(std::move(camera));
}

double OcamCamera::forward(double rho) const {
  double sum = 0.0;
  for (auto a = parameters_.polynomial.rbegin(); a != parameters_.polynomial.rend(); ++a) sum = sum * rho - *a;
  return sum;
}

double OcamCamera::forward_slope(double rho) const {
  double sum = 0.0;
  for (std::size_t k = parameters_.polynomial.size() - 1; k >= 1; --k) {
    sum = sum * rho - static_cast<double>(k) * parameters_.polynomial[k];
  }
  return sum;
}

double OcamCamera::rho_of(double lateral, double z) const {
  // Root of g = rho z - lateral F: one, since the angle grows with rho. g is negative below it.
  double low = 0.0;
  double high = max_rho_;
  double rho = 0.5 * max_rho_;
  constexpr int kMaxIterations = 60;
  const double tolerance = 1e-13 * max_rho_;
  for (int k = 0; k < kMaxIterations; ++k) {
    const double g = rho * z - lateral * forward(rho);
    (g > 0.0 ? high : low) = rho;
    const double step = g / (z - lateral * forward_slope(rho));
    const double next = rho - step;
    if (std::abs(step) < tolerance) break;
    rho = next > low && next < high ? next : 0.5 * (low + high);
  }
  return rho;
}

std::optional<Eigen::Vector2d> OcamCamera::project(const Eigen::Vector3d& ray) const { return project(ray, nullptr); }

std::optional<Eigen::Vector2d> OcamCamera::project(const Eigen::Vector3d& ray,
                                                   Eigen::Matrix<double, 2, 3>* pixel_by_ray) const {
  const double length = ray.norm();
  if (!(length > 0.0) || !std::isfinite(length)) return std::nullopt;
  const double lateral = ray.head<2>().norm();
  if (std::atan2(lateral, ray.z()) > max_angle_rad_) return std::nullopt;
  const Eigen::Vector2d centre(parameters_.cx, parameters_.cy);
  const double focal = forward(0.0);

  constexpr double kOnAxis = 1e-9;
  if (lateral < kOnAxis * length) {
    const double scale = focal / ray.z();
    if (pixel_by_ray != nullptr) {
      pixel_by_ray->leftCols<2>() = scale * affine_;
      pixel_by_ray->col(2) = -affine_ * ray.head<2>() * (scale / ray.z());
    }
    return Eigen::Vector2d(centre + affine_ * ray.head<2>() * scale);
  }
  const double z = ray.z() / length;
  const double m = lateral / length;
  const double rho = rho_of(m, z);
  const Eigen::Vector2d direction = ray.head<2>() / lateral;
  if (pixel_by_ray != nullptr) {
    // Implicitly from rho z = m F(rho).
    const double slope = z - m * forward_slope(rho);
    const double rho_by_m = forward(rho) / slope / length;
    const double rho_by_z = -rho / slope / length;
    const Eigen::Matrix2d along = direction * direction.transpose();
    const Eigen::Matrix2d by_lateral = rho_by_m * along + rho / lateral * (Eigen::Matrix2d::Identity() - along);
    pixel_by_ray->leftCols<2>() = affine_ * by_lateral;
    pixel_by_ray->col(2) = affine_ * direction * rho_by_z;
  }
  return Eigen::Vector2d(centre + affine_ * direction * rho);
}

std::optional<Eigen::Vector3d> OcamCamera::ray(const Eigen::Vector2d& pixel) const {
  const Eigen::Vector2d point = affine_inverse_ * (pixel - Eigen::Vector2d(parameters_.cx, parameters_.cy));
  const double rho = point.norm();
  if (!(rho <= max_rho_)) return std::nullopt;
  return Eigen::Vector3d(point.x(), point.y(), forward(rho)).normalized();
}

}  // namespace groundscale
