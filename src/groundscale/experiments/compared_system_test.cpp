#include "groundscale/experiments/compared_system.hpp"

#include <cmath>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/geometry/so3.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

std::string refusal(const std::vector<std::string>& texts) {
  const auto parsed = parse_compared(texts, {"none", "filtered"});
  return parsed ? "none" : parsed.error().message;
}

/// Along an arc that climbs: no symmetry.
Trajectory arc(int rows) {
  Trajectory trajectory;
  for (int k = 0; k < rows; ++k) {
    const double angle = 0.1 * k;
    trajectory.world_from_cam.push_back({exp_so3({0.0, angle, 0.0}), {std::cos(angle), 0.05 * k, std::sin(angle)}});
  }
  return trajectory;
}

std::string kitti_rows(const Trajectory& trajectory) {
  std::string text;
  for (const RigidTransform& pose : trajectory.world_from_cam) text += kitti_row(pose) + "\n";
  return text;
}

TEST(ParseCompared, NameAlignmentAndPoses) {
  const auto systems = parse_compared({"ORB-SLAM@sim3=a/b=c", "learned=poses"}, {});
  ASSERT_TRUE(systems) << systems.error().message;
  EXPECT_EQ(systems->at(0).name, "ORB-SLAM");
  EXPECT_TRUE(systems->at(0).sim3);
  EXPECT_EQ(systems->at(0).poses, "a/b=c") << "the first '=' divides";
  EXPECT_EQ(systems->at(0).label(), "ORB-SLAM (aligned by sim3)");
  EXPECT_FALSE(systems->at(1).sim3);
  EXPECT_EQ(systems->at(1).label(), "learned");
}

TEST(ParseCompared, TheSameSystemWithAndWithoutAlignmentIsTwo) { EXPECT_TRUE(parse_compared({"a@sim3=x", "a=x"}, {})); }

TEST(ParseCompared, WhatIsWrongIsSaid) {
  for (const char* text : {"poses.txt", "=poses.txt", "name=", ""}) {
    EXPECT_THAT(refusal({text}), HasSubstr("must be NAME=POSES or NAME@sim3=POSES")) << text;
  }
  for (const char* text : {"a@se3=x", "@sim3=x", "a@=x", "a@b@sim3=x"}) {
    EXPECT_THAT(refusal({text}), HasSubstr("may end in @sim3")) << text;
  }
  EXPECT_EQ(refusal({"a=x", "a=y"}), "--compare: 'a' is there twice");
  EXPECT_THAT(refusal({"filtered=x"}), HasSubstr("'filtered' has a meaning here"));
  EXPECT_THAT(refusal({"a\nb=x"}), HasSubstr("must be printable"));
}

TEST(ComparedFile, IsTheOneOfTheSequence) {
  const TempFolder folder;
  folder.file("09.txt", "");
  folder.file("10/run-10.txt", "");
  const ComparedSystem in_folder{.name = "a", .poses = folder.path()};
  EXPECT_EQ(compared_file(in_folder, "09"), folder / "09.txt");
  EXPECT_EQ(compared_file(in_folder, "10"), "");
  const ComparedSystem pattern{.name = "a", .poses = folder / "{}/run-{}.txt"};
  EXPECT_EQ(compared_file(pattern, "10"), folder / "10/run-10.txt");
  EXPECT_EQ(compared_file(pattern, "09"), "");
  const ComparedSystem file{.name = "a", .poses = folder / "09.txt"};
  EXPECT_EQ(compared_file(file, "city"), folder / "09.txt");
}

TEST(CheckCompared, FilesAreLookedAtBeforeTheWork) {
  const TempFolder folder;
  folder.file("06.txt", kitti_rows(arc(5)));
  folder.file("tum/06.txt", "0 0 0 0 0 0 0 1\n1 0 0 1 0 0 0 1\n");
  const std::vector<DriveChoice> drives = {{.name = "06", .frames = 5}, {.name = "07", .frames = 5}};
  const auto check = [&](const std::string& poses, const std::vector<DriveChoice>& of) {
    const auto checked = check_compared({{.name = "a", .poses = poses}}, of);
    return checked ? std::string("none") : checked.error().message;
  };
  EXPECT_EQ(check(folder.path(), drives), "none") << "a system needn't have all sequences";
  EXPECT_EQ(check(folder / "06.txt", {drives[0]}), "none");
  EXPECT_THAT(check(folder / "06.txt", drives), HasSubstr("is one file, but there are 2 drives"));
  EXPECT_THAT(check(folder.path(), {{.name = "06", .frames = 6}}), HasSubstr("5 rows, but the drive has 6 frames"));
  EXPECT_THAT(check(folder / "tum", drives), HasSubstr("has TUM rows"));
  EXPECT_THAT(check(folder.path(), {drives[1]}), HasSubstr("holds nothing for any drive, 07.txt for example"));
  EXPECT_THAT(check(folder / "nowhere.txt", {drives[0]}), HasSubstr("nowhere.txt"));
}

TEST(ReadCompared, HasTheDrivesRowsAndTheTruthsScaleOnlyWhereAskedFor) {
  const TempFolder folder;
  const Trajectory truth = arc(8);
  // The truth in another world at a third of its size, and two rows longer.
  Trajectory small = arc(10);
  const RigidTransform other{exp_so3({0.3, -0.2, 0.5}), {4.0, 5.0, 6.0}};
  for (RigidTransform& pose : small.world_from_cam) {
    pose.translation /= 3.0;
    pose = other * pose;
  }
  const std::string file = folder.file("06.txt", kitti_rows(small));
  const auto aligned = read_compared({.name = "a", .sim3 = true, .poses = file}, "06", truth);
  ASSERT_TRUE(aligned) << aligned.error().message;
  EXPECT_EQ(aligned->path.size(), 8);
  EXPECT_EQ(aligned->rows_in_file, 10);
  for (std::size_t k = 0; k < 8; ++k) {
    const RigidTransform& pose = aligned->path.world_from_cam[k];
    EXPECT_LT((pose.translation - truth.world_from_cam[k].translation).norm(), 1e-9);
    EXPECT_LT((pose.rotation - truth.world_from_cam[k].rotation).norm(), 1e-9);
  }
  const auto as_it_is = read_compared({.name = "a", .poses = file}, "06", truth);
  ASSERT_TRUE(as_it_is);
  const auto& poses = as_it_is->path.world_from_cam;
  EXPECT_NEAR((poses[1].translation - poses[0].translation).norm(),
              (truth.world_from_cam[1].translation - truth.world_from_cam[0].translation).norm() / 3.0, 1e-9);
}

}  // namespace
}  // namespace groundscale
