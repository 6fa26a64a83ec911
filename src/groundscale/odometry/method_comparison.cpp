#include "groundscale/odometry/method_comparison.hpp"

#include <algorithm>
#include <chrono>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "groundscale/io/text_internal.hpp"
#include "groundscale/odometry/pair_observations.hpp"
#include "groundscale/road/ground_methods.hpp"

namespace groundscale {
namespace {

/// What a frame is and how it was matched, without what a method has made of it.
FrameResult matched_frame(const FrameResult& seen) {
  FrameResult result;
  result.frame = seen.frame;
  result.time_s = seen.time_s;
  result.tracks = seen.tracks;
  result.tracks_kept = seen.tracks_kept;
  result.matches = seen.matches;
  result.inliers = seen.inliers;
  result.rms_px = seen.rms_px;
  return result;
}

}  // namespace

ComparedMethod::ComparedMethod(const PlaneMethod& method, const CameraSetup& setup, const OdometryOptions& options)
    : name_(method.name),
      estimate_(method.make(options.ground.plane)),
      rng_(static_cast<std::uint64_t>(options.seed)),
      chain_(setup, options.ground) {}

void ComparedMethod::follow(const PairwiseOdometry& front) {
  const FrameResult& seen = front.results().back();
  FrameResult result = matched_frame(seen);
  result.scaled = chain_.scaled();
  time_ms_.push_back(0.0);
  switch (seen.state) {
    case FrameState::kStill:
      if (seen.reference < 0) {
        chain_.begin(std::move(result));
      } else {
        chain_.stand(std::move(result));
      }
      return;
    case FrameState::kRotating:
      chain_.rotate(std::move(result), front.latest_pair());
      return;
    case FrameState::kBridged:
    case FrameState::kLost:
      chain_.bridge(std::move(result), seen.reason);
      return;
    case FrameState::kMoving:
      chain_.move(std::move(result), front.latest_pair(), [&](double expected_distance_m, FrameResult& measured) {
        return measure(front, expected_distance_m, measured);
      });
      return;
  }
}

Result<RoadMeasurement> ComparedMethod::measure(const PairwiseOdometry& front, double expected_distance_m,
                                                FrameResult& result) {
  const RoadSights& sights = *front.latest_road();
  RoadObservations observations = sights.observations;
  if (chain_.scaled() && !chain_.needs_search()) {
    const RoadWarp warp = chain_.expected_warp(front.latest_pair().motion.cam2_from_cam1, expected_distance_m);
    observations.predicted_plane = plane_in_baselines(warp);
  }
  result.road_matches = static_cast<int>(observations.points.size());
  const auto start = std::chrono::steady_clock::now();
  auto plane = estimate_(observations, rng_);
  time_ms_.back() = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  if (!plane) return plane.error();
  result.road_inliers = static_cast<int>(plane->inliers.size());
  result.road_rms_px = plane->rms_px;
  return road_measurement(std::move(*plane), sights);
}

Result<MethodComparison> MethodComparison::create(const CameraSetup& setup, const OdometryOptions& options,
                                                  const std::vector<PlaneMethod>& methods) {
  auto front = PairwiseOdometry::create(setup, options);
  if (!front) return front.error();
  std::vector<ComparedMethod> compared;
  compared.reserve(methods.size());
  for (const PlaneMethod& method : methods) compared.emplace_back(method, setup, options);
  return MethodComparison(std::move(*front), std::move(compared));
}

void MethodComparison::advance(const Frame& frame, const Image& road_mask) {
  front_.advance(frame, road_mask);
  for (ComparedMethod& method : methods_) method.follow(front_);
}

void MethodComparison::finish() {
  front_.finish();
  for (ComparedMethod& method : methods_) method.finish();
}

Result<std::vector<PlaneMethod>> choose_methods(const std::vector<std::string>& names) {
  std::vector<PlaneMethod> chosen;
  for (const std::string& name : names) {
    const PlaneMethod* method = find_ground_method(name);
    if (method == nullptr) {
      return internal::bad_input(
          fmt::format("--methods: \"{}\" is no method, known: {}", internal::printable(name), ground_method_names()));
    }
    const auto same = [&name](const PlaneMethod& other) { return other.name == name; };
    if (std::any_of(chosen.begin(), chosen.end(), same)) {
      return internal::bad_input(fmt::format("--methods: \"{}\" is named twice", name));
    }
    chosen.push_back(*method);
  }
  if (chosen.empty()) {
    return internal::bad_input(fmt::format("--methods: none is named, known: {}", ground_method_names()));
  }
  return chosen;
}

std::string methods_csv(const std::vector<ComparedMethod>& methods) {
  constexpr double kDegree = std::numbers::pi / 180.0;
  std::string csv = "frame,method,raw_step_m,raw_step_sd_m,online_step_m,pitch_deg,roll_deg,inliers,time_ms,reason\n";
  const auto number = [](bool known, double value) { return known ? fmt::format("{}", value) : std::string(); };
  const std::size_t frames = methods.empty() ? 0 : methods.front().results().size();
  for (std::size_t k = 0; k < frames; ++k) {
    for (const ComparedMethod& method : methods) {
      const FrameResult& r = method.results()[k];
      const bool step = r.scaled && k > 0;
      const bool raw = step && r.raw_over_online.has_value();
      const double raw_step = raw ? *r.raw_over_online * r.online_step_m : 0.0;
      csv += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", r.frame, method.name(), number(raw, raw_step),
                         number(raw, r.raw_sd * raw_step), number(step, r.online_step_m),
                         number(r.pitch_rad.has_value(), r.pitch_rad.value_or(0.0) / kDegree),
                         number(r.roll_rad.has_value(), r.roll_rad.value_or(0.0) / kDegree), r.road_inliers,
                         number(method.time_ms()[k] > 0.0, method.time_ms()[k]), internal::csv_text(r.reason));
    }
  }
  return csv;
}

}  // namespace groundscale
