// groundscale simulate: what it writes, that it is the same again, and that it can be run.
#include <filesystem>
#include <iterator>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "program.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;

ProgramRun simulate(const std::string& output, std::vector<std::string> more) {
  std::vector<std::string> arguments = {"simulate", "--output", output, "--preset", "small"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

TEST(Simulate, WritesADriveThatRunsAndIsMeasured) {
  const TempFolder folder;
  constexpr int kFrames = 24;
  const ProgramRun made = simulate(folder / "drive", {"--route", "straight", "--frames", fmt::to_string(kFrames)});
  ASSERT_EQ(made.status, 0) << made.err;
  for (const char* name : {"camera.yaml", "calib.txt", "times.txt", "poses.txt", "truth.csv", "image_0/000023.png"}) {
    EXPECT_TRUE(fs::exists(folder / (std::string("drive/") + name))) << name;
  }
  EXPECT_FALSE(fs::exists(folder / "drive/image_0/000024.png"));
  const auto truth = read_trajectory(folder / "drive/poses.txt");
  ASSERT_TRUE(truth) << truth.error().message;
  ASSERT_EQ(truth->size(), kFrames);
  EXPECT_LT(truth->world_from_cam.front().translation.norm(), 1e-9);

  const ProgramRun run = run_program({"run", folder / "drive", "--output", folder / "run"});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto estimate = read_trajectory(folder / "run/trajectory.kitti");
  ASSERT_TRUE(estimate);
  const double true_m = truth->world_from_cam.back().translation.norm();
  // A third of KITTI's resolution and an aliased image: scale to a tenth is enough to know that all fits together.
  EXPECT_NEAR(estimate->world_from_cam.back().translation.norm(), true_m, 0.1 * true_m);
}

TEST(Simulate, IsTheSameBytesWithAnyNumberOfThreadsAndAnotherWorldWithAnotherSeed) {
  const TempFolder folder;
  ASSERT_EQ(simulate(folder / "one", {"--frames", "3", "--threads", "1"}).status, 0);
  ASSERT_EQ(simulate(folder / "three", {"--frames", "3", "--threads", "3", "--no-cache"}).status, 0);
  ASSERT_EQ(simulate(folder / "other", {"--frames", "3", "--seed", "7"}).status, 0);
  for (const char* name : {"image_0/000000.png", "image_0/000002.png", "truth.csv", "poses.txt"}) {
    EXPECT_EQ(*read_text(folder / (std::string("one/") + name)), *read_text(folder / (std::string("three/") + name)))
        << name;
  }
  EXPECT_NE(*read_text(folder / "one/image_0/000000.png"), *read_text(folder / "other/image_0/000000.png"));
}

/// Folders of drives that are kept, each with its number of images.
std::map<std::string, int> kept_drives() {
  std::map<std::string, int> kept;
  const std::string folder = cache_folder() / "groundscale/drives";
  if (!fs::exists(folder)) return kept;
  for (const auto& drive : fs::directory_iterator(folder)) {
    kept[drive.path().string()] =
        static_cast<int>(std::distance(fs::directory_iterator(drive), fs::directory_iterator()));
  }
  return kept;
}

/// A cache that nothing has been kept in yet.
class SimulateCache : public testing::Test {
 protected:
  SimulateCache() {
    fs::remove_all(cache_folder() / "groundscale");
    std::string rows;
    for (int k = 0; k < 20; ++k) rows += fmt::format("1 0 0 0 0 1 0 0 0 0 1 {}\n", k);
    folder_.file("poses.txt", rows);
  }

  /// A short road is made in no time.
  void render(const std::string& name, std::vector<std::string> more) const {
    more.insert(more.end(), {"--trajectory", folder_ / "poses.txt"});
    const ProgramRun run = simulate(folder_ / name, more);
    ASSERT_EQ(run.status, 0) << run.err;
  }
  std::string image(const std::string& name, int frame) const {
    return *read_text(folder_ / fmt::format("{}/image_0/{:06d}.png", name, frame));
  }
  /// The only drive that is kept.
  static std::string kept_image(int frame) { return fmt::format("{}/{:06d}.png", kept_drives().begin()->first, frame); }

  TempFolder folder_;
};

TEST_F(SimulateCache, IsReadTheSecondTimeAndALongerDriveGoesOnFromIt) {
  render("first", {"--frames", "2"});
  ASSERT_EQ(kept_drives().size(), 1U);
  EXPECT_EQ(kept_drives().begin()->second, 2);
  // Another image in the place of the first tells whether it is read.
  fs::copy_file(kept_image(1), kept_image(0), fs::copy_options::overwrite_existing);
  render("second", {"--frames", "3"});
  EXPECT_EQ(image("second", 0), image("first", 1));
  EXPECT_EQ(image("second", 1), image("first", 1));
  ASSERT_EQ(kept_drives().size(), 1U);
  EXPECT_EQ(kept_drives().begin()->second, 3);
  // The exposure follows all frames before, those that weren't rendered too.
  render("anew", {"--frames", "3", "--no-cache"});
  EXPECT_EQ(image("anew", 0), image("first", 0));
  EXPECT_EQ(image("anew", 2), image("second", 2));
}

TEST_F(SimulateCache, HasAPlaceForEachDriveAndNoneIsUsedUnasked) {
  render("none", {"--frames", "1", "--no-cache"});
  EXPECT_TRUE(kept_drives().empty());
  render("first", {"--frames", "1"});
  render("threads", {"--frames", "1", "--threads", "1"});
  render("depth", {"--frames", "1", "--depth"});
  EXPECT_EQ(kept_drives().size(), 1U);
  render("seed", {"--frames", "1", "--seed", "7"});
  render("option", {"--frames", "1", "--set", "world.sun_elevation_deg=20"});
  render("height", {"--frames", "1", "--set", "rig.height_m=1.5"});
  EXPECT_EQ(kept_drives().size(), 4U);
}

TEST_F(SimulateCache, WhatIsNoWholeImageOfTheCameraIsRenderedAgain) {
  render("first", {"--frames", "4"});
  const std::string whole = *read_text(kept_image(0));
  ASSERT_TRUE(write_text(kept_image(0), ""));
  ASSERT_TRUE(write_text(kept_image(1), "words"));
  ASSERT_TRUE(write_text(kept_image(2), whole.substr(0, whole.size() / 2)));
  ASSERT_TRUE(write_image(kept_image(3), Image(20, 10)));
  render("second", {"--frames", "4"});
  for (int k = 0; k < 4; ++k) {
    EXPECT_EQ(image("second", k), image("first", k)) << k;
    EXPECT_EQ(*read_text(kept_image(k)), image("first", k)) << k;
  }
}

TEST_F(SimulateCache, ThatCanNotBeWrittenIsNoError) {
  ASSERT_TRUE(write_text(cache_folder() / "groundscale", "a file where the folder would be"));
  render("drive", {"--frames", "2"});
  EXPECT_TRUE(fs::exists(folder_ / "drive/image_0/000001.png"));
}

TEST(Simulate, NeverRemovesImagesThatNoSimulationHasMade) {
  const TempFolder folder;
  fs::create_directories(folder / "image_0");
  folder.file("image_0/000000.png", "somebody's");
  const ProgramRun run = simulate(folder / "", {"--frames", "2", "--force"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, testing::HasSubstr("image_0 in it holds what no simulation has made"));
  EXPECT_EQ(*read_text(folder / "image_0/000000.png"), "somebody's");
}

}  // namespace
}  // namespace groundscale
