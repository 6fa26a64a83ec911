// Hard stretches made from one rendered street: what the keyframe odometry must survive, against the truth. Where a
// stretch is seen its length is within 3 % of the truth: a map that has just begun is measured by the road over its
// first metres to 1 or 2 %.
#include "groundscale/camera/pinhole.hpp"
#include "hard_drive.hpp"

namespace groundscale {
namespace {

constexpr std::size_t kFrames = 120;
constexpr double kLength = 0.03;

const CameraPreset& camera() {
  static const CameraPreset preset = find_camera_preset("small").value();
  return preset;
}

/// 119 m of a street at 36 km/h, a metre a frame: straight, then a gentle bend.
const Feed& street() {
  static const Feed feed = [] {
    const std::vector<PathPiece> pieces{{60.0, 0.0}, {15.0, 0.01}, {80.0, 0.01}};
    return rendered(drive_along(Route{Path::of_pieces(pieces, {}), Surroundings::kTown, 10.0, {}, 0.0}, camera(), 3),
                    kFrames);
  }();
  return feed;
}

Image black() { return Image(camera().camera->width(), camera().camera->height()); }

DriveRun run(const Feed& feed) { return run(feed, setup_of(camera())); }

/// The street with a halt at a frame, under new noise, while cars pass: one every 4 s, now from the left, now from the
/// right, a sixth of the view each.
Feed with_halt(std::size_t at, int count) {
  Feed feed(street().begin(), street().begin() + static_cast<std::ptrdiff_t>(at) + 1);
  for (int k = 1; k <= count; ++k) {
    FeedFrame frame = street()[at];
    frame.time_s += 0.1 * k;
    frame.image = with_noise(frame.image, static_cast<std::uint64_t>(k));
    const int phase = k % 40;
    const bool leftwards = (k / 40) % 2 == 1;
    const int left = leftwards ? 480 - 25 * phase : -200 + 25 * phase;
    frame.image = painted(frame.image, {left, 50, 200, 80, static_cast<std::uint64_t>(k / 40)});
    feed.push_back(frame);
  }
  for (std::size_t k = at + 1; k < kFrames; ++k) {
    feed.push_back(street()[k]);
    feed.back().time_s += 0.1 * count;
  }
  return feed;
}

TEST(KeyframeHard, TheStreetUndisturbed) {
  const DriveRun result = run(street());
  expect_whole(result, street());
  EXPECT_NEAR(length_ratio(result, street(), 0, kFrames - 1), 1.0, 0.01);
  EXPECT_LT(motion_error_m(result, street(), 0, kFrames - 1), 1.5);
  EXPECT_GT(accepted_in(result, 20, kFrames - 1), 95U);
}

TEST(KeyframeHard, OneFrameInFiveIsMissing) {
  Feed feed;
  for (std::size_t k = 0; k < kFrames; ++k) {
    if (k % 5 != 3) feed.push_back(street()[k]);
  }
  const DriveRun result = run(feed);
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 0, feed.size() - 1), 1.0, kLength);
  EXPECT_EQ(count_of(result, FrameState::kLost), 0U);
}

TEST(KeyframeHard, AGapOfTwentyFrames) {
  Feed feed = street();
  feed.erase(feed.begin() + 50, feed.begin() + 70);
  const DriveRun result = run(feed);
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 50, feed.size() - 1), 1.0, kLength);
  // The speed before the gap goes on in it, which here is the truth.
  EXPECT_NEAR(length_ratio(result, feed, 49, 50), 1.0, 0.05);
}

TEST(KeyframeHard, TwentyUnreadableFrames) {
  Feed feed = street();
  for (std::size_t k = 50; k < 70; ++k) feed[k].image = {};
  const DriveRun result = run(feed);
  expect_whole(result, feed);
  for (std::size_t k = 50; k < 70; ++k) EXPECT_EQ(result.results[k].reason, "unreadable") << k;
  EXPECT_NEAR(length_ratio(result, feed, 70, kFrames - 1), 1.0, kLength);
  EXPECT_NEAR(length_ratio(result, feed, 49, 70), 1.0, 0.08);
}

TEST(KeyframeHard, ASecondOfBlackFramesIsNoHalt) {
  for (const bool noisy : {false, true}) {
    Feed feed = street();
    for (std::size_t k = 50; k < 60; ++k) feed[k].image = noisy ? with_noise(black(), k) : black();
    const DriveRun result = run(feed);
    expect_whole(result, feed);
    EXPECT_EQ(count_of(result, FrameState::kStill), 1U);  // the first of all
    EXPECT_NEAR(length_ratio(result, feed, 60, kFrames - 1), 1.0, kLength);
    EXPECT_NEAR(length_ratio(result, feed, 49, 60), 1.0, 0.05);
  }
}

/// A map must not begin with a step whose length was guessed: before the first frame that sees nothing is known of the
/// speed. With so much parallax asked for, a map takes more than one step.
TEST(KeyframeHard, BlackFramesAtTheStartWhileDriving) {
  Feed feed = street();
  for (std::size_t k = 0; k < 10; ++k) feed[k].image = black();
  OdometryOptions options;
  for (const double parallax_px : {15.0, 45.0}) {
    options.keyframe.start_parallax_px = parallax_px;
    const DriveRun result = run(feed, setup_of(camera()), options);
    expect_whole(result, feed);
    for (std::size_t k = 14; k < 40; ++k) {
      EXPECT_NEAR(length_of(result.online, k - 1, k), 1.0, 0.15) << k << ", " << parallax_px;
      EXPECT_NEAR(length_of(result.finals, k - 1, k), 1.0, 0.1) << k << ", " << parallax_px;
    }
    EXPECT_NEAR(length_ratio(result, feed, 20, kFrames - 1), 1.0, kLength);
  }
}

/// The first map is too small when it ends, for the camera's distortion is not what its calibration says; the second
/// one begins with a scale of its own, which its first steps have too.
TEST(KeyframeHard, TheFirstStepsOfASecondMapHaveItsScale) {
  Feed feed(street().rbegin(), street().rend());  // the bend first, backwards
  for (std::size_t k = 0; k < feed.size(); ++k) feed[k].time_s = 0.1 * static_cast<double>(k);
  for (std::size_t k = 45; k < 100; ++k) feed[k].image = black();
  CameraSetup setup = setup_of(camera());
  setup.camera =
      PinholeCamera::create({.fx = 300.0, .fy = 300.0, .cx = 239.5, .cy = 60.0, .k1 = 0.08}, 480, 200).value();
  const DriveRun result = run(feed, setup);
  const double held = result.results[44].map_scale.value_or(1.0);
  EXPECT_GT(std::abs(held - 1.0), 0.05) << "the first map should have drifted";
  double before = 0.0;
  for (std::size_t k = 102; k < feed.size(); ++k) {
    const double step_m = length_of(result.finals, k - 1, k);
    if (before > 0.0) {
      EXPECT_NEAR(step_m / before, 1.0, 0.04) << k;
    }
    before = step_m;
  }
}

TEST(KeyframeHard, StandingForThirtySecondsWithCarsPassing) {
  const Feed feed = with_halt(50, 300);
  const DriveRun result = run(feed);
  expect_whole(result, feed);
  for (std::size_t k = 51; k <= 350; ++k) EXPECT_EQ(result.results[k].state, FrameState::kStill) << k;
  EXPECT_EQ(length_of(result.finals, 50, 350), 0.0);
  EXPECT_EQ(length_of(result.online, 50, 350), 0.0);
  EXPECT_NEAR(length_ratio(result, feed, 350, feed.size() - 1), 1.0, kLength);
  EXPECT_EQ(count_of(result, FrameState::kBridged), 0U);  // the map carries on where it stood
}

TEST(KeyframeHard, StartingWhileStandingForThirtySeconds) {
  const Feed feed = with_halt(0, 300);
  const DriveRun result = run(feed);
  expect_whole(result, feed);
  EXPECT_EQ(length_of(result.finals, 0, 300), 0.0);
  EXPECT_NEAR(length_ratio(result, feed, 300, feed.size() - 1), 1.0, kLength);
}

TEST(KeyframeHard, ATruckFillsHalfOfTheView) {
  // It comes in from the right, drives ahead for 2 s, and hides the road from 4 m on.
  Feed feed = street();
  for (std::size_t k = 50; k < 80; ++k) {
    const int sway = static_cast<int>(std::lround(4.0 * std::sin(0.4 * static_cast<double>(k))));
    const int in = k < 54 ? 80 * (54 - static_cast<int>(k)) : k > 75 ? 80 * (static_cast<int>(k) - 75) : 0;
    feed[k].image = painted(feed[k].image, {120 + sway + in, 0, 240, 170, 5});
  }
  const DriveRun result = run(feed);
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 80, kFrames - 1), 1.0, kLength);
  // Without road the map's scale goes on by itself.
  EXPECT_NEAR(length_ratio(result, feed, 50, 80), 1.0, 0.05);
}

TEST(KeyframeHard, ASuddenChangeOfExposure) {
  for (const double factor : {0.4, 1.7}) {
    Feed feed = street();
    for (std::size_t k = 50; k < 80; ++k) feed[k].image = brightened(feed[k].image, factor);
    const DriveRun result = run(feed);
    expect_whole(result, feed);
    EXPECT_NEAR(length_ratio(result, feed, 0, kFrames - 1), 1.0, kLength);
    // The map is found again at once: a sight of its landmarks is good to some centimetres.
    EXPECT_LT(motion_error_m(result, feed, 49, 50), 0.1);
    EXPECT_LT(motion_error_m(result, feed, 79, 80), 0.1);
    EXPECT_EQ(count_of(result, FrameState::kBridged) + count_of(result, FrameState::kLost), 0U);
  }
}

TEST(KeyframeHard, DrivingBackwards) {
  Feed feed = street();
  for (std::size_t k = 0; k < kFrames; ++k) {
    feed[k] = street()[kFrames - 1 - k];
    feed[k].time_s = street()[k].time_s;
  }
  const DriveRun result = run(feed);
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 0, kFrames - 1), 1.0, kLength);
  EXPECT_LT(motion_error_m(result, feed, 0, kFrames - 1), 1.5);
  EXPECT_LT(result.finals.back().translation.z(), -90.0);  // the first camera looks ahead
}

TEST(KeyframeHard, ForwardsBackwardsForwards) {
  Feed feed;
  const auto add = [&feed](std::size_t k) {
    feed.push_back(street()[k]);
    feed.back().time_s = 0.1 * static_cast<double>(feed.size());
  };
  for (std::size_t k = 0; k <= 60; ++k) add(k);
  for (std::size_t k = 60; k-- > 30;) add(k);
  for (std::size_t k = 31; k < kFrames; ++k) add(k);
  const DriveRun result = run(feed);
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 0, 60), 1.0, kLength);
  EXPECT_NEAR(length_ratio(result, feed, 60, 90), 1.0, kLength);
  EXPECT_NEAR(length_ratio(result, feed, 90, feed.size() - 1), 1.0, kLength);
  // Where it turns around, after 30 m backwards, it is back at frame 30.
  EXPECT_LT(motion_error_m(result, feed, 30, 90), 0.5);
}

TEST(KeyframeHard, AHeightThatIsWrongByATenthMakesThePathSoMuchLonger) {
  CameraSetup setup = setup_of(camera());
  const DriveRun right = run(street(), setup);
  *setup.height_m *= 1.1;
  const DriveRun wrong = run(street(), setup);
  expect_whole(wrong, street());
  EXPECT_NEAR(length_of(wrong.finals, 0, kFrames - 1) / length_of(right.finals, 0, kFrames - 1), 1.10, 0.005);
}

TEST(KeyframeHard, ABonnetBehindTheVehicleMaskAndAWiper) {
  Feed feed = street();
  CameraSetup setup = setup_of(camera());
  setup.vehicle_mask = black();
  constexpr int kBonnetRow = 170;
  const int width = setup.vehicle_mask.width();
  std::fill(setup.vehicle_mask.data() + static_cast<std::ptrdiff_t>(width) * kBonnetRow,
            setup.vehicle_mask.data() + static_cast<std::ptrdiff_t>(width) * setup.vehicle_mask.height(),
            std::uint8_t{255});
  for (std::size_t k = 0; k < kFrames; ++k) {
    feed[k].image = painted(feed[k].image, {0, kBonnetRow, width, 30, 9});
    // The wiper crosses the view in a second and rests for another.
    const int phase = static_cast<int>(k % 20);
    if (phase < 10) feed[k].image = painted(feed[k].image, {-20 + 50 * phase, 0, 14, kBonnetRow, 11});
  }
  const DriveRun result = run(feed, setup);
  expect_whole(result, feed);
  EXPECT_NEAR(length_ratio(result, feed, 0, kFrames - 1), 1.0, kLength);
  EXPECT_LT(motion_error_m(result, feed, 0, kFrames - 1), 2.5);
}

TEST(KeyframeHard, TheSameToTheLastBitWhenRunAgain) {
  Feed feed(street().begin(), street().begin() + 90);
  for (std::size_t k = 30; k < 40; ++k) feed[k].image = with_noise(black(), k);
  for (std::size_t k = 60; k < 75; ++k) feed[k].image = brightened(feed[k].image, 0.4);
  const DriveRun a = run(feed);
  const DriveRun b = run(feed);
  for (std::size_t k = 0; k < feed.size(); ++k) {
    EXPECT_EQ(a.finals[k].rotation, b.finals[k].rotation) << k;
    EXPECT_EQ(a.finals[k].translation, b.finals[k].translation) << k;
    EXPECT_EQ(a.online[k].translation, b.online[k].translation) << k;
    EXPECT_EQ(a.results[k].reason, b.results[k].reason) << k;
    EXPECT_EQ(a.results[k].raw_over_online, b.results[k].raw_over_online) << k;
  }
}

}  // namespace
}  // namespace groundscale
