#include "groundscale/camera/kannala_brandt.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "groundscale/camera/checks_internal.hpp"

namespace groundscale {
namespace {

double distort(const KannalaBrandtParameters& p, double angle) {
  const double a2 = angle * angle;
  return angle * (1.0 + a2 * (p.k1 + a2 * (p.k2 + a2 * (p.k3 + a2 * p.k4))));
}

double distort_slope(const KannalaBrandtParameters& p, double angle) {
  const double a2 = angle * angle;
  return 1.0 + a2 * (3.0 * p.k1 + a2 * (5.0 * p.k2 + a2 * (7.0 * p.k3 + a2 * 9.0 * p.k4)));
}

/// Largest angle up to which theta_d grows by at least a hundredth of the angle; below that a pixel says little.
double monotonic_angle(const KannalaBrandtParameters& p) {
  constexpr double kMinSlope = 0.01;
  constexpr int kSteps = 2000;
  constexpr double kStep = std::numbers::pi / kSteps;
  for (int k = 1; k <= kSteps; ++k) {
    if (!(distort_slope(p, k * kStep) >= kMinSlope)) return (k - 1) * kStep;
  }
  return std::numbers::pi;
}

}  // namespace

KannalaBrandtCamera::KannalaBrandtCamera(const KannalaBrandtParameters& parameters, int width, int height)
    : Camera(width, height),
      parameters_(parameters),
      max_angle_rad_(monotonic_angle(parameters)),
      max_distorted_(distort(parameters, max_angle_rad_)) {}

Result<CameraPtr> KannalaBrandtCamera::create(const KannalaBrandtParameters& parameters, int width, int height) {
  const KannalaBrandtParameters& p = parameters;
  if (auto size = internal::check_image_size(width, height); !size) return size.error();
  const auto finite = internal::check_finite(
      {{"fx", p.fx}, {"fy", p.fy}, {"cx", p.cx}, {"cy", p.cy}, {"k1", p.k1}, {"k2", p.k2}, {"k3", p.k3}, {"k4", p.k4}});
  if (!finite) return finite.error();
  if (auto focal = internal::check_focal_lengths({{"fx", p.fx}, {"fy", p.fy}}); !focal) return focal.error();
  std::shared_ptr<const KannalaBrandtCamera> camera(new KannalaBrandtCamera(parameters, width, height));
  const double right = width - 1.0;
  const double bottom = height - 1.0;
  const Eigen::Vector2d middles[] = {{0.5 * right, 0.5 * bottom},
                                     {0.0, 0.5 * bottom},
                                     {right, 0.5 * bottom},
                                     {0.5 * right, 0.0},
                                     {0.5 * right, bottom}};
  // A circular image may leave the narrow edges black, but not all four: one edge in view is enough.
  const bool sees_centre = camera->ray(middles[0]).has_value();
  const auto edges = std::count_if(std::begin(middles) + 1, std::end(middles),
                                   [&](const Eigen::Vector2d& middle) { return camera->ray(middle).has_value(); });
  if (!sees_centre || edges == 0) {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("the distortion folds back inside the image: beyond {:.1f} degrees from the optical axis no "
                    "pixel has a ray",
                    camera->max_angle_rad_ * 180.0 / std::numbers::pi)};
  }
  return CameraPtr(std::move(camera));
}

std::optional<Eigen::Vector2d> KannalaBrandtCamera::project(const Eigen::Vector3d& ray) const {
  return project(ray, nullptr);
}

std::optional<Eigen::Vector2d> KannalaBrandtCamera::project(const Eigen::Vector3d& ray,
                                                            Eigen::Matrix<double, 2, 3>* pixel_by_ray) const {
  const double length_squared = ray.squaredNorm();
  if (!(length_squared > 0.0) || !std::isfinite(length_squared)) return std::nullopt;
  const double radius = std::hypot(ray.x(), ray.y());
  const double angle = std::atan2(radius, ray.z());
  if (angle > max_angle_rad_) return std::nullopt;
  const KannalaBrandtParameters& p = parameters_;
  const Eigen::Vector2d focal(p.fx, p.fy);
  const Eigen::Vector2d lateral = ray.head<2>();

  constexpr double kOnAxis = 1e-9;  // of the ray's length: scale and its derivative as in the limit
  const bool on_axis = radius * radius < kOnAxis * kOnAxis * length_squared;
  if (on_axis && ray.z() < 0.0) return std::nullopt;  // straight backwards: every direction at once
  const double scale = on_axis ? 1.0 / ray.z() : distort(p, angle) / radius;
  if (pixel_by_ray != nullptr) {
    Eigen::Matrix<double, 2, 3> by_ray = Eigen::Matrix<double, 2, 3>::Zero();
    by_ray.leftCols<2>().diagonal().setConstant(scale);
    const double slope = distort_slope(p, angle);
    if (on_axis) {
      by_ray.col(2) = -lateral * scale * scale;
    } else {
      const double scale_by_radius = (slope * ray.z() / length_squared - scale) / radius;
      by_ray.leftCols<2>() += lateral * lateral.transpose() * (scale_by_radius / radius);
      by_ray.col(2) = -lateral * (slope / length_squared);
    }
    *pixel_by_ray = focal.asDiagonal() * by_ray;
  }
  return Eigen::Vector2d(focal.cwiseProduct(lateral) * scale + Eigen::Vector2d(p.cx, p.cy));
}

std::optional<Eigen::Vector3d> KannalaBrandtCamera::ray(const Eigen::Vector2d& pixel) const {
  const KannalaBrandtParameters& p = parameters_;
  const Eigen::Vector2d distorted((pixel.x() - p.cx) / p.fx, (pixel.y() - p.cy) / p.fy);
  const double wanted = distorted.norm();
  if (!(wanted <= max_distorted_)) return std::nullopt;
  if (wanted == 0.0) return Eigen::Vector3d::UnitZ();

  // Newton within a bracket: theta_d grows all the way, so there is one angle.
  double low = 0.0;
  double high = max_angle_rad_;
  double angle = std::min(wanted, high);
  constexpr int kMaxIterations = 60;
  const double tolerance = 1e-12;
  for (int k = 0; k < kMaxIterations; ++k) {
    const double excess = distort(p, angle) - wanted;
    (excess > 0.0 ? high : low) = angle;
    const double step = excess / distort_slope(p, angle);
    const double next = angle - step;
    if (std::abs(step) < tolerance) break;
    angle = next > low && next < high ? next : 0.5 * (low + high);
  }
  const double sine = std::sin(angle) / wanted;
  return Eigen::Vector3d(distorted.x() * sine, distorted.y() * sine, std::cos(angle)).normalized();
}

}  // namespace groundscale
