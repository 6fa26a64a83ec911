#pragma once

#include "groundscale/core/result.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/plane/methods.hpp"

namespace groundscale {

/// The plane that aligns the pixels of the road region between the reference view and view 1 (S. Song, M. Chandraker,
/// CVPR 2014; with C. C. Guest, TPAMI 2016), R and t given: m = n / h, gain and offset that minimise
///   sum f_k w_k rho((I1(u_k) - gain I2(pi(H r_k)) - offset) / s) + prior,  H = R + t m^T,
/// r_k the ray of pixel u_k, pi the camera model, rho = Cauchy's loss, s the robust sd of the differences; coarse to
/// fine, Gauss-Newton with d I2 / d m = grad I2 . (d pi / d ray) t r^T. The prior is that of the expected normal,
/// against which a square of pixels counts as DenseOptions::square_worth road points. With
/// DenseOptions::refinement = nelder_mead the plane with the best score, as there.
///
/// Covariance: that of squares of pixels as independent errors, and the uncertainty of R and t where given.
/// @return kBadInput (no pixels), kTooFewMatches (region empty or too small, too little texture), kDegenerateMotion (no
///         baseline), kNotConverged, kNotGround (the plane runs away, or the aligned images don't correlate).
/// Deterministic. O(iterations * max_pixels) after filters over the region.
Result<PlaneMeasurement> estimate_plane_dense(const RoadObservations& observations, const PlaneOptions& options,
                                              Rng& rng);

/// The same with R and the direction of t free too, from the given ones and the plane of estimate_plane_dense: the
/// eight parameters of a homography (what Zhou, Dai, Li 2019 argue against, their eq. 5). PlaneMeasurement::motion has
/// what became of R and t.
Result<PlaneMeasurement> estimate_plane_joint_dense(const RoadObservations& observations, const PlaneOptions& options,
                                                    Rng& rng);

/// The plane is known, what is sought is the motion (S. Lovegrove, A. J. Davison, J. Ibanez-Guzman, IV 2011): normal =
/// expected_normal and height 1, all six parameters of R and t' from the same difference of the road's pixels. t' comes
/// out in heights of the camera, so the plane's height in steps is 1 / |t'|. PlaneMeasurement::motion has R and
/// t' / |t'|.
///
/// Covariance: of |t'|, also by the error of the given normal (FixedPlaneOptions::normal_sd_deg), which a degree of
/// pitch makes about 10 %.
/// @return As estimate_plane_dense; kNotGround where no normal is given.
Result<PlaneMeasurement> estimate_fixed_plane(const RoadObservations& observations, const PlaneOptions& options,
                                              Rng& rng);

}  // namespace groundscale
