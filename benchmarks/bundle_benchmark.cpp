#include <benchmark/benchmark.h>

#include "groundscale/camera/kannala_brandt.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/geometry/so3.hpp"
#include "groundscale/mapping/bundle_adjustment.hpp"
#include "groundscale/mapping/resection.hpp"
#include "groundscale/mapping/triangulation.hpp"

namespace groundscale {
namespace {

CameraPtr pinhole(double k1 = 0.0) {
  return PinholeCamera::create({.fx = 700.0, .fy = 700.0, .cx = 620.0, .cy = 188.0, .k1 = k1}, 1241, 376).value();
}

CameraPtr fisheye() {
  return KannalaBrandtCamera::create({.fx = 340.0, .fy = 340.0, .cx = 640.0, .cy = 400.0, .k1 = -0.02}, 1280, 800)
      .value();
}

CameraPtr camera_of(int kind) { return kind == 0 ? pinhole() : kind == 1 ? pinhole(-0.1) : fisheye(); }

/// A drive along z, a metre a view: points at the sides and on the road, pixels with 0.3 px of noise, and a start that
/// is off by some pixels. The first four of the views are fixed.
Bundle street(const CameraPtr& camera, int views, int points, int max_length) {
  Rng rng(7);
  Bundle bundle;
  bundle.camera = camera;
  for (int v = 0; v < views; ++v) {
    const RigidTransform world_from_cam{exp_so3({0.0, 0.01 * v, 0.0}), {0.0, 0.0, 1.0 * v}};
    bundle.views.push_back({world_from_cam.inverse(), v < 4});
  }
  while (static_cast<int>(bundle.points_in_world.size()) < points) {
    const double z = rng.uniform(6.0, 45.0);
    const Eigen::Vector3d point(rng.uniform(-0.6, 0.6) * z, rng.uniform(-0.2, 0.2) * z, z);
    const int begin = rng.index(views - 1);
    const int index = static_cast<int>(bundle.points_in_world.size());
    const std::size_t before = bundle.observations.size();
    for (int v = begin; v < std::min(views, begin + max_length); ++v) {
      const auto pixel = camera->project(bundle.views[static_cast<std::size_t>(v)].cam_from_world * point);
      if (!pixel || !camera->contains(*pixel)) continue;
      bundle.observations.push_back({v, index, *pixel + 0.3 * Eigen::Vector2d(rng.normal(), rng.normal())});
    }
    if (bundle.observations.size() < before + 2) {
      bundle.observations.resize(before);
      continue;
    }
    bundle.points_in_world.push_back(point * (1.0 + 0.02 * rng.normal()));
  }
  for (BundleView& view : bundle.views) {
    if (view.fixed) continue;
    view.cam_from_world.rotation =
        exp_so3(0.002 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal())) * view.cam_from_world.rotation;
    view.cam_from_world.translation += 0.02 * Eigen::Vector3d(rng.normal(), rng.normal(), rng.normal());
  }
  return bundle;
}

/// Arguments: camera (0 pinhole, 1 with distortion, 2 fisheye), longest track, loss.
void BM_AdjustBundle(benchmark::State& state) {
  const Bundle start = street(camera_of(static_cast<int>(state.range(0))), 12, 400, static_cast<int>(state.range(1)));
  BundleOptions options;
  options.min_relative_decrease = 0.0;  // all five steps
  options.loss = static_cast<BundleLoss>(state.range(2));
  BundleSummary summary;
  for (auto _ : state) {
    Bundle bundle = start;
    summary = adjust_bundle(bundle, options).value();
    benchmark::DoNotOptimize(bundle);
  }
  state.counters["observations"] = summary.observations;
  state.counters["steps"] = summary.iterations;
  state.counters["px"] = summary.final_rms_px;
}
BENCHMARK(BM_AdjustBundle)
    ->Args({0, 7, 0})
    ->Args({0, 7, 1})
    ->Args({1, 7, 0})
    ->Args({2, 7, 0})
    ->Args({0, 12, 0})
    ->Unit(benchmark::kMillisecond);

void BM_Triangulate(benchmark::State& state) {
  const CameraPtr camera = camera_of(static_cast<int>(state.range(0)));
  const Bundle bundle = street(camera, 12, 400, 6);
  std::vector<std::vector<Sight>> points(400);
  for (const BundleObservation& o : bundle.observations) {
    points[static_cast<std::size_t>(o.point)].push_back(
        {bundle.views[static_cast<std::size_t>(o.view)].cam_from_world, camera->ray(o.pixel).value(), o.pixel});
  }
  std::erase_if(points, [](const auto& sights) { return sights.size() != 6; });
  std::size_t k = 0;
  int found = 0;
  int tried = 0;
  for (auto _ : state) {
    const auto point = triangulate(points[k++ % points.size()], *camera);
    found += point.has_value() ? 1 : 0;
    ++tried;
    benchmark::DoNotOptimize(point);
  }
  state.counters["found"] = static_cast<double>(found) / tried;
}
BENCHMARK(BM_Triangulate)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

std::vector<PointSight> sights_of_street(const CameraPtr& camera, double wrong_share) {
  Rng rng(8);
  std::vector<PointSight> sights;
  while (sights.size() < 300) {
    const double z = rng.uniform(6.0, 45.0);
    const Eigen::Vector3d point(rng.uniform(-0.6, 0.6) * z, rng.uniform(-0.2, 0.2) * z, z);
    const auto pixel = camera->project(point);
    if (!pixel || !camera->contains(*pixel)) continue;
    const double spread_px = rng.uniform() < wrong_share ? 50.0 : 0.3;
    sights.push_back({point, *pixel + spread_px * Eigen::Vector2d(rng.normal(), rng.normal())});
  }
  return sights;
}

void BM_RefinePose(benchmark::State& state) {
  const CameraPtr camera = camera_of(static_cast<int>(state.range(0)));
  const auto sights = sights_of_street(camera, 0.3);
  const RigidTransform guess{exp_so3({0.005, 0.01, 0.0}), {0.1, 0.0, 0.3}};
  for (auto _ : state) benchmark::DoNotOptimize(refine_pose(sights, *camera, guess, {}));
}
BENCHMARK(BM_RefinePose)->Arg(0)->Arg(1)->Arg(2)->Unit(benchmark::kMicrosecond);

void BM_Resect(benchmark::State& state) {
  const CameraPtr camera = pinhole();
  const auto sights = sights_of_street(camera, 0.3);
  Rng rng(9);
  for (auto _ : state) benchmark::DoNotOptimize(resect(sights, *camera, {}, rng));
}
BENCHMARK(BM_Resect)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace groundscale
