#include "groundscale/mapping/batch_adjustment.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/mapping/track_point_internal.hpp"

namespace groundscale {
namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix26 = Eigen::Matrix<double, 2, 6>;
using Matrix23 = Eigen::Matrix<double, 2, 3>;
constexpr int kMaxParameters = 4;
using ByParameters = Eigen::Matrix<double, 2, Eigen::Dynamic, 0, 2, kMaxParameters>;

/// What is adjusted.
struct State {
  CameraPtr camera;
  std::vector<RigidTransform> cam_from_world;
  std::vector<Eigen::Vector3d> points;  ///< Of the tracks that take part.
};

/// One sight at a state: error, its weight and derivatives.
struct LinearSight {
  int view = 0;
  Eigen::Vector2d error = Eigen::Vector2d::Zero();  ///< projected - seen
  double weight = 0.0;
  Matrix26 by_pose;
  Matrix23 by_point;
  ByParameters by_parameters;
};

/// A track's part of the normal equations, its point eliminated.
struct LinearTrack {
  std::vector<LinearSight> sights;
  Eigen::Matrix3d inverse = Eigen::Matrix3d::Zero();       ///< Of the point's own block.
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();      ///< Of the point.
  std::vector<Eigen::Matrix<double, 6, 3>> pose_by_point;  ///< Of each sight.
  Eigen::Matrix<double, Eigen::Dynamic, 3> parameters_by_point;
};

/// Cameras a little to each side of the present one in each parameter.
struct Neighbours {
  struct Pair {
    CameraPtr below, above;
    double width = 0.0;  ///< Of the difference, in pixel steps.
  };
  std::vector<Pair> pairs;
};

/// Normal equations of the poses and parameters: blocks of views that share tracks, and a border of parameters.
struct Reduced {
  std::vector<std::vector<Matrix6>> bands;  ///< [view][later view - view]
  std::vector<Vector6> gradients;
  std::vector<Eigen::Matrix<double, 6, Eigen::Dynamic>> border;
  Eigen::MatrixXd corner;
  Eigen::VectorXd corner_gradient;
};

class Batch {
 public:
  Batch(const DriveTracks& drive, const std::vector<FreeParameter>& free, const BatchOptions& options)
      : drive_(drive), free_(free), options_(options), loss_{options.loss_px} {}

  /// Chooses the tracks and solves their points.
  void begin(const CameraPtr& camera) {
    state_.camera = camera;
    for (const DriveTracks::View& view : drive_.views) state_.cam_from_world.push_back(view.cam_from_world);
    for (const FreeParameter& parameter : free_) {
      steps_.push_back(pixel_step(parameter.parameter, *camera));
      start_.push_back(value_of(parameter.parameter, *camera));
    }
    for (const DriveTracks::Track& track : drive_.tracks) {
      const auto point = first_point(track);
      if (!point) continue;
      tracks_.push_back(&track);
      state_.points.push_back(*point);
    }
  }

  int tracks() const { return static_cast<int>(tracks_.size()); }
  int sights() const {
    int count = 0;
    for (const auto* track : tracks_) count += static_cast<int>(track->sights.size());
    return count;
  }
  const State& state() const { return state_; }

  /// Sum of the losses; nothing where a point has left a camera that sees it.
  double cost(const State& state) const {
    double sum = 0.0;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      for (const DriveTracks::Sight& sight : tracks_[i]->sights) {
        sum += loss_.rho(error_of(state, sight, state.points[i]).norm());
      }
    }
    for (std::size_t j = 0; j < free_.size(); ++j) sum += 0.5 * std::pow(prior_error(state, j), 2);
    return sum;
  }

  double rms_px(const State& state) const {
    double sum = 0.0;
    int count = 0;
    const double bound = 3.0 * options_.loss_px;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      for (const DriveTracks::Sight& sight : tracks_[i]->sights) {
        sum += std::min(bound * bound, error_of(state, sight, state.points[i]).squaredNorm());
        ++count;
      }
    }
    return std::sqrt(sum / count);
  }

  Result<int> iterate();
  void covariance(BatchResult& result) const;

 private:
  std::optional<Eigen::Vector3d> first_point(const DriveTracks::Track& track) const;
  Eigen::Vector2d error_of(const State& state, const DriveTracks::Sight& sight, const Eigen::Vector3d& point) const;
  double prior_error(const State& state, std::size_t j) const;
  void solve_point(const State& state, const DriveTracks::Track& track, Eigen::Vector3d& point) const;
  Result<Neighbours> neighbours(const Camera& camera) const;
  LinearTrack linearise(const State& state, const Neighbours& neighbours, std::size_t i) const;
  Reduced reduce(const State& state, const Neighbours& neighbours) const;
  Eigen::SparseMatrix<double> matrix_of(const Reduced& reduced, double damping) const;
  std::optional<State> moved(const State& state, const Eigen::VectorXd& step) const;

  const DriveTracks& drive_;
  const std::vector<FreeParameter>& free_;
  const BatchOptions& options_;
  CauchyLoss loss_;
  std::vector<const DriveTracks::Track*> tracks_;
  std::vector<double> steps_, start_;
  State state_;
};

std::optional<Eigen::Vector3d> Batch::first_point(const DriveTracks::Track& track) const {
  return internal::point_of(track, state_.cam_from_world, *state_.camera, options_);
}

Eigen::Vector2d Batch::error_of(const State& state, const DriveTracks::Sight& sight,
                                const Eigen::Vector3d& point) const {
  constexpr double kOutside = 1e3;  // px: of a point that a camera can't see
  const auto pixel = state.camera->project(state.cam_from_world[static_cast<std::size_t>(sight.view)] * point);
  return pixel ? Eigen::Vector2d(*pixel - sight.pixel) : Eigen::Vector2d(kOutside, 0.0);
}

/// In units of pixel_sd, as the residuals are.
double Batch::prior_error(const State& state, std::size_t j) const {
  if (!(free_[j].prior_sd > 0.0)) return 0.0;
  return options_.pixel_sd * (value_of(free_[j].parameter, *state.camera) - start_[j]) / free_[j].prior_sd;
}

/// A point from its own sights: Gauss-Newton from where it is.
void Batch::solve_point(const State& state, const DriveTracks::Track& track, Eigen::Vector3d& point) const {
  constexpr int kIterations = 4;
  constexpr double kConverged = 1e-10;
  for (int k = 0; k < kIterations; ++k) {
    Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    double cost = 0.0;
    for (const DriveTracks::Sight& sight : track.sights) {
      const RigidTransform& pose = state.cam_from_world[static_cast<std::size_t>(sight.view)];
      Matrix23 by_ray;
      const auto pixel = state.camera->project(pose * point, &by_ray);
      if (!pixel) return;
      const Eigen::Vector2d error = *pixel - sight.pixel;
      const double weight = loss_.weight(error.norm());
      const Matrix23 by_point = by_ray * pose.rotation;
      matrix += weight * by_point.transpose() * by_point;
      gradient += weight * by_point.transpose() * error;
      cost += loss_.rho(error.norm());
    }
    matrix.diagonal() *= 1.0 + 1e-9;
    const Eigen::Vector3d step = -matrix.ldlt().solve(gradient);
    if (!step.allFinite()) return;
    const Eigen::Vector3d next = point + step;
    double next_cost = 0.0;
    for (const DriveTracks::Sight& sight : track.sights) next_cost += loss_.rho(error_of(state, sight, next).norm());
    if (!(next_cost < cost)) return;
    point = next;
    if (cost - next_cost < kConverged * cost) return;
  }
}

Result<Neighbours> Batch::neighbours(const Camera& camera) const {
  Neighbours result;
  constexpr double kPixels = 0.02;  // far above rounding, far below where a model bends
  for (std::size_t j = 0; j < free_.size(); ++j) {
    const CameraParameter parameter = free_[j].parameter;
    const double value = value_of(parameter, camera);
    auto below = with_value(parameter, value - kPixels * steps_[j], camera);
    if (!below) return below.error();
    auto above = with_value(parameter, value + kPixels * steps_[j], camera);
    if (!above) return above.error();
    result.pairs.push_back({*below, *above, 2.0 * kPixels});
  }
  return result;
}

LinearTrack Batch::linearise(const State& state, const Neighbours& neighbours, std::size_t i) const {
  LinearTrack track;
  const auto parameters = static_cast<Eigen::Index>(free_.size());
  track.parameters_by_point.setZero(parameters, 3);
  Eigen::Matrix3d matrix = Eigen::Matrix3d::Zero();
  for (const DriveTracks::Sight& seen : tracks_[i]->sights) {
    const RigidTransform& pose = state.cam_from_world[static_cast<std::size_t>(seen.view)];
    const Eigen::Vector3d in_cam = pose * state.points[i];
    LinearSight sight;
    sight.view = seen.view;
    Matrix23 by_ray;
    const auto pixel = state.camera->project(in_cam, &by_ray);
    if (!pixel) continue;
    sight.error = *pixel - seen.pixel;
    sight.weight = loss_.weight(sight.error.norm());
    sight.by_point = by_ray * pose.rotation;
    // The pose moves as X + w x X + v.
    sight.by_pose << by_ray * -skew(in_cam), by_ray;
    sight.by_parameters.setZero(2, parameters);
    for (std::size_t j = 0; j < neighbours.pairs.size(); ++j) {
      const auto& pair = neighbours.pairs[j];
      const auto below = pair.below->project(in_cam);
      const auto above = pair.above->project(in_cam);
      if (below && above) sight.by_parameters.col(static_cast<Eigen::Index>(j)) = (*above - *below) / pair.width;
    }
    const Matrix23 weighted = sight.weight * sight.by_point;
    matrix += weighted.transpose() * sight.by_point;
    track.gradient += weighted.transpose() * sight.error;
    track.pose_by_point.emplace_back(sight.by_pose.transpose() * weighted);
    track.parameters_by_point += sight.by_parameters.transpose() * weighted;
    track.sights.push_back(std::move(sight));
  }
  matrix.diagonal() *= 1.0 + 1e-9;
  track.inverse = matrix.ldlt().solve(Eigen::Matrix3d::Identity());
  if (!track.inverse.allFinite()) track.inverse.setZero();
  return track;
}

Reduced Batch::reduce(const State& state, const Neighbours& neighbours) const {
  const auto views = drive_.views.size();
  const auto parameters = static_cast<Eigen::Index>(free_.size());
  Reduced reduced;
  reduced.bands.resize(views);
  reduced.gradients.assign(views, Vector6::Zero());
  reduced.border.assign(views, Eigen::Matrix<double, 6, Eigen::Dynamic>::Zero(6, parameters));
  reduced.corner.setZero(parameters, parameters);
  reduced.corner_gradient.setZero(parameters);
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const LinearTrack track = linearise(state, neighbours, i);
    for (std::size_t a = 0; a < track.sights.size(); ++a) {
      const LinearSight& sight = track.sights[a];
      const auto view = static_cast<std::size_t>(sight.view);
      auto& band = reduced.bands[view];
      const auto span = static_cast<std::size_t>(track.sights.back().view - sight.view) + 1;
      if (band.size() < span) band.resize(span, Matrix6::Zero());
      const Eigen::Matrix<double, 6, 2> weighted = sight.weight * sight.by_pose.transpose();
      const Eigen::Matrix<double, 6, 3> eliminated = track.pose_by_point[a] * track.inverse;
      band[0] += weighted * sight.by_pose;
      for (std::size_t b = a; b < track.sights.size(); ++b) {
        band[static_cast<std::size_t>(track.sights[b].view - sight.view)] -=
            eliminated * track.pose_by_point[b].transpose();
      }
      reduced.gradients[view] += weighted * sight.error - eliminated * track.gradient;
      reduced.border[view] += weighted * sight.by_parameters - eliminated * track.parameters_by_point.transpose();
      reduced.corner += sight.weight * sight.by_parameters.transpose() * sight.by_parameters;
      reduced.corner_gradient += sight.weight * sight.by_parameters.transpose() * sight.error;
    }
    const Eigen::MatrixXd eliminated = track.parameters_by_point * track.inverse;
    reduced.corner -= eliminated * track.parameters_by_point.transpose();
    reduced.corner_gradient -= eliminated * track.gradient;
  }
  for (std::size_t j = 0; j < free_.size(); ++j) {
    if (!(free_[j].prior_sd > 0.0)) continue;
    const double by_step = options_.pixel_sd * steps_[j] / free_[j].prior_sd;
    const auto index = static_cast<Eigen::Index>(j);
    reduced.corner(index, index) += by_step * by_step;
    reduced.corner_gradient(index) += by_step * prior_error(state, j);
  }
  return reduced;
}

/// Lower triangle, the diagonal (1 + damping) times.
Eigen::SparseMatrix<double> Batch::matrix_of(const Reduced& reduced, double damping) const {
  const int views = static_cast<int>(reduced.bands.size());
  const int parameters = static_cast<int>(free_.size());
  const int size = 6 * views + parameters;
  constexpr double kFloor = 1e-9;  // of what nothing sees
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&entries, damping](int row, int column, double value) {
    if (row < column) return;
    entries.emplace_back(row, column, row == column ? value * (1.0 + damping) + kFloor : value);
  };
  for (int view = 0; view < views; ++view) {
    const auto& band = reduced.bands[static_cast<std::size_t>(view)];
    for (std::size_t k = 0; k < std::max<std::size_t>(1, band.size()); ++k) {
      const Matrix6 block = k < band.size() ? band[k] : Matrix6::Zero();
      // The block is that of (view, later view): its transpose lies below the diagonal.
      const int later = view + static_cast<int>(k);
      for (int r = 0; r < 6; ++r) {
        for (int c = 0; c < 6; ++c) add(6 * later + r, 6 * view + c, block(c, r));
      }
    }
    const auto& border = reduced.border[static_cast<std::size_t>(view)];
    for (int j = 0; j < parameters; ++j) {
      for (int c = 0; c < 6; ++c) add(6 * views + j, 6 * view + c, border(c, j));
    }
  }
  for (int j = 0; j < parameters; ++j) {
    for (int k = 0; k <= j; ++k) add(6 * views + j, 6 * views + k, reduced.corner(j, k));
  }
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

using Solver = Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>;

/// The state a step further, its points solved anew; nothing where there is no such camera.
std::optional<State> Batch::moved(const State& state, const Eigen::VectorXd& step) const {
  State next = state;
  for (std::size_t view = 0; view < next.cam_from_world.size(); ++view) {
    const Vector6 own = step.segment<6>(6 * static_cast<Eigen::Index>(view));
    RigidTransform& pose = next.cam_from_world[view];
    const Eigen::Matrix3d turn = exp_so3(own.head<3>());
    pose.rotation = nearest_rotation(turn * pose.rotation);
    pose.translation = turn * pose.translation + own.tail<3>();
  }
  const auto first = static_cast<Eigen::Index>(6 * next.cam_from_world.size());
  for (std::size_t j = 0; j < free_.size(); ++j) {
    const CameraParameter parameter = free_[j].parameter;
    const double value = value_of(parameter, *next.camera) + steps_[j] * step(first + static_cast<Eigen::Index>(j));
    auto camera = with_value(parameter, value, *next.camera);
    if (!camera) return std::nullopt;
    next.camera = *camera;
  }
  for (std::size_t i = 0; i < tracks_.size(); ++i) solve_point(next, *tracks_[i], next.points[i]);
  return next;
}

Result<int> Batch::iterate() {
  for (std::size_t i = 0; i < tracks_.size(); ++i) solve_point(state_, *tracks_[i], state_.points[i]);
  double present = cost(state_);
  double damping = 1e-6;
  int iterations = 0;
  constexpr double kMaxDamping = 1e4;
  constexpr double kMinDecrease = 1e-3;  // of the cost: below, reweighting only sorts outliers
  while (iterations < options_.max_iterations) {
    ++iterations;
    const auto around = neighbours(*state_.camera);
    if (!around) return Error{ErrorCode::kNotConverged, around.error().message};
    const Reduced reduced = reduce(state_, *around);
    Eigen::VectorXd gradient(static_cast<Eigen::Index>(6 * reduced.gradients.size() + free_.size()));
    for (std::size_t view = 0; view < reduced.gradients.size(); ++view) {
      gradient.segment<6>(6 * static_cast<Eigen::Index>(view)) = reduced.gradients[view];
    }
    gradient.tail(static_cast<Eigen::Index>(free_.size())) = reduced.corner_gradient;
    bool lowered = false;
    double moved_px = 0.0;
    double decrease = 0.0;
    for (; damping <= kMaxDamping && !lowered; damping *= lowered ? 1.0 : 10.0) {
      const Solver solver(matrix_of(reduced, damping));
      if (solver.info() != Eigen::Success) continue;
      const Eigen::VectorXd step = -solver.solve(gradient);
      if (!step.allFinite()) continue;
      auto next = moved(state_, step);
      if (!next) continue;
      const double next_cost = cost(*next);
      if (!(next_cost < present)) continue;
      lowered = true;
      decrease = (present - next_cost) / present;
      moved_px = step.tail(static_cast<Eigen::Index>(free_.size())).lpNorm<Eigen::Infinity>();
      present = next_cost;
      state_ = std::move(*next);
    }
    if (!lowered) break;
    damping = std::max(1e-9, 0.1 * damping);
    if (moved_px < options_.converged_px && decrease < kMinDecrease) break;
  }
  return iterations;
}

void Batch::covariance(BatchResult& result) const {
  const auto parameters = static_cast<Eigen::Index>(free_.size());
  const auto around = neighbours(*state_.camera);
  GS_CHECK(around.has_value(), "iterate has been here");
  const Reduced reduced = reduce(state_, *around);
  constexpr double kGauge = 1e-10;  // the seven directions that nothing sees, which no parameter depends on
  const Solver solver(matrix_of(reduced, kGauge));
  const Eigen::Index size = 6 * static_cast<Eigen::Index>(reduced.bands.size()) + parameters;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(size, parameters);
  right.bottomRows(parameters).setIdentity();
  const Eigen::MatrixXd solved = solver.solve(right);

  std::map<int, Eigen::VectorXd> blocks;
  double squares = 0.0;
  for (std::size_t i = 0; i < tracks_.size(); ++i) {
    const LinearTrack track = linearise(state_, *around, i);
    const Eigen::MatrixXd by_parameters = solved.bottomRows(parameters);
    Eigen::MatrixXd point = -track.inverse * (track.parameters_by_point.transpose() * by_parameters);
    for (std::size_t a = 0; a < track.sights.size(); ++a) {
      point -= track.inverse * track.pose_by_point[a].transpose() *
               solved.middleRows<6>(6 * static_cast<Eigen::Index>(track.sights[a].view));
    }
    Eigen::VectorXd change = Eigen::VectorXd::Zero(parameters);
    for (const LinearSight& sight : track.sights) {
      const Eigen::Matrix<double, 2, Eigen::Dynamic> moved =
          sight.by_pose * solved.middleRows<6>(6 * static_cast<Eigen::Index>(sight.view)) +
          sight.by_parameters * by_parameters + sight.by_point * point;
      change += sight.weight * moved.transpose() * sight.error;
      squares += sight.weight * sight.error.squaredNorm();
    }
    const DriveTracks::Track& seen = *tracks_[i];
    const int middle = seen.sights[seen.sights.size() / 2].view;
    const int block = drive_.views[static_cast<std::size_t>(middle)].frame / std::max(1, options_.block_frames);
    const auto [entry, is_new] = blocks.try_emplace(block, Eigen::VectorXd::Zero(parameters));
    entry->second += change;
  }
  Eigen::VectorXd steps(parameters);
  for (Eigen::Index j = 0; j < parameters; ++j) steps(j) = steps_[static_cast<std::size_t>(j)];
  Eigen::MatrixXd sandwich = Eigen::MatrixXd::Zero(parameters, parameters);
  for (const auto& [block, change] : blocks) sandwich += change * change.transpose();
  const double degrees = 2.0 * sights() - 3.0 * tracks() - 6.0 * static_cast<double>(drive_.views.size());
  const double variance = squares / std::max(1.0, degrees);
  result.formal_covariance = variance * steps.asDiagonal() * solved.bottomRows(parameters) * steps.asDiagonal();
  result.covariance = steps.asDiagonal() * sandwich * steps.asDiagonal();
}

}  // namespace

void visit_fields(BatchOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "max_iterations", .unit = "", .help = "steps of Levenberg-Marquardt", .min = 1, .max = 1000},
                options.max_iterations);
  visitor.field({.key = "loss_px", .unit = "px", .help = "bound of the Cauchy loss", .min = 0.01, .max = 100},
                options.loss_px);
  visitor.field({.key = "pixel_sd",
                 .unit = "px",
                 .help = "of a track's pixels, against which priors are weighed",
                 .min = 0.001,
                 .max = 100},
                options.pixel_sd);
  visitor.field({.key = "min_parallax_px",
                 .unit = "px",
                 .help = "between the rays of a track's point, below it takes no part",
                 .min = 0.1,
                 .max = 100},
                options.min_parallax_px);
  visitor.field({.key = "max_error_px",
                 .unit = "px",
                 .help = "rms reprojection error at the start, above a track takes no part",
                 .min = 0.1,
                 .max = 100},
                options.max_error_px);
  visitor.field({.key = "block_frames",
                 .unit = "frames",
                 .help = "errors of tracks within such a stretch count as one",
                 .min = 1,
                 .max = 10000},
                options.block_frames);
  visitor.field({.key = "converged_px",
                 .unit = "px",
                 .help = "the iteration ends where parameters move pixels by less",
                 .min = 1e-6,
                 .max = 1},
                options.converged_px);
}

Result<BatchResult> adjust_batch(const DriveTracks& drive, const CameraPtr& camera,
                                 const std::vector<FreeParameter>& free, const BatchOptions& options) {
  GS_CHECK(free.size() <= kMaxParameters, "at most four free parameters");
  Batch batch(drive, free, options);
  batch.begin(camera);
  constexpr int kMinTracks = 50;
  if (batch.tracks() < kMinTracks) {
    return Error{ErrorCode::kTooFewMatches,
                 fmt::format("{} tracks have enough parallax, {} are needed", batch.tracks(), kMinTracks)};
  }
  BatchResult result;
  result.initial_rms_px = batch.rms_px(batch.state());
  const auto iterations = batch.iterate();
  if (!iterations) return iterations.error();
  result.iterations = *iterations;
  result.final_rms_px = batch.rms_px(batch.state());
  result.camera = batch.state().camera;
  for (const FreeParameter& parameter : free) result.values.push_back(value_of(parameter.parameter, *result.camera));
  result.cam_from_world = batch.state().cam_from_world;
  result.tracks = batch.tracks();
  result.sights = batch.sights();
  if (!free.empty()) batch.covariance(result);
  return result;
}

std::vector<TrackError> reprojection_errors(const DriveTracks& drive, const std::vector<RigidTransform>& cam_from_world,
                                            const Camera& camera, const BatchOptions& options) {
  BatchOptions any_error = options;
  any_error.max_error_px = std::numeric_limits<double>::infinity();
  const CauchyLoss loss{options.loss_px};
  std::vector<TrackError> errors;
  errors.reserve(drive.tracks.size());
  for (const DriveTracks::Track& track : drive.tracks) {
    TrackError& error = errors.emplace_back();
    const auto point = internal::point_of(track, cam_from_world, camera, any_error);
    if (!point) continue;
    double squares = 0.0;
    for (const DriveTracks::Sight& sight : track.sights) {
      const auto pixel = camera.project(cam_from_world[static_cast<std::size_t>(sight.view)] * *point);
      constexpr double kUnseenPx = 1e3;
      const double size = pixel ? (*pixel - sight.pixel).norm() : kUnseenPx;
      error.loss += loss.rho(size);
      squares += size * size;
      ++error.sights;
    }
    error.rms_px = std::sqrt(squares / error.sights);
  }
  return errors;
}

}  // namespace groundscale
