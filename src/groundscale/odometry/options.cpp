#include "groundscale/odometry/options.hpp"

#include <fmt/format.h>

namespace groundscale {

void visit_fields(PairOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "min_parallax_px",
                 .unit = "px",
                 .help = "a frame is paired with the latest earlier one that has so much parallax (upper quartile)",
                 .min = 0.1,
                 .max = 200},
                options.min_parallax_px);
  visitor.field({.key = "max_frames", .unit = "frames", .help = "how far back a partner may lie", .min = 1, .max = 300},
                options.max_frames);
  visitor.field(
      {.key = "min_matches", .unit = "", .help = "tracks that a pair must have in common", .min = 10, .max = 10000},
      options.min_matches);
}

void visit_fields(GroundOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "method", .unit = "", .help = "how the plane is measured: sparse"}, options.method);
  visitor.group("plane", options.plane);
  visitor.group("gates", options.gates);
  visit_fields(options.filter, visitor);
  visitor.field({.key = "follow_rotation", .unit = "", .help = "carry the plane along by the camera's own rotation"},
                options.follow_rotation);
  visitor.field({.key = "use_structure", .unit = "", .help = "predict the speed from points that two pairs share"},
                options.use_structure);
  visitor.field({.key = "reopen_after",
                 .unit = "frames",
                 .help = "refusals in a row after which the filter trusts itself less",
                 .min = 1,
                 .max = 1000},
                options.reopen_after);
  visitor.field({.key = "search_after",
                 .unit = "frames",
                 .help = "refusals in a row after which the step is searched for anew",
                 .min = 1,
                 .max = 1000},
                options.search_after);
  visitor.field({.key = "turn_sd_m",
                 .unit = "m",
                 .help = "sd of log step over the path's curvature, which filtering doesn't reduce",
                 .min = 0,
                 .max = 10},
                options.turn_sd_m);
  visitor.field({.key = "crest_sd_m",
                 .unit = "m",
                 .help = "the same over the path's curvature upwards or downwards, over the last 10 m",
                 .min = 0,
                 .max = 200},
                options.crest_sd_m);
  visitor.field({.key = "unsettled_prior_factor",
                 .unit = "",
                 .help = "how much wider the normal's prior is until the mounting has been found",
                 .min = 1,
                 .max = 100},
                options.unsettled_prior_factor);
  visitor.field({.key = "settle_after",
                 .unit = "frames",
                 .help = "accepted measurements that find the mounting",
                 .min = 1,
                 .max = 1000},
                options.settle_after);
}

void visit_fields(RoadOptions& options, FieldVisitor& visitor) {
  visitor.group("region", options.region);
  visitor.group("tracking", options.tracking);
  visitor.group("search", options.search);
  visitor.group("network", options.network);
}

void visit_fields(OdometryOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "seed", .unit = "", .help = "of all random draws", .min = 0, .max = 2147483647}, options.seed);
  visitor.group("tracking", options.tracking);
  visitor.group("motion", options.motion);
  visitor.group("pair", options.pair);
  visitor.group("road", options.road);
  visitor.group("ground", options.ground);
}

Result<void> OdometryOptions::validate() const {
  if (const auto ranges = check_ranges(*this); !ranges) return ranges;
  if (find_plane_method(ground.method) == nullptr) {
    std::string known;
    for (const PlaneMethod& method : plane_methods()) known += (known.empty() ? "" : ", ") + std::string(method.name);
    return Error{ErrorCode::kBadInput,
                 fmt::format("ground.method: \"{}\" is unknown, known: {}", ground.method, known)};
  }
  if (road.region.near_m >= road.region.far_m) {
    return Error{ErrorCode::kBadInput, fmt::format("road.region.near_m: {} must be below road.region.far_m, {}",
                                                   road.region.near_m, road.region.far_m)};
  }
  if (road.search.min_step_m >= road.search.max_step_m) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("road.search.min_step_m: {} must be below road.search.max_step_m, {}",
                             road.search.min_step_m, road.search.max_step_m)};
  }
  if (const auto network = road.network.validate(); !network) return network;
  const std::size_t corners = road.region.polygon_px.size();
  if (corners % 2 != 0 || (corners > 0 && corners < 6)) {
    return Error{
        ErrorCode::kBadInput,
        fmt::format("road.region.polygon_px: {} numbers, x and y of at least three corners expected", corners)};
  }
  return {};
}

}  // namespace groundscale
