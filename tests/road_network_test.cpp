// `run --set road.network.file=...`: a network of the user's says where the road is.

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bad_input_docs.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/road/test_network_internal.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;
using testing::Not;

constexpr int kFrames = 10;

class RoadNetworkOfRun : public testing::Test {
 protected:
  void SetUp() override { drive.write_kitti(folder / "drive", kFrames); }

  ProgramRun run(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", folder / "drive", "--output", folder / output});
    return run_program(more);
  }
  std::string network(bool road) const {
    return "road.network.file=" +
           folder.file(road ? "road.onnx" : "none.onnx", TestNetwork::always(road, 160, 64).onnx());
  }
  std::string text(const std::string& name) const { return read_text(folder / name).value(); }
  void write_masks(int grey) const {
    std::filesystem::create_directories(folder / "masks");
    Image mask(drive.width, drive.height);
    std::fill_n(mask.data(), drive.width * drive.height, static_cast<std::uint8_t>(grey));
    for (int k = 0; k < kFrames; ++k) ASSERT_TRUE(write_image(folder / ("masks/" + drive.image_name(k)), mask));
  }

  SyntheticDrive drive;
  TempFolder folder;
};

TEST_F(RoadNetworkOfRun, WithRoadEverywhereItChangesNothingAndSaysWhatItCost) {
  ASSERT_EQ(run("plain").status, 0);
  const ProgramRun done = run("network", {"--set", network(true), "road.network.every=4"});
  ASSERT_EQ(done.status, 0) << done.err;
  for (const char* file : {"/trajectory.kitti", "/online.kitti", "/frames.csv"}) {
    EXPECT_TRUE(text(std::string("plain") + file) == text(std::string("network") + file)) << file;
  }
  EXPECT_THAT(text("plain/summary.json"), Not(HasSubstr("road_network")));
  // Frames 0 and 4, with metres to carry the mask by from frame 1 on, and at least once more where a map begins.
  EXPECT_THAT(text("network/summary.json"), testing::AllOf(HasSubstr("\"runs\": 3"), HasSubstr("\"mean_ms_a_run\"")));
  EXPECT_THAT(text("network/summary.json"), HasSubstr("\"road network\""));
}

TEST_F(RoadNetworkOfRun, RepeatsFromItsConfigurationInAnotherFolder) {
  const std::string here = std::filesystem::relative(folder.path()).string() + "/road.onnx";
  (void)network(true);
  ASSERT_EQ(run("first", {"--set", "road.network.file=" + here}).status, 0);
  EXPECT_THAT(text("first/config.yaml"), HasSubstr(std::filesystem::absolute(folder / "road.onnx").string()));
  ASSERT_EQ(run("repeated", {"--config", folder / "first/config.yaml"}).status, 0);
  for (const char* file : {"/trajectory.kitti", "/frames.csv", "/config.yaml"}) {
    EXPECT_TRUE(text(std::string("first") + file) == text(std::string("repeated") + file)) << file;
  }
}

TEST_F(RoadNetworkOfRun, WithoutRoadEveryMeasurementIsRefused) {
  const ProgramRun done = run("network", {"--set", network(false)});
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("no measurement of the road was accepted"));
}

TEST_F(RoadNetworkOfRun, BesideMasksBothMustSeeRoad) {
  write_masks(255);
  EXPECT_THAT(run("a", {"--set", network(false), "--road-masks", folder / "masks"}).err, HasSubstr("no measurement"));
  EXPECT_THAT(run("b", {"--set", network(true), "--road-masks", folder / "masks"}).err,
              Not(HasSubstr("no measurement")));
  write_masks(0);
  EXPECT_THAT(run("c", {"--set", network(true), "--road-masks", folder / "masks"}).err, HasSubstr("no measurement"));
}

/// Rows of docs/bad-input.md.
struct Refusal {
  std::string name;
  std::string onnx;  ///< "": no file.
  std::string option;
  std::string message;
};

std::vector<Refusal> refusals() {
  const std::string sound = TestNetwork::dark_is_road(160, 64).onnx();
  const std::string none = "road.network.erode_px=0";
  return {
      {"road network missing", "", none, "road.onnx: no such file"},
      {"road network that is none", "words", none, "isn't a network that OpenCV can load"},
      {"road network whose input size isn't known", TestNetwork::dark_is_road(0, 0).onnx(), none,
       "doesn't say its input's size, width and height must"},
      {"road network of another input", sound, "road.network.channels=1", "can't be run on an input of 1 x 64 x 160"},
      {"road network without that output", sound, "road.network.output=rod", "has no output 'rod', it has: road"},
      {"road network without that channel", sound, "road.network.road_channel=2", "channels 0 to 1"},
      {"road network with a width alone", sound, "road.network.width=160", "both must be given, or neither"},
  };
}

TEST_F(RoadNetworkOfRun, WhatIsWrongIsFoundBeforeAnythingIsWritten) {
  for (const Refusal& row : refusals()) {
    const std::string file = row.onnx.empty() ? folder / "nowhere/road.onnx" : folder.file("road.onnx", row.onnx);
    const ProgramRun done = run("refused", {"--set", "road.network.file=" + file, row.option});
    EXPECT_EQ(done.status, 2) << row.name;
    EXPECT_THAT(done.err, testing::AllOf(testing::StartsWith("groundscale: road.network."), HasSubstr(row.message)));
    // OpenCV doesn't add words of its own.
    EXPECT_EQ(std::count(done.err.begin(), done.err.end(), '\n'), 1) << done.err;
    EXPECT_FALSE(std::filesystem::exists(folder / "refused")) << row.name;
    expect_in_bad_input_docs(row.name, 2, row.message);
  }
}

}  // namespace
}  // namespace groundscale
