#pragma once

#include <string>
#include <vector>

#include "groundscale/core/options.hpp"

namespace groundscale {

enum class DenseRefinement { kGaussNewton, kNelderMead };

/// For the methods that align the pixels of the road region: `dense`, `joint_dense`, `fixed_plane`.
struct DenseOptions {
  DenseRefinement refinement = DenseRefinement::kGaussNewton;  ///< Of `dense`; the others have Gauss-Newton only.
  int levels = 2;                                              ///< Halvings of the images, coarse to fine.
  int max_pixels = 4000;      ///< Pixels of the region that are compared, evenly spread, at each level.
  double smooth_px = 0.8;     ///< Sd of the Gauss filter on both images: interpolation errs less in smooth ones.
  double loss_bound = 2.0;    ///< Of Cauchy's loss, in robust sds of the differences.
  double square_worth = 1.0;  ///< A square with texture counts as so many road points of PlaneOptions::point_sd_px.
  int square_px = 16;  ///< Pixels in squares of this side are taken as one, against the prior and in the covariance.
  double min_correlation = 0.5;  ///< Of the aligned region (zero-mean normalised).
  int min_pixels = 300;          ///< Fewer that both images see refuse the measurement.
  double max_log_sd = 0.03;      ///< Formal sd of log height: beyond it there is too little texture.
};

void visit_fields(DenseOptions& options, FieldVisitor& visitor);

struct FixedPlaneOptions {
  /// Formal sd of the given normal. Like every formal one it's enlarged later.
  double normal_sd_deg = 0.2;
};

void visit_fields(FixedPlaneOptions& options, FieldVisitor& visitor);

struct FusedOptions {
  std::string methods = "sparse,dense";  ///< Names with commas between them.
  /// From the formal variance of each to that of its own error, which it shares with none of the others; 5 where none
  /// is given.
  std::vector<double> variance_factors{};
  double own_height_sd = 0.01;    ///< Of each one's own error at least, of log height,
  double own_normal_deg = 0.15;   ///< and of the normal.
  double max_disagreement = 5.0;  ///< Mahalanobis distance from the most certain one; beyond it one is left out.
};

void visit_fields(FusedOptions& options, FieldVisitor& visitor);

}  // namespace groundscale
