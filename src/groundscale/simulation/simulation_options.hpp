#pragma once

#include <vector>

#include "groundscale/core/options.hpp"
#include "groundscale/simulation/camera_rig.hpp"
#include "groundscale/simulation/renderer.hpp"
#include "groundscale/simulation/route.hpp"
#include "groundscale/simulation/sensor.hpp"
#include "groundscale/simulation/traffic.hpp"
#include "groundscale/simulation/world.hpp"

namespace groundscale {

/// All that decides what a drive looks like, besides its camera model and where it goes.
struct SimulationOptions {
  CameraRig rig;
  double rate_hz = 10.0;
  double shutter_ms = 4.0;
  int edge_rays = 8;  ///< As RenderOptions has it.
  SensorOptions sensor;
  WorldOptions world;
  TrafficOptions traffic;
};

void visit_fields(RoadProfile& profile, FieldVisitor& visitor);
void visit_fields(AsphaltOptions& options, FieldVisitor& visitor);
void visit_fields(WorldOptions& options, FieldVisitor& visitor);
void visit_fields(SensorOptions& options, FieldVisitor& visitor);
void visit_fields(TrafficOptions& options, FieldVisitor& visitor);
void visit_fields(SimulationOptions& options, FieldVisitor& visitor);

/// Every value within its bounds, and those that depend on each other fit. @return kBadInput with field, value, bound.
Result<void> validate(const SimulationOptions& options);

/// What lies about a route, over the options of a town.
void set_surroundings(Surroundings surroundings, WorldOptions& options);

}  // namespace groundscale
