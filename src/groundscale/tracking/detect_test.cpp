#include "groundscale/tracking/detect.hpp"

#include <cmath>
#include <map>
#include <utility>

#include <gtest/gtest.h>

#include "groundscale/tracking/test_texture_internal.hpp"

namespace groundscale {
namespace {

constexpr int kWidth = 160;
constexpr int kHeight = 112;

Image texture() {
  return TestTexture(2).render(kWidth, kHeight, [](int x, int y) { return Eigen::Vector2d(x, y); });
}

/// Corners in each cell of the grid that begins at the border.
std::map<std::pair<int, int>, int> count_by_cell(const std::vector<Eigen::Vector2d>& corners,
                                                 const DetectOptions& options) {
  std::map<std::pair<int, int>, int> counts;
  for (const Eigen::Vector2d& corner : corners) {
    const auto column = static_cast<int>(std::floor((corner.x() - options.border_px) / options.cell_px));
    const auto row = static_cast<int>(std::floor((corner.y() - options.border_px) / options.cell_px));
    ++counts[{column, row}];
  }
  return counts;
}

class DetectCorners : public testing::TestWithParam<int> {
 protected:
  DetectOptions options_{.cell_px = 24, .min_gradient = 2.0, .reduction = GetParam(), .border_px = 8};
};

TEST_P(DetectCorners, CoversATexturedImageWithOneInEachCell) {
  const auto corners = detect_corners(texture(), {}, {}, options_);
  const auto counts = count_by_cell(corners, options_);
  EXPECT_EQ(counts.size(), 6U * 4U);  // 144 x 96 px within the border
  for (const auto& [cell, count] : counts) EXPECT_EQ(count, 1) << cell.first << ", " << cell.second;
}

TEST_P(DetectCorners, LeavesOutCellsThatAreTaken) {
  const auto corners = detect_corners(texture(), {}, {{20.0, 20.0}, {90.0, 60.0}, {-5.0, 500.0}}, options_);
  const auto counts = count_by_cell(corners, options_);
  EXPECT_EQ(counts.size(), 6U * 4U - 2U);
  EXPECT_FALSE(counts.contains({0, 0}));
  EXPECT_FALSE(counts.contains({3, 2}));
}

TEST_P(DetectCorners, StaysWithinTheMask) {
  Image mask(kWidth, kHeight);
  // A triangle, so that its bounding rectangle isn't all allowed.
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < y; ++x) mask.data()[y * kWidth + x] = 255;
  }
  const auto corners = detect_corners(texture(), mask, {}, options_);
  EXPECT_GT(corners.size(), 5U);
  for (const Eigen::Vector2d& corner : corners) {
    // On half the size the mask is asked at the upper left of the four pixels that a corner stands for.
    EXPECT_NE(mask.at(static_cast<int>(corner.x()), static_cast<int>(corner.y())), 0) << corner.transpose();
  }
}

TEST_P(DetectCorners, FindsTheCornersOfASquareButNotItsEdges) {
  Image image(kWidth, kHeight);
  for (int y = 40; y < 72; ++y) {
    for (int x = 50; x < 110; ++x) image.data()[y * kWidth + x] = 200;
  }
  options_.cell_px = 8;
  const auto corners = detect_corners(image, {}, {}, options_);
  ASSERT_GE(corners.size(), 4U);
  for (const Eigen::Vector2d& corner : corners) {
    const double dx = std::min(std::abs(corner.x() - 49.5), std::abs(corner.x() - 109.5));
    const double dy = std::min(std::abs(corner.y() - 39.5), std::abs(corner.y() - 71.5));
    // Farther away the window of 5 px and Sobel's 3 px see one edge only.
    EXPECT_LE(std::max(dx, dy), 4.0 * options_.reduction) << corner.transpose();
  }
}

TEST_P(DetectCorners, FindsNothingInAFlatImageOrATinyOne) {
  EXPECT_TRUE(detect_corners(Image(kWidth, kHeight), {}, {}, options_).empty());
  EXPECT_TRUE(detect_corners(Image(10, 10), {}, {}, options_).empty());
}

INSTANTIATE_TEST_SUITE_P(Reductions, DetectCorners, testing::Values(1, 2));

}  // namespace
}  // namespace groundscale
