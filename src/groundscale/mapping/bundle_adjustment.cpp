#include "groundscale/mapping/bundle_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <mutex>

#include <ceres/loss_function.h>
#include <ceres/ordered_groups.h>
#include <ceres/problem.h>
#include <ceres/sized_cost_function.h>
#include <ceres/solver.h>
#include <fmt/format.h>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/mapping/bundle_state_internal.hpp"

namespace groundscale {
namespace {

/// Hands out what BundleState has evaluated. Parameters: point, pose; or point alone where the view is fixed.
template <int... Sizes>
class ReprojectionCost final : public ceres::SizedCostFunction<2, kPointSize, Sizes...> {
 public:
  ReprojectionCost(const BundleState& state, const Observed& observed) : state_(state), observed_(observed) {}

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    if (!state_.valid()) return false;
    Eigen::Map<Eigen::Vector2d>(residuals, 2) = observed_.residual;
    if (jacobians == nullptr) return true;
    if (jacobians[0] != nullptr) std::copy_n(observed_.by_point.data(), 2 * kPointSize, jacobians[0]);
    if constexpr (sizeof...(Sizes) > 0) {
      if (jacobians[1] != nullptr) std::copy_n(observed_.by_pose.data(), 2 * kPoseSize, jacobians[1]);
    }
    return true;
  }

 private:
  const BundleState& state_;
  const Observed& observed_;
};

/// log(|c1 - c2| / distance) in units of its sd. Parameters: the poses of those of the two views that are free.
class DistanceCost final : public ceres::CostFunction {
 public:
  DistanceCost(const BundleState& state, const BundleDistance& distance, double pixel_sd)
      : state_(state), distance_(distance), weight_(pixel_sd / distance.log_sd) {
    set_num_residuals(1);
    for (const ViewState* view : {&view1(), &view2()}) {
      if (view->parameters != nullptr) mutable_parameter_block_sizes()->push_back(kPoseSize);
    }
  }

  bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
    const Eigen::Vector3d apart = centre_of(view1()) - centre_of(view2());
    const double squared = apart.squaredNorm();
    if (!(squared > 0.0)) return false;
    residuals[0] = weight_ * (0.5 * std::log(squared) - std::log(distance_.distance));
    if (jacobians == nullptr) return true;
    int block = 0;
    double sign = 1.0;
    for (const ViewState* view : {&view1(), &view2()}) {
      const Eigen::RowVector3d by_centre = sign * weight_ / squared * apart.transpose();
      sign = -sign;
      if (view->parameters == nullptr) continue;
      if (jacobians[block] != nullptr) {
        // c = -R^T u: dc/du = -R^T, dc/dw = -R^T [u] J(w).
        const Eigen::Matrix3d& rotation = view->cam_from_world.rotation;
        Eigen::Map<Eigen::Matrix<double, 1, kPoseSize>> by_pose(jacobians[block]);
        by_pose.leftCols<3>() =
            -by_centre * rotation.transpose() * skew(view->cam_from_world.translation) * view->rotation_by_w;
        by_pose.rightCols<3>() = -by_centre * rotation.transpose();
      }
      ++block;
    }
    return true;
  }

 private:
  static Eigen::Vector3d centre_of(const ViewState& view) {
    return -(view.cam_from_world.rotation.transpose() * view.cam_from_world.translation);
  }
  const ViewState& view1() const { return state_.views()[static_cast<std::size_t>(distance_.view1)]; }
  const ViewState& view2() const { return state_.views()[static_cast<std::size_t>(distance_.view2)]; }

  const BundleState& state_;
  BundleDistance distance_;
  double weight_;
};

using FreeViewCost = ReprojectionCost<kPoseSize>;
using FixedViewCost = ReprojectionCost<>;

/// The solver's problem beside the cost functions that it points to.
struct BundleProblem {
  std::deque<FreeViewCost> free_costs;  // grow without moving, for the problem points into them
  std::deque<FixedViewCost> fixed_costs;
  std::deque<DistanceCost> distance_costs;
  std::unique_ptr<ceres::LossFunction> loss;
  std::unique_ptr<ceres::Problem> problem;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering;
};

/// A distance counts where both views are held by observations or fixed, and one of them is free.
void add_distances(BundleState& state, const std::vector<BundleDistance>& distances, double pixel_sd,
                   const std::vector<bool>& seen, BundleProblem& problem) {
  for (const BundleDistance& distance : distances) {
    std::vector<double*> free;
    bool held = true;
    for (const int index : {distance.view1, distance.view2}) {
      const auto view = static_cast<std::size_t>(index);
      double* pose = state.views()[view].parameters;
      if (pose == nullptr) continue;
      free.push_back(pose);
      held = held && seen[view];
    }
    if (!held || free.empty()) continue;
    problem.distance_costs.emplace_back(state, distance, pixel_sd);
    problem.problem->AddResidualBlock(&problem.distance_costs.back(), nullptr, free);
  }
}

BundleProblem problem_of(BundleState& state, const Bundle& bundle, const BundleOptions& options) {
  BundleProblem result;
  if (options.loss == BundleLoss::kHuber) {
    result.loss = std::make_unique<ceres::HuberLoss>(options.loss_px);
  } else {
    result.loss = std::make_unique<ceres::CauchyLoss>(options.loss_px);
  }
  ceres::Problem::Options settings;
  settings.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  settings.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  settings.disable_all_safety_checks = true;
  settings.evaluation_callback = &state;
  result.problem = std::make_unique<ceres::Problem>(settings);
  result.ordering = std::make_shared<ceres::ParameterBlockOrdering>();

  std::vector<bool> seen(state.views().size(), false);
  for (std::size_t k = 0; k < state.points().size(); ++k) {
    double* point = state.parameters_of_point(k);
    result.problem->AddParameterBlock(point, kPointSize);
    result.ordering->AddElementToGroup(point, 0);
    for (int i = state.points()[k].begin; i < state.points()[k].end; ++i) {
      const Observed& observed = state.observed()[static_cast<std::size_t>(i)];
      const auto view = static_cast<std::size_t>(observed.view);
      double* pose = state.views()[view].parameters;
      if (pose == nullptr) {
        result.fixed_costs.emplace_back(state, observed);
        result.problem->AddResidualBlock(&result.fixed_costs.back(), result.loss.get(), point);
      } else {
        result.free_costs.emplace_back(state, observed);
        result.problem->AddResidualBlock(&result.free_costs.back(), result.loss.get(), point, pose);
        seen[view] = true;
      }
    }
  }
  for (std::size_t v = 0; v < seen.size(); ++v) {
    if (seen[v]) result.ordering->AddElementToGroup(state.views()[v].parameters, 1);
  }
  add_distances(state, bundle.distances, options.pixel_sd, seen, result);
  return result;
}

/// Ceres tells of refused steps through glog, whatever its own options say; a library doesn't print by itself. The
/// level is the whole process's: it is put back when the last adjustment has ended.
class QuietSolver {
 public:
  QuietSolver() {
    const std::lock_guard guard(mutex());
    if (running()++ > 0) return;
    level_before() = FLAGS_minloglevel;
    FLAGS_minloglevel = google::GLOG_FATAL;
  }
  ~QuietSolver() {
    const std::lock_guard guard(mutex());
    if (--running() == 0) FLAGS_minloglevel = level_before();
  }
  QuietSolver(const QuietSolver&) = delete;
  QuietSolver& operator=(const QuietSolver&) = delete;

 private:
  static std::mutex& mutex() {
    static std::mutex instance;
    return instance;
  }
  static int& running() {
    static int count = 0;
    return count;
  }
  static int& level_before() {
    static int level = 0;
    return level;
  }
};

ceres::Solver::Summary solve(const BundleProblem& problem, const BundleOptions& options) {
  ceres::Solver::Options settings;
  settings.linear_solver_type = ceres::DENSE_SCHUR;
  settings.linear_solver_ordering = problem.ordering;
  settings.num_threads = 1;
  settings.max_num_iterations = options.max_iterations;
  // Damping stays above this share of the diagonal: without it points that have run far away make the reduced system
  // indefinite by rounding.
  settings.max_trust_region_radius = 1e6;
  settings.function_tolerance = options.min_relative_decrease;
  settings.logging_type = ceres::SILENT;
  const QuietSolver quiet;
  ceres::Solver::Summary summary;
  ceres::Solve(settings, problem.problem.get(), &summary);
  return summary;
}

void check_indices(const Bundle& bundle) {
  GS_CHECK(bundle.camera != nullptr, "a bundle needs a camera");
  const int views = static_cast<int>(bundle.views.size());
  const int points = static_cast<int>(bundle.points_in_world.size());
  for (const BundleObservation& o : bundle.observations) {
    GS_CHECK(o.view >= 0 && o.view < views, "an observation of a view that isn't there");
    GS_CHECK(o.point >= 0 && o.point < points, "an observation of a point that isn't there");
  }
  for (const BundleDistance& d : bundle.distances) {
    GS_CHECK(d.view1 >= 0 && d.view1 < views && d.view2 >= 0 && d.view2 < views && d.view1 != d.view2,
             "a distance between two of the views");
    GS_CHECK(d.distance > 0.0 && d.log_sd > 0.0, "a distance and its sd are above 0");
  }
}

}  // namespace

template <>
std::vector<std::string_view> names_of<BundleLoss>() {
  return {"huber", "cauchy"};
}

void visit_fields(BundleOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "max_iterations", .unit = "", .help = "steps of Levenberg-Marquardt", .min = 1, .max = 1000},
                options.max_iterations);
  visitor.field({.key = "loss", .unit = "", .help = "robust loss of the reprojection error"}, options.loss);
  visitor.field({.key = "loss_px", .unit = "px", .help = "bound of that loss", .min = 0.01, .max = 100},
                options.loss_px);
  visitor.field({.key = "pixel_sd",
                 .unit = "px",
                 .help = "of observations, against which the ground's distances are weighed",
                 .min = 0.001,
                 .max = 100},
                options.pixel_sd);
  visitor.field({.key = "min_relative_decrease",
                 .unit = "",
                 .help = "the iteration ends where a step lowers the cost by less than this share",
                 .min = 0.0,
                 .max = 1.0},
                options.min_relative_decrease);
}

Result<BundleSummary> adjust_bundle(Bundle& bundle, const BundleOptions& options) {
  check_indices(bundle);
  BundleState state(bundle);
  if (state.observed().empty()) {
    return Error{ErrorCode::kTooFewMatches, fmt::format("none of {} points is seen by two of {} views",
                                                        bundle.points_in_world.size(), bundle.views.size())};
  }
  state.PrepareForEvaluation(false, true);
  BundleSummary summary;
  summary.observations = static_cast<int>(state.observed().size());
  summary.initial_rms_px = state.rms_px();

  const BundleProblem problem = problem_of(state, bundle, options);
  const ceres::Solver::Summary solved = solve(problem, options);
  if (!solved.IsSolutionUsable()) return Error{ErrorCode::kNotConverged, solved.message};

  state.PrepareForEvaluation(true, true);
  summary.iterations = static_cast<int>(solved.iterations.size()) - 1;
  summary.final_rms_px = state.rms_px();
  summary.shortened_steps = state.shortened_steps();
  state.write(bundle);
  return summary;
}

}  // namespace groundscale
