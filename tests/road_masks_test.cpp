// `run --road-masks`: what a detector says about the road restricts where it is measured.

#include <algorithm>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/odometry/pairwise.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kFrames = 10;
constexpr int kMasked = 5;

Image plain(int width, int height, int grey) {
  Image image(width, height);
  std::fill_n(image.data(), width * height, static_cast<std::uint8_t>(grey));
  return image;
}

class RoadMasksOfRun : public testing::Test {
 protected:
  void SetUp() override { drive.write_kitti(folder / "drive", kFrames); }

  void write_mask(const std::string& name, int grey) const {
    std::filesystem::create_directories(folder / "masks");
    ASSERT_TRUE(write_image(folder / ("masks/" + name), plain(drive.width, drive.height, grey)));
  }
  void write_masks(int grey) const {
    for (int k = 0; k < kFrames; ++k) write_mask(drive.image_name(k), grey);
  }
  ProgramRun run(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.begin(), {"run", folder / "drive", "--output", folder / output});
    return run_program(more);
  }
  ProgramRun run_masked(const std::string& output) const { return run(output, {"--road-masks", folder / "masks"}); }
  /// Frame to frame: each frame has a region of its own.
  ProgramRun run_pairwise(const std::string& output, std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--road-masks", folder / "masks", "--set", "odometry.mode=pairwise"});
    return run(output, more);
  }
  std::string text(const std::string& name) const { return read_text(folder / name).value(); }
  /// `reason` of each frame: why its measurement wasn't accepted.
  std::vector<std::string> reasons(const std::string& output) const {
    std::istringstream stream(text(output + "/frames.csv"));
    std::vector<std::string> reasons;
    std::string line;
    std::getline(stream, line);
    while (std::getline(stream, line)) {
      int commas = 0;
      std::size_t at = 0;
      for (constexpr int kBefore = 13; commas < kBefore; ++commas) at = line.find(',', at) + 1;
      // The columns after it are numbers or empty.
      std::size_t end = line.size();
      for (int after = 0; after < 3; ++after) end = line.rfind(',', end - 1);
      reasons.push_back(line.substr(at, end - at));
    }
    return reasons;
  }

  SyntheticDrive drive;
  TempFolder folder;
};

TEST_F(RoadMasksOfRun, WithoutRoadEveryMeasurementIsRefused) {
  write_masks(0);
  const ProgramRun done = run_masked("masked");
  ASSERT_EQ(done.status, 0) << done.err;
  EXPECT_THAT(done.err, HasSubstr("no measurement of the road was accepted"));
  EXPECT_THAT(reasons("masked"), AllOf(testing::SizeIs(kFrames), testing::Each(Not(IsEmpty()))));
}

TEST_F(RoadMasksOfRun, WithRoadEverywhereTheyChangeNothing) {
  write_masks(255);
  ASSERT_EQ(run("plain").status, 0);
  ASSERT_EQ(run_masked("masked").status, 0);
  for (const char* file : {"/trajectory.kitti", "/online.kitti", "/frames.csv"}) {
    EXPECT_TRUE(text(std::string("plain") + file) == text(std::string("masked") + file)) << file;
  }
  ASSERT_EQ(run("repeated", {"--config", folder / "masked/config.yaml"}).status, 0);
  EXPECT_TRUE(text("masked/config.yaml") == text("repeated/config.yaml"));
}

TEST_F(RoadMasksOfRun, AMaskCountsInTheEarlierImageOfAPair) {
  write_masks(255);
  write_mask(drive.image_name(kMasked), 0);
  ASSERT_EQ(run_pairwise("masked").status, 0);
  const std::vector<std::string> reason = reasons("masked");
  ASSERT_EQ(reason.size(), std::size_t{kFrames});
  EXPECT_THAT(reason[kMasked], IsEmpty());
  EXPECT_THAT(reason[kMasked + 1], Not(IsEmpty()));
  EXPECT_THAT(reason[kMasked + 2], IsEmpty());
}

TEST_F(RoadMasksOfRun, WithoutCommonNamesTheOrderCounts) {
  for (int k = 0; k < kFrames; ++k) write_mask(fmt::format("road{}.png", k + 1), k == kMasked ? 0 : 1);
  const ProgramRun done = run_pairwise("masked", {"--start", "2"});
  ASSERT_EQ(done.status, 0) << done.err;
  const std::vector<std::string> reason = reasons("masked");
  ASSERT_EQ(reason.size(), std::size_t{kFrames - 2});
  EXPECT_THAT(reason[kMasked - 2], IsEmpty());
  EXPECT_THAT(reason[kMasked - 1], Not(IsEmpty()));
}

TEST_F(RoadMasksOfRun, WithoutCommonNamesThereMustBeAMaskAnImage) {
  for (int k = 0; k < 3; ++k) write_mask(fmt::format("road{}.png", k), 255);
  const ProgramRun done = run_masked("masked");
  EXPECT_EQ(done.status, 2);
  EXPECT_THAT(done.err, HasSubstr("3 masks, none with the name of an image, and 10 images"));
}

/// Of the library: the mask given with a frame is of that frame.
TEST(PairwiseOdometry, TakesAMaskWithEachFrame) {
  const SyntheticDrive drive;
  const TempFolder folder;
  drive.write_kitti(folder / "drive", 4);
  auto sequence = open_sequence({.source = folder / "drive"}, false);
  ASSERT_TRUE(sequence) << sequence.error().message;
  auto setup = read_kitti_calibration((*sequence)->calibration_path(), 0, drive.width, drive.height);
  ASSERT_TRUE(setup) << setup.error().message;
  setup->height_m = drive.camera_height_m;
  auto odometry = PairwiseOdometry::create(*setup, {});
  ASSERT_TRUE(odometry) << odometry.error().message;
  std::vector<bool> accepted;
  while (const auto frame = (*sequence)->next()) {
    const Image mask = plain(drive.width, drive.height, frame->index == 1 ? 0 : 255);
    accepted.push_back(odometry->advance(*frame, mask).accepted());
  }
  EXPECT_THAT(accepted, testing::ElementsAre(false, true, false, true));
}

}  // namespace
}  // namespace groundscale
