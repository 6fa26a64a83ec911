// Noise-free images of a flat road against their truth: what is rendered lies where the truth says, and the plane that
// the pairwise odometry measures is the true one.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Dense>
#include <gtest/gtest.h>

#include "groundscale/camera/mounting.hpp"
#include "groundscale/odometry/pairwise.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/road/region.hpp"
#include "groundscale/simulation/drive_simulation.hpp"
#include "groundscale/simulation/renderer.hpp"
#include "groundscale/simulation/sensor.hpp"
#include "preset_setup.hpp"

namespace groundscale {
namespace {

/// A preset on a flat road with nothing beside it, whose camera has neither noise nor blur; 8 bits stay.
CameraPreset exact_camera(std::string_view name) {
  CameraPreset camera = find_camera_preset(name).value();
  SimulationOptions& options = camera.options;
  options.shutter_ms = 0.0;
  options.sensor.vignetting = 0.0;
  options.sensor.full_well_e = 0.0;
  options.world = WorldOptions::bare();
  options.world.profile.crown = 0.0;
  options.world.profile.roughness_m = 0.0;
  options.world.profile.kerb_m = 0.0;
  options.world.profile.verge_slope = 0.0;
  return camera;
}

/// 36 km/h along a level road: straight, then a bend.
SimulatedDrive level_drive(const CameraPreset& camera) {
  constexpr double kSpeedMps = 10.0;
  const std::vector<PathPiece> pieces{{40.0, 0.0}, {15.0, 0.01}, {60.0, 0.01}};
  return drive_along(Route{Path::of_pieces(pieces, {}), Surroundings::kTown, kSpeedMps, {}, 0.0}, camera, 3);
}

/// Images of a drive, all at the first one's exposure.
class ExactImages {
 public:
  explicit ExactImages(const SimulatedDrive& drive)
      : drive_(drive),
        renderer_(drive.world, drive.camera.camera, {.edge_rays = drive.camera.options.edge_rays, .threads = 1}),
        gain_(Exposure(drive.camera.options.sensor).follow(renderer_.mean_light(drive.moments.front().shutter), 0.0)) {}

  Image at(std::size_t frame) const {
    Rng rng(0);  // without noise there is nothing to draw
    return expose(renderer_.render(drive_.moments[frame].shutter), gain_, drive_.camera.options.sensor, rng);
  }

 private:
  const SimulatedDrive& drive_;
  Renderer renderer_;
  double gain_;
};

RigidTransform motion_between(const SimulatedDrive& drive, std::size_t first, std::size_t second) {
  return drive.moments[second].world_from_cam.inverse() * drive.moments[first].world_from_cam;
}

Eigen::Matrix3d true_homography(const SimulatedDrive& drive, std::size_t first) {
  return homography_of_plane(road_truth(drive, first).plane, motion_between(drive, first, first + 1));
}

// --- Where road pixels lie ---

/// Pixels over the road of a frame, far ones included, and where rays and poses put what they show in the next frame.
/// @return Largest distance from where the homography of the truth maps them.
double largest_ray_error_px(const SimulatedDrive& drive, std::size_t first) {
  const Camera& camera = *drive.camera.camera;
  const Eigen::Matrix3d homography = true_homography(drive, first);
  const RigidTransform& world_from_cam1 = drive.moments[first].world_from_cam;
  const RigidTransform cam2_from_world = drive.moments[first + 1].world_from_cam.inverse();
  constexpr int kStridePx = 7;
  double largest = 0.0;
  int count = 0;
  for (int y = 0; y < camera.height(); y += kStridePx) {
    for (int x = 0; x < camera.width(); x += kStridePx) {
      const auto ray = camera.ray({x, y});
      if (!ray) continue;
      const Eigen::Vector3d direction = world_from_cam1.rotation * *ray;
      const auto hit = drive.world.scene.hit(world_from_cam1.translation, direction);
      constexpr double kFarM = 60.0;
      if (!hit || !is_road(hit->material) || hit->distance_m > kFarM) continue;
      const Eigen::Vector3d place = world_from_cam1.translation + static_cast<double>(hit->distance_m) * direction;
      const auto seen = camera.project(cam2_from_world * place);
      const auto mapped = camera.project(homography * *ray);
      if (!seen || !mapped) continue;
      largest = std::max(largest, (*seen - *mapped).norm());
      ++count;
    }
  }
  EXPECT_GT(count, 1000);
  return largest;
}

/// Third-order interpolation (Keys 1981, a = -1/2): exact for parabolas, so it shifts nothing.
double cubic(const Image& image, const Eigen::Vector2d& pixel) {
  const auto weights = [](double t) -> Eigen::Vector4d {
    return 0.5 * Eigen::Vector4d(t * (-1.0 + t * (2.0 - t)), 2.0 + t * t * (3.0 * t - 5.0),
                                 t * (1.0 + t * (4.0 - 3.0 * t)), t * t * (t - 1.0));
  };
  const int x = static_cast<int>(std::floor(pixel.x()));
  const int y = static_cast<int>(std::floor(pixel.y()));
  const Eigen::Vector4d along = weights(pixel.x() - x);
  const Eigen::Vector4d down = weights(pixel.y() - y);
  double sum = 0.0;
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) {
      sum += down[row] * along[column] * image.at(x + column - 1, y + row - 1);
    }
  }
  return sum;
}

using Patch = Eigen::ArrayXXd;  // (row, column)

/// Smoothed by a Gaussian; what its window doesn't cover is left away.
Patch smoothed(const Patch& patch) {
  constexpr int kHalf = 4;
  constexpr double kSdPx = 1.5;
  Eigen::Array<double, 2 * kHalf + 1, 1> window;
  for (int k = -kHalf; k <= kHalf; ++k) window[k + kHalf] = std::exp(-0.5 * k * k / (kSdPx * kSdPx));
  window /= window.sum();
  const auto size = patch.rows() - 2 * kHalf;
  Patch rows = Patch::Zero(size, patch.cols());
  for (Eigen::Index k = 0; k < window.size(); ++k) rows += window[k] * patch.middleRows(k, size);
  Patch both = Patch::Zero(size, size);
  for (Eigen::Index k = 0; k < window.size(); ++k) both += window[k] * rows.middleCols(k, size);
  return both;
}

/// Two images and what is said to map the road of the first onto the second.
struct ImagePair {
  Image first;
  Image second;
  CameraPtr camera;
  Eigen::Matrix3d homography = Eigen::Matrix3d::Identity();

  std::optional<Eigen::Vector2d> mapped(const Eigen::Vector2d& pixel1) const {
    const auto ray = camera->ray(pixel1);
    return ray ? camera->project(homography * *ray) : std::nullopt;
  }
};

constexpr int kPatchHalfPx = 26;

/// The second image as seen from the first, about a pixel of it; nothing where it leaves the image.
std::optional<Patch> warped_patch(const ImagePair& pair, const Eigen::Vector2d& centre) {
  Patch patch(2 * kPatchHalfPx + 1, 2 * kPatchHalfPx + 1);
  for (int y = -kPatchHalfPx; y <= kPatchHalfPx; ++y) {
    for (int x = -kPatchHalfPx; x <= kPatchHalfPx; ++x) {
      const auto pixel2 = pair.mapped(centre + Eigen::Vector2d(x, y));
      constexpr double kMargin = 3.0;
      if (!pixel2 || pixel2->minCoeff() < kMargin || pixel2->x() > pair.second.width() - kMargin ||
          pixel2->y() > pair.second.height() - kMargin) {
        return std::nullopt;
      }
      patch(y + kPatchHalfPx, x + kPatchHalfPx) = cubic(pair.second, *pixel2);
    }
  }
  return smoothed(patch);
}

/// By how many pixels of the first image the warped second one lies off, about a pixel: least squares over shift, gain
/// and offset (Lucas, Kanade 1981).
std::optional<Eigen::Vector2d> shift_at(const ImagePair& pair, int x, int y) {
  Patch raw(2 * kPatchHalfPx + 1, 2 * kPatchHalfPx + 1);
  for (int row = -kPatchHalfPx; row <= kPatchHalfPx; ++row) {
    for (int column = -kPatchHalfPx; column <= kPatchHalfPx; ++column) {
      raw(row + kPatchHalfPx, column + kPatchHalfPx) = pair.first.at(x + column, y + row);
    }
  }
  const Patch wanted = smoothed(raw);
  const auto inner = wanted.rows() - 2;
  const Patch by_x = 0.5 * (wanted.block(1, 2, inner, inner) - wanted.block(1, 0, inner, inner));
  const Patch by_y = 0.5 * (wanted.block(2, 1, inner, inner) - wanted.block(0, 1, inner, inner));
  const Patch middle = wanted.block(1, 1, inner, inner);
  Eigen::MatrixXd jacobian(inner * inner, 4);
  jacobian << by_x.matrix().reshaped(), by_y.matrix().reshaped(), middle.matrix().reshaped(),
      Eigen::VectorXd::Ones(inner * inner);
  const Eigen::Matrix4d information = jacobian.transpose() * jacobian;
  Eigen::Vector2d shift = Eigen::Vector2d::Zero();
  for (int iteration = 0; iteration < 8; ++iteration) {
    const auto seen = warped_patch(pair, Eigen::Vector2d(x, y) + shift);
    if (!seen) return std::nullopt;
    const Patch residual = seen->block(1, 1, inner, inner) - middle;
    const Eigen::Vector4d step = information.ldlt().solve(jacobian.transpose() * residual.matrix().reshaped());
    shift -= step.head<2>();
    if (step.head<2>().norm() < 1e-4) break;
  }
  return shift;
}

struct Shifts {
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  double mean_length = 0.0;
  int count = 0;
};

/// Over the patches that lie in both images.
Shifts shifts_over(const ImagePair& pair, const std::vector<Eigen::Vector2i>& centres) {
  Shifts shifts;
  for (const Eigen::Vector2i& centre : centres) {
    const auto shift = shift_at(pair, centre.x(), centre.y());
    if (!shift) continue;
    shifts.mean += *shift;
    shifts.mean_length += shift->norm();
    ++shifts.count;
  }
  shifts.mean /= std::max(1, shifts.count);
  shifts.mean_length /= std::max(1, shifts.count);
  return shifts;
}

ImagePair pair_of(const SimulatedDrive& drive, std::size_t first) {
  const ExactImages images(drive);
  return {images.at(first), images.at(first + 1), drive.camera.camera, true_homography(drive, first)};
}

TEST(ExactTruth, RaysMeetTheRoadWhereTheHomographySays) {
  // Single precision in what rays meet: a distance of 60 m is good to 1e-5 m.
  EXPECT_LT(largest_ray_error_px(level_drive(exact_camera("kitti")), 50), 0.01);
  EXPECT_LT(largest_ray_error_px(level_drive(exact_camera("campus")), 12), 0.01);
}

TEST(ExactTruth, RoadPixelsAreMappedWithinATwentiethOfAPixel) {
  // Rows from 9 to 21 m ahead. What is left, 0.02 to 0.04 px a patch, is a patch's two samplings of one texture, which
  // have nothing in common above half of the sampling rate, and 8 bits; over many patches it averages out.
  const SimulatedDrive drive = level_drive(exact_camera("kitti"));
  for (const std::size_t first : {std::size_t{2}, std::size_t{50}}) {
    const ImagePair pair = pair_of(drive, first);
    for (const int row : {230, 250, 270, 290, 310}) {
      std::vector<Eigen::Vector2i> centres;
      const int half_width = 4 * (row - 200);
      for (int k = -8; k <= 8; ++k) centres.emplace_back(620 + k * half_width / 8, row);
      const Shifts shifts = shifts_over(pair, centres);
      EXPECT_GE(shifts.count, 12) << "row " << row;
      EXPECT_LT(shifts.mean_length, 0.05) << "frame " << first << ", row " << row;
      EXPECT_LT(shifts.mean.norm(), 0.025) << "frame " << first << ", row " << row;
    }
  }
}

TEST(ExactTruth, RoadPixelsOfAFisheyeAreMappedWithinATenthOfAPixel) {
  const SimulatedDrive drive = level_drive(exact_camera("campus"));
  const ImagePair pair = pair_of(drive, 12);
  for (const int row : {660, 720, 780, 840, 900, 960, 1010}) {
    std::vector<Eigen::Vector2i> centres;
    for (int x = 260; x <= 1660; x += 100) centres.emplace_back(x, row);
    const Shifts shifts = shifts_over(pair, centres);
    EXPECT_GE(shifts.count, 12) << "row " << row;
    EXPECT_LT(shifts.mean_length, 0.05) << "row " << row;
    EXPECT_LT(shifts.mean.norm(), 0.025) << "row " << row;
  }
}

// --- The measured plane ---

/// Of one measurement against the truth.
struct PlaneError {
  double pitch_deg = 0.0;
  double roll_deg = 0.0;
  double height = 0.0;  ///< Over the true one, less 1.
};

double median_of(const std::vector<PlaneError>& errors, double PlaneError::*field) {
  std::vector<double> values;
  for (const PlaneError& error : errors) values.push_back(error.*field);
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

PairwiseOdometry odometry_for(const CameraPreset& camera) {
  return std::move(PairwiseOdometry::create(setup_of(camera), {}).value());
}

/// @param height_m  As measured with the length of the pair's step known.
PlaneError error_of(const PlaneAngles& angles, double height_m, const GroundPlane& truth) {
  constexpr double kDegPerRad = 180.0 / std::numbers::pi;
  const PlaneAngles true_angles = plane_angles(truth.normal_in_cam);
  return {kDegPerRad * (angles.pitch_rad - true_angles.pitch_rad),
          kDegPerRad * (angles.roll_rad - true_angles.roll_rad), height_m / truth.height - 1.0};
}

/// The last frame's measurement, before any filter.
PlaneError last_error(const PairwiseOdometry& odometry, const SimulatedDrive& drive) {
  const FrameResult& result = odometry.results().back();
  const auto frame = odometry.results().size() - 1;
  const auto partner = static_cast<std::size_t>(result.reference);
  const auto& poses = odometry.online_poses();
  const double raw_m = result.raw_over_online.value() * (poses[frame].translation - poses[partner].translation).norm();
  const double true_m = motion_between(drive, partner, frame).translation.norm();
  // The vehicle bounces by a few millimetres: not the step is compared, but the height that it stands for.
  const double height_m = drive.camera.options.rig.height_m * true_m / raw_m;
  return error_of({result.pitch_rad.value(), result.roll_rad.value()}, height_m, road_truth(drive, partner).plane);
}

/// The same from the frame's road matches alone: with the true motion and without a prior.
PlaneError last_error_with_true_motion(const PairwiseOdometry& odometry, const SimulatedDrive& drive) {
  const FrameDetails& details = odometry.details();
  const auto partner = static_cast<std::size_t>(odometry.results().back().reference);
  RoadObservations observations;
  observations.camera = drive.camera.camera;
  observations.cam_from_reference = {{}, motion_between(drive, partner, odometry.results().size() - 1)};
  for (const Match& match : details.road_matches) {
    const Eigen::Vector3d ray = drive.camera.camera->ray(match.pixel1).value();
    const double offset = offset_from_path(details.path, details.road, ray) / RegionOptions{}.weight_sd_m;
    observations.points.push_back(
        {match.id, match.pixel1, {RoadSight{1, match.pixel2}}, std::max(1e-3, std::exp(-0.5 * offset * offset))});
  }
  PlaneOptions options;
  options.normal_prior_deg = 0.0;
  Rng rng(1);
  const GroundPlane plane = estimate_plane_sparse(observations, options, rng).value().plane;
  return error_of(plane_angles(plane.normal_in_cam), plane.height, road_truth(drive, partner).plane);
}

TEST(ExactTruth, ThePlaneOfAFlatRoadIsMeasured) {
  CameraPreset camera = exact_camera("kitti");
  camera.options.world.houses_share = WorldOptions{}.houses_share;  // R and t are found by them
  const SimulatedDrive drive = level_drive(camera);
  const ExactImages images(drive);
  PairwiseOdometry odometry = odometry_for(camera);
  std::vector<PlaneError> errors;
  std::vector<PlaneError> with_true_motion;
  constexpr int kFrames = 51;
  for (int k = 0; k < kFrames; ++k) {
    const auto frame = static_cast<std::size_t>(k);
    odometry.advance({k, drive.moments[frame].time_s, images.at(frame), ""});
    if (k == 0) continue;
    ASSERT_GE(motion_between(drive, frame - 1, frame).translation.norm(), 0.7);
    ASSERT_TRUE(odometry.results().back().accepted()) << "frame " << k << ": " << odometry.results().back().reason;
    errors.push_back(last_error(odometry, drive));
    with_true_motion.push_back(last_error_with_true_motion(odometry, drive));
    EXPECT_LT(std::abs(errors.back().height), 0.01) << "frame " << k;
    EXPECT_LT(std::abs(with_true_motion.back().height), 0.01) << "frame " << k;
  }
  for (const auto& measured : {errors, with_true_motion}) {
    EXPECT_LT(std::abs(median_of(measured, &PlaneError::pitch_deg)), 0.03);
    EXPECT_LT(std::abs(median_of(measured, &PlaneError::height)), 0.003);
  }
  EXPECT_LT(std::abs(median_of(with_true_motion, &PlaneError::roll_deg)), 0.05);
  // 0.116. Patches near the vehicle stretch from frame to frame, so that the tracks which find R and t lag by up to
  // 0.2 px, more of them on the side of the far lane: t comes out 0.06 degrees to the right, and roll twice that.
  EXPECT_LT(std::abs(median_of(errors, &PlaneError::roll_deg)), 0.15);
}

}  // namespace
}  // namespace groundscale
