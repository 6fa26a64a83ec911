#include "groundscale/road/fused.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>
#include <utility>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <fmt/format.h>

#include "groundscale/road/ground_methods.hpp"
#include "groundscale/road/road_alignment_internal.hpp"

namespace groundscale {
namespace {

/// D of the header.
Eigen::Matrix3d own_covariance(const FusedPart& part, const FusedOptions& options) {
  const Eigen::Vector3d m = part.measurement.plane.inverse_form();
  const Eigen::Vector3d n = m.normalized();
  const double normal_sd = options.own_normal_deg * std::numbers::pi / 180.0;
  const Eigen::Matrix3d along = n * n.transpose();
  const Eigen::Matrix3d floor = m.squaredNorm() * (options.own_height_sd * options.own_height_sd * along +
                                                   normal_sd * normal_sd * (Eigen::Matrix3d::Identity() - along));
  return part.variance_factor * part.measurement.covariance_of_m + floor;
}

double log_height_variance(const Eigen::Vector3d& m, const Eigen::Matrix3d& covariance) {
  return m.dot(covariance * m) / (m.squaredNorm() * m.squaredNorm());
}

struct Weighed {
  FusedPart part;
  Eigen::Matrix3d own = Eigen::Matrix3d::Zero();
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();
};

std::vector<Weighed> that_agree(std::vector<FusedPart> parts, const FusedOptions& options) {
  std::vector<Weighed> all;
  for (FusedPart& part : parts) {
    const Eigen::Matrix3d own = own_covariance(part, options);
    all.push_back({std::move(part), own, own.inverse()});
  }
  const auto variance_of = [](const Weighed& one) {
    return log_height_variance(one.part.measurement.plane.inverse_form(), one.own);
  };
  std::stable_sort(all.begin(), all.end(),
                   [&](const Weighed& a, const Weighed& b) { return variance_of(a) < variance_of(b); });
  const Weighed first = all.front();
  const auto disagrees = [&](const Weighed& other) {
    const Eigen::Vector3d difference =
        other.part.measurement.plane.inverse_form() - first.part.measurement.plane.inverse_form();
    const Eigen::Matrix3d sum = first.own + other.own;
    return difference.dot(sum.inverse() * difference) > options.max_disagreement * options.max_disagreement;
  };
  all.erase(std::remove_if(all.begin() + 1, all.end(), disagrees), all.end());
  return all;
}

}  // namespace

PlaneMeasurement fuse_planes(std::vector<FusedPart> parts, const FusedOptions& options) {
  GS_CHECK(!parts.empty(), "at least one measurement");
  const std::vector<Weighed> agreed = that_agree(std::move(parts), options);
  PlaneMeasurement fused = agreed.front().part.measurement;
  if (agreed.size() == 1) return fused;
  Eigen::Matrix3d information = Eigen::Matrix3d::Zero();
  for (const Weighed& one : agreed) information += one.inverse;
  const Eigen::Matrix3d inverse = information.inverse();
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
  fused.covariance_of_m.setZero();
  for (const Weighed& one : agreed) {
    const Eigen::Matrix3d weight = inverse * one.inverse;
    m += weight * one.part.measurement.plane.inverse_form();
    fused.covariance_of_m +=
        weight * one.part.measurement.covariance_of_m * weight.transpose() * (3.0 / weight.trace());
  }
  fused.plane = GroundPlane::from_inverse_form(m);
  return fused;
}

Result<std::vector<const PlaneMethod*>> fused_methods(const FusedOptions& options) {
  std::vector<const PlaneMethod*> methods;
  std::stringstream names(options.methods);
  for (std::string name; std::getline(names, name, ',');) {
    name.erase(std::remove(name.begin(), name.end(), ' '), name.end());
    const PlaneMethod* method = name == "fused" ? nullptr : find_ground_method(name);
    if (method == nullptr) {
      return Error{ErrorCode::kBadInput, fmt::format("\"{}\" can't be fused; known: {}", name, ground_method_names())};
    }
    if (std::find(methods.begin(), methods.end(), method) != methods.end())
      return Error{ErrorCode::kBadInput, fmt::format("\"{}\" is named twice", name)};
    methods.push_back(method);
  }
  if (methods.empty()) return Error{ErrorCode::kBadInput, "no method is named to be fused"};
  return methods;
}

EstimatePlane make_fused(const PlaneOptions& options) {
  const auto methods = fused_methods(options.fused);
  GS_CHECK(methods.has_value(), "methods that can be fused");
  std::vector<std::pair<std::string, EstimatePlane>> made;
  for (const PlaneMethod* method : *methods) made.emplace_back(method->name, method->make(options));
  return [options, made](const RoadObservations& observations, Rng& rng) -> Result<PlaneMeasurement> {
    std::vector<FusedPart> parts;
    std::string reasons;
    ErrorCode code = ErrorCode::kNotGround;
    for (std::size_t k = 0; k < made.size(); ++k) {
      auto measured = made[k].second(observations, rng);
      if (!measured) {
        code = measured.error().code;
        reasons += (reasons.empty() ? "" : "; ") + made[k].first + ": " + measured.error().message;
        continue;
      }
      const auto& factors = options.fused.variance_factors;
      // On four drives sparse and dense differed by five times what their formal variances say.
      constexpr double kUsual = 5.0;
      parts.push_back({std::move(*measured), k < factors.size() ? factors[k] : kUsual});
    }
    if (parts.empty()) return Error{code, reasons};
    PlaneMeasurement fused = fuse_planes(std::move(parts), options.fused);
    fused.inliers.clear();
    find_points_on_plane(observations, observations.cam_from_reference[1], options.max_error_px, fused);
    return fused;
  };
}

}  // namespace groundscale
