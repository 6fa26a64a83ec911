// groundscale simulate: what it writes, that it is the same again, and that it can be run.
#include <filesystem>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/trajectory_file.hpp"
#include "program.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;
using testing::HasSubstr;

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
  ASSERT_EQ(simulate(folder / "three", {"--frames", "3", "--threads", "3"}).status, 0);
  ASSERT_EQ(simulate(folder / "other", {"--frames", "3", "--seed", "7"}).status, 0);
  for (const char* name : {"image_0/000000.png", "image_0/000002.png", "truth.csv", "poses.txt"}) {
    EXPECT_EQ(*read_text(folder / (std::string("one/") + name)), *read_text(folder / (std::string("three/") + name)))
        << name;
  }
  EXPECT_NE(*read_text(folder / "one/image_0/000000.png"), *read_text(folder / "other/image_0/000000.png"));
}

TEST(Simulate, RefusesWhatItDoesNotKnowAndWritesNothing) {
  const TempFolder folder;
  const ProgramRun route = simulate(folder / "drive", {"--route", "circle"});
  EXPECT_EQ(route.status, 2);
  EXPECT_THAT(route.err, HasSubstr("'circle' is no route, known: city, straight, hills, stop-and-go, motorway"));
  const ProgramRun preset = run_program({"simulate", "--output", folder / "drive", "--preset", "large"});
  EXPECT_EQ(preset.status, 2);
  EXPECT_THAT(preset.err, HasSubstr("'large' is no preset, known: kitti, small"));
  EXPECT_FALSE(fs::exists(folder / "drive"));
}

TEST(Simulate, NeverWritesOverWhatIsThereUnasked) {
  const TempFolder folder;
  folder.file("keep.txt", "kept");
  const ProgramRun run = simulate(folder / "", {"--frames", "2"});
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr("--force overwrites it"));
  EXPECT_FALSE(fs::exists(folder / "image_0"));
}

}  // namespace
}  // namespace groundscale
