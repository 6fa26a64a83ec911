// A way of one's own to measure the ground, beside those that are there, on the same matches: docs/adding-a-method.md.
// usage: own_plane_method [SEQUENCE CAMERA.yaml]; without a drive it measures a road that is made up.
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/estimation/robust.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/method_comparison.hpp"
#include "groundscale/plane/methods.hpp"
#include "groundscale/road/ground_methods.hpp"

namespace {

using namespace groundscale;

// [method]
/// Height of the road as the median of its points' heights, the normal being the expected one.
Result<PlaneMeasurement> median_height(const RoadObservations& observations, const PlaneOptions& options, Rng&) {
  const Eigen::Vector3d& normal = observations.expected_normal;
  if (normal.isZero()) return Error{ErrorCode::kBadInput, "the normal must be known"};
  const RigidTransform& cam2_from_cam1 = observations.cam_from_reference[1];
  if (!(cam2_from_cam1.translation.norm() > 1e-9)) return Error{ErrorCode::kDegenerateMotion, "there is no baseline"};

  std::vector<int> points;
  std::vector<double> heights;
  for (std::size_t i = 0; i < observations.points.size(); ++i) {
    const RoadPoint& point = observations.points[i];
    const auto ray1 = observations.camera->ray(point.pixel_in_reference);
    const auto ray2 = observations.camera->ray(point.sights.front().pixel);
    if (!ray1 || !ray2) continue;
    // The point d ray1 that the second camera sees along ray2: ray2 x (R d ray1 + t) = 0, d by least squares.
    const Eigen::Vector3d a = ray2->cross(cam2_from_cam1.rotation * *ray1);
    const Eigen::Vector3d b = ray2->cross(cam2_from_cam1.translation);
    const double distance = -a.dot(b) / a.squaredNorm();
    if (!(distance > 0.0)) continue;
    points.push_back(static_cast<int>(i));
    heights.push_back(distance * normal.dot(*ray1));
  }
  const double height = median(heights);  // NaN without points
  PlaneMeasurement measurement;
  for (std::size_t k = 0; k < heights.size(); ++k) {
    if (std::abs(heights[k] - height) < 0.1 * height) measurement.inliers.push_back(points[k]);
  }
  const std::size_t count = measurement.inliers.size();
  if (static_cast<int>(count) < options.min_inliers) {
    return Error{ErrorCode::kTooFewMatches, std::to_string(count) + " points have about the median height, " +
                                                std::to_string(options.min_inliers) + " needed"};
  }
  measurement.plane = measurement.initial_plane = {normal, height};
  // Of m = n / h. The gates want to know; two hundredths of the height and of a radian are a guess.
  measurement.covariance_of_m = 4e-4 / (height * height) * Eigen::Matrix3d::Identity();
  return measurement;
}
// [method]

int measure_made_up_road() {
  const auto camera = PinholeCamera::create({.fx = 718.0, .fy = 718.0, .cx = 607.0, .cy = 185.0}, 1241, 376);
  if (!camera) return 1;
  constexpr double kHeight = 1.65;
  RoadObservations observations;
  observations.camera = *camera;
  observations.expected_normal = Eigen::Vector3d::UnitY();
  observations.cam_from_reference = {RigidTransform{}, RigidTransform{Eigen::Matrix3d::Identity(), {0.0, 0.0, -1.0}}};
  for (double z = 5.0; z < 15.0; z += 0.5) {
    for (double x = -1.0; x <= 1.0; x += 0.25) {
      const Eigen::Vector3d point(x, kHeight, z);
      const auto first = (*camera)->project(point);
      const auto second = (*camera)->project(observations.cam_from_reference[1] * point);
      const auto id = static_cast<std::int64_t>(observations.points.size());
      if (first && second) observations.points.push_back({id, *first, {RoadSight{1, *second}}});
    }
  }
  Rng rng(0);
  const auto measured = make_memoryless<median_height>({})(observations, rng);
  if (!measured) {
    std::fprintf(stderr, "%s\n", measured.error().message.c_str());
    return 1;
  }
  std::printf("height %.4f, put in %.4f\n", measured->plane.height, kHeight);
  return std::abs(measured->plane.height - kHeight) < 1e-9 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 1) return measure_made_up_road();
  if (argc != 3) {
    std::fprintf(stderr, "usage: %s [SEQUENCE CAMERA.yaml]\n", argv[0]);
    return 2;
  }
  SequenceRequest request;
  request.source = argv[1];
  auto sequence = open_sequence(request, /*decode_ahead=*/true);
  if (!sequence) {
    std::fprintf(stderr, "%s\n", sequence.error().message.c_str());
    return 2;
  }
  const auto setup = read_camera_file(argv[2], (*sequence)->width(), (*sequence)->height());
  if (!setup || !setup->height_m) {
    std::fprintf(stderr, "%s\n", setup ? "height_m is missing in the camera file" : setup.error().message.c_str());
    return 2;
  }
  // [comparison]
  std::vector<PlaneMethod> methods(ground_methods().begin(), ground_methods().end());
  methods.push_back({"median_height", "median height of the road's points", make_memoryless<median_height>});
  auto comparison = MethodComparison::create(*setup, {}, methods);
  // [comparison]
  if (!comparison) {
    std::fprintf(stderr, "%s\n", comparison.error().message.c_str());
    return 2;
  }
  while (const auto frame = (*sequence)->next()) comparison->advance(*frame, {});
  comparison->finish();
  std::fputs(methods_csv(comparison->methods()).c_str(), stdout);
  return 0;
}
