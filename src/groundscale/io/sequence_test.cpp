#include "groundscale/io/sequence.hpp"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/decode_ahead_internal.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/image_folder_internal.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// An image whose first pixel tells which one it is.
Image numbered_image(int number, int width = 32, int height = 16) {
  Image image(width, height);
  for (int k = 0; k < width * height; ++k) image.data()[k] = static_cast<std::uint8_t>(k * 7 + k / 5);
  image.data()[0] = static_cast<std::uint8_t>(number);
  return image;
}

void write_images(const std::string& folder, int count) {
  std::filesystem::create_directories(folder);
  for (int k = 0; k < count; ++k) {
    ASSERT_TRUE(write_image(folder + "/img" + std::to_string(k) + ".png", numbered_image(k)));
  }
}

std::vector<Frame> all_frames(Sequence& sequence) {
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = sequence.next()) frames.push_back(*frame);
  return frames;
}

std::string error_of(const SequenceRequest& request) {
  const auto sequence = open_sequence(request, false);
  if (sequence) return "no error";
  EXPECT_EQ(sequence.error().code, ErrorCode::kBadInput);
  return sequence.error().message;
}

TEST(NaturalOrder, NumbersInNamesCountAsNumbers) {
  std::vector<std::string> names = {"img10.png", "img2.png", "img1.png", "a.png", "img02.png", "img2b.png", "img.png"};
  std::sort(names.begin(), names.end(), internal::natural_less);
  EXPECT_THAT(names, ElementsAre("a.png", "img.png", "img1.png", "img02.png", "img2.png", "img2b.png", "img10.png"));
}

TEST(NaturalOrder, IsTotalAlsoForNumbersBeyondAnyInteger) {
  EXPECT_TRUE(internal::natural_less("99999999999999999999999998", "99999999999999999999999999"));
  EXPECT_FALSE(internal::natural_less("99999999999999999999999999", "99999999999999999999999998"));
  EXPECT_FALSE(internal::natural_less("img2", "img2"));
  EXPECT_NE(internal::natural_less("img02", "img2"), internal::natural_less("img2", "img02"));
}

TEST(ImageFolder, FramesComeInNaturalOrderAtTenHertz) {
  const TempFolder folder;
  write_images(folder.path(), 12);
  const auto sequence = open_sequence({.source = folder.path()}, false);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_EQ((*sequence)->frame_count(), 12);
  EXPECT_EQ((*sequence)->width(), 32);
  EXPECT_EQ((*sequence)->height(), 16);
  EXPECT_FALSE((*sequence)->has_times());
  EXPECT_FALSE((*sequence)->kitti_image());
  EXPECT_EQ((*sequence)->calibration_path(), "");
  const std::vector<Frame> frames = all_frames(**sequence);
  ASSERT_EQ(frames.size(), 12U);
  for (int k = 0; k < 12; ++k) {
    EXPECT_EQ(frames[k].index, k);
    EXPECT_EQ(frames[k].image.at(0, 0), k);
    EXPECT_DOUBLE_EQ(frames[k].time_s, 0.1 * k);
    EXPECT_THAT(frames[k].problem, IsEmpty());
  }
  EXPECT_FALSE((*sequence)->next());
  EXPECT_THAT((*sequence)->warnings(), IsEmpty());
}

TEST(ImageFolder, StartAndFramesCutAndKeepTheIndices) {
  const TempFolder folder;
  write_images(folder.path(), 6);
  const auto sequence = open_sequence({.source = folder.path(), .kitti_image = {}, .start = 2, .frames = 3}, false);
  ASSERT_TRUE(sequence);
  EXPECT_EQ((*sequence)->first_frame(), 2);
  EXPECT_EQ((*sequence)->frame_count(), 3);
  EXPECT_DOUBLE_EQ((*sequence)->time_span().value().first_s, 0.2);
  EXPECT_DOUBLE_EQ((*sequence)->time_span().value().last_s, 0.4);
  const std::vector<Frame> frames = all_frames(**sequence);
  ASSERT_EQ(frames.size(), 3U);
  EXPECT_EQ(frames[0].index, 2);
  EXPECT_EQ(frames[0].image.at(0, 0), 2);
  EXPECT_DOUBLE_EQ(frames[0].time_s, 0.2);
}

TEST(ImageFolder, TimesAreReadAndTheirRowsCounted) {
  const TempFolder folder;
  write_images(folder.path(), 3);
  folder.file("times.txt", "0.5\r\n0.5\r\n0.75\r\n");
  const auto sequence = open_sequence({.source = folder.path()}, false);
  ASSERT_TRUE(sequence) << sequence.error().message;
  EXPECT_TRUE((*sequence)->has_times());
  EXPECT_EQ(all_frames(**sequence)[2].time_s, 0.75);

  folder.file("times.txt", "0\n1\n");
  EXPECT_THAT(error_of({.source = folder.path()}), HasSubstr("times.txt: 2 rows, but there are 3 images"));
  folder.file("times.txt", "0\n1\n0.5\n");
  EXPECT_THAT(error_of({.source = folder.path()}), HasSubstr("times.txt:3: time falls from 1 to 0.5 s"));
  folder.file("times.txt", "0\nsoon\n2\n");
  EXPECT_THAT(error_of({.source = folder.path()}), HasSubstr("times.txt:2: 'soon' must be one number"));
}

TEST(ImageFolder, ATruncatedOrOddlySizedImageIsAFrameWithoutImageAndWithTheReason) {
  const TempFolder folder;
  write_images(folder.path(), 5);
  const std::string whole = *read_text(folder / "img1.png");
  folder.file("img1.png", whole.substr(0, whole.size() - 20));
  folder.file("img2.png", "not an image");
  ASSERT_TRUE(write_image(folder / "img3.png", numbered_image(3, 30, 16)));
  const auto sequence = open_sequence({.source = folder.path()}, false);
  ASSERT_TRUE(sequence);
  const std::vector<Frame> frames = all_frames(**sequence);
  ASSERT_EQ(frames.size(), 5U);
  EXPECT_TRUE(frames[1].image.empty());
  EXPECT_THAT(frames[1].problem, HasSubstr("img1.png: truncated: the PNG's end is missing"));
  EXPECT_TRUE(frames[2].image.empty());
  EXPECT_THAT(frames[2].problem, HasSubstr("img2.png: can't be decoded"));
  EXPECT_TRUE(frames[3].image.empty());
  EXPECT_THAT(frames[3].problem, HasSubstr("img3.png: is 30x16, the first image is 32x16"));
  EXPECT_EQ(frames[4].image.at(0, 0), 4);
  EXPECT_THAT((*sequence)->warnings(), IsEmpty()) << "what is wrong with a frame comes with the frame";
}

TEST(ImageFolder, WhatCanNotBeOpenedSaysWhy) {
  const TempFolder folder;
  EXPECT_THAT(error_of({.source = folder / "none"}), HasSubstr("none: no such folder or file"));
  EXPECT_THAT(error_of({.source = folder.path()}), HasSubstr("holds no images"));
  write_images(folder.path(), 3);
  EXPECT_THAT(error_of({.source = folder.path(), .kitti_image = 1}), HasSubstr("--image 1 has no meaning"));
  EXPECT_THAT(error_of({.source = folder.path(), .kitti_image = {}, .start = 3}),
              HasSubstr("start is frame 3, it must be from 0 to 2"));
  EXPECT_THAT(error_of({.source = folder.path(), .kitti_image = {}, .start = -1}), HasSubstr("start is frame -1"));
  EXPECT_THAT(error_of({.source = folder.path(), .kitti_image = {}, .start = 0, .frames = 0}), HasSubstr("at least 1"));
  folder.file("img0.png", "");
  EXPECT_THAT(error_of({.source = folder.path()}), HasSubstr("img0.png: the file is empty (the first image gives"));
}

TEST(KittiFolder, TheChosenImageFolderIsReadWithTimesAndCalibration) {
  const TempFolder folder;
  write_images(folder / "image_1", 3);
  write_images(folder / "image_2", 2);
  folder.file("calib.txt", "P1: ...");
  const auto first = open_sequence({.source = folder.path()}, false);
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ((*first)->kitti_image(), 1);
  EXPECT_EQ((*first)->frame_count(), 3);
  EXPECT_EQ((*first)->calibration_path(), folder / "calib.txt");
  folder.file("camera.yaml", "");
  const auto second = open_sequence({.source = folder.path(), .kitti_image = 2}, false);
  ASSERT_TRUE(second);
  EXPECT_EQ((*second)->kitti_image(), 2);
  EXPECT_EQ((*second)->frame_count(), 2);
  EXPECT_EQ((*second)->calibration_path(), folder / "camera.yaml");
  EXPECT_THAT(error_of({.source = folder.path(), .kitti_image = 0}),
              HasSubstr("has no image_0, there: image_1, image_2"));
}

TEST(DecodeAhead, GivesTheSameFrames) {
  const TempFolder folder;
  write_images(folder.path(), 30);
  folder.file("img7.png", "broken");
  folder.file("img20.png", "broken");
  const auto plain = open_sequence({.source = folder.path()}, false);
  const auto ahead = open_sequence({.source = folder.path()}, true);
  ASSERT_TRUE(plain);
  ASSERT_TRUE(ahead);
  EXPECT_EQ((*ahead)->frame_count(), 30);
  EXPECT_DOUBLE_EQ((*ahead)->time_span().value().last_s, 2.9);
  for (int k = 0; k < 32; ++k) {
    const std::optional<Frame> expected = (*plain)->next();
    const std::optional<Frame> frame = (*ahead)->next();
    ASSERT_EQ(frame.has_value(), expected.has_value());
    if (!frame) continue;
    EXPECT_EQ(frame->index, expected->index);
    EXPECT_EQ(frame->time_s, expected->time_s);
    EXPECT_EQ(frame->problem, expected->problem);
    ASSERT_EQ(frame->image.empty(), expected->image.empty());
    if (!frame->image.empty()) {
      EXPECT_EQ(std::memcmp(frame->image.data(), expected->image.data(), 32 * 16), 0);
    }
  }
}

/// Warns before every third frame.
class WarningSequence final : public Sequence {
 public:
  std::optional<Frame> next() override {
    if (next_ == 30) return std::nullopt;
    if (next_ % 3 == 0) warnings_.push_back(std::to_string(next_));
    return Frame{.index = next_++, .time_s = 0.0, .image = {}, .problem = {}};
  }
  int first_frame() const override { return 0; }
  int frame_count() const override { return 30; }
  int width() const override { return 1; }
  int height() const override { return 1; }
  std::string calibration_path() const override { return ""; }
  std::vector<std::string> warnings() const override { return warnings_; }
  bool has_times() const override { return false; }

 private:
  int next_ = 0;
  std::vector<std::string> warnings_;
};

TEST(DecodeAhead, WarningsAreThoseUpToTheFrameHandedOutNotUpToTheFrameDecoded) {
  WarningSequence plain;
  const auto ahead = internal::decode_ahead(std::make_unique<WarningSequence>());
  while (plain.next()) {
    ASSERT_TRUE(ahead->next());
    EXPECT_EQ(ahead->warnings(), plain.warnings());
  }
  EXPECT_FALSE(ahead->next());
  EXPECT_FALSE(ahead->next());
}

TEST(DecodeAhead, MayBeDroppedAtAnyFrame) {
  const TempFolder folder;
  write_images(folder.path(), 12);
  for (int stop = 0; stop <= 13; ++stop) {
    auto sequence = open_sequence({.source = folder.path()}, true);
    ASSERT_TRUE(sequence);
    for (int k = 0; k < stop; ++k) (*sequence)->next();
  }
}

}  // namespace
}  // namespace groundscale
