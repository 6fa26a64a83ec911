#pragma once

#include <optional>
#include <vector>

#include <ceres/evaluation_callback.h>
#include <Eigen/Core>

#include "groundscale/camera/camera.hpp"
#include "groundscale/geometry/rigid_transform.hpp"
#include "groundscale/mapping/bundle_adjustment.hpp"

namespace groundscale {

inline constexpr int kPoseSize = 6;
inline constexpr int kPointSize = 3;

/// An observation as the solver sees it: residual and derivatives at the present state, row by row.
struct Observed {
  int view = 0;
  Eigen::Vector2d pixel;
  Eigen::Vector2d residual;
  Eigen::Matrix<double, 2, kPointSize, Eigen::RowMajor> by_point;
  Eigen::Matrix<double, 2, kPoseSize, Eigen::RowMajor> by_pose;
};

/// A view's pose as parameters (w, u): R = exp(w) R_start, t = u. Fixed ones have none.
struct ViewState {
  Eigen::Matrix3d start_rotation;
  RigidTransform cam_from_world;
  Eigen::Matrix3d rotation_by_w;
  double* parameters = nullptr;
};

/// The observations of a point lie side by side.
struct PointState {
  int index = 0;  ///< In the bundle.
  int begin = 0;
  int end = 0;
  Eigen::Vector3d accepted;                          ///< Where it was at the last accepted step.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Position less parameters, by steps that were shortened.
};

/// A bundle at the solver's present parameters: what the cost functions read, and all that they know. The solver's
/// problem points to the parameters and the observations, which stay where they are; it changes the one and reads the
/// other. Evaluated as a whole before the solver asks for the parts: the rotations are made once a view, and the step
/// of a point that would leave a camera's field can be shortened for all its observations.
class BundleState final : public ceres::EvaluationCallback {
 public:
  /// Chooses the observations that take part (adjust_bundle).
  explicit BundleState(const Bundle& bundle);

  void PrepareForEvaluation(bool evaluate_jacobians, bool new_evaluation_point) override;

  const std::vector<Observed>& observed() const { return observed_; }
  const std::vector<PointState>& points() const { return points_; }
  const std::vector<ViewState>& views() const { return views_; }
  double* parameters_of_point(std::size_t k) { return &point_parameters_[kPointSize * k]; }
  /// Whether all points are in the field of their cameras; else there is nothing to read.
  bool valid() const { return valid_; }
  int shortened_steps() const { return shortened_steps_; }
  double rms_px() const;
  /// Hands poses and points over.
  void write(Bundle& bundle) const;

 private:
  void choose_observations(const Bundle& bundle);
  bool evaluate_point(const PointState& point, const Eigen::Vector3d& position, bool with_jacobians);
  std::optional<Eigen::Vector3d> place(const PointState& point, const Eigen::Vector3d& wanted, bool with_jacobians);
  void update_views();

  const Camera& camera_;
  std::vector<ViewState> views_;
  std::vector<PointState> points_;
  std::vector<Observed> observed_;
  std::vector<double> pose_parameters_;
  std::vector<double> point_parameters_;
  bool valid_ = true;
  int shortened_steps_ = 0;
};

}  // namespace groundscale
