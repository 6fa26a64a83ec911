#include "groundscale/simulation/cars.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "groundscale/simulation/material.hpp"

namespace groundscale {
namespace {

/// A car's section across, at a place along it. Lengths in metres; `along` as a share of the car's length, 0.5 in
/// front.
struct Section {
  double along;
  double half_width;  ///< At the belt line.
  double bottom;
  double belt;       ///< Where windows begin.
  double top;        ///< In the middle.
  double half_roof;  ///< Half width of what is on top.
  bool side_glass;   ///< Windows from here to the next section.
  bool top_glass;    ///< A windscreen, or the rear window.
};
using Sections = std::vector<Section>;

constexpr double kWheelRadiusM = 0.31;
constexpr double kWheelAlong = 0.31;  ///< From the middle, of the length.
constexpr double kWheelAsideM = 0.74;

Sections sections_of(CarKind kind) {
  // Nose and bonnet, then what tells one kind from another.
  Sections sections = {{0.50, 0.70, 0.30, 0.60, 0.64, 0.60, false, false},
                       {0.47, 0.82, 0.22, 0.70, 0.77, 0.72, false, false},
                       {0.36, 0.87, 0.19, 0.84, 0.92, 0.76, false, false}};
  const auto add = [&sections](const Sections& more) { sections.insert(sections.end(), more.begin(), more.end()); };
  switch (kind) {
    case CarKind::kSmall:
      add({{0.22, 0.87, 0.19, 0.90, 0.98, 0.76, true, true},
           {0.04, 0.87, 0.19, 0.93, 1.43, 0.60, true, false},
           {-0.09, 0.87, 0.19, 0.94, 1.47, 0.60, false, false},
           {-0.11, 0.87, 0.19, 0.94, 1.47, 0.60, true, false},
           {-0.30, 0.87, 0.20, 0.96, 1.43, 0.58, false, false},
           {-0.40, 0.86, 0.21, 0.97, 1.36, 0.55, false, true},
           {-0.475, 0.83, 0.24, 0.93, 1.00, 0.70, false, false},
           {-0.50, 0.76, 0.32, 0.80, 0.86, 0.66, false, false}});
      break;
    case CarKind::kEstate:
      add({{0.22, 0.88, 0.19, 0.92, 1.00, 0.76, true, true},
           {0.06, 0.88, 0.19, 0.94, 1.42, 0.60, true, false},
           {-0.06, 0.88, 0.19, 0.95, 1.46, 0.60, false, false},
           {-0.08, 0.88, 0.19, 0.95, 1.46, 0.60, true, false},
           {-0.24, 0.88, 0.20, 0.96, 1.46, 0.60, false, false},
           {-0.26, 0.88, 0.20, 0.96, 1.46, 0.60, true, false},
           {-0.43, 0.86, 0.21, 0.97, 1.40, 0.56, false, true},
           {-0.485, 0.83, 0.24, 0.94, 1.00, 0.72, false, false},
           {-0.50, 0.77, 0.32, 0.82, 0.90, 0.68, false, false}});
      break;
    case CarKind::kSaloon:
      add({{0.21, 0.88, 0.19, 0.90, 0.97, 0.76, true, true},
           {0.06, 0.88, 0.19, 0.92, 1.38, 0.58, true, false},
           {-0.06, 0.88, 0.19, 0.93, 1.42, 0.58, false, false},
           {-0.08, 0.88, 0.19, 0.93, 1.42, 0.58, true, false},
           {-0.21, 0.88, 0.20, 0.94, 1.36, 0.56, true, true},
           {-0.33, 0.87, 0.21, 0.95, 1.01, 0.70, false, false},
           {-0.475, 0.83, 0.24, 0.93, 0.99, 0.70, false, false},
           {-0.50, 0.76, 0.32, 0.78, 0.84, 0.66, false, false}});
      break;
    case CarKind::kVan:
      sections = {
          {0.50, 0.74, 0.32, 0.72, 0.78, 0.66, false, false},  {0.47, 0.86, 0.24, 0.90, 0.98, 0.76, false, false},
          {0.35, 0.92, 0.21, 1.08, 1.20, 0.80, true, true},    {0.22, 0.92, 0.21, 1.10, 1.82, 0.74, true, false},
          {0.08, 0.92, 0.21, 1.10, 1.90, 0.76, false, false},  {-0.44, 0.92, 0.22, 1.10, 1.90, 0.76, false, false},
          {-0.485, 0.90, 0.24, 1.08, 1.80, 0.74, false, true}, {-0.498, 0.88, 0.28, 1.06, 1.15, 0.78, false, false},
          {-0.50, 0.84, 0.34, 0.90, 0.98, 0.76, false, false}};
      break;
  }
  return sections;
}

/// Corners of a section from the left sill over the roof to the right one.
constexpr std::size_t kCorners = 12;
std::array<Eigen::Vector2d, kCorners> outline(const Section& s) {
  const std::array<Eigen::Vector2d, kCorners / 2> right = {{{0.45 * s.half_roof, s.top},
                                                            {s.half_roof - 0.04, s.top - 0.03},
                                                            {s.half_roof + 0.03, s.top - 0.09},
                                                            {s.half_width - 0.02, std::min(s.belt, s.top - 0.1)},
                                                            {s.half_width, 0.45 * s.belt + 0.55 * s.bottom},
                                                            {s.half_width - 0.07, s.bottom}}};
  std::array<Eigen::Vector2d, kCorners> corners;
  for (std::size_t k = 0; k < right.size(); ++k) {
    corners[kCorners / 2 + k] = right[k];
    corners[kCorners / 2 - 1 - k] = {-right[k].x(), right[k].y()};
  }
  return corners;
}

/// The shell: sections joined, ends closed. uv: along from the middle, and up.
void add_shell(TriangleMesh& paint, TriangleMesh& glass, const Footing& foot, const Sections& sections, double length) {
  constexpr std::size_t kSideLeft = 2;  // from the belt to the roof
  constexpr std::size_t kSideRight = kCorners - 2 - kSideLeft;
  const auto vertex = [&](TriangleMesh& mesh, const Section& section, std::size_t corner) {
    const Eigen::Vector2d at = outline(section)[corner];
    const double along = section.along * length;
    return mesh.add_vertex(foot.at(at.x(), at.y(), along), {along, at.y()});
  };
  for (std::size_t i = 0; i + 1 < sections.size(); ++i) {
    const Section& a = sections[i];
    const Section& b = sections[i + 1];
    for (std::size_t k = 0; k + 1 < kCorners; ++k) {
      const bool on_side = k == kSideLeft || k == kSideRight;
      const bool on_top = k > kSideLeft + 1 && k + 1 < kSideRight;
      TriangleMesh& mesh = (on_side && a.side_glass) || (on_top && a.top_glass) ? glass : paint;
      mesh.add_quad(vertex(mesh, a, k), vertex(mesh, a, k + 1), vertex(mesh, b, k + 1), vertex(mesh, b, k));
    }
  }
  for (const Section& end : {sections.front(), sections.back()}) {
    const std::uint32_t first = vertex(paint, end, 0);
    for (std::size_t k = 1; k + 1 < kCorners; ++k) {
      paint.faces.push_back({first, vertex(paint, end, k), vertex(paint, end, k + 1)});
    }
  }
}

/// Tyres, with the dark of the wheel arch about them, and hubs.
void add_wheels(TriangleMesh& rubber, TriangleMesh& hubs, const Footing& foot, const CarSize& size) {
  constexpr double kTyreM = 0.2;
  constexpr int kSides = 14;
  for (const double front : {-1.0, 1.0}) {
    for (const double side : {-1.0, 1.0}) {
      const double along = front * kWheelAlong * size.length_m;
      const double outer = side * (size.half_width_m + 0.015);
      const Eigen::Vector3d middle = foot.at(outer, kWheelRadiusM, along);
      const Eigen::Vector3d inwards = -side * foot.right;
      add_tube(rubber, {middle, middle + kTyreM * inwards, kWheelRadiusM, kWheelRadiusM, kSides});
      add_disc(rubber, {middle, foot.along, foot.up, kWheelRadiusM, kSides});
      add_disc(rubber, {middle + 0.01 * inwards + 0.03 * foot.up, foot.along, foot.up, kWheelRadiusM + 0.07, kSides});
      add_disc(hubs, {middle - 0.006 * inwards, foot.along, foot.up, 0.62 * kWheelRadiusM, kSides});
    }
  }
}

/// Number plates, lamps, bumpers' dark strips, mirrors.
void add_fittings(Meshes& parts, const Footing& foot, const Sections& sections, const CarSize& size, int variant) {
  TriangleMesh plates = mesh_of(material_code(Material::kPlate, variant));
  TriangleMesh lamps = mesh_of(material_code(Material::kLamp, variant));
  TriangleMesh dark = mesh_of(material_code(Material::kRubber, 0));
  for (const bool front : {true, false}) {
    const Section& end = front ? sections.front() : sections.back();
    const double toward = front ? 1.0 : -1.0;
    const double face = end.along * size.length_m + toward * 0.012;
    const auto patch = [&](TriangleMesh& mesh, double middle, double half, double low, double high) {
      // Seen from outside, from its left to its right.
      add_panel(mesh, {foot.at(middle + toward * half, low, face), foot.at(middle - toward * half, low, face),
                       foot.at(middle - toward * half, high, face), foot.at(middle + toward * half, high, face)});
    };
    const double waist = 0.5 * (end.bottom + end.belt);
    patch(plates, 0.0, 0.26, waist - 0.055, waist + 0.055);
    patch(dark, 0.0, end.half_width - 0.1, end.bottom + 0.01, waist - 0.08);
    for (const double side : {-1.0, 1.0}) {
      patch(lamps, side * (end.half_width - 0.17), 0.13, waist + 0.02, end.belt - 0.01);
    }
    if (front) patch(dark, 0.0, 0.3, waist + 0.08, end.belt - 0.02);
  }
  const auto windscreen =
      std::find_if(sections.begin(), sections.end(), [](const Section& section) { return section.top_glass; });
  for (const double side : {-1.0, 1.0}) {
    const double along = (windscreen->along - 0.05) * size.length_m;
    const double inner = side * (windscreen->half_width - 0.02);
    const double outer = side * (windscreen->half_width + 0.16);
    add_box(dark, foot,
            {{std::min(inner, outer), windscreen->belt + 0.02, along - 0.05},
             {std::max(inner, outer), windscreen->belt + 0.16, along + 0.05}});
  }
  parts.push_back(std::move(plates));
  parts.push_back(std::move(lamps));
  parts.push_back(std::move(dark));
}

}  // namespace

CarKind random_car_kind(Rng& rng) {
  const double share = rng.uniform();
  if (share < 0.45) return CarKind::kSmall;
  if (share < 0.7) return CarKind::kEstate;
  return share < 0.88 ? CarKind::kSaloon : CarKind::kVan;
}

CarSize car_size(CarKind kind) {
  switch (kind) {
    case CarKind::kSmall:
      return {3.9, 0.87, 1.47};
    case CarKind::kEstate:
      return {4.5, 0.88, 1.46};
    case CarKind::kSaloon:
      return {4.6, 0.88, 1.42};
    case CarKind::kVan:
      return {4.8, 0.92, 1.90};
  }
  return {};
}

Meshes car_meshes(const Footing& foot, CarKind kind, int variant) {
  const CarSize size = car_size(kind);
  const Sections sections = sections_of(kind);
  TriangleMesh paint = mesh_of(material_code(Material::kPaint, variant));
  TriangleMesh glass = mesh_of(material_code(Material::kGlass, variant));
  TriangleMesh rubber = mesh_of(material_code(Material::kRubber, 0));
  TriangleMesh hubs = mesh_of(material_code(Material::kHub, variant));
  add_shell(paint, glass, foot, sections, size.length_m);
  add_wheels(rubber, hubs, foot, size);
  Meshes parts;
  add_fittings(parts, foot, sections, size, variant);
  for (TriangleMesh* part : {&paint, &glass, &rubber, &hubs}) parts.push_back(std::move(*part));
  return parts;
}

Footing car_footing(const RoadSurface& surface, const Eigen::Vector3d& place, double heading_rad) {
  PathPoint level;
  level.heading_rad = heading_rad;
  constexpr double kWheelM = 1.3;
  const auto wheel = [&](double aside, double along) {
    Eigen::Vector3d at = place + aside * kWheelAsideM * level.right() + along * kWheelM * level.forward();
    at.y() = surface.ground_y(at.x(), at.z());
    return at;
  };
  const Eigen::Vector3d front_left = wheel(-1.0, 1.0);
  const Eigen::Vector3d front_right = wheel(1.0, 1.0);
  const Eigen::Vector3d back_left = wheel(-1.0, -1.0);
  const Eigen::Vector3d back_right = wheel(1.0, -1.0);
  Footing foot;
  foot.origin = 0.25 * (front_left + front_right + back_left + back_right);
  foot.along = (front_left + front_right - back_left - back_right).normalized();
  const Eigen::Vector3d right = front_right + back_right - front_left - back_left;
  foot.up = right.cross(foot.along).normalized();
  foot.right = foot.along.cross(foot.up);
  return foot;
}

void add_parked_cars(Roadside& roadside) {
  constexpr double kPlaceM = 5.6;
  Rng rng = roadside.generator(3);
  int variant = 0;
  for (const double side : {-1.0, 1.0}) {
    for (double s = roadside.begin_m; s < roadside.end_m; s += kPlaceM) {
      const bool taken = rng.uniform() < roadside.options.cars_share;
      Rng own(rng.next());
      ++variant;
      // Not in turns.
      constexpr double kStraightPerM = 0.02;
      if (!taken || std::abs(roadside.path.at(s).curvature_per_m) > kStraightPerM) continue;
      const CarKind kind = random_car_kind(own);
      const CarSize size = car_size(kind);
      // Two wheels on the pavement, so that the lane stays free; mostly with the traffic of their side.
      const double aside = roadside.surface.profile().half_width_m + 0.5 + own.uniform(-0.1, 0.15);
      const Footing rough = roadside.footing(s + own.uniform(-0.4, 0.4), side * aside);
      const bool with_traffic = own.uniform() < 0.85;
      const double turned = std::clamp(0.02 * own.normal(), -0.05, 0.05);
      const double heading = roadside.path.at(s).heading_rad + turned + ((side > 0.0) == with_traffic ? 0.0 : M_PI);
      const Footing foot = car_footing(roadside.surface, rough.origin, heading);
      const double reach = 0.5 * size.length_m;
      if (!roadside.clear_of_roads({foot.at(0.0, 0.0, -reach), foot.at(0.0, 0.0, reach)}, 0.2)) continue;
      if (!roadside.taken.take(foot, reach + 0.15, size.half_width_m)) continue;
      append(roadside.meshes, car_meshes(foot, kind, variant));
    }
  }
}

}  // namespace groundscale
