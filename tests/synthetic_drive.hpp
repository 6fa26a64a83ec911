#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "groundscale/core/check.hpp"
#include "groundscale/core/image.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {

/// A small drive with exact truth for tests of the program: straight ahead along a flat road between two walls, with a
/// distant background, all of random texture. What a camera sees is worked out by intersecting each pixel's ray.
struct SyntheticDrive {
  int width = 640;
  int height = 240;
  double focal_px = 440.0;
  double camera_height_m = 1.65;
  double step_m = 0.8;
  double half_street_m = 6.0;

  double cx() const { return 0.5 * (width - 1); }
  double cy() const { return 0.35 * height; }

  /// The image `travelled_m` metres down the street.
  Image render(double travelled_m) const {
    Image image(width, height);
    constexpr int kSamples = 2;  // a side, against aliasing
    for (int y = 0; y < height; ++y) {
      for (int x = 0; x < width; ++x) {
        double sum = 0.0;
        for (int k = 0; k < kSamples * kSamples; ++k) {
          const double u = x + (k % kSamples + 0.5) / kSamples - 0.5;
          const int row = k / kSamples;
          const double v = y + (row + 0.5) / kSamples - 0.5;
          sum += seen(u, v, travelled_m);
        }
        const double grey = std::clamp(sum / (kSamples * kSamples), 0.0, 255.0);
        image.data()[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] =
            static_cast<std::uint8_t>(std::lround(grey));
      }
    }
    return image;
  }

  std::string image_name(int frame) const { return fmt::format("{:06d}.png", frame); }
  std::string calibration() const { return fmt::format("P0: {0} 0 {1} 0 0 {0} {2} 0 0 0 1 0\n", focal_px, cx(), cy()); }
  std::string truth(int frames) const {
    std::string rows;
    for (int k = 0; k < frames; ++k) {
      rows += kitti_row({Eigen::Matrix3d::Identity(), {0.0, 0.0, step_m * k}}) + "\n";
    }
    return rows;
  }

  /// A KITTI odometry folder: image_0, calib.txt, times.txt (10 Hz).
  void write_kitti(const std::string& folder, int frames) const {
    const std::filesystem::path root = folder;
    std::filesystem::create_directories(root / "image_0");
    std::string times;
    for (int k = 0; k < frames; ++k) {
      const auto written = write_image((root / "image_0" / image_name(k)).string(), render(step_m * k));
      GS_CHECK(written.has_value(), "the fixture can't be written");
      times += fmt::format("{}\n", 0.1 * k);
    }
    GS_CHECK(write_text((root / "calib.txt").string(), calibration()).has_value(), "the fixture can't be written");
    GS_CHECK(write_text((root / "times.txt").string(), times).has_value(), "the fixture can't be written");
  }

 private:
  /// Random value of a lattice point, 0 to 1.
  static double lattice(std::int64_t x, std::int64_t y, std::uint64_t layer) {
    std::uint64_t h = static_cast<std::uint64_t>(x) * 0x9E3779B97F4A7C15ULL ^
                      static_cast<std::uint64_t>(y) * 0xC2B2AE3D27D4EB4FULL ^ layer * 0x165667B19E3779F9ULL;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ULL;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBULL;
    return static_cast<double>((h ^ (h >> 31)) >> 11) * 0x1p-53;
  }

  static double noise(double x, double y, std::uint64_t layer) {
    const double fx = std::floor(x), fy = std::floor(y);
    const auto smooth = [](double t) { return t * t * (3.0 - 2.0 * t); };
    const double tx = smooth(x - fx), ty = smooth(y - fy);
    const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
    const double top = (1.0 - tx) * lattice(ix, iy, layer) + tx * lattice(ix + 1, iy, layer);
    const double bottom = (1.0 - tx) * lattice(ix, iy + 1, layer) + tx * lattice(ix + 1, iy + 1, layer);
    return (1.0 - ty) * top + ty * bottom;
  }

  /// Octaves from 0.06 m on; those finer than a pixel's footprint fade to their mean.
  static double texture(double a_m, double b_m, double footprint_m, std::uint64_t surface) {
    double grey = 0.0;
    double weight = 0.0;
    std::uint64_t layer = 16 * surface;
    for (double size_m = 0.06; size_m < 4.0; size_m *= 2.0) {
      const double fade = std::clamp(1.5 - footprint_m / size_m, 0.0, 1.0);
      grey += fade * (noise(a_m / size_m, b_m / size_m, ++layer) - 0.5);
      weight += 1.0;
    }
    return 120.0 + 420.0 * grey / std::sqrt(weight) / 1.6;
  }

  double seen(double u, double v, double travelled_m) const {
    const double x = (u - cx()) / focal_px;
    const double y = (v - cy()) / focal_px;
    constexpr double kFar_m = 80.0;
    const double to_road = y > 0.0 ? camera_height_m / y : kFar_m;
    const double to_wall = x != 0.0 ? half_street_m / std::abs(x) : kFar_m;
    const double depth = std::min({to_road, to_wall, kFar_m});
    const double footprint = depth / focal_px;
    // Distance along the street shrinks with the slope at which it is seen.
    if (depth == kFar_m) return texture(kFar_m * x, kFar_m * y, footprint, 3);
    if (depth == to_road) return texture(depth * x, depth + travelled_m, footprint * depth / camera_height_m, 1);
    return texture(depth * y, depth + travelled_m, footprint * depth / half_street_m, x > 0.0 ? 2 : 4);
  }
};

}  // namespace groundscale
