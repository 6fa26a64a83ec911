#include "groundscale/experiments/calibration_parts.hpp"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::ElementsAre;
using testing::HasSubstr;

std::vector<CalibrationPart> planned(const CalibrationTrialOptions& options) {
  auto parts = plan_calibration_parts(options, "fisheye.yaml");
  EXPECT_TRUE(parts) << parts.error().message;
  return parts.value();
}

std::vector<std::string> trials_of(const CalibrationPart& part) {
  std::vector<std::string> words;
  for (const auto& item : part.items) words.push_back(item.drive.choice.name + ": " + in_words(item.trial.start));
  return words;
}

TEST(CalibrationParts, SeedsAreWorldsWithErrorsOfAllSigns) {
  const auto parts = planned({.parts = {"seeds"}, .seeds = 4});
  ASSERT_EQ(parts.size(), 1U);
  EXPECT_THAT(trials_of(parts.front()),
              ElementsAre("city-small-seed-1: k1 -0.02, cy +5 px", "city-small-seed-2: k1 +0.02, cy -5 px",
                          "city-small-seed-3: k1 -0.02, cy -5 px", "city-small-seed-4: k1 +0.02, cy +5 px"));
  const auto& last = parts.front().items.back().drive;
  EXPECT_EQ(last.options.seed, 4);
  EXPECT_EQ(last.choice.route, "city");
  EXPECT_EQ(last.choice.frames, 250);
}

TEST(CalibrationParts, DrivesAreTheCityAndThoseAlongPoses) {
  const TempFolder kitti;
  for (const char* name : {"00", "05", "07"}) {
    std::string rows;
    for (int k = 0; k < 6; ++k) rows += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(k) + "\n";
    kitti.file(std::string("poses/") + name + ".txt", rows);
  }
  const auto parts = planned({.parts = {"drives"}, .kitti = kitti.path()});
  const std::vector<std::string> trials = trials_of(parts.front());
  ASSERT_EQ(trials.size(), 8U);
  EXPECT_EQ(trials.front(), "city: k1 -0.02, cy +5 px");
  EXPECT_EQ(trials[3], "07: k1 -0.02, cy +5 px");
  EXPECT_EQ(trials.back(), "07: k1 +0.02, cy -5 px");
  EXPECT_EQ(trials_of(planned({.parts = {"drives"}}).front()).size(), 2U) << "without poses the route alone";
}

TEST(CalibrationParts, ComeInTheirOrderAndHaveEachCalibrationOnce) {
  const auto parts = planned({.parts = {"range", "focal", "straight", "fisheye", "drives", "seeds"}});
  std::vector<std::string> names;
  for (const CalibrationPart& part : parts) {
    names.push_back(part.name);
    const std::vector<std::string> trials = trials_of(part);
    EXPECT_FALSE(trials.empty());
    EXPECT_EQ(std::set<std::string>(trials.begin(), trials.end()).size(), trials.size()) << part.name;
  }
  EXPECT_EQ(names, calibration_part_names());
  EXPECT_EQ(planned({}).size(), names.size()) << "all, where none is named";
}

TEST(CalibrationParts, FisheyeIsAsFarOffInTheCornersAsKitti) {
  const auto part = planned({.parts = {"fisheye"}}).front();
  EXPECT_EQ(part.items.front().drive.options.camera, "fisheye.yaml");
  const TempFolder folder;
  ASSERT_TRUE(write_fisheye_camera(folder / "cameras/fisheye.yaml"));
  const auto camera = read_camera_file(folder / "cameras/fisheye.yaml", 0, 0);
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->camera->model(), "kannala_brandt");
  const double step = pixel_step(CameraParameter::kRadial, *camera->camera);
  EXPECT_NEAR(part.items.front().trial.start.radial / step, -10.0, 1e-9);
}

TEST(CalibrationParts, RefuseWhatIsNotThere) {
  const auto error = [](const CalibrationTrialOptions& options) {
    const auto parts = plan_calibration_parts(options, "");
    return parts ? "no error" : parts.error().message;
  };
  EXPECT_THAT(error({.parts = {"seedz"}}),
              HasSubstr("--parts: 'seedz' is no part, known: seeds, drives, straight, fisheye, focal, range"));
  EXPECT_THAT(error({.preset = "large"}), HasSubstr("'large' is no preset"));
  EXPECT_THAT(error({.kitti = "/nowhere"}), HasSubstr("holds no poses/NN.txt"));
}

}  // namespace
}  // namespace groundscale
