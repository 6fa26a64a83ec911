#include "groundscale/experiments/image_statistics.hpp"

#include <cmath>
#include <filesystem>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/core/rng.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;

/// Even grey with a slight tilt and noise.
Image noisy(double level, double sd) {
  Rng rng(3);
  Image image(300, 200);
  for (int y = 0; y < image.height(); ++y) {
    for (int x = 0; x < image.width(); ++x) {
      const double grey = level + 0.02 * x + sd * rng.normal();
      image.data()[y * image.width() + x] = static_cast<std::uint8_t>(std::lround(grey));
    }
  }
  return image;
}

TEST(ImageStatistics, FindsNoiseBesideATilt) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "image_0");
  ASSERT_TRUE(write_image(folder / "image_0/000000.png", noisy(100.0, 2.0)));
  const auto statistics = image_statistics(folder.path(), 1);
  ASSERT_TRUE(statistics) << statistics.error().message;
  EXPECT_NEAR(statistics->mean, 103.0, 0.1);
  ASSERT_TRUE(statistics->noise[3]);
  // Rounding adds 1 / 12 to the variance; 2400 patches give their 5 % quantile to 2 %.
  EXPECT_NEAR(*statistics->noise[3], std::sqrt(4.0 + 1.0 / 12.0), 0.08);
  EXPECT_FALSE(statistics->noise[0]);
  EXPECT_EQ(statistics->bright_share, 0.0);
}

TEST(ImageStatistics, SaysWhichImageIsMissing) {
  const TempFolder folder;
  const auto statistics = image_statistics(folder.path(), 1);
  ASSERT_FALSE(statistics);
  EXPECT_THAT(statistics.error().message, testing::HasSubstr("image_0/000000.png"));
}

TEST(WritePair, PutsOneImageAboveTheOther) {
  const TempFolder folder;
  ASSERT_TRUE(write_image(folder / "a.png", noisy(50.0, 0.0)));
  ASSERT_TRUE(write_image(folder / "b.png", noisy(150.0, 0.0)));
  ASSERT_TRUE(write_pair(folder / "a.png", folder / "b.png", folder / "pair.png"));
  const auto pair = read_image(folder / "pair.png");
  ASSERT_TRUE(pair);
  EXPECT_EQ(pair->height(), 404);
  EXPECT_EQ(pair->at(0, 199), 50);
  EXPECT_EQ(pair->at(0, 201), 255);
  EXPECT_EQ(pair->at(0, 204), 150);
}

}  // namespace
}  // namespace groundscale
