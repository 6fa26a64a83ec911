#include "groundscale/estimation/ransac.hpp"

namespace groundscale {

void visit_fields(RansacOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "min_trials", .unit = "", .help = "samples drawn at least", .min = 1, .max = 100000},
                options.min_trials);
  visitor.field({.key = "max_trials", .unit = "", .help = "samples drawn at most", .min = 1, .max = 100000},
                options.max_trials);
  visitor.field({.key = "confidence",
                 .unit = "",
                 .help = "probability of one sample without outliers at which drawing stops",
                 .min = 0.5,
                 .max = 0.999999},
                options.confidence);
}

}  // namespace groundscale
