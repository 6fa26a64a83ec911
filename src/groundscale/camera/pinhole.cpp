#include "groundscale/camera/pinhole.hpp"

#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/LU>
#include <fmt/format.h>

#include "groundscale/camera/checks_internal.hpp"

namespace groundscale {
namespace {

/// Distorted normalised point with its derivative.
struct Distorted {
  Eigen::Vector2d point;
  Eigen::Matrix2d by_undistorted;
};

Distorted distort(const PinholeParameters& p, double x, double y) {
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (p.k1 + r2 * (p.k2 + r2 * p.k3));
  const double radial_by_r2 = p.k1 + r2 * (2.0 * p.k2 + r2 * 3.0 * p.k3);
  Distorted d;
  d.point << x * radial + 2.0 * p.p1 * x * y + p.p2 * (r2 + 2.0 * x * x),
      y * radial + p.p1 * (r2 + 2.0 * y * y) + 2.0 * p.p2 * x * y;
  const double mixed = 2.0 * x * y * radial_by_r2 + 2.0 * p.p1 * x + 2.0 * p.p2 * y;
  d.by_undistorted << radial + 2.0 * x * x * radial_by_r2 + 2.0 * p.p1 * y + 6.0 * p.p2 * x, mixed, mixed,
      radial + 2.0 * y * y * radial_by_r2 + 6.0 * p.p1 * y + 2.0 * p.p2 * x;
  return d;
}

/// Largest r^2 up to which r (1 + k1 r^2 + k2 r^4 + k3 r^6) grows.
double monotonic_radius_squared(const PinholeParameters& p) {
  constexpr double kMaxRadius = 20.0;  // tan of 87 degrees: no pinhole sees further out
  constexpr double kStep = 0.005;
  for (double r = kStep; r <= kMaxRadius; r += kStep) {
    const double r2 = r * r;
    if (1.0 + r2 * (3.0 * p.k1 + r2 * (5.0 * p.k2 + r2 * 7.0 * p.k3)) <= 0.0) return (r - kStep) * (r - kStep);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace

PinholeCamera::PinholeCamera(const PinholeParameters& parameters, int width, int height)
    : Camera(width, height), parameters_(parameters), max_radius_squared_(monotonic_radius_squared(parameters)) {
  const PinholeParameters& p = parameters_;
  distorted_ = p.k1 != 0.0 || p.k2 != 0.0 || p.p1 != 0.0 || p.p2 != 0.0 || p.k3 != 0.0;
}

Result<CameraPtr> PinholeCamera::create(const PinholeParameters& parameters, int width, int height) {
  const PinholeParameters& p = parameters;
  if (auto size = internal::check_image_size(width, height); !size) return size.error();
  const auto finite = internal::check_finite({{"fx", p.fx},
                                              {"fy", p.fy},
                                              {"cx", p.cx},
                                              {"cy", p.cy},
                                              {"k1", p.k1},
                                              {"k2", p.k2},
                                              {"p1", p.p1},
                                              {"p2", p.p2},
                                              {"k3", p.k3}});
  if (!finite) return finite.error();
  if (auto focal = internal::check_focal_lengths({{"fx", p.fx}, {"fy", p.fy}}); !focal) return focal.error();
  std::shared_ptr<const PinholeCamera> camera(new PinholeCamera(parameters, width, height));
  for (const double x : {0.0, 0.5 * (width - 1), width - 1.0}) {
    for (const double y : {0.0, 0.5 * (height - 1), height - 1.0}) {
      if (!camera->ray({x, y})) {
        return Error{ErrorCode::kBadInput,
                     fmt::format("the distortion folds back inside the image: pixel ({}, {}) has no ray", x, y)};
      }
    }
  }
  return CameraPtr(std::move(camera));
}

std::optional<Eigen::Vector2d> PinholeCamera::project(const Eigen::Vector3d& ray) const {
  return project(ray, nullptr);
}

std::optional<Eigen::Vector2d> PinholeCamera::project(const Eigen::Vector3d& ray,
                                                      Eigen::Matrix<double, 2, 3>* pixel_by_ray) const {
  constexpr double kMinDepth = 1e-6;  // of the ray's length
  if (!(ray.z() > 0.0) || ray.z() * ray.z() < kMinDepth * kMinDepth * ray.squaredNorm()) return std::nullopt;
  const double inverse_z = 1.0 / ray.z();
  const double x = ray.x() * inverse_z;
  const double y = ray.y() * inverse_z;
  const PinholeParameters& p = parameters_;
  if (!distorted_) {
    if (pixel_by_ray != nullptr) {
      *pixel_by_ray << p.fx * inverse_z, 0.0, -p.fx * x * inverse_z, 0.0, p.fy * inverse_z, -p.fy * y * inverse_z;
    }
    return Eigen::Vector2d(p.fx * x + p.cx, p.fy * y + p.cy);
  }
  if (x * x + y * y > max_radius_squared_) return std::nullopt;
  const Distorted d = distort(p, x, y);
  if (pixel_by_ray != nullptr) {
    Eigen::Matrix<double, 2, 3> normalised_by_ray;
    normalised_by_ray << inverse_z, 0.0, -x * inverse_z, 0.0, inverse_z, -y * inverse_z;
    *pixel_by_ray = Eigen::Vector2d(p.fx, p.fy).asDiagonal() * d.by_undistorted * normalised_by_ray;
  }
  return Eigen::Vector2d(p.fx * d.point.x() + p.cx, p.fy * d.point.y() + p.cy);
}

std::optional<Eigen::Vector3d> PinholeCamera::ray(const Eigen::Vector2d& pixel) const {
  const PinholeParameters& p = parameters_;
  const Eigen::Vector2d distorted((pixel.x() - p.cx) / p.fx, (pixel.y() - p.cy) / p.fy);
  if (!distorted_) return Eigen::Vector3d(distorted.x(), distorted.y(), 1.0).normalized();

  // Newton from the distorted point; halved steps keep it inside the monotonic radius.
  Eigen::Vector2d point = distorted;
  if (point.squaredNorm() > max_radius_squared_) point *= 0.9 * std::sqrt(max_radius_squared_) / point.norm();
  constexpr int kMaxIterations = 30;
  const double tolerance = 1e-10 / focal_px();
  for (int k = 0; k < kMaxIterations; ++k) {
    const Distorted d = distort(p, point.x(), point.y());
    const Eigen::Vector2d residual = d.point - distorted;
    if (residual.norm() < tolerance) break;
    Eigen::Vector2d step = d.by_undistorted.inverse() * residual;
    if (!step.allFinite()) return std::nullopt;
    while ((point - step).squaredNorm() > max_radius_squared_ && step.norm() > tolerance) step *= 0.5;
    point -= step;
  }
  constexpr double kAcceptedPx = 1e-7;
  const Eigen::Vector2d residual = distort(p, point.x(), point.y()).point - distorted;
  if (!(residual.norm() * focal_px() < kAcceptedPx)) return std::nullopt;
  return Eigen::Vector3d(point.x(), point.y(), 1.0).normalized();
}

}  // namespace groundscale
