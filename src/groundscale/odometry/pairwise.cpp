#include "groundscale/odometry/pairwise.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/io/speed_file.hpp"
#include "groundscale/odometry/pose_chain.hpp"
#include "groundscale/road/ground_methods.hpp"

namespace groundscale {
namespace {

/// Whether two images differ by less than a grey level on average.
bool same_image(const Image& a, const Image& b) {
  if (a.width() != b.width() || a.height() != b.height()) return false;
  const auto count = static_cast<std::ptrdiff_t>(a.width()) * a.height();
  std::int64_t difference = 0;
  for (std::ptrdiff_t i = 0; i < count; ++i) difference += std::abs(a.data()[i] - b.data()[i]);
  return difference < count;
}

}  // namespace

Image allowed_of(const Image& vehicle_mask) {
  if (vehicle_mask.empty()) return {};
  Image allowed(vehicle_mask.width(), vehicle_mask.height());
  const auto count = static_cast<std::ptrdiff_t>(vehicle_mask.width()) * vehicle_mask.height();
  std::transform(vehicle_mask.data(), vehicle_mask.data() + count, allowed.data(),
                 [](std::uint8_t own) { return static_cast<std::uint8_t>(own == 0 ? 255 : 0); });
  return allowed;
}

Result<PairwiseOdometry> PairwiseOdometry::create(const CameraSetup& setup, const OdometryOptions& options) {
  GS_CHECK(setup.camera != nullptr && setup.height_m.has_value(), "a camera and its height");
  if (const auto valid = options.validate(); !valid) return valid.error();
  use_one_thread();
  PairwiseOdometry odometry(setup, options);
  const Mounting mounting = odometry.mounting();
  const GroundPlane road{mounting.normal_in_cam(), *setup.height_m};
  const Image region = restrict_region(
      region_mask({mounting.forward_in_cam(), 0.0}, road, *setup.camera, options.road.region), odometry.tracking_mask_);
  // An unlikely height says more about its unit than about where the road is: the run goes on, with a warning.
  if (mask_area(region) == 0 && *setup.height_m <= kUnlikelyHeightM) {
    if (!options.road.region.polygon_px.empty()) {
      return Error{ErrorCode::kBadInput,
                   "no road is in view: road.region.polygon_px lies outside the image (or behind the vehicle mask)"};
    }
    return Error{ErrorCode::kBadInput,
                 fmt::format("no road is in view: the strip from {} to {} m ahead lies outside the image with this "
                             "height, pitch, roll and yaw (or behind the vehicle mask)",
                             options.road.region.near_m, options.road.region.far_m)};
  }
  if (!options.road.network.file.empty()) {
    auto detector = RoadDetector::open(options.road.network, setup.camera);
    if (!detector) return detector.error();
    odometry.detector_ = std::make_shared<RoadDetector>(std::move(*detector));
  }
  if (!options.scale.speed.file.empty()) {
    auto log = read_speed_log(options.scale.speed.file);
    if (!log) return Error{log.error().code, "scale.speed: " + log.error().message};
    odometry.share_speed(std::make_shared<SpeedReference>(std::move(*log), options.scale.speed));
  }
  return odometry;
}

PairwiseOdometry::PairwiseOdometry(const CameraSetup& setup, const OdometryOptions& options)
    : camera_(setup.camera),
      camera_height_m_(*setup.height_m),
      tracking_mask_(allowed_of(setup.vehicle_mask)),
      options_(options),
      refine_warp_(make_memoryless<estimate_plane_sparse>(options.ground.plane)),
      estimate_plane_(find_ground_method(options.ground.method)->make(options.ground.plane)),
      rng_(static_cast<std::uint64_t>(options.seed)),
      tracker_(options.tracking),
      road_matcher_(options.road.tracking),
      chain_(setup, options.ground),
      views_(options.pair, options.motion) {}

const FrameResult& PairwiseOdometry::advance(const Frame& frame, const Image& road_mask) {
  clock_.skip();
  if (!frame.image.empty()) {
    tracker_.advance(frame.image, tracking_mask_);
    clock_.lap("tracking");
  }
  return advance(frame, road_mask, {tracker_.points(), tracker_.followed()});
}

const FrameResult& PairwiseOdometry::advance(const Frame& frame, const Image& road_mask, const TrackedPoints& tracked) {
  details_ = {};
  pair_ = {};
  road_.reset();
  tracked_ = tracked;
  road_mask_ = road_mask;
  clock_.skip();
  FrameResult result;
  result.frame = frame.index;
  result.time_s = frame.time_s;
  result.scaled = chain_.scaled();
  if (frame.image.empty()) return chain_.bridge(std::move(result), frame.problem);

  result.tracks = static_cast<int>(tracked_.points.size());
  result.tracks_kept = tracked_.followed;
  if (views_.empty()) {
    chain_.begin(std::move(result));
    remember_view(frame);
    return results().back();
  }
  const bool standing = results().size() > 1 && results().back().state == FrameState::kStill;
  Pair pair = views_.pair_with(tracked_.points, *camera_, standing);
  result.matches = static_cast<int>(pair.matches.size());
  if (pair.motion.state != MotionState::kStill) {
    pair.motion = estimate_motion(pair.rays, camera_->focal_px(), options_.motion, rng_, last_motion_);
  }
  result.inliers = static_cast<int>(pair.motion.inliers.size());
  result.rms_px = pair.motion.rms_px;
  clock_.lap("motion");
  details_.matches = pair.matches;
  details_.pairs = pair.rays;
  details_.inliers = pair.motion.inliers;
  pair_ = pair;
  switch (pair.motion.state) {
    case MotionState::kStill:
      return chain_.stand(std::move(result));
    case MotionState::kRotating:
      chain_.rotate(std::move(result), pair);
      remember_view(frame);
      return results().back();
    case MotionState::kMoving:
      return move(std::move(result), pair, frame);
    case MotionState::kLost:
      break;
  }
  // A frozen image; one without anything to see, such as a black one, says nothing of a camera that was moving.
  const bool seeing = !tracked_.points.empty() || results().back().state == FrameState::kStill;
  if (seeing && same_image(views_.latest().road.image, frame.image)) return chain_.stand(std::move(result));
  chain_.bridge(std::move(result), pair.motion.reason);
  // A partner from before the gap is best; where it fails as well, tracks begin anew here.
  constexpr int kNewStart = 2;
  if (chain_.bridged_in_a_row() >= kNewStart) remember_view(frame);
  return results().back();
}

const FrameResult& PairwiseOdometry::move(FrameResult result, const Pair& pair, const Frame& frame) {
  chain_.move(std::move(result), pair, [&](double expected_distance_m, FrameResult& measured) {
    return measure_road(pair, expected_distance_m, measured, frame);
  });
  last_motion_ = pair.motion.cam2_from_cam1;
  remember_view(frame);
  clock_.lap("filter and poses");
  return results().back();
}

/// The latest frame becomes one that later ones may be paired with.
void PairwiseOdometry::remember_view(const Frame& frame) {
  View view;
  view.result = static_cast<int>(results().size()) - 1;
  view.time_s = frame.time_s;
  view.points = tracked_.points;
  view.road.image = frame.image;
  view.road_mask = road_mask_;
  if (detector_) {
    clock_.lap("filter and poses");
    const auto warp = views_.empty() ? std::nullopt : chain_.latest_warp(views_.latest().result);
    view.road_mask = intersect_masks(road_mask_, detector_->advance(frame.image, warp));
    clock_.lap("road network");
  }
  for (const Match& match : road_matches_) view.road.points.push_back({match.id, match.pixel2});
  road_matches_.clear();
  views_.push(std::move(view));
}

}  // namespace groundscale
