#include "groundscale/experiments/calibration_trial.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/simulation/camera_presets.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

CameraSetup kitti() {
  CameraSetup setup;
  setup.camera = find_camera_preset("kitti")->camera;
  setup.height_m = 1.65;
  setup.pitch_rad = 0.01;
  return setup;
}

double value(CameraParameter parameter, const CameraSetup& setup) { return value_of(parameter, *setup.camera); }

TEST(CalibrationStart, IsOffByWhatItSays) {
  const CameraSetup truth = kitti();
  const auto start = start_setup(truth, {.radial = -0.02, .row_px = 5.0, .focal = 0.01});
  ASSERT_TRUE(start) << start.error().message;
  EXPECT_NEAR(value(CameraParameter::kRadial, *start), 0.0117 - 0.02, 1e-12);
  EXPECT_NEAR(value(CameraParameter::kRow, *start), 185.2157 + 5.0, 1e-9);
  EXPECT_NEAR(value(CameraParameter::kFocal, *start), 718.856 * 1.01, 1e-9);
  EXPECT_EQ(value(CameraParameter::kColumn, *start), value(CameraParameter::kColumn, truth));
  EXPECT_EQ(start->height_m, 1.65);
  EXPECT_FALSE(start->pitch_rad.has_value()) << "how it is mounted is to be found";
  EXPECT_TRUE(start->parameter_sds.empty());
}

TEST(CalibrationStart, FreesTheFocalLengthByItsSd) {
  const auto start = start_setup(kitti(), {.focal = -0.01, .known = FocalKnowledge::kWithSd});
  ASSERT_TRUE(start);
  EXPECT_NEAR(start->parameter_sds.at(CameraParameter::kFocal), 0.01 * 0.99 * 718.856, 1e-9);
}

TEST(CalibrationStart, OfAFieldOfViewKnowsNothingElse) {
  const auto start = start_setup(kitti(), {.focal = 0.1, .known = FocalKnowledge::kView});
  ASSERT_TRUE(start);
  EXPECT_NEAR(value(CameraParameter::kFocal, *start), 718.856 * 1.1, 1e-9);
  EXPECT_EQ(value(CameraParameter::kRadial, *start), 0.0);
  EXPECT_EQ(value(CameraParameter::kColumn, *start), 620.0);
  EXPECT_EQ(value(CameraParameter::kRow, *start), 187.5);
}

TEST(CalibrationStart, ThatIsNoCameraIsRefused) {
  EXPECT_FALSE(start_setup(kitti(), {.focal = -1.5}));
  EXPECT_FALSE(start_setup(kitti(), {.radial = -3.0}));
}

TEST(CalibrationStart, SaysInWordsWhatIsOff) {
  EXPECT_EQ(in_words({}), "the truth");
  EXPECT_EQ(in_words({.radial = -0.02, .row_px = 5.0}), "k1 -0.02, cy +5 px");
  EXPECT_EQ(in_words({.row_px = -40.0, .focal = 0.01}), "cy -40 px, f +1 %");
  EXPECT_EQ(in_words({.focal = -0.01, .known = FocalKnowledge::kWithSd}), "f -1 %, f freed");
  EXPECT_EQ(in_words({.focal = 0.1, .known = FocalKnowledge::kView}), "--fov with f +10 %");
  EXPECT_EQ(in_words({.known = FocalKnowledge::kNothing}), "nothing known");
}

/// A drive without images, so that what isn't kept can't be made.
class KeptTrial : public testing::Test {
 protected:
  KeptTrial() {
    request.output = folder.path();
    request.program = folder.file("program", "bytes");
    drive.folder = folder / "drive";
  }
  TempFolder folder;
  ExperimentRequest request;
  RenderedDrive drive{.name = "city", .folder = "", .key = "seed 1"};
  CalibrationTrial trial{.start = {.radial = -0.02}};
};

TEST_F(KeptTrial, ThatFailsLeavesNothingDone) {
  const auto failed = measure_trial(drive, trial, {}, folder / "trial", request);
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kIo);
  EXPECT_THAT(failed.error().message, HasSubstr("camera.yaml"));
  EXPECT_THAT(read_text(folder / "trial.key").value(), testing::StartsWith("begun\n"));
}

TEST_F(KeptTrial, IsReadAgainAndNotMade) {
  ASSERT_FALSE(measure_trial(drive, trial, {}, folder / "trial", request));
  const std::string key = read_text(folder / "trial.key").value();
  folder.file("trial.key", "done\n" + key.substr(std::string("begun\n").size()));
  folder.file("trial/calibration.json", R"({"adopted": true, "verdict": "calibrated", "stayed": "",
      "figures": {"radial_error": 0.001, "slope_error": null}})");
  const auto kept = measure_trial(drive, trial, {}, folder / "trial", request);
  ASSERT_TRUE(kept) << kept.error().message;
  EXPECT_TRUE(kept->adopted);
  EXPECT_EQ(kept->drive, "city");
  EXPECT_EQ(in_words(kept->start), "k1 -0.02");
  EXPECT_EQ(kept->figure("radial_error"), 0.001);
  EXPECT_EQ(kept->figure("slope_error"), std::nullopt);
  EXPECT_EQ(kept->figure("row_error"), std::nullopt);

  folder.file("trial/calibration.json", "{");
  EXPECT_THAT(measure_trial(drive, trial, {}, folder / "trial", request).error().message, HasSubstr("can't be read"));
  trial.frames = 100;
  EXPECT_FALSE(measure_trial(drive, trial, {}, folder / "trial", request)) << "another trial is made anew";
}

}  // namespace
}  // namespace groundscale
