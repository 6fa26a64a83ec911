#include "groundscale/io/image_file.hpp"

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "groundscale/io/files.hpp"
#include "groundscale/io/image_decoder_internal.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::ImageDecoder;
using internal::TempFolder;
using testing::HasSubstr;

/// Smooth enough for JPEG, busy enough to fill a few kilobytes.
cv::Mat pattern(int type) {
  cv::Mat mat(48, 64, type);
  const double top = mat.depth() == CV_16U ? 65535.0 : 255.0;
  for (int y = 0; y < mat.rows; ++y) {
    for (int x = 0; x < mat.cols; ++x) {
      const double value = top * (0.5 + 0.3 * std::sin(0.9 * x) + 0.2 * std::cos(0.7 * y + 0.1 * x));
      for (int c = 0; c < mat.channels(); ++c) {
        const int at = x * mat.channels() + c;
        if (mat.depth() == CV_16U) mat.ptr<std::uint16_t>(y)[at] = cv::saturate_cast<std::uint16_t>(value);
        if (mat.depth() == CV_8U) mat.ptr(y)[at] = cv::saturate_cast<std::uint8_t>(value * (c + 1) / mat.channels());
      }
    }
  }
  return mat;
}

std::string encoded(const std::string& ending, const cv::Mat& mat) {
  std::vector<unsigned char> bytes;
  EXPECT_TRUE(cv::imencode(ending, mat, bytes));
  return {bytes.begin(), bytes.end()};
}

std::string bytes_of(const Image& image) {
  return {reinterpret_cast<const char*>(image.data()), static_cast<std::size_t>(image.width()) * image.height()};
}

TEST(ImageFile, GreyEightBitReadsBackToTheSameBytes) {
  const TempFolder folder;
  Image image(5, 3);
  for (int k = 0; k < 15; ++k) image.data()[k] = static_cast<std::uint8_t>(17 * k);
  ASSERT_TRUE(write_image(folder / "image.png", image));
  const Result<Image> back = read_image(folder / "image.png");
  ASSERT_TRUE(back);
  EXPECT_EQ(back->width(), 5);
  EXPECT_EQ(back->height(), 3);
  EXPECT_EQ(bytes_of(*back), bytes_of(image));
}

TEST(ImageFile, AnUnknownEndingCanNotBeWritten) {
  const Result<void> written = write_image(testing::TempDir() + "image.nothing", Image(2, 2));
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kIo);
}

TEST(ImageDecoder, ColourBecomesLumaWhateverTheFormat) {
  cv::Mat colour(1, 3, CV_8UC3);
  colour.at<cv::Vec3b>(0, 0) = {255, 0, 0};  // blue
  colour.at<cv::Vec3b>(0, 1) = {0, 255, 0};
  colour.at<cv::Vec3b>(0, 2) = {0, 0, 255};
  for (const char* ending : {".png", ".bmp", ".ppm", ".tiff"}) {
    const Result<Image> image = ImageDecoder().decode(encoded(ending, colour));
    ASSERT_TRUE(image) << ending;
    EXPECT_NEAR(image->at(0, 0), 0.114 * 255, 0.51) << ending;
    EXPECT_NEAR(image->at(1, 0), 0.587 * 255, 0.51) << ending;
    EXPECT_NEAR(image->at(2, 0), 0.299 * 255, 0.51) << ending;
  }
}

TEST(ImageDecoder, SixteenBitUsesOneFactorFromTheFirstImagesBits) {
  struct Case {
    int highest;
    int full;
  };
  for (const Case& c : {Case{200, 255}, Case{1000, 1023}, Case{3000, 4095}, Case{10000, 16383}, Case{50000, 65535}}) {
    const int half = c.highest / 2;
    const int tenth = c.highest / 10;
    cv::Mat first(2, 2, CV_16U, cv::Scalar(half));
    first.at<std::uint16_t>(0, 0) = static_cast<std::uint16_t>(c.highest);
    ImageDecoder decoder;
    const Result<Image> image = decoder.decode(encoded(".png", first));
    ASSERT_TRUE(image);
    EXPECT_NEAR(image->at(0, 0), 255.0 * c.highest / c.full, 0.5);
    EXPECT_NEAR(image->at(1, 0), 255.0 * half / c.full, 0.5);
    // A darker and a brighter image later: the same factor, and white where it is too bright.
    const Result<Image> dark = decoder.decode(encoded(".png", cv::Mat(2, 2, CV_16U, cv::Scalar(tenth))));
    EXPECT_NEAR(dark->at(0, 0), 255.0 * tenth / c.full, 0.5);
    const Result<Image> bright = decoder.decode(encoded(".png", cv::Mat(2, 2, CV_16U, cv::Scalar(65535))));
    EXPECT_EQ(bright->at(0, 0), 255);
  }
}

TEST(ImageDecoder, SixteenBitColourIsReadAsWell) {
  const Result<Image> image = ImageDecoder().decode(encoded(".png", pattern(CV_16UC3)));
  ASSERT_TRUE(image);
  const Result<Image> grey = ImageDecoder().decode(encoded(".png", pattern(CV_16UC1)));
  ASSERT_TRUE(grey);
  for (int k = 0; k < 64 * 48; ++k) EXPECT_NEAR(image->data()[k], grey->data()[k], 1);  // one step of rounding
}

class WholeImages : public testing::TestWithParam<const char*> {};

TEST_P(WholeImages, AreReadAndTruncatedAtAnyPlaceTheyAreNot) {
  const std::string ending = GetParam();
  for (const int type : {CV_8UC1, CV_8UC3}) {
    if (ending == (type == CV_8UC1 ? ".ppm" : ".pgm")) continue;
    const std::string whole = encoded(ending, pattern(type));
    ImageDecoder decoder;
    ASSERT_TRUE(decoder.decode(whole));
    for (std::size_t length = 0; length < whole.size(); length += 1 + length / 16) {
      EXPECT_FALSE(decoder.decode(whole.substr(0, length))) << length << " of " << whole.size() << " bytes";
    }
    if (ending == ".tiff") continue;  // ends in padding
    EXPECT_FALSE(decoder.decode(whole.substr(0, whole.size() - 2)));
  }
}
INSTANTIATE_TEST_SUITE_P(Formats, WholeImages,
                         testing::Values(".png", ".jpg", ".bmp", ".pgm", ".ppm", ".tiff", ".webp"));

TEST(ImageDecoder, AJpegWithBytesAfterItsEndIsWhole) {
  EXPECT_TRUE(ImageDecoder().decode(encoded(".jpg", pattern(CV_8UC1)) + std::string(100, '\0')));
}

TEST(ImageDecoder, AnEndMarkerInsideAJpegsThumbnailIsNotItsEnd) {
  // An application segment (FF E1, length) that holds a whole small JPEG, as cameras write it.
  const std::string thumbnail = encoded(".jpg", cv::Mat(8, 8, CV_8U, cv::Scalar(9)));
  const std::size_t length = thumbnail.size() + 2;
  std::string segment = {'\xFF', '\xE1', static_cast<char>(length >> 8), static_cast<char>(length & 0xFF)};
  segment += thumbnail;
  std::string jpeg = encoded(".jpg", pattern(CV_8UC1));
  jpeg.insert(2, segment);
  EXPECT_TRUE(ImageDecoder().decode(jpeg));
  EXPECT_FALSE(ImageDecoder().decode(jpeg.substr(0, jpeg.size() - 200)));
}

TEST(ImageDecoder, FlippedBytesInAPngAreNoticedByItsChecksums) {
  const std::string whole = encoded(".png", pattern(CV_8UC1));
  for (std::size_t at = 45; at + 16 < whole.size(); at += whole.size() / 7) {
    std::string broken = whole;
    broken[at] = static_cast<char>(broken[at] ^ 0x5A);
    EXPECT_FALSE(ImageDecoder().decode(broken)) << "byte " << at << " of " << whole.size();
  }
}

TEST(ImageDecoder, GarbageIsAnErrorWithAReason) {
  const Result<Image> image = ImageDecoder().decode("this is no image");
  ASSERT_FALSE(image);
  EXPECT_THAT(image.error().message, HasSubstr("can't be decoded"));
}

TEST(ReadDepth, ReadsBackWhatIsWrittenToHalfAUnit) {
  const TempFolder folder;
  const std::vector<float> depths_m = {0.0F, 1.0F, 6.123F, 255.9F, 300.0F, 4.0F};
  ASSERT_TRUE(write_text(folder / "depth.png", *encode_depth(depths_m, 3, 2)));
  const auto read = read_depth(folder / "depth.png");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->width, 3);
  EXPECT_EQ(read->height, 2);
  ASSERT_EQ(read->depths_m.size(), depths_m.size());
  for (std::size_t k = 0; k < depths_m.size(); ++k) {
    const bool none = depths_m[k] > 255.99F;
    EXPECT_NEAR(read->depths_m[k], none ? 0.0F : depths_m[k], 1.0 / 512.0) << k;
  }
}

TEST(ReadDepth, RefusesWhatIsNoDepthImage) {
  const TempFolder folder;
  ASSERT_TRUE(write_image(folder / "grey.png", Image(4, 3)));
  ASSERT_TRUE(write_text(folder / "empty.png", ""));
  ASSERT_TRUE(write_text(folder / "words.png", "no image"));
  for (const char* name : {"grey.png", "empty.png", "words.png", "missing.png"}) {
    const auto read = read_depth(folder / name);
    ASSERT_FALSE(read) << name;
    EXPECT_THAT(read.error().message, testing::HasSubstr(name));
  }
}

}  // namespace
}  // namespace groundscale
