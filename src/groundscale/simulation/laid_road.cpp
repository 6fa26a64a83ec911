#include "groundscale/simulation/laid_road.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <numbers>
#include <tuple>
#include <utility>

#include <Eigen/Dense>
#include <fmt/format.h>

#include "groundscale/geometry/so3.hpp"

namespace groundscale {
namespace {

constexpr double kSpacingM = 0.25;
constexpr double kPlanSdM = 1.5;    ///< Of the smoothing seen from above.
constexpr double kHeightSdM = 2.0;  ///< Of height and slope: shorter waves are the vehicle's bounce.
constexpr double kLeanSdM = 6.0;    ///< Of the road's normal: shorter ones are the vehicle's roll.

/// The camera at an even spacing along its way.
struct Track {
  std::vector<Eigen::Vector3d> position;
  std::vector<Eigen::Vector3d> down;  ///< Of the vehicle.
};

Eigen::Vector3d level(const Eigen::Vector3d& v) { return {v.x(), 0.0, v.z()}; }

/// Turns the world so that the vehicle's mean down is y. The first pose's place stays the origin.
std::vector<RigidTransform> levelled(const std::vector<RigidTransform>& given, const Eigen::Vector3d& normal_in_cam) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const RigidTransform& pose : given) mean += pose.rotation * normal_in_cam;
  if (!(mean.norm() > 0.1 * static_cast<double>(given.size()))) mean = Eigen::Vector3d::UnitY();  // they contradict
  const Eigen::Matrix3d turn = Eigen::Quaterniond::FromTwoVectors(mean, Eigen::Vector3d::UnitY()).toRotationMatrix();
  std::vector<RigidTransform> poses;
  for (const RigidTransform& pose : given) {
    poses.push_back({turn * pose.rotation, turn * (pose.translation - given.front().translation)});
  }
  return poses;
}

/// Whether a road vehicle can lie so.
Result<void> check_attitudes(const std::vector<RigidTransform>& poses, const Eigen::Vector3d& normal_in_cam) {
  constexpr double kMostDeg = 45.0;
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  for (std::size_t k = 0; k < poses.size(); ++k) {
    const Eigen::Vector3d down = poses[k].rotation * normal_in_cam;
    const double tilt_deg = kDegPerRad * std::atan2(level(down).norm(), down.y());
    if (tilt_deg <= kMostDeg) continue;
    return Error{
        ErrorCode::kBadInput,
        fmt::format("at pose {}, counted from 0, the vehicle is tilted by {:.0f} degrees against the mean of all; "
                    "a road needs less than {}. If the camera is mounted with a roll or pitch, rig.roll_deg and "
                    "rig.pitch_deg must say so",
                    k, tilt_deg, kMostDeg)};
  }
  return {};
}

/// Takes out climbs that the vehicle's own attitude contradicts: KITTI's truth rises by metres where the car stands.
void steady(std::vector<RigidTransform>& poses, const Eigen::Vector3d& normal_in_cam) {
  constexpr double kJoltM = 0.02;
  constexpr double kSlope = 0.1;
  double taken_m = 0.0;
  double before = poses.front().translation.y();
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const double given = poses[k].translation.y();
    const Eigen::Vector3d step = level(poses[k].translation - poses[k - 1].translation);
    const Eigen::Vector3d down = poses[k].rotation * normal_in_cam;
    const double expected = -down.dot(step) / down.y();
    const double drop = given - before;
    before = given;
    if (std::abs(drop - expected) > std::min(kJoltM, step.norm()) + kSlope * step.norm()) taken_m += drop - expected;
    poses[k].translation.y() = given - taken_m;
  }
}

/// Distance of each pose along its way seen from above; a standing camera's trembling doesn't count.
std::vector<double> distances(const std::vector<RigidTransform>& poses) {
  constexpr double kStandsM = 0.05;
  std::vector<double> distance = {0.0};
  Eigen::Vector3d anchor = level(poses.front().translation);
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const Eigen::Vector3d place = level(poses[k].translation);
    const double step = (place - anchor).norm();
    distance.push_back(distance.back() + (step < kStandsM ? 0.0 : step));
    if (step >= kStandsM) anchor = place;
  }
  return distance;
}

Track resampled(const std::vector<RigidTransform>& poses, const std::vector<double>& distance,
                const Eigen::Vector3d& normal_in_cam) {
  Track track;
  std::size_t k = 0;
  const auto count = static_cast<int>(std::floor(distance.back() / kSpacingM)) + 1;
  for (int i = 0; i < count; ++i) {
    const double s = i * kSpacingM;
    while (k + 2 < poses.size() && distance[k + 1] <= s) ++k;
    const double length = distance[k + 1] - distance[k];
    const double share = length > 0.0 ? std::clamp((s - distance[k]) / length, 0.0, 1.0) : 0.0;
    track.position.push_back((1.0 - share) * poses[k].translation + share * poses[k + 1].translation);
    track.down.push_back(((1.0 - share) * poses[k].rotation + share * poses[k + 1].rotation) * normal_in_cam);
  }
  return track;
}

/// Gaussian mean; beyond the ends the values go on as they do over the last metres there.
std::vector<Eigen::Vector3d> smoothed(const std::vector<Eigen::Vector3d>& values, double sd_m) {
  const int count = static_cast<int>(values.size());
  const int reach = static_cast<int>(std::ceil(3.0 * sd_m / kSpacingM));
  const int ends = std::min(count - 1, static_cast<int>(std::ceil(2.0 / kSpacingM)));
  const auto at = [&](int k) -> Eigen::Vector3d {
    const auto value = [&values](int i) { return values[static_cast<std::size_t>(i)]; };
    if (k < 0) return value(0) + k * (value(ends) - value(0)) / ends;
    if (k >= count) return value(count - 1) + (k - count + 1) * (value(count - 1) - value(count - 1 - ends)) / ends;
    return value(k);
  };
  std::vector<double> weights;
  for (int i = -reach; i <= reach; ++i) weights.push_back(std::exp(-0.5 * std::pow(i * kSpacingM / sd_m, 2)));
  std::vector<Eigen::Vector3d> means;
  for (int k = 0; k < count; ++k) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double total = 0.0;
    for (int i = -reach; i <= reach; ++i) {
      const double weight = weights[static_cast<std::size_t>(i + reach)];
      sum += weight * at(k + i);
      total += weight;
    }
    means.push_back(sum / total);
  }
  return means;
}

/// Two places along the path that are one place of the road.
struct Revisit {
  double first_m = 0.0;
  double second_m = 0.0;
  double rise_m = 0.0;  ///< World y of the second less that of the first.
  double weight = 1.0;  ///< Less where they lie apart: the road may be banked.
};

/// The nearest place of each other pass, every metre.
std::vector<Revisit> find_revisits(const std::vector<Eigen::Vector3d>& feet) {
  // Both lanes of a road and all that lies between are one road.
  constexpr double kSameRoadM = 4.5;
  constexpr double kApartSdM = 1.2;
  constexpr double kOtherPassM = 30.0;
  constexpr int kStride = 4;
  const int apart = static_cast<int>(kOtherPassM / kSpacingM);
  const int count = static_cast<int>(feet.size());
  const auto place = [&feet](int k) { return level(feet[static_cast<std::size_t>(k)]); };
  std::vector<Revisit> revisits;
  for (int k = 0; k < count; k += kStride) {
    int best = -1;
    double best_distance = kSameRoadM;
    const auto finish = [&] {
      if (best < 0) return;
      const double rise = feet[static_cast<std::size_t>(best)].y() - feet[static_cast<std::size_t>(k)].y();
      revisits.push_back(
          {k * kSpacingM, best * kSpacingM, rise, std::exp(-0.5 * std::pow(best_distance / kApartSdM, 2))});
      best = -1;
      best_distance = kSameRoadM;
    };
    for (int j = k + apart; j < count;) {
      const double distance = (place(j) - place(k)).norm();
      if (best >= 0 && j - best > apart) finish();
      if (distance < best_distance) std::tie(best, best_distance) = std::pair(j, distance);
      // Nothing can come within reach sooner than this.
      j += std::max(1, static_cast<int>((distance - kSameRoadM) / kSpacingM));
    }
    finish();
  }
  return revisits;
}

/// A piecewise linear function of distance.
class Correction {
 public:
  static constexpr double kKnotM = 4.0;

  Correction(double length_m, const std::vector<Revisit>& revisits) {
    const int count = static_cast<int>(std::ceil(length_m / kKnotM)) + 2;
    constexpr double kSlopeWeight = 1e-2;
    constexpr double kBendWeight = 1.0;
    constexpr double kRevisitWeight = 1000.0;
    Eigen::MatrixXd information = 1e-9 * Eigen::MatrixXd::Identity(count, count);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
    const auto add = [&](std::initializer_list<std::pair<int, double>> terms, double value, double weight) {
      for (const auto& [i, a] : terms) {
        right[i] += weight * a * value;
        for (const auto& [j, b] : terms) information(i, j) += weight * a * b;
      }
    };
    for (int k = 0; k + 1 < count; ++k) add({{k, -1.0}, {k + 1, 1.0}}, 0.0, kSlopeWeight);
    for (int k = 0; k + 2 < count; ++k) add({{k, 1.0}, {k + 1, -2.0}, {k + 2, 1.0}}, 0.0, kBendWeight);
    for (const Revisit& revisit : revisits) {
      const auto [first, first_share] = knot(revisit.first_m);
      const auto [second, second_share] = knot(revisit.second_m);
      add({{first, -(1.0 - first_share)},
           {first + 1, -first_share},
           {second, 1.0 - second_share},
           {second + 1, second_share}},
          -revisit.rise_m, kRevisitWeight * revisit.weight);
    }
    values_ = information.llt().solve(right);
  }

  double at(double distance_m) const {
    const auto [k, share] = knot(distance_m);
    return (1.0 - share) * values_[k] + share * values_[k + 1];
  }
  /// Over the length of a knot, so that it has no steps.
  double slope_at(double distance_m) const {
    return (at(distance_m + 0.5 * kKnotM) - at(distance_m - 0.5 * kKnotM)) / kKnotM;
  }
  double largest() const { return (values_.array() - values_.mean()).abs().maxCoeff(); }

 private:
  static std::pair<int, double> knot_of(double distance_m) {
    const double at = std::max(0.0, distance_m / kKnotM);
    return {static_cast<int>(at), at - std::floor(at)};
  }
  std::pair<int, double> knot(double distance_m) const {
    auto [k, share] = knot_of(distance_m);
    const int last = static_cast<int>(values_.size()) - 2;
    if (values_.size() > 0 && k > last) return {last, 1.0};
    return {k, share};
  }

  Eigen::VectorXd values_;
};

/// The road's places under the camera's smoothed way.
/// @param down  Of the road there, smoothed.
std::vector<PathPoint> places_under(const Track& track, const std::vector<Eigen::Vector3d>& down, double height_m) {
  const auto plan = smoothed(track.position, kPlanSdM);
  const auto heights = smoothed(track.position, kHeightSdM);
  std::vector<PathPoint> places(plan.size());
  for (std::size_t k = 0; k < plan.size(); ++k) {
    places[k].position = {plan[k].x(), heights[k].y(), plan[k].z()};
    places[k].position += height_m * down[k].normalized();
  }
  return places;
}

/// Fall to the right that the road must have besides its crown for the vehicle to lie as it does on average.
void bank(std::vector<PathPoint>& places, const std::vector<Eigen::Vector3d>& down, const RoadProfile& profile) {
  const double crown = profile.lane_offset_m > 0.0 ? profile.crown : 0.0;
  for (std::size_t k = 0; k < places.size(); ++k) {
    const PathPoint& before = places[k == 0 ? 0 : k - 1];
    const PathPoint& after = places[std::min(k + 1, places.size() - 1)];
    const Eigen::Vector3d way = level(after.position - before.position).normalized();
    const Eigen::Vector3d right(way.z(), 0.0, -way.x());
    places[k].bank = -down[k].dot(right) / down[k].y() - crown;
  }
}

Result<void> check_steps(const std::vector<RigidTransform>& poses) {
  constexpr double kJumpM = 10.0;
  if (poses.size() < 2) return Error{ErrorCode::kBadInput, "there is one pose, a drive needs two at least"};
  for (std::size_t k = 1; k < poses.size(); ++k) {
    const double step = (poses[k].translation - poses[k - 1].translation).norm();
    if (step > kJumpM) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("pose {}, counted from 0, lies {:.1f} m from the one before; up to {} m can be "
                               "driven from frame to frame",
                               k, step, kJumpM)};
    }
  }
  return {};
}

/// Distances of the places along the path through them.
std::vector<double> distances_of(const std::vector<PathPoint>& places) {
  std::vector<double> along = {0.0};
  for (std::size_t k = 1; k < places.size(); ++k) {
    along.push_back(along.back() + level(places[k].position - places[k - 1].position).norm());
  }
  return along;
}

/// A vehicle that reverses leaves smoothed places that hardly move, or turn on the spot.
Result<void> check_progress(const std::vector<PathPoint>& places) {
  constexpr double kLeastShare = 0.2;
  for (std::size_t k = 1; k < places.size(); ++k) {
    if (level(places[k].position - places[k - 1].position).norm() > kLeastShare * kSpacingM) continue;
    return Error{ErrorCode::kBadInput,
                 fmt::format("the poses turn back on themselves {:.0f} m from the start; a road can only be laid under "
                             "a vehicle that drives forwards",
                             static_cast<double>(k) * kSpacingM)};
  }
  return {};
}

/// A road along the way of a vehicle that reverses all the time would lie behind its camera.
Result<void> check_heading(const LaidRoad& road, const Eigen::Vector3d& forward_in_cam) {
  for (std::size_t k = 0; k < road.world_from_cam.size(); ++k) {
    const Eigen::Vector3d forward = road.world_from_cam[k].rotation * forward_in_cam;
    if (road.path.at(road.distance_m[k]).forward().dot(forward) > 0.0) continue;
    return Error{
        ErrorCode::kBadInput,
        fmt::format("at pose {}, counted from 0, the vehicle points against its way; a road can only be laid "
                    "under a vehicle that drives forwards. If the camera looks to the side or back, rig.yaw_deg "
                    "must say so",
                    k)};
  }
  return {};
}

Result<void> check_turns(const Path& path, const RoadProfile& profile) {
  for (double s = 0.0; s <= path.length_m(); s += kSpacingM) {
    const double radius = 1.0 / std::max(1e-9, std::abs(path.at(s).curvature_per_m));
    if (radius < profile.half_width_m) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("the path turns too tightly for the road: radius {:.1f} m at {:.0f} m from the start, "
                               "half the road is {} m wide",
                               radius, s, profile.half_width_m)};
    }
  }
  return {};
}

}  // namespace

Result<LaidRoad> lay_road(const Trajectory& given, const CameraRig& rig, const RoadProfile& profile) {
  if (auto checked = check_steps(given.world_from_cam); !checked) return checked.error();
  const Eigen::Vector3d normal = rig.mounting().normal_in_cam();
  std::vector<RigidTransform> poses = levelled(given.world_from_cam, normal);
  if (auto checked = check_attitudes(poses, normal); !checked) return checked.error();
  steady(poses, normal);
  const std::vector<double> distance = distances(poses);
  constexpr double kShortestM = 5.0;
  if (distance.back() < kShortestM) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("the poses go {:.2f} m in all, a road needs {} m", distance.back(), kShortestM)};
  }
  const Track track = resampled(poses, distance, normal);
  const std::vector<Eigen::Vector3d> down = smoothed(track.down, kLeanSdM);
  std::vector<PathPoint> places = places_under(track, down, rig.height_m);
  bank(places, down, profile);

  std::vector<Eigen::Vector3d> feet;
  for (const PathPoint& place : places) feet.push_back(place.position);
  const Correction correction(distance.back(), find_revisits(feet));
  for (std::size_t k = 0; k < places.size(); ++k) {
    places[k].position.y() += correction.at(static_cast<double>(k) * kSpacingM);
  }
  if (auto checked = check_progress(places); !checked) return checked.error();
  const std::vector<double> along = distances_of(places);
  LaidRoad road{Path::through(std::move(places)), std::move(poses), {}, correction.largest()};
  if (auto checked = check_turns(road.path, profile); !checked) return checked.error();
  for (std::size_t k = 0; k < distance.size(); ++k) {
    // Smoothing has made the way a little shorter.
    const double at = std::min(distance[k] / kSpacingM, static_cast<double>(along.size() - 1));
    const auto low = std::min(static_cast<std::size_t>(at), along.size() - 2);
    road.distance_m.push_back(along[low] + (at - static_cast<double>(low)) * (along[low + 1] - along[low]));
    RigidTransform& pose = road.world_from_cam[k];
    pose.translation.y() += correction.at(distance[k]);
    // y grows downwards: where the correction grows the road dips, and the vehicle's nose with it.
    const Eigen::Vector3d right = road.path.at(road.distance_m[k]).right();
    pose.rotation = exp_so3(-std::atan(correction.slope_at(distance[k])) * right) * pose.rotation;
  }
  if (auto checked = check_heading(road, rig.mounting().forward_in_cam()); !checked) return checked.error();
  return road;
}

}  // namespace groundscale
