#pragma once

#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/plane/methods.hpp"

namespace groundscale {

/// One of several measurements of the same plane.
struct FusedPart {
  PlaneMeasurement measurement;
  double variance_factor = 1.0;  ///< From its formal covariance to that of its own error.
};

/// Several measurements of one pair of views as one.
///
/// The errors of two methods are e_i = c + d_i: c is what they share (the road isn't a plane, and R, t are the same),
/// d_i is a method's own. What is shared doesn't tell which one is better, so the weights are by
///   D_i = variance_factor_i C_i + floor,   m = sum W_i m_i,   W_i = (sum D_j^-1)^-1 D_i^-1,
/// floor = the least own error that the options say. Nor does it average out: the covariance is
///   C = sum W_i C_i W_i^T / a_i,   a_i = tr W_i / 3,
/// which holds however the errors are correlated (by convexity) and is C_i where there is one measurement.
///
/// The most certain part (log height by D_i) comes first; others enter, by certainty, where they agree with it:
///   (m_i - m_1)^T (D_i + D_1)^-1 (m_i - m_1) <= max_disagreement^2.
/// @param parts  At least one.
PlaneMeasurement fuse_planes(std::vector<FusedPart> parts, const FusedOptions& options);

/// Names in FusedOptions::methods.
/// @return kBadInput for an unknown one, none at all, or `fused` itself.
Result<std::vector<const PlaneMethod*>> fused_methods(const FusedOptions& options);

/// The methods that the options name, each run on the same observations, fused. Those that refuse are left out; where
/// all do, the reasons are put together.
/// @pre fused_methods(options.fused) has a value.
EstimatePlane make_fused(const PlaneOptions& options);

}  // namespace groundscale
