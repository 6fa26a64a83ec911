#include "groundscale/plane/dense_options.hpp"

namespace groundscale {

template <>
std::vector<std::string_view> names_of<DenseRefinement>() {
  return {"gauss_newton", "nelder_mead"};
}

void visit_fields(DenseOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "refinement",
                 .unit = "",
                 .help = "of dense: Gauss-Newton on the robust difference, or the score of Song and Chandraker by the "
                         "simplex of Nelder and Mead"},
                options.refinement);
  visitor.field({.key = "levels", .unit = "", .help = "halvings of the images, coarse to fine", .min = 0, .max = 5},
                options.levels);
  visitor.field({.key = "max_pixels",
                 .unit = "",
                 .help = "about so many pixels of the region are compared at each of them",
                 .min = 100,
                 .max = 10000000},
                options.max_pixels);
  visitor.field({.key = "smooth_px", .unit = "px", .help = "sd of the Gauss filter on both images", .min = 0, .max = 5},
                options.smooth_px);
  visitor.field({.key = "loss_bound",
                 .unit = "",
                 .help = "bound of Cauchy's loss, in robust sds of the differences",
                 .min = 0.1,
                 .max = 1000},
                options.loss_bound);
  visitor.field({.key = "square_worth",
                 .unit = "",
                 .help = "a square with texture counts as so many road points",
                 .min = 0.0001,
                 .max = 10000},
                options.square_worth);
  visitor.field({.key = "square_px",
                 .unit = "px",
                 .help = "side of the squares whose pixels count together, and err together in the covariance",
                 .min = 2,
                 .max = 1000},
                options.square_px);
  visitor.field(
      {.key = "min_correlation", .unit = "", .help = "least correlation of the aligned region", .min = -1, .max = 1},
      options.min_correlation);
  visitor.field({.key = "min_pixels",
                 .unit = "",
                 .help = "fewer compared pixels refuse the measurement",
                 .min = 20,
                 .max = 1000000},
                options.min_pixels);
  visitor.field({.key = "max_log_sd",
                 .unit = "",
                 .help = "largest formal sd of log height: beyond it there is too little texture",
                 .min = 0.0001,
                 .max = 1},
                options.max_log_sd);
}

void visit_fields(FixedPlaneOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "normal_sd_deg",
                 .unit = "deg",
                 .help = "formal sd of the given normal, which is enlarged as every formal one is",
                 .min = 0.001,
                 .max = 20},
                options.normal_sd_deg);
}

void visit_fields(FusedOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "methods", .unit = "", .help = "the methods that are combined, with commas between them"},
                options.methods);
  visitor.field({.key = "variance_factors",
                 .unit = "",
                 .help = "one for each: from its formal variance to that of its own error, which the others don't "
                         "share; 5 where none is given",
                 .min = 0,
                 .max = 100000},
                options.variance_factors);
  visitor.field({.key = "own_height_sd",
                 .unit = "",
                 .help = "own error of each, of log height, at least",
                 .min = 0.00001,
                 .max = 1},
                options.own_height_sd);
  visitor.field({.key = "own_normal_deg",
                 .unit = "deg",
                 .help = "own error of each, of the normal, at least",
                 .min = 0.0001,
                 .max = 20},
                options.own_normal_deg);
  visitor.field({.key = "max_disagreement",
                 .unit = "",
                 .help = "Mahalanobis distance from the most certain one, beyond which one is left out",
                 .min = 0.1,
                 .max = 1000},
                options.max_disagreement);
}

}  // namespace groundscale
