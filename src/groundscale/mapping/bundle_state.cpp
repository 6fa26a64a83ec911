#include <algorithm>
#include <cmath>
#include <numeric>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/mapping/bundle_state_internal.hpp"
#include "groundscale/mapping/reprojection_internal.hpp"

namespace groundscale {

BundleState::BundleState(const Bundle& bundle) : camera_(*bundle.camera) {
  pose_parameters_.resize(kPoseSize * bundle.views.size(), 0.0);
  views_.reserve(bundle.views.size());
  for (const BundleView& view : bundle.views) {
    ViewState state{view.cam_from_world.rotation, view.cam_from_world, Eigen::Matrix3d::Identity(), nullptr};
    if (!view.fixed) {
      state.parameters = &pose_parameters_[kPoseSize * views_.size()];
      Eigen::Map<Eigen::Vector3d>(state.parameters + 3) = view.cam_from_world.translation;
    }
    views_.push_back(state);
  }
  choose_observations(bundle);
  point_parameters_.resize(kPointSize * points_.size());
  for (std::size_t k = 0; k < points_.size(); ++k) {
    Eigen::Map<Eigen::Vector3d>(parameters_of_point(k)) = points_[k].accepted;
  }
}

void BundleState::choose_observations(const Bundle& bundle) {
  // Sorted by point with the order kept, by counting.
  std::vector<int> first(bundle.points_in_world.size() + 1, 0);
  for (const BundleObservation& o : bundle.observations) ++first[static_cast<std::size_t>(o.point) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  std::vector<const BundleObservation*> sorted(bundle.observations.size());
  std::vector<int> next = first;
  for (const BundleObservation& o : bundle.observations) {
    sorted[static_cast<std::size_t>(next[static_cast<std::size_t>(o.point)]++)] = &o;
  }
  observed_.reserve(sorted.size());
  for (std::size_t p = 0; p < bundle.points_in_world.size(); ++p) {
    const Eigen::Vector3d& position = bundle.points_in_world[p];
    const std::size_t begin = observed_.size();
    for (int k = first[p]; k < first[p + 1]; ++k) {
      const BundleObservation& o = *sorted[static_cast<std::size_t>(k)];
      if (!camera_.project(views_[static_cast<std::size_t>(o.view)].cam_from_world * position)) continue;
      Observed& observed = observed_.emplace_back();
      observed.view = o.view;
      observed.pixel = o.pixel;
    }
    if (observed_.size() - begin < 2) {
      observed_.resize(begin);
      continue;
    }
    points_.push_back({static_cast<int>(p), static_cast<int>(begin), static_cast<int>(observed_.size()), position});
  }
}

void BundleState::update_views() {
  for (ViewState& view : views_) {
    if (view.parameters == nullptr) continue;
    const Eigen::Map<const Eigen::Vector3d> w(view.parameters);
    view.cam_from_world.rotation = exp_so3(w) * view.start_rotation;
    view.cam_from_world.translation = Eigen::Map<const Eigen::Vector3d>(view.parameters + 3);
    view.rotation_by_w = left_jacobian(w);
  }
}

bool BundleState::evaluate_point(const PointState& point, const Eigen::Vector3d& position, bool with_jacobians) {
  for (int k = point.begin; k < point.end; ++k) {
    Observed& observed = observed_[static_cast<std::size_t>(k)];
    const ViewState& view = views_[static_cast<std::size_t>(observed.view)];
    if (!with_jacobians) {
      const auto pixel = camera_.project(view.cam_from_world * position);
      if (!pixel) return false;
      observed.residual = *pixel - observed.pixel;
      continue;
    }
    const auto seen = reproject(camera_, view.cam_from_world, position);
    if (!seen) return false;
    observed.residual = seen->pixel - observed.pixel;
    observed.by_point = seen->by_point;
    observed.by_pose.leftCols<3>().noalias() = seen->by_pose.leftCols<3>() * view.rotation_by_w;
    observed.by_pose.rightCols<3>() = seen->by_pose.rightCols<3>();
  }
  return true;
}

/// Evaluates a point as far along its step as all cameras that see it have it in their field; nothing where that isn't
/// so even without the step.
std::optional<Eigen::Vector3d> BundleState::place(const PointState& point, const Eigen::Vector3d& wanted,
                                                  bool with_jacobians) {
  if (evaluate_point(point, wanted, with_jacobians)) return wanted;
  constexpr double kShorter = 0.25;
  constexpr double kShortest = 1e-3;
  for (double share = kShorter; share > kShortest; share *= kShorter) {
    const Eigen::Vector3d position = point.accepted + share * (wanted - point.accepted);
    if (evaluate_point(point, position, with_jacobians)) return position;
  }
  if (evaluate_point(point, point.accepted, with_jacobians)) return point.accepted;
  return std::nullopt;
}

void BundleState::PrepareForEvaluation(bool evaluate_jacobians, bool) {
  update_views();
  valid_ = true;
  for (std::size_t k = 0; k < points_.size() && valid_; ++k) {
    PointState& point = points_[k];
    const Eigen::Vector3d parameters = Eigen::Map<const Eigen::Vector3d>(parameters_of_point(k));
    const Eigen::Vector3d wanted = parameters + point.offset;
    const auto position = place(point, wanted, evaluate_jacobians);
    valid_ = position.has_value();
    // Derivatives are asked for where a step has been accepted, and at the start.
    if (!evaluate_jacobians || !valid_) continue;
    if (*position != wanted) {
      point.offset = *position - parameters;
      ++shortened_steps_;
    }
    point.accepted = *position;
  }
}

double BundleState::rms_px() const {
  double squares = 0.0;
  for (const Observed& observed : observed_) squares += observed.residual.squaredNorm();
  return std::sqrt(squares / static_cast<double>(observed_.size()));
}

void BundleState::write(Bundle& bundle) const {
  for (std::size_t k = 0; k < views_.size(); ++k) {
    if (views_[k].parameters == nullptr) continue;
    bundle.views[k].cam_from_world = {nearest_rotation(views_[k].cam_from_world.rotation),
                                      views_[k].cam_from_world.translation};
  }
  for (const PointState& point : points_) {
    bundle.points_in_world[static_cast<std::size_t>(point.index)] = point.accepted;
  }
}

}  // namespace groundscale
