#include "groundscale/io/trajectory_file.hpp"

#include <cmath>
#include <numbers>
#include <string>

#include <Eigen/Geometry>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

constexpr const char* kUnitRow = "1 0 0 0 0 1 0 0 0 0 1 0\n";

Trajectory random_drive(bool with_times) {
  Rng rng(3);
  Trajectory drive;
  for (int k = 0; k < 20; ++k) {
    const Eigen::Vector3d turn(rng.normal(), rng.normal(), rng.normal());
    drive.world_from_cam.push_back({Eigen::AngleAxisd(turn.norm(), turn.normalized()).toRotationMatrix(),
                                    Eigen::Vector3d(rng.normal(), rng.normal(), 1e3 * rng.normal())});
    if (with_times) drive.times_s.push_back(1e9 + 0.1 * k);
  }
  return drive;
}

std::string error_of(const std::string& content) {
  const TempFolder folder;
  const Result<Trajectory> trajectory = read_trajectory(folder.file("poses.txt", content));
  if (trajectory) return "no error";
  EXPECT_EQ(trajectory.error().code, ErrorCode::kBadInput);
  return trajectory.error().message;
}

TEST(TrajectoryFile, KittiRowsReadBackToTheSameBits) {
  const TempFolder folder;
  const Trajectory drive = random_drive(false);
  ASSERT_TRUE(write_kitti(folder / "drive.kitti", drive));
  const Result<Trajectory> back = read_trajectory(folder / "drive.kitti");
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), drive.size());
  EXPECT_FALSE(back->has_times());
  for (std::size_t k = 0; k < drive.world_from_cam.size(); ++k) {
    EXPECT_EQ(back->world_from_cam[k].rotation, drive.world_from_cam[k].rotation);
    EXPECT_EQ(back->world_from_cam[k].translation, drive.world_from_cam[k].translation);
  }
}

TEST(TrajectoryFile, TumRowsReadBackTimesAndPlacesToTheSameBitsAndRotationsToRounding) {
  const TempFolder folder;
  const Trajectory drive = random_drive(true);
  ASSERT_TRUE(write_tum(folder / "drive.tum", drive));
  const Result<Trajectory> back = read_trajectory(folder / "drive.tum");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->times_s, drive.times_s);
  for (std::size_t k = 0; k < drive.world_from_cam.size(); ++k) {
    EXPECT_EQ(back->world_from_cam[k].translation, drive.world_from_cam[k].translation);
    EXPECT_LT((back->world_from_cam[k].rotation - drive.world_from_cam[k].rotation).norm(), 1e-14);
  }
}

TEST(TrajectoryFile, TumQuaternionIsXyzwOfWorldFromCam) {
  // A quarter turn to the right: the camera's z axis points along the world's x axis.
  const double half = std::sqrt(0.5);
  const Eigen::Matrix3d right = Eigen::AngleAxisd(0.5 * std::numbers::pi, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const TempFolder folder;
  const auto read =
      read_trajectory(folder.file("right.tum", "0.5 1 2 3 0 " + std::to_string(half) + " 0 " + std::to_string(half)));
  ASSERT_TRUE(read);
  EXPECT_LT((read->world_from_cam[0].rotation - right).norm(), 1e-6);
  EXPECT_LT((read->world_from_cam[0].rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(), 1e-6);
  EXPECT_EQ(read->world_from_cam[0].translation, Eigen::Vector3d(1, 2, 3));
}

TEST(TrajectoryFile, CommentsEmptyLinesAndWindowsLineEndsAreSkipped) {
  const TempFolder folder;
  const auto read = read_trajectory(
      folder.file("poses.txt", "\xEF\xBB\xBF# poses\r\n\r\n1 0 0 0 0 1 0 0 0 0 1 0\r\n  \n1 0 0 4 0 1 0 5 0 0 1 6"));
  ASSERT_TRUE(read);
  ASSERT_EQ(read->size(), 2);
  EXPECT_EQ(read->world_from_cam[1].translation, Eigen::Vector3d(4, 5, 6));
}

TEST(TrajectoryFile, ErrorsNameFileAndLineAndWhatIsWrong) {
  const std::string unit = kUnitRow;
  EXPECT_THAT(error_of(unit + "1 0 0 0 0 1 0 0 0 0 1\n"), HasSubstr("poses.txt:2: 11 values"));
  EXPECT_THAT(error_of("1 2 3\n"), HasSubstr("poses.txt:1: 3 values"));
  EXPECT_THAT(error_of(unit + unit + "1 0 0 nan 0 1 0 0 0 0 1 0\n"), HasSubstr("poses.txt:3: value 4 is 'nan'"));
  EXPECT_THAT(error_of("1 0 0 inf 0 1 0 0 0 0 1 0\n"), HasSubstr("'inf'"));
  EXPECT_THAT(error_of("1 0 0 1e999 0 1 0 0 0 0 1 0\n"), HasSubstr("'1e999'"));
  EXPECT_THAT(error_of("1 0 0 1,5 0 1 0 0 0 0 1 0\n"), HasSubstr("'1,5'"));
  EXPECT_THAT(error_of("2 0 0 0 0 1 0 0 0 0 1 0\n"), HasSubstr("isn't a rotation"));
  EXPECT_THAT(error_of("1 0 0 0 0 1 0 0 0 0 -1 0\n"), HasSubstr("isn't a rotation"));  // a mirror
  EXPECT_THAT(error_of("0 0 0 0 0 0 0 2\n"), HasSubstr("norm is 2"));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 1\n0.5 0 0 0 0 0 0 1\n"), HasSubstr("poses.txt:2: time falls from 1 to 0.5 s"));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 1\n" + unit), HasSubstr("poses.txt:2: 12 values"));
  EXPECT_THAT(error_of(""), HasSubstr("holds no pose"));
  EXPECT_THAT(error_of("# nothing\n"), HasSubstr("holds no pose"));
}

TEST(TrajectoryFile, AMissingFileIsBadInputThatNamesIt) {
  const auto read = read_trajectory("/no/such/file.txt");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(read.error().message, HasSubstr("/no/such/file.txt: can't be opened: No such file"));
}

}  // namespace
}  // namespace groundscale
