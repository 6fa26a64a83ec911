#pragma once

#include <optional>

#include <Eigen/Core>

#include "groundscale/core/result.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/normal_prior_internal.hpp"
#include "groundscale/road/photometric_internal.hpp"

namespace groundscale {

/// What an alignment may change, beside gain and offset.
enum class FreeParameters { kPlane, kPlaneAndMotion, kMotion };

/// Columns: one a free parameter, gain and offset last. |t| stays as it is where the plane is free too.
Eigen::MatrixXd basis_of(FreeParameters free, const PhotometricState& state);

/// The state moved by a step in all parameters.
PhotometricState moved(const PhotometricState& state, const PhotometricVector& step, FreeParameters free);

/// An end of the alignment.
struct Aligned {
  PhotometricState state;
  PhotometricSums sums;  ///< At full size, with what concerns the motion.
  double sd = 1.0;       ///< Robust, of the differences, in grey levels.
  double correlation = 0.0;
  std::optional<PhotometricLevel> level{};  ///< The full size.
};

/// Whether there are pixels to work on.
Result<void> check_pixels(const RoadObservations& observations);

/// Where to start: the predicted plane; else that of the sparse matches; else, the expected normal with the height at
/// which the region correlates best.
Result<PhotometricState> alignment_start(const RoadObservations& observations, const PlaneOptions& options, Rng& rng);

/// The start, or the plane nearby (15 % in height, 2 degrees in pitch) with which the images agree better at their
/// smallest size.
PhotometricState search_nearby(const RoadObservations& observations, const PhotometricState& start,
                               const PlaneOptions& options);

/// Minimum of sum f w rho(difference / sd) + prior, f = PhotometricLevel::factor, coarse to fine, by Gauss-Newton steps
/// damped as Levenberg and Marquardt have it.
Result<Aligned> align_road(const RoadObservations& observations, const PhotometricState& start, FreeParameters free,
                           const NormalPrior& prior, const PlaneOptions& options);

/// Covariance of the free parameters. Pixels next to each other err alike (texture larger than a pixel, road that isn't
/// flat), so whole squares of DenseOptions::square_px are taken as one error each: A^-1 B A^-1 with B = sum over
/// squares of g g^T, g the square's part of the gradient (sandwich for clusters, Liang and Zeger 1986).
Eigen::MatrixXd alignment_covariance(const Aligned& aligned, FreeParameters free, const NormalPrior& prior,
                                     const PlaneOptions& options);

/// Whether the aligned images correlate and the plane stayed near its start.
Result<void> check_alignment(const Aligned& aligned, const PhotometricState& start, const PlaneOptions& options);
/// Whether the texture says enough of the height.
Result<void> check_certainty(const PlaneMeasurement& measurement, const PlaneOptions& options);

/// Road points of view 1 that lie on the plane, ascending, and their rms.
void find_points_on_plane(const RoadObservations& observations, const RigidTransform& cam2_from_cam1,
                          double max_error_px, PlaneMeasurement& measurement);

}  // namespace groundscale
