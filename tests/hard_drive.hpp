#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/odometry/odometry.hpp"
#include "groundscale/simulation/drive_simulation.hpp"
#include "groundscale/simulation/renderer.hpp"
#include "groundscale/simulation/sensor.hpp"
#include "groundscale/simulation/traffic.hpp"
#include "preset_setup.hpp"

namespace groundscale {

/// What a camera gives, and where it truly was.
struct FeedFrame {
  double time_s = 0.0;
  Image image;
  RigidTransform world_from_cam;
};
using Feed = std::vector<FeedFrame>;

/// Renders a drive with its traffic; at most so many frames.
inline Feed rendered(const SimulatedDrive& drive, std::size_t most = 100000) {
  const SimulationOptions& options = drive.camera.options;
  const Renderer renderer(drive.world, drive.camera.camera, {.edge_rays = options.edge_rays, .threads = 1});
  Exposure exposure(options.sensor);
  std::vector<VehicleState> states;
  for (const CameraMoment& moment : drive.moments) {
    states.push_back({moment.time_s, moment.distance_m, moment.speed_mps, 0.0});
  }
  std::unique_ptr<Traffic> traffic;
  if (options.traffic.on) {
    traffic = std::make_unique<Traffic>(drive.world.surface, states, options.traffic, drive.seed);
  }
  Feed feed;
  for (std::size_t k = 0; k < std::min(most, drive.moments.size()); ++k) {
    const CameraMoment& moment = drive.moments[k];
    const auto moving = traffic ? std::make_unique<RayScene>(traffic->at(moment.time_s)) : nullptr;
    const double dt_s = k == 0 ? 0.0 : moment.time_s - drive.moments[k - 1].time_s;
    const double gain = exposure.follow(renderer.mean_light(moment.shutter, moving.get()), dt_s);
    Rng rng(drive.seed + 1000 * k);
    feed.push_back({moment.time_s, expose(renderer.render(moment.shutter, moving.get()), gain, options.sensor, rng),
                    moment.world_from_cam});
  }
  return feed;
}

/// With pixels of its own.
inline Image copy_of(const Image& image) {
  Image copy(image.width(), image.height());
  const auto count = static_cast<std::ptrdiff_t>(image.width()) * image.height();
  std::copy(image.data(), image.data() + count, copy.data());
  return copy;
}

/// A box of random texture, drawn over an image: something that moves by itself, or a part of the own vehicle.
struct PaintedBox {
  int left = 0, top = 0, width = 0, height = 0;
  std::uint64_t seed = 0;
};

inline Image painted(const Image& image, const PaintedBox& box) {
  Image result = copy_of(image);
  constexpr int kGrainPx = 6;
  const auto grain = [&box](int x, int y) {
    Rng rng(box.seed + 7919U * static_cast<std::uint64_t>(x) + 104729U * static_cast<std::uint64_t>(y));
    return rng.uniform(30.0, 220.0);
  };
  const int columns = box.width / kGrainPx + 2;
  const int rows = box.height / kGrainPx + 2;
  std::vector<double> grains;
  for (int y = 0; y < rows; ++y) {
    for (int x = 0; x < columns; ++x) grains.push_back(grain(x, y));
  }
  for (int y = std::max(0, -box.top); y < box.height && box.top + y < image.height(); ++y) {
    for (int x = std::max(0, -box.left); x < box.width && box.left + x < image.width(); ++x) {
      const int gx = x / kGrainPx;
      const int gy = y / kGrainPx;
      const double u = static_cast<double>(x % kGrainPx) / kGrainPx;
      const double v = static_cast<double>(y % kGrainPx) / kGrainPx;
      const auto at = [&](int column, int row) { return grains[static_cast<std::size_t>(row * columns + column)]; };
      const double value = (1.0 - v) * ((1.0 - u) * at(gx, gy) + u * at(gx + 1, gy)) +
                           v * ((1.0 - u) * at(gx, gy + 1) + u * at(gx + 1, gy + 1));
      const auto row = static_cast<std::ptrdiff_t>(box.top + y) * image.width();
      result.data()[row + box.left + x] = static_cast<std::uint8_t>(value);
    }
  }
  return result;
}

/// The same image with other noise of a sensor.
inline Image with_noise(const Image& image, std::uint64_t seed) {
  constexpr double kGreySd = 2.0;
  Image noisy = copy_of(image);
  Rng rng(seed);
  const auto count = static_cast<std::ptrdiff_t>(image.width()) * image.height();
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    noisy.data()[i] =
        static_cast<std::uint8_t>(std::clamp(std::lround(image.data()[i] + kGreySd * rng.normal()), 0L, 255L));
  }
  return noisy;
}

/// Each grey level times a factor, cut off at white.
inline Image brightened(const Image& image, double factor) {
  Image result = copy_of(image);
  const auto count = static_cast<std::ptrdiff_t>(image.width()) * image.height();
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    result.data()[i] = static_cast<std::uint8_t>(std::min(255.0, std::round(factor * image.data()[i])));
  }
  return result;
}

/// An odometry's answers to a feed.
struct DriveRun {
  std::vector<FrameResult> results;
  std::vector<RigidTransform> online, finals;
};

inline DriveRun run(const Feed& feed, const CameraSetup& setup, const OdometryOptions& options = {}) {
  auto odometry = make_odometry(setup, options);
  GS_CHECK(odometry.has_value(), "the road is in view");
  for (std::size_t k = 0; k < feed.size(); ++k) {
    Frame frame;
    frame.index = static_cast<int>(k);
    frame.time_s = feed[k].time_s;
    frame.image = feed[k].image;
    if (frame.image.empty()) frame.problem = "unreadable";
    (*odometry)->advance(frame);
  }
  (*odometry)->finish();
  return {(*odometry)->results(), (*odometry)->online_poses(), (*odometry)->final_poses()};
}

/// A row for every frame, a reason for every gap, and numbers everywhere.
inline void expect_whole(const DriveRun& run, const Feed& feed) {
  ASSERT_EQ(run.results.size(), feed.size());
  ASSERT_EQ(run.online.size(), feed.size());
  ASSERT_EQ(run.finals.size(), feed.size());
  for (std::size_t k = 0; k < feed.size(); ++k) {
    const FrameResult& result = run.results[k];
    EXPECT_TRUE(result.accepted() || !result.reason.empty()) << k;
    EXPECT_TRUE(run.finals[k].rotation.allFinite() && run.finals[k].translation.allFinite()) << k;
    EXPECT_TRUE(run.online[k].rotation.allFinite() && run.online[k].translation.allFinite()) << k;
    EXPECT_TRUE(std::isfinite(result.step_m) && result.step_m >= 0.0) << k;
    EXPECT_TRUE(std::isfinite(result.online_step_m) && result.online_step_m >= 0.0) << k;
    EXPECT_TRUE(std::isfinite(result.step_sd) && std::isfinite(result.online_step_sd)) << k;
    EXPECT_GT(result.map_scale.value_or(1.0), 0.0) << k;
    EXPECT_GT(result.raw_over_online.value_or(1.0), 0.0) << k;
  }
}

inline double length_of(const std::vector<RigidTransform>& poses, std::size_t from, std::size_t to) {
  double length_m = 0.0;
  for (std::size_t k = from + 1; k <= to; ++k) length_m += (poses[k].translation - poses[k - 1].translation).norm();
  return length_m;
}

inline double true_length_m(const Feed& feed, std::size_t from, std::size_t to) {
  double length_m = 0.0;
  for (std::size_t k = from + 1; k <= to; ++k) {
    length_m += (feed[k].world_from_cam.translation - feed[k - 1].world_from_cam.translation).norm();
  }
  return length_m;
}

/// Final length over the true one from one frame to a later one.
inline double length_ratio(const DriveRun& run, const Feed& feed, std::size_t from, std::size_t to) {
  return length_of(run.finals, from, to) / true_length_m(feed, from, to);
}

/// Distance of the final motion between two frames from the true one.
inline double motion_error_m(const DriveRun& run, const Feed& feed, std::size_t from, std::size_t to) {
  const RigidTransform truth = feed[from].world_from_cam.inverse() * feed[to].world_from_cam;
  const RigidTransform found = run.finals[from].inverse() * run.finals[to];
  return (truth.translation - found.translation).norm();
}

inline std::size_t count_of(const DriveRun& run, FrameState state) {
  return static_cast<std::size_t>(std::count_if(run.results.begin(), run.results.end(),
                                                [state](const FrameResult& r) { return r.state == state; }));
}

inline std::size_t accepted_in(const DriveRun& run, std::size_t from, std::size_t to) {
  std::size_t count = 0;
  for (std::size_t k = from; k <= to; ++k) count += run.results[k].accepted() ? 1U : 0U;
  return count;
}

}  // namespace groundscale
