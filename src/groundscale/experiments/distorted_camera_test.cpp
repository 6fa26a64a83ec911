#include "groundscale/experiments/distorted_camera.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

TEST(DistortedCameras, DifferInDistortionAlone) {
  const TempFolder folder;
  const auto cameras = write_distorted_cameras("kitti", 0.015, folder / "cameras");
  ASSERT_TRUE(cameras) << cameras.error().message;
  const auto rendered = read_camera_file(cameras->rendered, 0, 0);
  const auto believed = read_camera_file(cameras->believed, 0, 0);
  ASSERT_TRUE(rendered && believed);
  const auto& with = dynamic_cast<const PinholeCamera&>(*rendered->camera).parameters();
  const auto& without = dynamic_cast<const PinholeCamera&>(*believed->camera).parameters();
  EXPECT_EQ(with.k1, 0.015);
  EXPECT_EQ(without.k1, 0.0);
  EXPECT_EQ(with.fx, without.fx);
  EXPECT_EQ(with.cy, without.cy);
  EXPECT_FALSE(rendered->height_m.has_value()) << "the preset's mounting stays";
  EXPECT_EQ(believed->height_m, 1.65);
}

TEST(DistortedCameras, WantAPinholeAndOneRayAPixel) {
  EXPECT_TRUE(check_distortion("kitti", 0.015));
  EXPECT_THAT(check_distortion("campus", 0.015).error().message,
              HasSubstr("the camera of preset 'campus' is no pinhole"));
  EXPECT_THAT(check_distortion("kitti", -3.0).error().message, HasSubstr("--distortion -3"));
}

}  // namespace
}  // namespace groundscale
