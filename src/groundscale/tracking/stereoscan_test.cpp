#include "groundscale/tracking/stereoscan.hpp"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "groundscale/tracking/stereoscan_internal.hpp"
#include "groundscale/tracking/test_texture_internal.hpp"

namespace groundscale {
namespace {

constexpr int kWidth = 260;
constexpr int kHeight = 180;

Image shifted(const Eigen::Vector2d& shift) {
  static const TestTexture texture(21);
  return texture.render(kWidth, kHeight, [&](int x, int y) { return Eigen::Vector2d(Eigen::Vector2d(x, y) - shift); });
}

std::vector<Eigen::Vector2d> places_of(const FeatureSet& set) {
  std::vector<Eigen::Vector2d> places;
  for (const Feature& feature : set.features()) places.emplace_back(feature.x, feature.y);
  return places;
}

/// Errors of all features of the first image that were followed, against a known motion.
template <class Motion>
std::vector<double> errors(const Image& first, const Image& second, const Motion& motion) {
  const StereoScanOptions options;
  const FeatureSet a(first, options);
  const FeatureSet b(second, options);
  const std::vector<Eigen::Vector2d> points = places_of(a);
  const auto found = follow_features(a, b, match_features(a, b, options), points, options);
  std::vector<double> result;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (found[i]) result.push_back((*found[i] - motion(points[i])).norm());
  }
  std::sort(result.begin(), result.end());
  return result;
}

TEST(StereoScan, FindsAShiftToATwentiethOfAPixel) {
  for (const Eigen::Vector2d& shift : {Eigen::Vector2d(7.3, -2.6), Eigen::Vector2d(-31.5, 12.25)}) {
    const Image first = shifted({0.0, 0.0});
    const auto found =
        errors(first, shifted(shift), [&](const Eigen::Vector2d& point) { return Eigen::Vector2d(point + shift); });
    // Grey levels are rounded and interpolated between; 30 of 260 columns leave the image.
    ASSERT_GT(found.size(), FeatureSet(first, {}).features().size() / 2);
    EXPECT_LT(found[found.size() / 2], 0.02);
    EXPECT_LT(found[found.size() * 95 / 100], 0.05);
    EXPECT_LT(found.back(), 0.5);
  }
}

TEST(StereoScan, FindsAZoomAndTurnToATenthOfAPixelInTheMedian) {
  const TestTexture texture(22);
  const Eigen::Vector2d middle(kWidth / 2.0, kHeight / 2.0);
  Eigen::Matrix2d zoom;
  zoom << std::cos(0.02), -std::sin(0.02), std::sin(0.02), std::cos(0.02);
  zoom *= 1.04;
  const Image first = texture.render(kWidth, kHeight, [](int x, int y) { return Eigen::Vector2d(x, y); });
  const Image second = texture.render(kWidth, kHeight, [&](int x, int y) {
    return Eigen::Vector2d(zoom.transpose() / (1.04 * 1.04) * (Eigen::Vector2d(x, y) - middle) + middle);
  });
  const auto found = errors(
      first, second, [&](const Eigen::Vector2d& point) { return Eigen::Vector2d(zoom * (point - middle) + middle); });
  ASSERT_GT(found.size(), FeatureSet(first, {}).features().size() / 2);
  // A patch of 11 px has moved by another 0.25 px at its rim: what isn't symmetric in it pulls.
  EXPECT_LT(found[found.size() / 2], 0.08);
  EXPECT_LT(found[found.size() * 95 / 100], 0.2);
}

TEST(StereoScan, AConstantBetweenTheImagesChangesNothing) {
  const Eigen::Vector2d shift(4.5, 3.2);
  Image brighter = shifted(shift);
  for (int k = 0; k < kWidth * kHeight; ++k) {
    brighter.data()[k] = static_cast<std::uint8_t>(std::min(255, brighter.data()[k] + 12));
  }
  const auto found = errors(shifted({0.0, 0.0}), brighter,
                            [&](const Eigen::Vector2d& point) { return Eigen::Vector2d(point + shift); });
  ASSERT_GT(found.size(), 100U);
  EXPECT_LT(found[found.size() / 2], 0.02);
}

TEST(StereoScan, EachFeatureOfAnImageIsItsOwnMatchInTheSameImage) {
  const StereoScanOptions options;
  const FeatureSet set(shifted({0.0, 0.0}), options);
  const auto matches = match_features(set, set, options);
  EXPECT_GT(matches.size(), set.features().size() * 98 / 100);  // corners of the triangulation have no two neighbours
  for (const FeatureMatch& match : matches) EXPECT_EQ(match.first, match.second);
}

TEST(StereoScan, MatchesAreThoseOfTheWayBack) {
  StereoScanOptions options;
  options.min_support = 0;  // which is judged in the first image
  const FeatureSet a(shifted({0.0, 0.0}), options);
  const FeatureSet b(shifted({-9.2, 5.7}), options);
  std::set<std::pair<int, int>> forth, back;
  for (const FeatureMatch& match : match_features(a, b, options)) forth.emplace(match.first, match.second);
  for (const FeatureMatch& match : match_features(b, a, options)) back.emplace(match.second, match.first);
  EXPECT_GT(forth.size(), 100U);
  EXPECT_EQ(forth, back);
}

TEST(StereoScan, MatchesOnlyLikeWithLikeAndNoFeatureTwice) {
  const StereoScanOptions options;
  const FeatureSet a(shifted({0.0, 0.0}), options);
  const FeatureSet b(shifted({14.2, -8.7}), options);
  std::set<int> seconds;
  for (const FeatureMatch& match : match_features(a, b, options)) {
    EXPECT_EQ(a.features()[static_cast<std::size_t>(match.first)].kind,
              b.features()[static_cast<std::size_t>(match.second)].kind);
    EXPECT_TRUE(seconds.insert(match.second).second);
  }
  EXPECT_GT(seconds.size(), 100U);
}

TEST(StereoScan, FindsNothingWithoutTexture) {
  const StereoScanOptions options;
  Image grey(kWidth, kHeight);
  std::fill_n(grey.data(), kWidth * kHeight, std::uint8_t{120});
  const FeatureSet flat(grey, options);
  EXPECT_TRUE(flat.features().empty());
  const FeatureSet set(shifted({0.0, 0.0}), options);
  EXPECT_TRUE(match_features(flat, set, options).empty());
  EXPECT_TRUE(match_features(set, flat, options).empty());
  EXPECT_TRUE(match_features({}, set, options).empty());
}

TEST(StereoScan, FindsNothingInATinyImage) {
  const StereoScanOptions options;
  const TestTexture texture(23);
  for (const int size : {1, 4, 5, 16, 20}) {
    const FeatureSet set(texture.render(size, size, [](int x, int y) { return Eigen::Vector2d(x, y); }), options);
    EXPECT_TRUE(set.features().empty()) << size;
    EXPECT_TRUE(match_features(set, set, options).empty());
  }
}

TEST(FollowFeatures, APointFarFromAllFeaturesIsLost) {
  const StereoScanOptions options;
  const FeatureSet set(shifted({0.0, 0.0}), options);
  const auto matches = match_features(set, set, options);
  const Feature& feature = set.features()[static_cast<std::size_t>(matches.front().first)];
  const Eigen::Vector2d at(feature.x, feature.y);
  const auto found = follow_features(set, set, matches, {at, at + Eigen::Vector2d(0.4, 0.3), {-50.0, 1e4}}, options);
  ASSERT_TRUE(found[0] && found[1]);
  EXPECT_LT((*found[0] - at).norm(), 0.01);
  EXPECT_LT((*found[1] - at - Eigen::Vector2d(0.4, 0.3)).norm(), 0.01);  // the point's own place, not the feature's
  EXPECT_FALSE(found[2]);
  EXPECT_FALSE(follow_features(set, set, {}, {at}, options)[0]);
}

TEST(Supported, LeavesOutWhatNoNeighbourSupports) {
  std::vector<Eigen::Vector2f> points, flows;
  for (int y = 20; y < 100; y += 10) {
    for (int x = 20; x < 100; x += 10) {
      points.emplace_back(x + y % 3, y + x % 7);
      flows.emplace_back(0.05F * static_cast<float>(x), 1.0F);
    }
  }
  const std::size_t wild = 27;
  flows[wild] = {-9.0F, 14.0F};
  points.push_back(points[5]);  // two features on one pixel
  flows.push_back(flows[5]);
  const std::vector<char> kept = internal::supported(points, flows, Image(120, 120), {});
  for (std::size_t k = 0; k < points.size(); ++k) EXPECT_EQ(kept[k] != 0, k != wild) << k;
}

TEST(Supported, TooFewPointsSupportNothing) {
  const Image image(50, 50);
  EXPECT_TRUE(internal::supported({}, {}, image, {}).empty());
  EXPECT_EQ(internal::supported({{10.0F, 10.0F}}, {{1.0F, 1.0F}}, image, {}), std::vector<char>{0});
}

}  // namespace
}  // namespace groundscale
