#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/camera/parameters.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/mapping/drive_tracks.hpp"

namespace groundscale {

/// A number of the camera that the adjustment may change.
struct FreeParameter {
  CameraParameter parameter = CameraParameter::kRadial;
  double prior_sd = 0.0;  ///< About its present value; 0: none.
};

struct BatchOptions {
  int max_iterations = 12;
  double loss_px = 0.5;          ///< Bound of the Cauchy loss.
  double pixel_sd = 0.3;         ///< Of sights, against which priors are weighed.
  double min_parallax_px = 3.0;  ///< Of a track's point, at the image's centre; tracks with less take no part.
  double max_error_px = 2.0;     ///< Rms reprojection error at the start above which a track takes no part.
  int block_frames = 15;         ///< Errors of tracks whose middles lie in one such stretch count as one.
  double converged_px = 0.03;    ///< The iteration ends where no parameter moves pixels by more than this.
};

void visit_fields(BatchOptions& options, FieldVisitor& visitor);

struct BatchResult {
  CameraPtr camera;
  std::vector<double> values;                  ///< Of the free parameters.
  Eigen::MatrixXd formal_covariance;           ///< Of them, as if pixels had independent errors,
  Eigen::MatrixXd covariance;                  ///< and by the sandwich over blocks of frames.
  std::vector<RigidTransform> cam_from_world;  ///< Of the views.
  int tracks = 0;                              ///< That took part,
  int sights = 0;                              ///< with so many sights.
  int iterations = 0;
  double initial_rms_px = 0.0;  ///< sqrt of the mean squared reprojection error, those beyond 3 loss_px cut there.
  double final_rms_px = 0.0;
};

/// Camera, poses and points that minimise, over a whole drive and gauge free,
///   sum rho(|pixel - project(R_view X_track + t_view; parameters)|) + sum (pixel_sd (p - p_0) / prior_sd)^2 / 2,
/// rho = Cauchy. Levenberg-Marquardt with the points eliminated (Triggs et al. 1999); after each step every point is
/// solved again from its own sights, so that the cost compared is that of poses and parameters alone. Derivatives by
/// the parameters are central differences of the model itself, the same for all models.
///
/// Covariance: with H the normal matrix, w_j = H^-1 e_j and psi_i the weighted residuals, the change of parameter j by
/// a block b of tracks is a_bj = sum_(i in b) (J_i w_j) . psi_i; covariance = sum_b a_b a_b^T (Huber 1967; White 1980).
/// Neighbouring tracks share what the model lacks, so the formal one is several times too small.
/// @param drive  Poses in any unit; their scale stays near what it was.
/// @param free  Four at most; none: poses and points alone, and no covariance.
/// @return kTooFewMatches: fewer than 50 tracks with enough parallax; kNotConverged: no step lowers the cost, or the
///         parameters leave their model.
/// Deterministic. O(iterations (sum over tracks of sights^2 + views (views a track spans)^2)).
Result<BatchResult> adjust_batch(const DriveTracks& drive, const CameraPtr& camera,
                                 const std::vector<FreeParameter>& free, const BatchOptions& options);

/// How a track fits a camera and poses that it took no part in finding.
struct TrackError {
  int sights = 0;       ///< 0: it gives no point, having fewer than three or too little parallax.
  double loss = 0.0;    ///< Sum of rho(|error|) over them, rho = Cauchy.
  double rms_px = 0.0;  ///< sqrt(mean |error|^2)
};

/// For each track of the drive, its point solved from its own sights.
std::vector<TrackError> reprojection_errors(const DriveTracks& drive, const std::vector<RigidTransform>& cam_from_world,
                                            const Camera& camera, const BatchOptions& options);

}  // namespace groundscale
