// Hard stretches of a drive, made from one rendered street: what the keyframe odometry must survive, against the truth.
#include <cstdio>

#include "hard_drive.hpp"

namespace groundscale {
namespace {

constexpr std::size_t kFrames = 120;

const CameraPreset& camera() {
  static const CameraPreset preset = find_camera_preset("small").value();
  return preset;
}

/// 120 m of a street at 36 km/h: straight, then a gentle bend.
const Feed& street() {
  static const Feed feed = [] {
    const std::vector<PathPiece> pieces{{60.0, 0.0}, {15.0, 0.01}, {80.0, 0.01}};
    return rendered(drive_along(Route{Path::of_pieces(pieces, {}), Surroundings::kTown, 10.0, {}, 0.0}, camera(), 3),
                    kFrames);
  }();
  return feed;
}

DriveRun run(const Feed& feed) { return run(feed, setup_of(camera())); }

void tell(const char* name, const DriveRun& r, const Feed& feed, std::size_t a, std::size_t b) {
  std::printf("%s: whole %.4f  first %.4f after %.4f  online after %.4f error %.2f m acc %zu\n", name,
              length_ratio(r, feed, 0, feed.size() - 1), a > 0 ? length_ratio(r, feed, 0, a) : 0.0,
              length_ratio(r, feed, b, feed.size() - 1),
              length_of(r.online, b, feed.size() - 1) / true_length_m(feed, b, feed.size() - 1),
              motion_error_m(r, feed, a, b), accepted_in(r, b, feed.size() - 1));
  if (std::getenv("VERBOSE")) {
    for (std::size_t k = 1; k < feed.size(); ++k) {
      const double t = (feed[k].world_from_cam.translation - feed[k - 1].world_from_cam.translation).norm();
      std::printf("%3zu %-9s true %.3f final %.3f online %.3f scale %.3f raw %.3f tracks %d/%d matches %d inl %d road %d/%d %s\n", k,
                  std::string(name_of(r.results[k].state)).c_str(), t, r.results[k].step_m, r.results[k].online_step_m,
                  r.results[k].map_scale.value_or(0), r.results[k].raw_over_online.value_or(0), r.results[k].tracks_kept,
                  r.results[k].tracks, r.results[k].matches, r.results[k].inliers, r.results[k].road_matches,
                  r.results[k].road_inliers, r.results[k].reason.c_str());
    }
  }
}

TEST(KeyframeHard, Undisturbed) {
  const DriveRun r = run(street());
  expect_whole(r, street());
  tell("undisturbed", r, street(), 0, 20);
  EXPECT_NEAR(length_ratio(r, street(), 0, kFrames - 1), 1.0, 0.03);
}

TEST(KeyframeHard, OneFrameInFiveIsMissing) {
  Feed feed;
  for (std::size_t k = 0; k < kFrames; ++k) {
    if (k % 5 != 3) feed.push_back(street()[k]);
  }
  const DriveRun r = run(feed);
  expect_whole(r, feed);
  tell("1 in 5", r, feed, 0, 20);
}

TEST(KeyframeHard, AGapOfTwentyFrames) {
  Feed feed = street();
  feed.erase(feed.begin() + 50, feed.begin() + 70);
  const DriveRun r = run(feed);
  expect_whole(r, feed);
  tell("gap", r, feed, 49, 50);
}

TEST(KeyframeHard, TwentyUnreadableFrames) {
  Feed feed = street();
  for (std::size_t k = 50; k < 70; ++k) feed[k].image = {};
  const DriveRun r = run(feed);
  expect_whole(r, feed);
  tell("unreadable", r, feed, 49, 70);
}

TEST(KeyframeHard, ASecondOfBlackFrames) {
  Feed feed = street();
  for (std::size_t k = 50; k < 60; ++k) feed[k].image = with_noise(Image(480, 200), k);
  const DriveRun r = run(feed);
  expect_whole(r, feed);
  tell("black noisy", r, feed, 49, 60);
  for (std::size_t k = 50; k < 60; ++k) feed[k].image = Image(480, 200);
  const DriveRun r2 = run(feed);
  expect_whole(r2, feed);
  tell("black", r2, feed, 49, 60);
}

Feed with_halt(std::size_t at, int count, bool cars) {
  Feed feed(street().begin(), street().begin() + static_cast<std::ptrdiff_t>(at) + 1);
  for (int k = 1; k <= count; ++k) {
    FeedFrame frame = street()[at];
    frame.time_s += 0.1 * k;
    frame.image = with_noise(frame.image, static_cast<std::uint64_t>(k));
    if (cars) {
      // Every 4 s one from either side, 25 px a frame, in the lower middle of the view.
      const int phase = k % 40;
      const bool leftwards = (k / 40) % 2 == 1;
      const int left = leftwards ? 480 - 25 * phase : -200 + 25 * phase;
      frame.image = painted(frame.image, {left, 50, 200, 80, static_cast<std::uint64_t>(k / 40)});
    }
    feed.push_back(frame);
  }
  for (std::size_t k = at + 1; k < kFrames; ++k) {
    feed.push_back(street()[k]);
    feed.back().time_s += 0.1 * count;
  }
  return feed;
}

TEST(KeyframeHard, StandingForThirtySecondsWithCars) {
  const Feed feed = with_halt(50, 300, true);
  const DriveRun r = run(feed);
  expect_whole(r, feed);
  tell("standing", r, feed, 50, 351);
  std::printf("added %.4f m\n", length_of(r.finals, 50, 350));
}

TEST(KeyframeHard, StartWhileStanding) {
  const Feed feed = with_halt(0, 30, true);
  const DriveRun r = run(feed);
  expect_whole(r, feed);
  tell("start standing", r, feed, 0, 31);
  std::printf("added %.4f m\n", length_of(r.finals, 0, 30));
}

TEST(KeyframeHard, Truck) {
  Feed feed = street();
  for (std::size_t k = 50; k < 80; ++k) {
    const int sway = static_cast<int>(std::lround(4.0 * std::sin(0.4 * static_cast<double>(k))));
    const int in = k < 54 ? 80 * (54 - static_cast<int>(k)) : k > 75 ? 80 * (static_cast<int>(k) - 75) : 0;
    feed[k].image = painted(feed[k].image, {120 + sway + in, 0, 240, 170, 5});
  }
  const DriveRun r = run(feed);
  expect_whole(r, feed);
  tell("truck", r, feed, 50, 80);
}

TEST(KeyframeHard, Exposure) {
  for (const double factor : {0.4, 1.7}) {
    Feed feed = street();
    for (std::size_t k = 50; k < 80; ++k) feed[k].image = brightened(feed[k].image, factor);
    const DriveRun r = run(feed);
    expect_whole(r, feed);
    tell("exposure", r, feed, 49, 50);
  }
}

TEST(KeyframeHard, Reverse) {
  Feed feed = street();
  for (std::size_t k = 0; k < kFrames; ++k) {
    feed[k] = street()[kFrames - 1 - k];
    feed[k].time_s = street()[k].time_s;
  }
  const DriveRun r = run(feed);
  expect_whole(r, feed);
  tell("reverse", r, feed, 0, 20);
  std::printf("error of the whole %.2f of %.2f\n", motion_error_m(r, feed, 0, kFrames - 1), true_length_m(feed, 0, kFrames - 1));
}

TEST(KeyframeHard, Height) {
  CameraSetup setup = setup_of(camera());
  const DriveRun right = run(street(), setup);
  *setup.height_m *= 1.1;
  const DriveRun wrong = run(street(), setup);
  std::printf("height: %.4f\n", length_of(wrong.finals, 0, kFrames - 1) / length_of(right.finals, 0, kFrames - 1));
}

TEST(KeyframeHard, Bonnet) {
  Feed feed = street();
  CameraSetup setup = setup_of(camera());
  setup.vehicle_mask = Image(480, 200);
  std::fill(setup.vehicle_mask.data() + 480 * 170, setup.vehicle_mask.data() + 480 * 200, std::uint8_t{255});
  for (std::size_t k = 0; k < kFrames; ++k) {
    feed[k].image = painted(feed[k].image, {0, 170, 480, 30, 9});
    // A wiper that crosses the view in a second and rests for another.
    const int phase = static_cast<int>(k % 20);
    if (phase < 10) feed[k].image = painted(feed[k].image, {-20 + 50 * phase, 0, 14, 170, 11});
  }
  const DriveRun r = run(feed, setup);
  expect_whole(r, feed);
  tell("bonnet and wipers", r, feed, 0, 20);
}

}  // namespace
}  // namespace groundscale
