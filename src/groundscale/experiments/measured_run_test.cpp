#include "groundscale/experiments/measured_run.hpp"

#include <filesystem>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;
using testing::ElementsAre;
using testing::HasSubstr;

/// A program that writes known results and notes in a file what it was called for.
class FakeProgram : public testing::Test {
 protected:
  void SetUp() override {
    write_program("");
    folder.file("drive/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1.5\n1 0 0 2 0 1 0 0 0 0 1 1.5\n");
    request.program = folder / "program";
  }
  void write_program(const std::string& more) const {
    const std::string script = fmt::format(R"(#!/bin/sh
echo "$1" >> '{}'
case $1 in
run)
  mkdir -p "$4"
  echo '{{"frames": 3, "accepted_measurements": 3, "states": {{"moving": 4, "lost": 1}}, "scale_corrections": [{{"frame": 2}}], "matching": {{"rms_px": 0.13}}, "time": {{"median_ms_a_frame": 5.5, "p95_ms_a_frame": 6.5}}, "warnings": ["dark"]}}' > "$4/summary.json";;
evaluate)
  echo '{{"moving": {{"steps": 2}}, "turns": {{"steps": 1}},
         "figures": {{"scale_bias": {{"value": -0.5}}, "t_rel": {{"value": null}}}}}}' > "$6";;
esac
{})",
                                           folder / "calls", more);
    folder.file("program", script);
    fs::permissions(folder / "program", fs::perms::owner_all);
  }
  std::string calls() const {
    const auto text = read_text(folder / "calls");
    return text ? *text : "";
  }
  Result<MeasuredRun> measure(const RunSettings& settings = {}) const {
    return measure_run({"one", folder / "drive", drive_key, "simulate"}, settings, folder / "run", request);
  }

  TempFolder folder;
  ExperimentRequest request;
  std::string drive_key = "key of the drive";
};

TEST_F(FakeProgram, ResultsOfAllStepsComeTogether) {
  const auto run = measure({.assignments = {"a.b=1"}, .seed = 7});
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_EQ(run->frames, 3);
  EXPECT_EQ(run->lost, 1);
  EXPECT_EQ(run->corrections, 1);
  EXPECT_EQ(run->moving_steps, 2);
  EXPECT_EQ(run->turn_steps, 1);
  EXPECT_EQ(run->median_ms, 5.5);
  EXPECT_EQ(run->p95_ms, 6.5);
  EXPECT_GT(run->peak_memory_mb, 0.0);
  EXPECT_DOUBLE_EQ(run->length_m, 1.5 + 2.0);
  EXPECT_THAT(run->warnings, ElementsAre("dark"));
  EXPECT_EQ(run->figure("scale_bias"), -0.5);
  EXPECT_FALSE(run->figure("t_rel").has_value());
  EXPECT_FALSE(run->figure("no such figure").has_value());
  EXPECT_THAT(run->commands[0], HasSubstr("--set a.b=1 --seed 7"));
}

TEST_F(FakeProgram, IsRunAgainOnlyWhereDriveSettingsOrProgramAreOthers) {
  ASSERT_TRUE(measure());
  ASSERT_TRUE(measure());
  EXPECT_EQ(calls(), "run\nevaluate\n");
  ASSERT_TRUE(measure({.assignments = {"a.b=1"}, .seed = {}}));
  EXPECT_EQ(calls(), "run\nevaluate\nrun\nevaluate\n");
  ASSERT_TRUE(measure());
  drive_key = "another drive";
  ASSERT_TRUE(measure());
  write_program("# another build of the same version");
  ASSERT_TRUE(measure());
  EXPECT_EQ(calls().size(), 5 * std::string("run\nevaluate\n").size());
}

TEST_F(FakeProgram, TakesTheDrivesConfigurationAnotherCameraAndTheFramesWanted) {
  folder.file("drive/config.yaml", "");
  const RunSettings settings{.assignments = {}, .seed = {}, .camera = folder.file("camera.yaml", "fx: 1")};
  RenderedDrive drive{.name = "one", .folder = folder / "drive", .key = "key", .command = "simulate"};
  drive.frames = 2;
  const auto run = measure_run(drive, settings, folder / "run", request);
  ASSERT_TRUE(run) << run.error().message;
  EXPECT_THAT(run->commands[0], HasSubstr(fmt::format("--config {0}/drive/config.yaml --camera {0}/camera.yaml "
                                                      "--frames 2",
                                                      folder.path())));
  folder.file("camera.yaml", "fx: 2");
  ASSERT_TRUE(measure_run(drive, settings, folder / "run", request));
  EXPECT_EQ(calls(), "run\nevaluate\nrun\nevaluate\n") << "another camera is another run";
}

TEST_F(FakeProgram, AResultThatIsSpoiltIsSaidToBe) {
  ASSERT_TRUE(measure());
  folder.file("run/summary.json", "{}");
  EXPECT_THAT(measure().error().message, HasSubstr("a result in it can't be read"));
  folder.file("run/summary.json", "{");
  EXPECT_THAT(measure().error().message, HasSubstr("summary.json: isn't JSON"));
}

TEST_F(FakeProgram, AStepThatFailsIsNotDone) {
  write_program("exit 1");
  const auto failed = measure();
  ASSERT_FALSE(failed);
  EXPECT_THAT(failed.error().message, HasSubstr("status 1 of: groundscale run"));
  EXPECT_EQ(calls(), "run\n");
  write_program("");
  EXPECT_TRUE(measure());
}

TEST(RunSettings, KeysAndValuesAreCheckedBeforeAnyWork) {
  EXPECT_TRUE(RunSettings().validate());
  const RunSettings unknown{.assignments = {"ground.metod=sparse"}, .seed = {}};
  EXPECT_THAT(unknown.validate().error().message, HasSubstr("the nearest is 'ground.method'"));
  const RunSettings beyond{.assignments = {"road.region.near_m=-3"}, .seed = {}};
  EXPECT_FALSE(beyond.validate());
}

}  // namespace
}  // namespace groundscale
