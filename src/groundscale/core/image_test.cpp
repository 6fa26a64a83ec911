#include "groundscale/core/image.hpp"

#include <cstdint>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

TEST(Image, IsEmptyUntilItHasASize) {
  const Image none;
  EXPECT_TRUE(none.empty());
  EXPECT_EQ(none.width(), 0);
  EXPECT_EQ(none.height(), 0);

  const Image image(3, 2);
  EXPECT_FALSE(image.empty());
  EXPECT_EQ(image.width(), 3);
  EXPECT_EQ(image.height(), 2);
}

TEST(Image, StartsBlackAndKeepsItsRowsWithoutGaps) {
  Image image(3, 2);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(image.data()[k], 0);
  for (int k = 0; k < 6; ++k) image.data()[k] = static_cast<std::uint8_t>(10 + k);
  EXPECT_EQ(image.at(0, 0), 10);
  EXPECT_EQ(image.at(2, 0), 12);
  EXPECT_EQ(image.at(0, 1), 13);
  EXPECT_EQ(image.at(2, 1), 15);
}

TEST(Image, CopiesShareTheirPixels) {
  Image image(1, 1);
  const Image copy = image;
  image.data()[0] = 7;
  EXPECT_EQ(copy.at(0, 0), 7);
  EXPECT_EQ(copy.data(), image.data());
}

TEST(ImageDeathTest, APixelOutsideOrASizeWithoutPixelsEndsTheProgramAndNamesThePlace) {
  const Image image(3, 2);
  EXPECT_DEATH((void)image.at(3, 0), "image\\.hpp:[0-9]+: at: pixel outside the image \\(condition: ");
  EXPECT_DEATH((void)image.at(0, 2), "pixel outside the image");
  EXPECT_DEATH((void)image.at(-1, 0), "pixel outside the image");
  EXPECT_DEATH(Image(0, 5), "an image has at least one pixel");
  EXPECT_DEATH(Image(5, -1), "an image has at least one pixel");
}

}  // namespace
}  // namespace groundscale
