#include "groundscale/calibration/residual_map.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "groundscale/mapping/test_tracks_internal.hpp"

namespace groundscale {
namespace {

using internal::drive_along;
using internal::off;
using internal::true_pinhole;

constexpr int kEnough = 50;

std::vector<RigidTransform> poses_of(const DriveTracks& drive) {
  std::vector<RigidTransform> poses;
  for (const DriveTracks::View& view : drive.views) poses.push_back(view.cam_from_world);
  return poses;
}

ResidualMap map_of(const DriveTracks& drive, const Camera& camera, int columns = 16) {
  return residual_map(drive, poses_of(drive), camera, {}, columns);
}

TEST(ResidualMap, HasSquareCellsThatCoverTheImage) {
  Rng rng(1);
  const ResidualMap map = map_of(drive_along({.points = 100}, *true_pinhole(), rng), *true_pinhole());
  EXPECT_EQ(map.columns, 16);
  EXPECT_EQ(map.rows, 5);  // 376 px of 77.6 px each
  EXPECT_EQ(map.cells.size(), 80U);
  EXPECT_EQ(map.width, 1241);
  EXPECT_EQ(map.height, 376);
}

TEST(ResidualMap, CountsEverySightOfExactTracksInItsOwnCell) {
  Rng rng(2);
  const DriveTracks drive = drive_along({.noise_px = 0.0, .points = 200}, *true_pinhole(), rng);
  // Without a bound on parallax every track has a point.
  BatchOptions options;
  options.min_parallax_px = 1e-3;
  const ResidualMap map = residual_map(drive, poses_of(drive), *true_pinhole(), options, 4);
  ASSERT_EQ(map.rows, 1);
  int counts[4] = {};
  for (const DriveTracks::Track& track : drive.tracks) {
    for (const DriveTracks::Sight& sight : track.sights) {
      ++counts[static_cast<int>(std::floor((sight.pixel.x() + 0.5) / (1241.0 / 4.0)))];
    }
  }
  for (int column = 0; column < 4; ++column) {
    EXPECT_EQ(map.cell(column, 0).count, counts[column]);
    EXPECT_LT(map.cell(column, 0).mean_px().norm(), 1e-3);
  }
}

TEST(ResidualMap, NoiseIsNoPatternAWrongCameraIs) {
  Rng rng(3);
  const DriveTracks drive = drive_along({.points = 3000}, *true_pinhole(), rng);
  const double right_px = map_of(drive, *true_pinhole()).pattern_px(kEnough);
  const double wrong_px = map_of(drive, *off(true_pinhole(), 0.03, 0.0)).pattern_px(kEnough);
  // Noise of 0.3 px in each coordinate leaves 0.42 / sqrt(count), of some 300 to a cell.
  EXPECT_LT(right_px, 0.04);
  EXPECT_GT(wrong_px, 2.0 * right_px);
}

/// Seen points shifted in a stretch of the image, where tracks pass through: the mean there is that shift turned round,
/// less what the points give way to.
TEST(ResidualMap, IsProjectedLessSeen) {
  Rng rng(4);
  DriveTracks drive = drive_along({.turn_rad = 0.0, .noise_px = 0.0, .points = 1500}, *true_pinhole(), rng);
  for (DriveTracks::Track& track : drive.tracks) {
    for (DriveTracks::Sight& sight : track.sights) {
      if (sight.pixel.x() < 200.0) sight.pixel.y() += 0.4;
    }
  }
  const ResidualMap map = map_of(drive, *true_pinhole());
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  int count = 0;
  for (int row = 0; row < map.rows; ++row) {
    sum += map.cell(1, row).sum_px;
    count += map.cell(1, row).count;
  }
  ASSERT_GT(count, 100);
  EXPECT_LT(sum.y() / count, -0.05);
  EXPECT_GT(sum.y() / count, -0.4);
}

TEST(ResidualMap, LeavesOutSightsThatAreFarOff) {
  Rng rng(5);
  DriveTracks drive = drive_along({.noise_px = 0.0, .points = 400}, *true_pinhole(), rng);
  const int all = map_of(drive, *true_pinhole()).count();
  int spoilt = 0;
  BatchOptions options;
  options.max_error_px = 100.0;  // so that the tracks stay
  for (DriveTracks::Track& track : drive.tracks) {
    if (track.sights.size() < 15) continue;
    track.sights[7].pixel.y() += track.sights[7].pixel.y() < 180.0 ? 8.0 : -8.0;
    ++spoilt;
  }
  ASSERT_GT(spoilt, 30);
  const ResidualMap map = residual_map(drive, poses_of(drive), *true_pinhole(), options);
  EXPECT_LE(map.count(), all - spoilt / 2);
  for (const ResidualMap::Cell& cell : map.cells) EXPECT_LT(cell.mean_px().norm(), 0.5);
}

TEST(ResidualMap, OfTwoDrivesIsThatOfAllTheirTracks) {
  Rng rng(6);
  const DriveTracks drive = drive_along({.points = 300}, *true_pinhole(), rng);
  DriveTracks first = drive;
  DriveTracks second = drive;
  std::erase_if(first.tracks, [](const DriveTracks::Track& track) { return track.id % 2 == 0; });
  std::erase_if(second.tracks, [](const DriveTracks::Track& track) { return track.id % 2 == 1; });
  const ResidualMap whole = map_of(drive, *true_pinhole());
  ResidualMap merged = map_of(first, *true_pinhole());
  merged.merge(map_of(second, *true_pinhole()));
  EXPECT_EQ(merged.count(), whole.count());
  for (std::size_t k = 0; k < whole.cells.size(); ++k) {
    EXPECT_EQ(merged.cells[k].count, whole.cells[k].count);
    EXPECT_LT((merged.cells[k].mean_px() - whole.cells[k].mean_px()).norm(), 1e-9);
  }
}

TEST(ResidualMap, OfNoTracksIsEmpty) {
  const ResidualMap map = residual_map({}, {}, *true_pinhole(), {});
  EXPECT_EQ(map.count(), 0);
  EXPECT_TRUE(std::isnan(map.pattern_px(1)));
  EXPECT_EQ(map.cell(3, 2).mean_px(), Eigen::Vector2d::Zero());
}

}  // namespace
}  // namespace groundscale
