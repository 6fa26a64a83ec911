#include "groundscale/odometry/views.hpp"

#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/core/rng.hpp"

namespace groundscale {
namespace {

CameraPtr camera() { return *PinholeCamera::create({.fx = 400.0, .fy = 400.0, .cx = 320.0, .cy = 120.0}, 640, 240); }

/// What a camera sees of 120 points after `travelled_m` straight ahead.
std::vector<TrackPoint> seen_after(double travelled_m) {
  Rng rng(3);
  std::vector<TrackPoint> points;
  for (int k = 0; k < 120; ++k) {
    const Eigen::Vector3d point(rng.uniform(-5.0, 5.0), rng.uniform(-2.0, 2.0), rng.uniform(8.0, 20.0) - travelled_m);
    points.push_back({k, {400.0 * point.x() / point.z() + 320.0, 400.0 * point.y() / point.z() + 120.0}});
  }
  return points;
}

View view_at(int result, double travelled_m) {
  View view;
  view.result = result;
  view.points = seen_after(travelled_m);
  return view;
}

TEST(Views, SayStillWhereThePointsStayed) {
  Views views({}, {});
  views.push(view_at(0, 0.0));
  views.push(view_at(1, 1.0));
  const Pair pair = views.pair_with(seen_after(1.0), *camera());
  EXPECT_EQ(pair.motion.state, MotionState::kStill);
  EXPECT_EQ(pair.view->result, 1);
}

TEST(Views, PairWithTheLatestViewThatHasEnoughParallax) {
  Views views({}, {});
  views.push(view_at(0, 0.0));
  views.push(view_at(1, 1.0));
  views.push(view_at(2, 1.9));
  // 0.1 m moves points by about a pixel, 1 m by ten.
  const Pair pair = views.pair_with(seen_after(2.0), *camera());
  EXPECT_EQ(pair.view->result, 1);
  EXPECT_EQ(pair.matches.size(), 120U);
  EXPECT_EQ(pair.rays.size(), 120U);
}

TEST(Views, PairWithTheMostParallaxWhereNoneHasEnough) {
  Views views({}, {});
  views.push(view_at(0, 0.0));
  views.push(view_at(1, 0.05));
  EXPECT_EQ(views.pair_with(seen_after(0.1), *camera()).view->result, 0);
}

TEST(Views, ForgetTheOldest) {
  PairOptions options;
  options.max_frames = 1;
  Views views(options, {});
  views.push(view_at(0, 0.0));
  views.push(view_at(1, 0.05));
  EXPECT_EQ(views.pair_with(seen_after(0.1), *camera()).view->result, 1);
}

}  // namespace
}  // namespace groundscale
