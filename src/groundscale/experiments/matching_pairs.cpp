#include "groundscale/experiments/matching_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <ctime>
#include <optional>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "groundscale/experiments/truth_rows.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/road/road_matcher.hpp"

namespace groundscale {
namespace {

using internal::bad_input;

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = line.find(';', begin);
    cells.push_back(line.substr(begin, end == std::string_view::npos ? end : end - begin));
    if (end == std::string_view::npos) break;
    begin = end + 1;
  }
  return cells;
}

/// A simulated drive, image by image.
struct Drive {
  std::string folder;
  CameraPtr camera;
  Trajectory poses;
  std::vector<TruthRow> roads;

  std::string file(const char* part, std::size_t frame) const {
    return fmt::format("{}/{}/{:06d}.png", folder, part, frame);
  }
};

Result<Drive> open_drive(const std::string& folder) {
  Drive drive;
  drive.folder = folder;
  auto poses = read_trajectory(folder + "/poses.txt");
  if (!poses) return poses.error();
  auto roads = read_truth_rows(folder + "/truth.csv");
  if (!roads) return roads.error();
  if (roads->size() < poses->world_from_cam.size()) {
    return bad_input(folder + "/truth.csv: fewer rows than poses.txt has");
  }
  const auto image = read_image(drive.file("image_0", 0));
  if (!image) return image.error();
  auto setup = read_camera_file(folder + "/camera.yaml", image->width(), image->height());
  if (!setup) return setup.error();
  drive.camera = setup->camera;
  drive.poses = std::move(*poses);
  drive.roads = std::move(*roads);
  return drive;
}

/// Depth between pixels, of a surface without an edge there: planes have inverse depths that are linear in the pixel.
std::optional<double> depth_at(const DepthImage& depth, const Eigen::Vector2d& pixel) {
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  if (x < 0 || y < 0 || x + 1 >= depth.width || y + 1 >= depth.height) return std::nullopt;
  const double a = pixel.x() - x;
  const double b = pixel.y() - y;
  const auto at = [&](int u, int v) {
    return static_cast<double>(depth.depths_m[static_cast<std::size_t>(v) * static_cast<std::size_t>(depth.width) +
                                              static_cast<std::size_t>(u)]);
  };
  const std::array<double, 4> corners = {at(x, y), at(x + 1, y), at(x, y + 1), at(x + 1, y + 1)};
  const auto [least, most] = std::minmax_element(corners.begin(), corners.end());
  constexpr double kEdge = 1.1;
  if (*least <= 0.0 || *most > kEdge * *least) return std::nullopt;
  const double inverse =
      (1 - b) * ((1 - a) / corners[0] + a / corners[1]) + b * ((1 - a) / corners[2] + a / corners[3]);
  return 1.0 / inverse;
}

/// Two neighbouring frames, and what is known and expected of them.
struct PairOfFrames {
  Image first, second, region;
  RoadWarp warp;
};

Matches match_plainly(const PairOfFrames& pair, FrontEndKind kind, const OdometryOptions& options) {
  TrackingOptions tracking = options.tracking;
  tracking.front_end = kind;
  const auto front_end = make_front_end(tracking);
  front_end->advance(pair.first, {}, {});
  RoadTrackingOptions road = options.road.tracking;
  road.front_end = kind;
  RoadView view{.image = pair.first};
  RoadMatcher(road).fill(view, pair.region);
  std::vector<Eigen::Vector2d> starts;
  for (const TrackPoint& point : view.points) starts.push_back(point.pixel);
  const auto found = front_end->advance(pair.second, starts, FrontEnd::Places(starts.size()));
  Matches matches;
  for (std::size_t i = 0; i < starts.size(); ++i) {
    if (found[i]) matches.push_back({view.points[i].id, starts[i], *found[i]});
  }
  return matches;
}

Matches match_through_warp(const PairOfFrames& pair, FrontEndKind kind, const OdometryOptions& options,
                           const Camera& camera) {
  RoadTrackingOptions road = options.road.tracking;
  road.front_end = kind;
  RoadView view{.image = pair.first};
  RoadMatcher matcher(road);
  matcher.fill(view, pair.region);
  return matcher.match(view, pair.second, pair.warp, /*fine=*/false, camera);
}

std::vector<double> errors_of(const Matches& matches, const DepthImage& depth, const RigidTransform& cam2_from_cam1,
                              const Camera& camera) {
  std::vector<double> errors;
  for (const Match& match : matches) {
    const auto ray = camera.ray(match.pixel1);
    const auto depth_m = depth_at(depth, match.pixel1);
    if (!ray || !depth_m) continue;
    const auto truth = camera.project(cam2_from_cam1 * Eigen::Vector3d(*ray * (*depth_m / ray->z())));
    if (truth) errors.push_back((match.pixel2 - *truth).norm());
  }
  return errors;
}

/// Region and warp as motion and plane of the frame before let expect.
Result<std::optional<PairOfFrames>> pair_at(const Drive& drive, std::size_t k, const OdometryOptions& options) {
  const auto& poses = drive.poses.world_from_cam;
  if (!drive.roads[k - 1].plane) return std::optional<PairOfFrames>();
  PairOfFrames pair;
  pair.warp = {poses[k].inverse() * poses[k - 1], *drive.roads[k - 1].plane};
  constexpr double kStandingM = 0.02;
  if (pair.warp.cam2_from_cam1.translation.norm() < kStandingM) return std::optional<PairOfFrames>();
  const DrivenPath path = path_of_motion(pair.warp.cam2_from_cam1, pair.warp.road_in_cam1.normal_in_cam,
                                         Eigen::Vector3d::UnitZ(), options.road.region.max_turn_deg);
  for (const auto& [part, frame, image] :
       {std::tuple("image_0", k, &pair.first), std::tuple("image_0", k + 1, &pair.second),
        std::tuple("road_masks", k, &pair.region)}) {
    auto read = read_image(drive.file(part, frame));
    if (!read) return read.error();
    *image = std::move(*read);
  }
  pair.region =
      restrict_region(region_mask(path, pair.warp.road_in_cam1, *drive.camera, options.road.region), pair.region);
  return std::optional(std::move(pair));
}

}  // namespace

const std::vector<std::string>& matching_ways() {
  static const std::vector<std::string> ways = {"klt", "stereoscan", "klt, warped", "stereoscan, warped"};
  return ways;
}

Result<std::vector<MatchedPair>> match_pairs(const std::string& folder, const OdometryOptions& options) {
  use_one_thread();
  const auto drive = open_drive(folder);
  if (!drive) return drive.error();
  const auto& poses = drive->poses.world_from_cam;
  std::vector<MatchedPair> pairs;
  for (std::size_t k = 1; k + 1 < poses.size(); ++k) {
    const auto pair = pair_at(*drive, k, options);
    if (!pair) return pair.error();
    if (!*pair || mask_area((*pair)->region) == 0) continue;
    const auto depth = read_depth(drive->file("depth", k));
    if (!depth) return depth.error();
    for (std::size_t way = 0; way < matching_ways().size(); ++way) {
      const FrontEndKind kind = way % 2 == 0 ? FrontEndKind::kKlt : FrontEndKind::kStereoScan;
      const std::clock_t start = std::clock();
      const Matches matches =
          way < 2 ? match_plainly(**pair, kind, options) : match_through_warp(**pair, kind, options, *drive->camera);
      const double time_ms = 1e3 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
      pairs.push_back({static_cast<int>(k), drive->roads[k].speed_mps, matching_ways()[way], time_ms,
                       errors_of(matches, *depth, poses[k + 1].inverse() * poses[k], *drive->camera)});
    }
  }
  return pairs;
}

std::string pairs_csv(const std::vector<MatchedPair>& pairs) {
  std::string text = "frame;speed_mps;way;time_ms;errors_px\n";
  for (const MatchedPair& pair : pairs) {
    text += fmt::format("{};{};{};{:.3f};", pair.frame, internal::shortest(pair.speed_mps), pair.way, pair.time_ms);
    for (const double error : pair.errors_px) text += fmt::format("{:.4f} ", error);
    text += '\n';
  }
  return text;
}

Result<std::vector<MatchedPair>> read_pairs(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return text.error();
  std::vector<MatchedPair> pairs;
  for (const internal::Line& line : internal::split_lines(*text)) {
    if (line.number == 1 || line.text.empty()) continue;
    const std::vector<std::string_view> cells = cells_of(line.text);
    constexpr std::size_t kColumns = 5;
    if (cells.size() != kColumns) return bad_input(fmt::format("{}, line {}: can't be read", path, line.number));
    const auto frame = internal::parse_integer(cells[0]);
    const auto speed = internal::parse_number(cells[1]);
    const auto time_ms = internal::parse_number(cells[3]);
    if (!frame || !speed || !time_ms) return bad_input(fmt::format("{}, line {}: can't be read", path, line.number));
    MatchedPair pair{static_cast<int>(*frame), *speed, std::string(cells[2]), *time_ms, {}};
    for (const std::string_view word : internal::split_words(cells[4])) {
      pair.errors_px.push_back(internal::parse_number(word).value_or(0.0));
    }
    pairs.push_back(std::move(pair));
  }
  return pairs;
}

}  // namespace groundscale
