#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "groundscale/io/files.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/video_internal.hpp"

namespace groundscale {
namespace {

using internal::RisingTimes;
using internal::TempFolder;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

constexpr int kWidth = 64;
constexpr int kHeight = 48;
constexpr int kFrames = 20;

/// Frame k has the grey level 8 k, but for a white top left corner.
bool write_video(const std::string& path, const char* codec) {
  const int fourcc = cv::VideoWriter::fourcc(codec[0], codec[1], codec[2], codec[3]);
  cv::VideoWriter writer(path, cv::CAP_FFMPEG, fourcc, 25.0, cv::Size(kWidth, kHeight));
  if (!writer.isOpened()) return false;
  for (int k = 0; k < kFrames; ++k) {
    cv::Mat frame(kHeight, kWidth, CV_8UC3, cv::Scalar::all(8 * k));
    cv::rectangle(frame, cv::Rect(0, 0, 16, 12), cv::Scalar::all(255), cv::FILLED);
    writer.write(frame);
  }
  return true;
}

/// Level of the middle, which tells the number of the frame; lossy coding moves it by a few.
double number_of(const Frame& frame) { return frame.image.at(frame.image.width() / 2, frame.image.height() / 2) / 8.0; }

std::vector<Frame> all_frames(Sequence& sequence) {
  std::vector<Frame> frames;
  while (std::optional<Frame> frame = sequence.next()) frames.push_back(*frame);
  return frames;
}

std::unique_ptr<Sequence> open_or_fail(const SequenceRequest& request, bool decode_ahead = false) {
  auto sequence = open_sequence(request, decode_ahead);
  EXPECT_TRUE(sequence) << (sequence ? "" : sequence.error().message);
  return sequence ? std::move(*sequence) : nullptr;
}

TEST(RisingTimes, TimesThatRiseStayAsTheyAre) {
  RisingTimes times(25.0);
  for (const double time_s : {0.08, 0.12, 0.5, 0.51}) EXPECT_EQ(times.next(time_s), time_s);
}

TEST(RisingTimes, RepeatedAndZeroTimesAreExtrapolatedWithTheMedianStep) {
  RisingTimes times(1000.0);
  for (const double time_s : {0.0, 0.04, 0.08, 0.13, 0.17}) EXPECT_EQ(times.next(time_s), time_s);
  EXPECT_DOUBLE_EQ(times.next(0.17), 0.21);
  EXPECT_DOUBLE_EQ(times.next(0.0), 0.25);
  EXPECT_DOUBLE_EQ(times.next(0.0), 0.29);
  EXPECT_EQ(times.next(0.31), 0.31);  // rises again: as presented
}

TEST(RisingTimes, WithoutAnyTimeTheDeclaredRateIsUsed) {
  RisingTimes declared(50.0);
  RisingTimes unknown(0.0);
  for (int k = 0; k < 5; ++k) {
    EXPECT_DOUBLE_EQ(declared.next(0.0), 0.02 * k);
    EXPECT_DOUBLE_EQ(unknown.next(0.0), k / 30.0);
  }
}

class VideoCodecs : public testing::TestWithParam<std::pair<const char*, const char*>> {};

TEST_P(VideoCodecs, EveryFrameComesWithItsTime) {
  const TempFolder folder;
  const std::string path = folder / GetParam().first;
  if (!write_video(path, GetParam().second)) GTEST_SKIP() << "no encoder for " << GetParam().second;
  const auto video = open_or_fail({.source = path});
  ASSERT_NE(video, nullptr);
  EXPECT_EQ(video->frame_count(), kFrames);
  EXPECT_EQ(video->width(), kWidth);
  EXPECT_EQ(video->height(), kHeight);
  EXPECT_TRUE(video->has_times());
  const std::vector<Frame> frames = all_frames(*video);
  ASSERT_THAT(frames, SizeIs(kFrames));
  for (int k = 0; k < kFrames; ++k) {
    EXPECT_EQ(frames[k].index, k);
    EXPECT_NEAR(frames[k].time_s, 0.04 * k, 1e-9);
    EXPECT_NEAR(number_of(frames[k]), k, 0.5);
  }
  EXPECT_THAT(video->warnings(), IsEmpty());
}
// The H.264 encoder reorders frames; that is where OpenCV 4.6 loses the last times.
INSTANTIATE_TEST_SUITE_P(Containers, VideoCodecs,
                         testing::Values(std::pair("drive.avi", "MJPG"), std::pair("drive.mp4", "mp4v"),
                                         std::pair("drive.mp4", "avc1"), std::pair("drive.mkv", "XVID")));

TEST(Video, StartDropsFramesExactlyAndKeepsNumbersAndTimes) {
  const TempFolder folder;
  ASSERT_TRUE(write_video(folder / "drive.avi", "MJPG"));
  const auto video = open_or_fail({.source = folder / "drive.avi", .kitti_image = {}, .start = 7, .frames = 3});
  ASSERT_NE(video, nullptr);
  EXPECT_EQ(video->first_frame(), 7);
  EXPECT_EQ(video->frame_count(), 3);
  const std::vector<Frame> frames = all_frames(*video);
  ASSERT_THAT(frames, SizeIs(3));
  EXPECT_EQ(frames[0].index, 7);
  EXPECT_NEAR(number_of(frames[0]), 7.0, 0.5);
  EXPECT_NEAR(frames[0].time_s, 0.28, 1e-9);
  EXPECT_THAT(video->warnings(), IsEmpty());
}

TEST(Video, DecodingAheadGivesTheSameFrames) {
  const TempFolder folder;
  ASSERT_TRUE(write_video(folder / "drive.mp4", "mp4v"));
  const auto plain = open_or_fail({.source = folder / "drive.mp4"});
  const auto ahead = open_or_fail({.source = folder / "drive.mp4"}, true);
  ASSERT_NE(plain, nullptr);
  ASSERT_NE(ahead, nullptr);
  const std::vector<Frame> expected = all_frames(*plain);
  const std::vector<Frame> frames = all_frames(*ahead);
  ASSERT_EQ(frames.size(), expected.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    EXPECT_EQ(frames[k].time_s, expected[k].time_s);
    EXPECT_EQ(std::memcmp(frames[k].image.data(), expected[k].image.data(), kWidth * kHeight), 0);
  }
}

/// Puts a rotation into an MP4's track header. `matrix` is a, b, c, d of x' = a x + c y, y' = b x + d y, y down.
void turn_track(const std::string& path, const std::array<int, 4>& matrix) {
  std::string bytes = *read_text(path);
  const std::size_t header = bytes.find("tkhd");
  ASSERT_NE(header, std::string::npos);
  const std::size_t at = header + 4 + 4 + 20 + 16;  // type, version and flags, times and duration, layer and volume
  const std::size_t places[] = {0, 4, 12, 16};
  for (int k = 0; k < 4; ++k) {
    const auto fixed_point = static_cast<std::uint32_t>(matrix[k] * 0x10000);
    for (int byte = 0; byte < 4; ++byte) {
      bytes[at + places[k] + byte] = static_cast<char>(fixed_point >> (24 - 8 * byte));
    }
  }
  ASSERT_TRUE(write_text(path, bytes));
}

/// Where the white corner is: (right, bottom).
std::pair<bool, bool> white_corner(const Image& image) {
  for (const bool right : {false, true}) {
    for (const bool bottom : {false, true}) {
      if (image.at(right ? image.width() - 3 : 2, bottom ? image.height() - 3 : 2) > 200) return {right, bottom};
    }
  }
  ADD_FAILURE() << "no white corner";
  return {};
}

TEST(Video, IsTurnedAsTheContainerSays) {
  struct Turn {
    std::array<int, 4> matrix;
    std::pair<bool, bool> corner;
    bool upright;
  };
  // A quarter turn clockwise takes the top left corner to the top right, and x to y.
  const Turn turns[] = {{{1, 0, 0, 1}, {false, false}, false},
                        {{0, 1, -1, 0}, {true, false}, true},
                        {{-1, 0, 0, -1}, {true, true}, false},
                        {{0, -1, 1, 0}, {false, true}, true}};
  for (const Turn& turn : turns) {
    const TempFolder folder;
    ASSERT_TRUE(write_video(folder / "drive.mp4", "mp4v"));
    turn_track(folder / "drive.mp4", turn.matrix);
    const auto video = open_or_fail({.source = folder / "drive.mp4"});
    ASSERT_NE(video, nullptr);
    EXPECT_EQ(video->width(), turn.upright ? kHeight : kWidth);
    EXPECT_EQ(video->height(), turn.upright ? kWidth : kHeight);
    EXPECT_EQ(white_corner(video->next()->image), turn.corner);
  }
}

TEST(Video, OneThatEndsEarlyIsReadToItsEndWithAWarning) {
  const TempFolder folder;
  ASSERT_TRUE(write_video(folder / "drive.avi", "MJPG"));
  const std::string whole = *read_text(folder / "drive.avi");
  std::size_t cut = whole.find("movi");  // the frames' chunks follow
  for (int k = 0; k < 12; ++k) cut = whole.find("00dc", cut + 4);
  folder.file("cut.avi", whole.substr(0, cut + 100));
  const auto video = open_or_fail({.source = folder / "cut.avi"});
  ASSERT_NE(video, nullptr);
  const std::vector<Frame> frames = all_frames(*video);
  EXPECT_GT(frames.size(), 2U);
  EXPECT_LT(frames.size(), std::size_t{kFrames});
  EXPECT_NEAR(number_of(frames[2]), 2.0, 0.5);
  ASSERT_THAT(video->warnings(), SizeIs(1));
  EXPECT_THAT(video->warnings()[0], HasSubstr("declares 20 frames, " + std::to_string(frames.size()) +
                                              " were decoded: the video ends early"));
  EXPECT_FALSE(video->next());
  EXPECT_THAT(video->warnings(), SizeIs(1));
}

TEST(Video, WhoseFirstFrameCanNotBeDecodedIsKIo) {
  const TempFolder folder;
  ASSERT_TRUE(write_video(folder / "drive.avi", "MJPG"));
  std::string bytes = *read_text(folder / "drive.avi");
  // Every JPEG in the container loses its content, the container stays whole.
  const std::size_t movi = bytes.find("movi");
  for (std::size_t at = bytes.find("00dc", movi); at != std::string::npos; at = bytes.find("00dc", at + 4)) {
    const std::size_t begin = at + 8;
    const std::size_t end = std::min(bytes.find("00dc", begin), bytes.find("idx1", begin));
    if (end == std::string::npos) break;
    for (std::size_t k = begin; k < end; ++k) bytes[k] = 0;
  }
  folder.file("broken.avi", bytes);
  const auto video = open_sequence({.source = folder / "broken.avi"}, false);
  ASSERT_FALSE(video);
  EXPECT_EQ(video.error().code, ErrorCode::kIo);
  EXPECT_THAT(video.error().message, HasSubstr("broken.avi: frame 0, the first asked for, can't be decoded"));
}

TEST(Video, WhatIsNoVideoIsBadInput) {
  const TempFolder folder;
  for (const std::string content : {"", "no video", "RIFF\1\2\3\4AVI LIST"}) {
    const auto video = open_sequence({.source = folder.file("drive.avi", content)}, false);
    ASSERT_FALSE(video);
    EXPECT_EQ(video.error().code, ErrorCode::kBadInput);
    EXPECT_THAT(video.error().message, HasSubstr("drive.avi: can't be opened as a video"));
  }
}

TEST(Video, StartBeyondTheEndAndAnImageChoiceAreBadInput) {
  const TempFolder folder;
  ASSERT_TRUE(write_video(folder / "drive.avi", "MJPG"));
  const auto beyond = open_sequence({.source = folder / "drive.avi", .kitti_image = {}, .start = kFrames}, false);
  ASSERT_FALSE(beyond);
  EXPECT_THAT(beyond.error().message, HasSubstr("start is frame 20, it must be from 0 to 19"));
  const auto image = open_sequence({.source = folder / "drive.avi", .kitti_image = 0}, false);
  ASSERT_FALSE(image);
  EXPECT_EQ(image.error().code, ErrorCode::kBadInput);
}

TEST(Video, ACameraFileBesideItIsItsCalibrationButACalibTxtIsNot) {
  const TempFolder folder;
  ASSERT_TRUE(write_video(folder / "drive.avi", "MJPG"));
  folder.file("calib.txt", "");
  EXPECT_EQ(open_or_fail({.source = folder / "drive.avi"})->calibration_path(), "");
  folder.file("camera.yaml", "");
  EXPECT_EQ(open_or_fail({.source = folder / "drive.avi"})->calibration_path(), folder / "camera.yaml");
}

}  // namespace
}  // namespace groundscale
