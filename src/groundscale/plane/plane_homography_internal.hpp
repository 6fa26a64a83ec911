#pragma once

#include <vector>

#include <Eigen/Core>

#include "groundscale/core/result.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/plane/transfer_internal.hpp"

namespace groundscale {

/// Homography of rays (ray2 ~ H ray1) by RANSAC over four transfers, then all inliers (algebraic, of unit rays).
/// @return kTooFewMatches, kNotGround where four points never agree.
Result<Eigen::Matrix3d> ransac_homography(const Camera& camera, const std::vector<Transfer>& transfers,
                                          const PlaneOptions& options, Rng& rng);

}  // namespace groundscale
