#include "groundscale/experiments/drive_choice.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::ElementsAre;
using testing::HasSubstr;

std::string poses(int rows) {
  std::string text;
  for (int k = 0; k < rows; ++k) text += "1 0 0 0 0 1 0 0 0 0 1 " + std::to_string(k) + "\n";
  return text;
}

/// A KITTI root with the default sequences.
class KittiRoot : public testing::Test {
 protected:
  void SetUp() override {
    for (const char* name : {"00", "06", "07", "10"}) folder.file(std::string("poses/") + name + ".txt", poses(5));
    folder.file("poses/01.txt", poses(2000));
    folder.file("times/06.txt", "0\n");
    folder.file("sequences/07/times.txt", "0\n");
    options.kitti = folder.path();
  }
  std::string error() const {
    const auto drives = choose_drives(options);
    return drives ? "no error" : drives.error().message;
  }
  TempFolder folder;
  DriveOptions options;
};

TEST_F(KittiRoot, DefaultsAreThreeWholeDrivesAndTheFirst1501FramesOf00) {
  folder.file("poses/00.txt", poses(1600));
  const auto drives = choose_drives(options);
  ASSERT_TRUE(drives) << drives.error().message;
  std::vector<std::string> names;
  for (const DriveChoice& drive : *drives) names.push_back(drive.name);
  EXPECT_THAT(names, ElementsAre("06", "07", "10", "00"));
  EXPECT_EQ((*drives)[0].frames, 5);
  EXPECT_EQ((*drives)[3].frames, 1501);
}

TEST_F(KittiRoot, TimesAreFoundInBothPlaces) {
  const auto drives = choose_drives(options);
  ASSERT_TRUE(drives);
  EXPECT_EQ((*drives)[0].times, folder / "times/06.txt");
  EXPECT_EQ((*drives)[1].times, folder / "sequences/07/times.txt");
  EXPECT_EQ((*drives)[2].times, "");
}

TEST_F(KittiRoot, FramesAreCappedByASequenceByAllAndByThePoses) {
  options.sequences = {"01:100", "06", "07:4"};
  options.frames = 50;
  const auto drives = choose_drives(options);
  ASSERT_TRUE(drives) << drives.error().message;
  EXPECT_EQ((*drives)[0].frames, 50);
  EXPECT_EQ((*drives)[1].frames, 5);
  EXPECT_EQ((*drives)[2].frames, 4);
}

TEST_F(KittiRoot, ADriveIsSimulatedAlongItsPoses) {
  options.sequences = {"06"};
  options.seed = 3;
  options.preset = "small";
  const auto drives = choose_drives(options);
  ASSERT_TRUE(drives);
  EXPECT_THAT(simulate_arguments(drives->front(), options),
              ElementsAre("simulate", "--trajectory", folder / "poses/06.txt", "--times", folder / "times/06.txt",
                          "--preset", "small", "--frames", "5", "--seed", "3"));
}

TEST_F(KittiRoot, WhatIsWrongIsSaidWithWhatWouldBeRight) {
  options.sequences = {"42"};
  EXPECT_EQ(error(), "'42' is no sequence of --kitti " + folder.path() + ", there are: 00, 01, 06, 07, 10");
  options.sequences = {"06", "06:3"};
  EXPECT_EQ(error(), "--sequences: '06' is there twice");
  options.sequences = {"06:one"};
  EXPECT_THAT(error(), HasSubstr("must be a number of frames, at least 2"));
  options.sequences = {"06:1"};
  EXPECT_THAT(error(), HasSubstr("must be a number of frames, at least 2"));
  options.sequences = {"../06"};
  EXPECT_THAT(error(), HasSubstr("is no name of a sequence"));
  options.sequences = {};
  options.preset = "large";
  EXPECT_THAT(error(), HasSubstr("'large' is no preset"));
}

TEST_F(KittiRoot, PosesThatCanNotBeUsedAreFoundBeforeTheWork) {
  options.sequences = {"08"};
  folder.file("poses/08.txt", "1 0 0\n");
  EXPECT_THAT(error(), HasSubstr("poses/08.txt"));
  folder.file("poses/08.txt", poses(1));
  EXPECT_THAT(error(), HasSubstr("1 poses, at least 2 are needed"));
  options.kitti = folder / "nowhere";
  EXPECT_THAT(error(), HasSubstr("holds no poses/NN.txt"));
}

TEST_F(KittiRoot, AllAreAllWhosePosesAreThere) {
  options.sequences = {"all"};
  const auto drives = choose_drives(options);
  ASSERT_TRUE(drives) << drives.error().message;
  EXPECT_EQ(drives->size(), 5U);
  EXPECT_EQ(drives->at(1).name, "01");
}

TEST_F(KittiRoot, SequencesWithImagesAreRealDrivesWhereTheyMayBe) {
  folder.file("sequences/07/image_0/000004.png", "");
  options.use_images = true;
  const auto present = choose_drives(options);
  ASSERT_TRUE(present) << present.error().message;
  ASSERT_EQ(present->size(), 1U);
  EXPECT_EQ(present->front().recorded, folder / "sequences/07");
  EXPECT_EQ(present->front().poses, folder / "poses/07.txt");
  options.sequences = {"06", "07:3"};
  const auto both = choose_drives(options);
  ASSERT_TRUE(both) << both.error().message;
  EXPECT_EQ(both->at(0).recorded, "");
  EXPECT_EQ(both->at(1).recorded, folder / "sequences/07");
  EXPECT_EQ(both->at(1).frames, 3);
  options.use_images = false;
  EXPECT_EQ(choose_drives(options)->at(1).recorded, "");
}

TEST(Clips, AreTheRealDrivesOfAFolder) {
  const TempFolder folder;
  folder.file("00/poses.txt", poses(4));
  folder.file("00/image_0/000003.png", "");
  folder.file("full/poses/00.txt", poses(4));
  DriveOptions options;
  options.clips = folder.path();
  const auto drives = choose_drives(options);
  ASSERT_TRUE(drives) << drives.error().message;
  ASSERT_EQ(drives->size(), 1U);
  EXPECT_EQ(drives->front().name, "00");
  EXPECT_EQ(drives->front().frames, 4);
  options.sequences = {"07"};
  EXPECT_EQ(choose_drives(options).error().message, "'07' is no drive of --clips " + folder.path() + ", there are: 00");
  options.sequences = {"00"};
  folder.file("00/poses.txt", poses(5));
  EXPECT_THAT(choose_drives(options).error().message, HasSubstr("there is no 000004.png, the image of the last of 5"));
  options.clips = folder / "full";
  options.sequences = {};
  EXPECT_THAT(choose_drives(options).error().message, HasSubstr("holds no NN/image_0"));
}

TEST(Routes, AreAllThereIsWithoutPoses) {
  DriveOptions options;
  options.frames = 20;
  const auto drives = choose_drives(options);
  ASSERT_TRUE(drives);
  ASSERT_GE(drives->size(), 5U);
  EXPECT_THAT(simulate_arguments(drives->front(), options),
              ElementsAre("simulate", "--route", "city", "--preset", "kitti", "--frames", "20"));
}

TEST(Routes, AWholeOneHasAsManyFramesAsItIsDriven) {
  DriveOptions options;
  options.sequences = {"straight"};
  const auto drives = choose_drives(options);
  ASSERT_TRUE(drives);
  // 1 km at 47 km/h and 10 Hz.
  EXPECT_NEAR(drives->front().frames, 1000.0 / (47.0 / 3.6) * 10.0, 10.0);
  options.sequences = {"circle"};
  EXPECT_THAT(choose_drives(options).error().message, HasSubstr("'circle' is no route, known: city"));
}

}  // namespace
}  // namespace groundscale
