#include "groundscale/road/road_network.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "groundscale/core/rng.hpp"
#include "groundscale/road/onnx_input_internal.hpp"
#include "groundscale/road/test_network_internal.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

Image filled(int width, int height, int grey) {
  Image image(width, height);
  std::fill_n(image.data(), width * height, static_cast<std::uint8_t>(grey));
  return image;
}

/// Pixels from (x0, y0) up to, but without, (x1, y1).
struct Box {
  int x0, y0, x1, y1;
};

Image with_box(Image image, const Box& box, int grey) {
  for (int y = box.y0; y < box.y1; ++y) {
    std::fill_n(image.data() + y * image.width() + box.x0, box.x1 - box.x0, static_cast<std::uint8_t>(grey));
  }
  return image;
}

/// What the road's pixels span.
Box extent(const Image& mask) {
  Box box{mask.width(), mask.height(), 0, 0};
  for (int y = 0; y < mask.height(); ++y) {
    for (int x = 0; x < mask.width(); ++x) {
      if (mask.at(x, y) == 0) continue;
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
    }
  }
  return box;
}

int differing(const Image& a, const Image& b) {
  int count = 0;
  for (int i = 0; i < a.width() * a.height(); ++i) count += a.data()[i] != b.data()[i] ? 1 : 0;
  return count;
}

Image noise(int width, int height) {
  Rng rng(3);
  Image image(width, height);
  std::generate_n(image.data(), width * height, [&] { return static_cast<std::uint8_t>(rng.uniform(0.0, 255.0)); });
  return image;
}

RoadNetworkOptions options_for(const TestFile& file) { return {.file = file.path(), .erode_px = 0}; }

Image detect(const TestNetwork& network, const Image& image, RoadNetworkOptions options = {.erode_px = 0}) {
  const TestFile file(network);
  options.file = file.path();
  auto opened = RoadNetwork::open(options);
  EXPECT_TRUE(opened) << opened.error().message;
  auto mask = opened ? opened->detect(image) : Result<Image>(opened.error());
  return mask ? *mask : Image();
}

std::string error_of(const TestNetwork& network, RoadNetworkOptions options = {}) {
  const TestFile file(network);
  options.file = file.path();
  const auto opened = RoadNetwork::open(options);
  return opened ? "opened" : opened.error().message;
}

TEST(RoadNetwork, AtItsOwnSizeEachPixelIsItsOwn) {
  const Image image = noise(64, 32);
  const Image mask = detect(TestNetwork::dark_is_road(64, 32), image);
  ASSERT_EQ(mask.width(), 64);
  ASSERT_EQ(mask.height(), 32);
  for (int y = 0; y < 32; ++y) {
    for (int x = 0; x < 64; ++x) ASSERT_EQ(mask.at(x, y), image.at(x, y) < 128 ? 255 : 0) << x << " " << y;
  }
}

TEST(RoadNetwork, AWideImageInASquareInputComesBackWhereItWas) {
  const Box box{72, 20, 168, 44};
  const Image mask = detect(TestNetwork::dark_is_road(60, 60), with_box(filled(240, 60, 200), box, 50));
  ASSERT_EQ(mask.width(), 240);
  const Box found = extent(mask);
  // Shrunk by 4 and interpolated: the box's edges are those of the input's pixels, so half is reached at the edge, and
  // rounding decides about the pixel there.
  EXPECT_NEAR(found.x0, box.x0, 1);
  EXPECT_NEAR(found.x1, box.x1, 1);
  EXPECT_NEAR(found.y0, box.y0, 1);
  EXPECT_NEAR(found.y1, box.y1, 1);
}

TEST(RoadNetwork, KeepsTheAspectRatio) {
  // Road where a row or column of the 5 x 5 pixels about it is white (two rows of the grey beside the image aren't
  // enough), so the box grows by two pixels of the input, 8 of the image, to all sides.
  TestNetwork grows = TestNetwork::dark_is_road(120, 120);
  grows.side = 5;
  grows.weights[1] = 1.0F / 3.0F;
  grows.biases[1] = -4.7F;
  const Box box{160, 80, 320, 160};
  const Box found = extent(detect(grows, with_box(filled(480, 240, 0), box, 255)));
  // Interpolation between the last pixel of road and the next, 4 px on.
  EXPECT_NEAR(box.x0 - found.x0, 8, 3);
  EXPECT_NEAR(found.x1 - box.x1, 8, 3);
  EXPECT_NEAR(box.y0 - found.y0, 8, 3);
  EXPECT_NEAR(found.y1 - box.y1, 8, 3);
}

TEST(RoadNetwork, ReadsAnOutputSmallerThanItsInput) {
  TestNetwork coarse = TestNetwork::dark_is_road(120, 120);
  coarse.stride = 4;        // the first of four pixels stands for them,
  coarse.biases[1] = 0.4F;  // so that it may be of the grey beside the image, which isn't dark any more
  // Edges where four pixels of the input begin, 8 of the image.
  const Box box{72, 22, 168, 54};
  const Box found = extent(detect(coarse, with_box(filled(240, 60, 184), box, 20)));
  EXPECT_NEAR(found.x0, box.x0, 1);
  EXPECT_NEAR(found.x1, box.x1, 1);
  EXPECT_NEAR(found.y0, box.y0, 1);
  EXPECT_NEAR(found.y1, box.y1, 1);
}

TEST(RoadNetwork, WhatItSaysBesideTheImageDoesNotCount) {
  // The grey about the image is road to this network, the image isn't.
  EXPECT_EQ(extent(detect(TestNetwork::dark_is_road(60, 60), filled(240, 60, 200))).x1, 0);
  EXPECT_EQ(extent(detect(TestNetwork::dark_is_road(60, 60), filled(90, 240, 200))).x1, 0);
}

TEST(RoadNetwork, TakesTheLargestOfSeveralChannels) {
  const Image image = with_box(filled(32, 32, 200), {0, 0, 16, 32}, 60);
  TestNetwork three = TestNetwork::dark_is_road(32, 32);
  three.weights = {0.0F, -1.0F / 3.0F, 1.0F / 3.0F};
  three.biases = {0.0F, 0.5F, -0.5F};
  for (const auto& [channel, left, right] : {std::tuple{0, 0, 0}, {1, 255, 0}, {2, 0, 255}}) {
    const Image mask = detect(three, image, {.road_channel = channel, .erode_px = 0});
    EXPECT_EQ(mask.at(4, 16), left) << channel;
    EXPECT_EQ(mask.at(28, 16), right) << channel;
  }
}

TEST(RoadNetwork, ComparesASingleChannelWithTheThreshold) {
  TestNetwork single{.width = 32, .height = 32, .channels = 1, .weights = {1.0F}, .biases = {0.0F}};
  const Image image = with_box(filled(32, 32, 200), {0, 0, 16, 32}, 60);
  EXPECT_EQ(extent(detect(single, image, {.threshold = 0.5, .erode_px = 0})).x0, 16);
  EXPECT_EQ(extent(detect(single, image, {.threshold = 0.2, .erode_px = 0})).x0, 0);
  EXPECT_EQ(extent(detect(single, image, {.threshold = 0.9, .erode_px = 0})).x1, 0);
}

TEST(RoadNetwork, NormalisesEachChannel) {
  TestNetwork sum{.width = 8, .height = 8, .weights = {1.0F}, .biases = {0.0F}};
  // Three channels of grey 100: (100 - 90) * 1 + (100 - 80) * 0.5 + (100 - 50) * 0.1 = 25.
  RoadNetworkOptions options{.mean = {90.0, 80.0, 50.0}, .scale = {1.0, 0.5, 0.1}, .erode_px = 0};
  options.threshold = 24.99;
  EXPECT_EQ(detect(sum, filled(8, 8, 100), options).at(4, 4), 255);
  options.threshold = 25.01;
  EXPECT_EQ(detect(sum, filled(8, 8, 100), options).at(4, 4), 0);
}

TEST(RoadNetwork, ErodesTheRoadButNotAtTheImagesEdge) {
  const Image image = with_box(filled(64, 64, 200), {20, 30, 50, 64}, 50);
  const Box found = extent(detect(TestNetwork::dark_is_road(64, 64), image, {.erode_px = 3}));
  EXPECT_EQ(found.x0, 23);
  EXPECT_EQ(found.x1, 47);
  EXPECT_EQ(found.y0, 33);
  EXPECT_EQ(found.y1, 64);
}

TEST(RoadNetwork, TakesTheSizeThatTheFileLeavesOpen) {
  const TestNetwork open = TestNetwork::dark_is_road(0, 0);
  const Image image = with_box(filled(64, 64, 200), {20, 30, 50, 64}, 50);
  const Box found = extent(detect(open, image, {.width = 64, .height = 64, .erode_px = 0}));
  EXPECT_EQ(found.x0, 20);
  EXPECT_EQ(found.y0, 30);
  EXPECT_THAT(error_of(open), HasSubstr("doesn't say its input's size"));
}

TEST(RoadNetwork, GivesTheSameBytesTwiceOnOneThread) {
  TestNetwork network = TestNetwork::dark_is_road(96, 64);
  network.side = 7;
  network.weights[1] = -1.0F / 147.0F;
  const TestFile file(network);
  auto first = RoadNetwork::open(options_for(file));
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(cv::getNumThreads(), 1);
  auto second = RoadNetwork::open(options_for(file));
  ASSERT_TRUE(second);
  const Image image = noise(300, 170);
  const Image mask = *first->detect(image);
  EXPECT_GT(std::count(mask.data(), mask.data() + 300 * 170, 255), 1000);
  // Not even what was detected in between matters.
  ASSERT_TRUE(first->detect(filled(300, 170, 10)));
  EXPECT_EQ(differing(mask, *first->detect(image)), 0);
  EXPECT_EQ(differing(mask, *second->detect(image)), 0);
}

TEST(RoadNetwork, NamesWhatIsWrong) {
  const TestNetwork sound = TestNetwork::dark_is_road(32, 32);
  EXPECT_THAT(RoadNetwork::open({.file = "nowhere/road.onnx"}).error().message,
              testing::Eq("road.network.file: nowhere/road.onnx: no such file"));
  for (const std::string& bytes : {std::string("no network at all"), std::string(), sound.onnx().substr(0, 90)}) {
    const TestFile file("network.onnx", bytes);
    EXPECT_THAT(RoadNetwork::open({.file = file.path()}).error().message,
                HasSubstr("isn't a network that OpenCV can load"));
  }
  const TestFile text("network.txt", "no network at all");
  EXPECT_THAT(RoadNetwork::open({.file = text.path()}).error().message,
              HasSubstr("isn't a network that OpenCV can load"));
  EXPECT_THAT(error_of(sound, {.road_channel = 2}),
              testing::AllOf(HasSubstr("road.network.road_channel: 2 is out of range"), HasSubstr("channels 0 to 1")));
  EXPECT_THAT(error_of(sound, {.output = "rod"}), HasSubstr("has no output 'rod', it has: road"));
  EXPECT_THAT(error_of(sound, {.width = 32}), HasSubstr("both must be given, or neither"));
  EXPECT_THAT(error_of(sound, {.channels = 1}), HasSubstr("can't be run on an input of 1 x 32 x 32"));
  EXPECT_THAT(error_of(sound, {.channels = 2}), HasSubstr("road.network.channels"));
  EXPECT_THAT(error_of(sound, {.mean = {1.0, 2.0}}), HasSubstr("road.network.mean: 2 numbers"));
  EXPECT_THAT(error_of(sound, {.every = 0}), HasSubstr("every"));
  TestNetwork colours = sound;
  colours.channels = 4;
  EXPECT_THAT(error_of(colours), HasSubstr("it must have 1 or 3 channels"));
  TestNetwork grey = sound;
  grey.channels = 1;
  EXPECT_THAT(error_of(grey, {.scale = {1.0, 1.0, 1.0}}), HasSubstr("the network's input has 1 channels"));
}

TEST(OnnxInput, ReadsTheSizeAndLeavesOutWeights) {
  const TestFile file(TestNetwork::dark_is_road(640, 192));
  const auto input = internal::onnx_input(file.path());
  ASSERT_TRUE(input);
  EXPECT_EQ(input->channels, 3);
  EXPECT_EQ(input->height, 192);
  EXPECT_EQ(input->width, 640);
  const TestFile open(TestNetwork::dark_is_road(0, 0));
  EXPECT_EQ(internal::onnx_input(open.path())->width, 0);
  EXPECT_FALSE(internal::onnx_input("nowhere"));
}

/// Whatever a file holds, reading it ends.
TEST(OnnxInput, TakesAnyBytes) {
  const std::string sound = TestNetwork::dark_is_road(640, 192).onnx();
  for (std::size_t length = 0; length < sound.size(); ++length) {
    const TestFile file("cut.onnx", sound.substr(0, length));
    const auto input = internal::onnx_input(file.path());
    EXPECT_TRUE(!input || input->width == 640 || input->width == 0) << length;
  }
  Rng rng(5);
  for (int k = 0; k < 200; ++k) {
    std::string bytes = sound;
    for (int n = 0; n < 5; ++n) {
      bytes[static_cast<std::size_t>(rng.uniform(0.0, static_cast<double>(bytes.size()) - 1.0))] =
          static_cast<char>(rng.uniform(0.0, 255.0));
    }
    const TestFile file("spoilt.onnx", bytes);
    const auto input = internal::onnx_input(file.path());
    EXPECT_TRUE(!input || std::min({input->channels, input->width, input->height}) >= 0);
  }
}

}  // namespace
}  // namespace groundscale
