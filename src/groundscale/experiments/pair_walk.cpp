#include "groundscale/experiments/pair_walk.hpp"

#include <algorithm>
#include <ctime>
#include <filesystem>
#include <system_error>
#include <utility>

#include <Eigen/Core>
#include <fmt/format.h>

#include "groundscale/experiments/truth_rows.hpp"
#include "groundscale/geometry/essential.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/road/road_matcher.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {
namespace {

/// Mean of the road's normals in a drive's truth.csv; nothing where it has none.
std::optional<Eigen::Vector3d> mean_normal_of(const std::string& truth_file) {
  const auto rows = read_truth_rows(truth_file);
  if (!rows) return std::nullopt;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const TruthRow& row : *rows) {
    if (row.plane) sum += row.plane->normal_in_cam;
  }
  if (!(sum.norm() > 0.0)) return std::nullopt;
  return sum.normalized();
}

/// The pair's motion by the truth: the matches that agree with it are its inliers.
TwoViewMotion motion_of_truth(const RigidTransform& metric_cam2_from_cam1, const std::vector<RayPair>& rays,
                              double focal_px, const MotionOptions& options) {
  TwoViewMotion motion;
  motion.state = MotionState::kMoving;
  motion.cam2_from_cam1 = {metric_cam2_from_cam1.rotation, metric_cam2_from_cam1.translation.normalized()};
  const Eigen::Matrix3d essential = essential_matrix(motion.cam2_from_cam1);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const double error = focal_px * epipolar_error_rad(essential, rays[k].ray1, rays[k].ray2);
    if (std::abs(error) <= options.max_error_px) motion.inliers.push_back(static_cast<int>(k));
  }
  return motion;
}

}  // namespace

double thread_cpu_s() {
  constexpr double kNano = 1e-9;
  std::timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + kNano * static_cast<double>(time.tv_nsec);
}

Result<PairWalk> PairWalk::open(const RenderedDrive& drive, const PairWalkOptions& options) {
  auto truth = read_trajectory(drive.truth());
  if (!truth) return truth.error();
  auto source = open_source_drive(drive.folder, "", drive.frames > 0 ? drive.frames : truth->size());
  if (!source) return source.error();
  if (source->sequence->frame_count() > truth->size()) {
    return internal::bad_input(
        fmt::format("{}: {} poses, but {} images", drive.truth(), truth->size(), source->sequence->frame_count()));
  }
  std::optional<RoadMasks> masks;
  const std::string folder = drive.folder + "/road_masks";
  std::error_code ignored;
  if (std::filesystem::is_directory(folder, ignored)) {
    auto opened = RoadMasks::open(folder, *source->sequence);
    if (!opened) return opened.error();
    masks = std::move(*opened);
  }
  const Mounting mounting{source->setup.pitch_rad.value_or(0.0), source->setup.roll_rad.value_or(0.0),
                          source->setup.yaw_rad.value_or(0.0)};
  const auto mean_normal = mean_normal_of(drive.folder + "/truth.csv");
  PairWalk walk(std::move(*source), std::move(*truth), mean_normal.value_or(mounting.normal_in_cam()), options);
  walk.masks_ = std::move(masks);
  return walk;
}

PairWalk::PairWalk(SourceDrive drive, Trajectory truth, const Eigen::Vector3d& mean_normal,
                   const PairWalkOptions& options)
    : drive_(std::move(drive)),
      truth_(std::move(truth)),
      options_(options),
      mean_normal_(mean_normal),
      tracker_(options.odometry.tracking),
      views_(options.odometry.pair, options.odometry.motion),
      rng_(static_cast<std::uint64_t>(options.odometry.seed)) {
  const PlaneAngles angles = plane_angles(mean_normal);
  mounting_ = {angles.pitch_rad, angles.roll_rad, drive_.setup.yaw_rad.value_or(0.0)};
}

void PairWalk::remember() {
  View view;
  view.result = frame_.index;
  view.time_s = frame_.time_s;
  view.points = tracker_.points();
  view.road.image = frame_.image;
  if (masks_) {
    if (auto mask = masks_->read(frame_.index)) view.road_mask = std::move(*mask);
  }
  views_.push(std::move(view));
}

bool PairWalk::next() {
  const OdometryOptions& odometry = options_.odometry;
  while (true) {
    if (!frame_.image.empty() && !frame_is_kept_) remember();
    auto frame = drive_.sequence->next();
    if (!frame) return false;
    frame_ = std::move(*frame);
    frame_is_kept_ = true;
    if (frame_.image.empty()) continue;
    double start_s = thread_cpu_s();
    tracker_.advance(frame_.image, {});
    times_.tracking_s = thread_cpu_s() - start_s;
    if (views_.empty()) {
      remember();
      continue;
    }
    start_s = thread_cpu_s();
    pair_ = views_.pair_with(tracker_.points(), *camera());
    if (pair_.motion.state == MotionState::kStill) continue;
    pair_.motion = estimate_motion(pair_.rays, camera()->focal_px(), odometry.motion, rng_);
    times_.motion_s = thread_cpu_s() - start_s;
    frame_is_kept_ = false;
    if (pair_.motion.state != MotionState::kMoving) continue;
    expect();
    return true;
  }
}

/// From the truth: the pair's motion, and what the odometry would know of it beforehand.
void PairWalk::expect() {
  const auto pose = [this](int index) { return truth_.world_from_cam[static_cast<std::size_t>(index)]; };
  const RigidTransform now = pose(frame_.index);
  true_motion_ = now.inverse() * pose(pair_.partner);
  if (options_.true_motion) {
    pair_.motion = motion_of_truth(true_motion_, pair_.rays, camera()->focal_px(), options_.odometry.motion);
  }
  const int before = std::max(frame_.index - 1, pair_.partner);
  const double lead_m = (pose(before).translation - pose(pair_.partner).translation).norm();
  const double last_step_m =
      before > 0 ? (pose(before).translation - pose(before - 1).translation).norm() : true_step();
  const double distance_m = lead_m + last_step_m;
  expected_.warp.cam2_from_cam1 = {pair_.motion.cam2_from_cam1.rotation,
                                   distance_m * pair_.motion.cam2_from_cam1.translation};
  expected_.warp.road_in_cam1 = {mean_normal_, camera_height_m()};
  expected_.path = path_of(expected_.warp);
}

DrivenPath PairWalk::path_of(const RoadWarp& warp) const {
  return path_of_motion(warp.cam2_from_cam1, warp.road_in_cam1.normal_in_cam, mounting_.forward_in_cam(),
                        options_.odometry.road.region.max_turn_deg);
}

Image PairWalk::region(const RegionOptions& options) const {
  return region_mask(expected_.path, expected_.warp.road_in_cam1, *camera(), options);
}

RoadObservations PairWalk::observe(const Image& region, const RegionOptions& options) {
  const double start_s = thread_cpu_s();
  RoadView partner{pair_.view->road.image, {}};
  RoadMatcher matcher(options_.odometry.road.tracking);
  matcher.fill(partner, region);
  const auto observed = [&](const Matches& matches, const ExpectedRoad& expected) {
    RoadObservations observations = observe_pair(pair_, matches, camera(), expected, options);
    observations.expected_normal = mean_normal_;
    observations.predicted_plane = plane_in_baselines(expected_.warp);
    observations.images = {partner.image, frame_.image};
    observations.region = region;
    return observations;
  };
  ExpectedRoad better = expected_;
  Rng rng(static_cast<std::uint64_t>(options_.odometry.seed));
  const auto plane =
      estimate_plane_sparse(observed(matcher.match_roughly(partner, frame_.image, better.warp, *camera()), better),
                            options_.odometry.ground.plane, rng);
  if (plane) {
    better.warp = warp_in_metres(plane->plane, pair_.motion.cam2_from_cam1, camera_height_m());
    better.path = path_of(better.warp);
  }
  const Matches matches = matcher.match(partner, frame_.image, better.warp, plane.has_value(), *camera());
  RoadObservations observations = observed(matches, better);
  times_.road_s = thread_cpu_s() - start_s;
  return observations;
}

}  // namespace groundscale
