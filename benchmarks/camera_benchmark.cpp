#include <cstdint>
#include <vector>

#include <benchmark/benchmark.h>

#include "groundscale/camera/pinhole.hpp"

namespace groundscale {
namespace {

constexpr int kWidth = 1241;
constexpr int kHeight = 376;

CameraPtr camera_with(double k1) {
  return *PinholeCamera::create({.fx = 718.856, .fy = 718.856, .cx = 607.2, .cy = 185.2, .k1 = k1}, kWidth, kHeight);
}

/// Pixels on a grid over the image.
std::vector<Eigen::Vector2d> grid() {
  std::vector<Eigen::Vector2d> pixels;
  for (int y = 0; y < kHeight; y += 20) {
    for (int x = 0; x < kWidth; x += 20) pixels.emplace_back(x, y);
  }
  return pixels;
}

/// Argument: k1 in thousandths; 0 has no distortion to undo.
void BM_RayOfPixel(benchmark::State& state) {
  const CameraPtr camera = camera_with(1e-3 * static_cast<double>(state.range(0)));
  const std::vector<Eigen::Vector2d> pixels = grid();
  for (auto _ : state) {
    for (const Eigen::Vector2d& pixel : pixels) benchmark::DoNotOptimize(camera->ray(pixel));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(pixels.size()));
}
BENCHMARK(BM_RayOfPixel)->Arg(0)->Arg(-100);

void BM_ProjectWithJacobian(benchmark::State& state) {
  const CameraPtr camera = camera_with(1e-3 * static_cast<double>(state.range(0)));
  std::vector<Eigen::Vector3d> rays;
  for (const Eigen::Vector2d& pixel : grid()) rays.push_back(*camera->ray(pixel));
  Eigen::Matrix<double, 2, 3> pixel_by_ray;
  for (auto _ : state) {
    for (const Eigen::Vector3d& ray : rays) benchmark::DoNotOptimize(camera->project(ray, &pixel_by_ray));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(rays.size()));
}
BENCHMARK(BM_ProjectWithJacobian)->Arg(0)->Arg(-100);

}  // namespace
}  // namespace groundscale
