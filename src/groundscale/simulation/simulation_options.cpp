#include "groundscale/simulation/simulation_options.hpp"

#include <fmt/format.h>

namespace groundscale {

void visit_fields(RoadProfile& profile, FieldVisitor& visitor) {
  visitor.field({"lane_offset_m", "m", "the vehicle drives so far to the right of the crest", 0.0, 20.0},
                profile.lane_offset_m);
  visitor.field({"half_width_m", "m", "from the crest to the kerb", 1.0, 20.0}, profile.half_width_m);
  visitor.field({"crown", "", "fall to the sides, over distance", 0.0, 0.1}, profile.crown);
  visitor.field({"roughness_m", "m", "sd of the roadway's height over waves of 0.7 to 6 m", 0.0, 0.05},
                profile.roughness_m);
  visitor.field({"kerb_m", "m", "height of the kerb; 0: none", 0.0, 0.5}, profile.kerb_m);
  visitor.field({"pavement_m", "m", "width beyond the kerb", 0.0, 10.0}, profile.pavement_m);
  visitor.field({"verge_slope", "", "rise beyond the pavement, over distance", -0.5, 0.5}, profile.verge_slope);
  visitor.field({"verge_m", "m", "width of what rises", 0.1, 20.0}, profile.verge_m);
}

void visit_fields(AsphaltOptions& options, FieldVisitor& visitor) {
  visitor.field({"albedo", "", "share of light that it sends back", 0.01, 0.9}, options.albedo);
  visitor.field({"grain", "", "contrast of its stones, relative sd", 0.0, 1.0}, options.grain);
  visitor.field({"stains", "", "contrast of decimetres to metres, relative sd", 0.0, 1.0}, options.stains);
  visitor.field({"patches_share", "", "of the road, mended", 0.0, 0.33}, options.patches_share);
  visitor.field({"manholes_share", "", "of stretches of 18 m that have one", 0.0, 1.0}, options.manholes_share);
  visitor.field({"marking_wear", "", "share of the paint that is gone", 0.0, 1.0}, options.marking_wear);
  visitor.field({"markings", "", "whether lanes are marked"}, options.markings);
}

void visit_fields(WorldOptions& options, FieldVisitor& visitor) {
  visitor.group("road", options.profile);
  visitor.group("asphalt", options.asphalt);
  visitor.field({"side_roads", "", "whether a road leads on where the path turns off"}, options.side_roads);
  visitor.field({"houses_share", "", "of the frontage that is built up", 0.0, 1.0}, options.houses_share);
  visitor.field({"hedges_share", "", "of front gardens", 0.0, 1.0}, options.hedges_share);
  visitor.field({"walls_share", "", "of front gardens", 0.0, 1.0}, options.walls_share);
  visitor.field({"fences_share", "", "of front gardens", 0.0, 1.0}, options.fences_share);
  visitor.field({"trees_a_side_m", "m", "mean distance between trees; 0: none", 0.0, 1e4}, options.trees_a_side_m);
  visitor.field({"bushes_a_side_m", "m", "mean distance between bushes; 0: none", 0.0, 1e4}, options.bushes_a_side_m);
  visitor.field({"poles_a_side_m", "m", "mean distance between lamps and signs; 0: none", 0.0, 1e4},
                options.poles_a_side_m);
  visitor.field({"boxes_a_side_m", "m", "mean distance between bins and cabinets; 0: none", 0.0, 1e4},
                options.boxes_a_side_m);
  visitor.field({"cars_share", "", "of the kerb that has cars parked along it", 0.0, 1.0}, options.cars_share);
  visitor.field({"sun_elevation_deg", "deg", "above the horizon; below 0: none", -90.0, 90.0},
                options.sun_elevation_deg);
  visitor.field({"sun_azimuth_deg", "deg", "from the start's direction of travel, to the right", -360.0, 360.0},
                options.sun_azimuth_deg);
}

void visit_fields(SensorOptions& options, FieldVisitor& visitor) {
  visitor.field({"vignetting", "", "loss of light in the corner", 0.0, 1.0}, options.vignetting);
  visitor.field({"target", "", "mean of the image that the exposure aims at, 1 = full", 0.05, 0.9}, options.target);
  visitor.field({"adaptation_s", "s", "in which the exposure makes up for most of a change", 0.0, 100.0},
                options.adaptation_s);
  visitor.field({"full_well_e", "e", "electrons of a full pixel, of which shot noise comes; 0: no noise", 0.0, 1e9},
                options.full_well_e);
  visitor.field({"read_noise_e", "e", "sd in electrons", 0.0, 1e6}, options.read_noise_e);
  visitor.field({"gamma", "", "grey level = light^(1 / gamma)", 0.2, 5.0}, options.gamma);
}

void visit_fields(TrafficOptions& options, FieldVisitor& visitor) {
  visitor.field({"on", "", "whether other cars drive"}, options.on);
  visitor.field({"ahead", "", "cars in the vehicle's own lane", 0.0, 20.0}, options.ahead);
  visitor.field({"gap_s", "s", "from the vehicle to the one ahead, and on to the next", 0.5, 60.0}, options.gap_s);
  visitor.field({"oncoming_every_s", "s", "mean time between oncoming cars, at least 3; 0: none", 0.0, 3600.0},
                options.oncoming_every_s);
}

void visit_fields(SimulationOptions& options, FieldVisitor& visitor) {
  visitor.group("rig", options.rig);
  visitor.field({"rate_hz", "Hz", "frames a second along a route; given poses have their times", 0.1, 1000.0},
                options.rate_hz);
  visitor.field({"shutter_ms", "ms", "open for so long: motion blur", 0.0, 1000.0}, options.shutter_ms);
  visitor.field({"edge_rays", "", "a pixel has 4 rays, at edges so many more: 0, 8 or 16", 0.0, 16.0},
                options.edge_rays);
  visitor.group("sensor", options.sensor);
  visitor.group("world", options.world);
  visitor.group("traffic", options.traffic);
}

Result<void> validate(const SimulationOptions& options) {
  if (auto checked = check_ranges(options); !checked) return checked;
  if (options.edge_rays != 0 && options.edge_rays != 8 && options.edge_rays != 16) {
    return Error{ErrorCode::kBadInput, fmt::format("edge_rays is {}, it must be 0, 8 or 16", options.edge_rays)};
  }
  const double every_s = options.traffic.oncoming_every_s;
  if (every_s > 0.0 && every_s < 3.0) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("traffic.oncoming_every_s is {}, it must be 0 or at least 3", every_s)};
  }
  const RoadProfile& road = options.world.profile;
  if (road.lane_offset_m >= road.half_width_m) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("world.road.lane_offset_m is {}, it must be below world.road.half_width_m, {}",
                             road.lane_offset_m, road.half_width_m)};
  }
  const WorldOptions& world = options.world;
  if (world.hedges_share + world.walls_share + world.fences_share > 1.0) {
    return Error{ErrorCode::kBadInput, "world.hedges_share, walls_share and fences_share are above 1 together"};
  }
  if (!(1e-3 * options.shutter_ms <= 1.0 / options.rate_hz)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("shutter_ms is {}, frames come every {} ms", options.shutter_ms, 1e3 / options.rate_hz)};
  }
  return {};
}

void set_surroundings(Surroundings surroundings, WorldOptions& options) {
  switch (surroundings) {
    case Surroundings::kTown:
      return;
    case Surroundings::kCountry:
      options.profile.kerb_m = 0.0;
      options.houses_share = 0.1;
      options.hedges_share = 0.1;
      options.walls_share = 0.0;
      options.trees_a_side_m = 12.0;
      options.poles_a_side_m = 60.0;
      options.boxes_a_side_m = 0.0;
      options.cars_share = 0.0;
      return;
    case Surroundings::kMotorway:
      options.profile.kerb_m = 0.0;
      options.profile.lane_offset_m = 5.4;
      options.profile.half_width_m = 9.0;
      options.profile.pavement_m = 1.0;
      options.asphalt.grain = 0.1;
      options.asphalt.stains = 0.03;
      options.asphalt.patches_share = 0.0;
      options.asphalt.manholes_share = 0.0;
      options.houses_share = 0.0;
      options.hedges_share = 0.0;
      options.walls_share = 0.0;
      options.fences_share = 0.3;
      options.trees_a_side_m = 40.0;
      options.poles_a_side_m = 80.0;
      options.boxes_a_side_m = 0.0;
      options.cars_share = 0.0;
      return;
  }
}

}  // namespace groundscale
