#include "groundscale/odometry/options.hpp"

#include <fmt/format.h>

#include "groundscale/road/fused.hpp"
#include "groundscale/road/ground_methods.hpp"

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
  static const std::string kMethodHelp = "how the plane of two views is measured: " + ground_method_names();
  visitor.field({.key = "method", .unit = "", .help = kMethodHelp}, options.method);
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

template <>
std::vector<std::string_view> names_of<OdometryMode>() {
  return {"pairwise", "keyframe"};
}

void visit_fields(PipelineOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "mode", .unit = "", .help = "frame to frame, or with a map of keyframes"}, options.mode);
  visitor.field({.key = "scale_correction",
                 .unit = "",
                 .help = "how keyframe mode holds the scale: at the start's, the map scaled beyond a threshold, as a "
                         "slow process, or by the ground in the bundle adjustment"},
                options.scale_correction);
}

void visit_fields(KeyframeOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "min_parallax_px",
                 .unit = "px",
                 .help = "to the last keyframe (upper quartile), makes a new one",
                 .min = 1,
                 .max = 1000},
                options.min_parallax_px);
  visitor.field({.key = "min_share",
                 .unit = "",
                 .help = "share of the last keyframe's points still followed, below makes a new one",
                 .min = 0,
                 .max = 1},
                options.min_share);
  visitor.field({.key = "start_parallax_px",
                 .unit = "px",
                 .help = "of the two views that a map starts from",
                 .min = 1,
                 .max = 1000},
                options.start_parallax_px);
  visitor.field({.key = "start_matches", .unit = "", .help = "points that they share", .min = 20, .max = 10000},
                options.start_matches);
  visitor.field({.key = "start_points", .unit = "", .help = "landmarks that come of them", .min = 10, .max = 10000},
                options.start_points);
  visitor.field({.key = "ground_weight",
                 .unit = "",
                 .help = "of the ground in the bundle adjustment, over what its sd says (continuous)",
                 .min = 0.001,
                 .max = 100},
                options.ground_weight);
  visitor.group("region", options.region);
  visitor.group("map", options.map);
  visitor.group("resection", options.resection);
  visitor.group("road", options.road);
}

void visit_fields(OdometryOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "seed", .unit = "", .help = "of all random draws", .min = 0, .max = 2147483647}, options.seed);
  visitor.group("odometry", options.odometry);
  visitor.group("camera", options.camera);
  visitor.group("tracking", options.tracking);
  visitor.group("motion", options.motion);
  visitor.group("pair", options.pair);
  visitor.group("road", options.road);
  visitor.group("ground", options.ground);
  visitor.group("keyframe", options.keyframe);
  visitor.group("scale", options.scale);
}

namespace {

Result<void> check_strip(std::string_view group, const StripOptions& strip) {
  if (strip.near_m < strip.far_m) return {};
  return Error{ErrorCode::kBadInput,
               fmt::format("{0}.near_m: {1} must be below {0}.far_m, {2}", group, strip.near_m, strip.far_m)};
}

}  // namespace

Result<void> OdometryOptions::validate() const {
  if (const auto ranges = check_ranges(*this); !ranges) return ranges;
  if (find_ground_method(ground.method) == nullptr) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("ground.method: \"{}\" is unknown, known: {}", ground.method, ground_method_names())};
  }
  if (const auto fused = fused_methods(ground.plane.fused); !fused)
    return Error{ErrorCode::kBadInput, "ground.plane.fused.methods: " + fused.error().message};
  if (const auto strip = check_strip("road.region", road.region); !strip) return strip;
  if (const auto strip = check_strip("keyframe.region", keyframe.region); !strip) return strip;
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
