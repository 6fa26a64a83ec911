#include "groundscale/experiments/path_plots.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

using testing::ElementsAre;
using testing::Optional;

/// Straight ahead along the world's x, looking that way: 1 m a row.
Trajectory along_x(int rows) {
  Trajectory trajectory;
  for (int k = 0; k < rows; ++k) {
    RigidTransform pose;
    pose.rotation << 0, 0, 1, 0, 1, 0, -1, 0, 0;
    pose.translation = {5.0 + k, 2.0, 3.0};
    trajectory.world_from_cam.push_back(pose);
  }
  return trajectory;
}

TEST(TrajectoryPlot, BeginsWhereItsFirstPoseLooks) {
  const Plot plot = trajectory_plot("06", {{{"truth", "truth"}, from_first_pose(along_x(3))}});
  EXPECT_EQ(plot.name, "trajectory-06");
  EXPECT_THAT(plot.columns, ElementsAre("truth_x_m", "truth_z_m"));
  ASSERT_EQ(plot.rows.size(), 3U);
  EXPECT_THAT(plot.rows[0], ElementsAre(Optional(0.0), Optional(0.0)));
  EXPECT_THAT(plot.rows[2], ElementsAre(Optional(0.0), Optional(2.0)));
  EXPECT_TRUE(plot.equal_axes);
}

TEST(LengthPlot, HasARowForEachLengthThatSomebodyHas) {
  const SegmentErrors some{.segments = 3, .t_rel = 0.02, .r_rel_rad_per_m = 1e-3 * std::numbers::pi / 180.0};
  const std::vector<PlottedErrors> errors = {{{"none", "none"}, {{100.0, some}, {200.0, {}}, {300.0, {}}}},
                                             {{"filtered", "filtered"}, {{100.0, {}}, {200.0, some}, {300.0, {}}}}};
  const Plot translation = length_plot("06", PathError::kTranslation, errors);
  EXPECT_EQ(translation.name, "t_rel-06");
  EXPECT_THAT(translation.columns, ElementsAre("length_m", "none", "filtered"));
  ASSERT_EQ(translation.rows.size(), 2U);
  EXPECT_THAT(translation.rows[0], ElementsAre(Optional(100.0), Optional(2.0), std::nullopt));
  const Plot rotation = length_plot("06", PathError::kRotation, errors);
  EXPECT_EQ(rotation.name, "r_rel-06");
  EXPECT_NEAR(rotation.rows[1][2].value(), 0.1, 1e-12);  // 1e-3 deg/m
}

}  // namespace
}  // namespace groundscale
