#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "groundscale/experiments/contamination_records_internal.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale::internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFile = "/pairs.json";

double share_without_road(const Image& region, const Image& road) {
  const int area = mask_area(region);
  if (area == 0) return 1.0;
  return 1.0 - static_cast<double>(mask_area(restrict_region(region, road))) / area;
}

/// A method in one region, with what it remembers of the drive so far.
struct Measurer {
  std::string method;
  EstimatePlane estimate;
  Rng rng;
};

std::vector<Measurer> make_measurers(const std::vector<PlaneMethod>& methods, const OdometryOptions& options) {
  std::vector<Measurer> measurers;
  for (const PlaneMethod& method : methods) {
    measurers.push_back(
        {std::string(method.name), method.make(options.ground.plane), Rng(static_cast<std::uint64_t>(options.seed))});
  }
  return measurers;
}

/// Errors of all methods in a region of the present pair.
std::vector<std::optional<double>> errors_in(PairWalk& walk, const Image& region, const RegionOptions& options,
                                             std::vector<Measurer>& measurers) {
  std::vector<std::optional<double>> errors;
  const RoadObservations observations = walk.observe(region, options);
  for (Measurer& measurer : measurers) {
    const auto plane = measurer.estimate(observations, measurer.rng);
    errors.push_back(plane ? std::optional(walk.camera_height_m() / plane->plane.height / walk.true_step() - 1.0)
                           : std::nullopt);
  }
  return errors;
}

/// What there is for one share of the fixed strip.
struct Contaminated {
  double share = 0.0;
  std::vector<Measurer> whole, mask;
};

}  // namespace

PlacedStrip place_strip(const PairWalk& walk, const RegionOptions& strip, double shift_m) {
  constexpr double kPieceM = 0.5;  // a distorted edge is no line
  PlacedStrip placed{.options = strip, .mask = {}};
  DrivenPath straight = walk.expected().path;
  straight.curvature_per_m = 0.0;
  std::vector<Eigen::Vector2d> left, right;
  for (double along = strip.near_m; along < strip.far_m + 0.5 * kPieceM; along += kPieceM) {
    const GroundPlane& road = walk.expected().warp.road_in_cam1;
    const auto l = walk.camera()->project(point_on_path(straight, road, along, shift_m - strip.half_width_m));
    const auto r = walk.camera()->project(point_on_path(straight, road, along, shift_m + strip.half_width_m));
    if (!l || !r) continue;
    left.push_back(*l);
    right.push_back(*r);
  }
  left.insert(left.end(), right.rbegin(), right.rend());
  placed.options.polygon_px.clear();
  for (const Eigen::Vector2d& corner : left) {
    placed.options.polygon_px.insert(placed.options.polygon_px.end(), {corner.x(), corner.y()});
  }
  if (!left.empty()) placed.mask = walk.region(placed.options);
  placed.share = share_without_road(placed.mask, walk.road_mask());
  return placed;
}

std::vector<std::optional<PlacedStrip>> strips_of_shares(const PairWalk& walk, const RegionOptions& strip,
                                                         const std::vector<double>& shares) {
  constexpr double kTolerance = 0.025;
  constexpr double kStepM = 0.1;
  constexpr int kSteps = 80;
  std::vector<std::optional<PlacedStrip>> best(shares.size());
  for (int k = 0; k <= 2 * kSteps; ++k) {
    // 0, 0.1, -0.1, 0.2, ... m: of equals the smallest comes first.
    const int step = k % 2 == 0 ? -k / 2 : (k + 1) / 2;
    const PlacedStrip placed = place_strip(walk, strip, step * kStepM);
    if (mask_area(placed.mask) == 0) continue;
    for (std::size_t s = 0; s < shares.size(); ++s) {
      const double off = std::abs(placed.share - shares[s]);
      if (off <= kTolerance && (!best[s] || off < std::abs(best[s]->share - shares[s]))) best[s] = placed;
    }
  }
  return best;
}

Result<std::vector<ContaminationRecord>> measure_contamination(const RenderedDrive& drive,
                                                               const std::vector<PlaneMethod>& methods,
                                                               const std::vector<double>& shares,
                                                               const PairWalkOptions& options) {
  auto walk = PairWalk::open(drive, options);
  if (!walk) return walk.error();
  const OdometryOptions& odometry = options.odometry;
  const RegionOptions& strip = odometry.road.region;
  std::vector<Contaminated> levels;
  for (const double share : shares) {
    levels.push_back({share, make_measurers(methods, odometry), make_measurers(methods, odometry)});
  }
  std::vector<Measurer> along_path = make_measurers(methods, odometry);

  std::vector<ContaminationRecord> records;
  while (walk->next()) {
    if (walk->road_mask().empty()) return bad_input(fmt::format("{}: has no road_masks", drive.folder));
    const auto add = [&](std::string_view region, double wanted, double share,
                         const std::vector<std::optional<double>>& errors) {
      for (std::size_t m = 0; m < methods.size(); ++m) {
        records.push_back(
            {drive.name, walk->frame(), std::string(region), wanted, share, std::string(methods[m].name), errors[m]});
      }
    };
    const Image path = walk->region(strip);
    const double path_share = share_without_road(path, walk->road_mask());
    const auto path_errors = errors_in(*walk, path, strip, along_path);
    const auto strips = strips_of_shares(*walk, strip, shares);
    for (std::size_t s = 0; s < shares.size(); ++s) {
      if (!strips[s]) continue;
      const PlacedStrip& placed = *strips[s];
      add(kWholeRegion, shares[s], placed.share, errors_in(*walk, placed.mask, placed.options, levels[s].whole));
      const Image road = restrict_region(placed.mask, walk->road_mask());
      add(kRoadMask, shares[s], 0.0, errors_in(*walk, road, placed.options, levels[s].mask));
      add(kPathRegion, shares[s], path_share, path_errors);
    }
  }
  return records;
}

Result<void> write_records(const std::vector<ContaminationRecord>& records, const std::string& folder) {
  Json rows = Json::array();
  for (const ContaminationRecord& r : records) {
    rows.push_back(Json::array(
        {r.drive, r.frame, r.region, r.wanted_share, r.share, r.method, r.error ? Json(*r.error) : Json()}));
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return write_text(folder + kFile, rows.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<std::vector<ContaminationRecord>> read_records(const std::string& folder) {
  const auto text = read_text(folder + kFile);
  if (!text) return Error{ErrorCode::kIo, text.error().message};
  try {
    std::vector<ContaminationRecord> records;
    for (const Json& row : Json::parse(*text)) {
      std::size_t k = 0;
      ContaminationRecord record;
      record.drive = row.at(k++).get<std::string>();
      record.frame = row.at(k++).get<int>();
      record.region = row.at(k++).get<std::string>();
      record.wanted_share = row.at(k++).get<double>();
      record.share = row.at(k++).get<double>();
      record.method = row.at(k++).get<std::string>();
      if (!row.at(k).is_null()) record.error = row.at(k).get<double>();
      records.push_back(std::move(record));
    }
    return records;
  } catch (const Json::exception& error) {
    return Error{ErrorCode::kIo, fmt::format("{}: a result in it can't be read: {}", folder, error.what())};
  }
}

}  // namespace groundscale::internal
