// A run can be repeated: from its configuration file, and by the same command.

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

constexpr int kFrames = 9;

class Repeat : public testing::Test {
 protected:
  void SetUp() override { SyntheticDrive().write_kitti(folder / "drive", kFrames); }

  /// A run into the folder's `output`, which must end well.
  void run(const std::string& output, std::vector<std::string> more) const {
    more.insert(more.begin(), {"run", "--output", folder / output});
    const ProgramRun done = run_program(more);
    ASSERT_EQ(done.status, 0) << done.err;
  }
  std::string text(const std::string& name) const { return read_text(folder / name).value(); }
  void expect_same_bytes(const std::string& a, const std::string& b) const {
    for (const char* file :
         {"/trajectory.kitti", "/trajectory.tum", "/online.kitti", "/online.tum", "/frames.csv", "/config.yaml"}) {
      EXPECT_TRUE(text(a + file) == text(b + file)) << file;
    }
  }

  TempFolder folder;
};

TEST_F(Repeat, AConfigurationFileRepeatsItsRunByteForByte) {
  const std::vector<std::string> arguments = {folder / "drive",
                                              "--start",
                                              "1",
                                              "--frames",
                                              "7",
                                              "--seed",
                                              "3",
                                              "--camera-height",
                                              "1.7123456789",
                                              "--set",
                                              "road.region.far_m=20.3"};
  ASSERT_NO_FATAL_FAILURE(run("first", arguments));
  ASSERT_NO_FATAL_FAILURE(run("same", arguments));
  ASSERT_NO_FATAL_FAILURE(run("repeated", {"--config", folder / "first/config.yaml"}));
  expect_same_bytes("first", "same");
  expect_same_bytes("first", "repeated");
  EXPECT_EQ(read_trajectory(folder / "first/trajectory.kitti")->size(), 7);
}

TEST_F(Repeat, TheCommandLineGoesBeforeTheFile) {
  ASSERT_NO_FATAL_FAILURE(run("first", {folder / "drive", "--start", "4", "--camera-height", "1.5"}));
  ASSERT_NO_FATAL_FAILURE(run(
      "second", {"--config", folder / "first/config.yaml", "--start", "0", "--frames", "3", "--camera-height", "3"}));
  EXPECT_EQ(read_trajectory(folder / "second/trajectory.kitti")->size(), 3);
  EXPECT_THAT(text("second/config.yaml"), HasSubstr("  start: 0\n  frames: 3\n"));
  EXPECT_THAT(text("second/config.yaml"), HasSubstr("  camera_height_m: 3\n"));
  EXPECT_THAT(text("second/summary.json"), HasSubstr("\"camera_height_from\": \"--camera-height\""));
}

TEST_F(Repeat, EveryPlaceToReadFromIsInTheFile) {
  ASSERT_NO_FATAL_FAILURE(run("first", {folder / "drive"}));
  const std::string config = text("first/config.yaml");
  EXPECT_THAT(config, HasSubstr("run:\n  source: \"" + (folder / "drive") + "\"\n  image: 0\n"));
  EXPECT_THAT(config, HasSubstr("  camera: \"" + (folder / "drive/calib.txt") + "\"\n  camera_height_m: 1.65\n"));
}

TEST_F(Repeat, UnknownKeysNameTheNearest) {
  const std::string config = folder.file("my.yaml", "run:\n  sorce: drive\n");
  const ProgramRun done = run_program({"run", "--config", config, "--output", folder / "output"});
  EXPECT_EQ(done.status, 2);
  EXPECT_THAT(done.err, HasSubstr("my.yaml:2: run.sorce: unknown key, the nearest is 'run.source'"));
}

}  // namespace
}  // namespace groundscale
