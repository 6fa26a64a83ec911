#include "groundscale/mapping/relocalise.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <map>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>

#include "groundscale/tracking/detect.hpp"
#include "groundscale/tracking/klt.hpp"
#include "groundscale/tracking/opencv_internal.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {
namespace {

constexpr std::array<double, 4> kReductions{1.0, 1.26, 1.59, 2.0};

using Descriptor = std::array<std::uint64_t, 4>;

struct Feature {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();  ///< In the image that isn't reduced.
  Descriptor descriptor{};
  int level = 0;  ///< Of kReductions.
};

/// A landmark of a view and what the image has for it.
struct Found {
  int view = 0;
  int landmark = 0;  ///< Of the view's.
  int feature = 0;
  int distance = 0;
};

int distance_between(const Descriptor& a, const Descriptor& b) {
  int bits = 0;
  for (std::size_t k = 0; k < a.size(); ++k) bits += std::popcount(a[k] ^ b[k]);
  return bits;
}

/// Descriptors at pixels; nothing where one lies too near the border.
std::vector<std::optional<Descriptor>> describe(const Image& image, const std::vector<Eigen::Vector2d>& pixels) {
  constexpr int kBorderPx = 8;
  constexpr int kPatchPx = 31;
  const auto orb = cv::ORB::create(/*nfeatures=*/1, /*scaleFactor=*/1.2F, /*nlevels=*/1, kBorderPx, /*firstLevel=*/0,
                                   /*WTA_K=*/2, cv::ORB::HARRIS_SCORE, kPatchPx);
  std::vector<cv::KeyPoint> points;
  for (std::size_t k = 0; k < pixels.size(); ++k) {
    // Angle 0: the camera stays upright. class_id: which of the pixels, for some are left out.
    points.emplace_back(to_cv(pixels[k]), static_cast<float>(kPatchPx), 0.0F, 0.0F, 0, static_cast<int>(k));
  }
  cv::Mat rows;
  orb->compute(view_of(image), points, rows);
  std::vector<std::optional<Descriptor>> result(pixels.size());
  for (std::size_t k = 0; k < points.size(); ++k) {
    Descriptor& descriptor = result[static_cast<std::size_t>(points[k].class_id)].emplace();
    std::memcpy(descriptor.data(), rows.ptr(static_cast<int>(k)), sizeof(descriptor));
  }
  return result;
}

Image resized(const Image& image, double factor) {
  Image result(std::max(1, static_cast<int>(std::lround(factor * image.width()))),
               std::max(1, static_cast<int>(std::lround(factor * image.height()))));
  cv::Mat view = view_of(result);
  cv::resize(view_of(image), view, view.size(), 0.0, 0.0, factor < 1.0 ? cv::INTER_AREA : cv::INTER_LINEAR);
  return result;
}

/// Where a pixel of an image lies in the same image of another width.
Eigen::Vector2d rescaled(const Eigen::Vector2d& pixel, const Image& from, const Image& to) {
  const Eigen::Array2d factor(static_cast<double>(to.width()) / from.width(),
                              static_cast<double>(to.height()) / from.height());
  return (factor * (pixel.array() + 0.5) - 0.5).matrix();
}

std::vector<Feature> features_of(const Image& image) {
  std::vector<Feature> features;
  for (std::size_t level = 0; level < kReductions.size(); ++level) {
    const Image reduced = level == 0 ? image : resized(image, 1.0 / kReductions[level]);
    constexpr int kLeastPx = 64;
    if (reduced.width() < kLeastPx || reduced.height() < kLeastPx) break;
    const auto corners = detect_corners(reduced, {}, {}, {.cell_px = 10, .min_gradient = 2.0, .border_px = 8});
    const auto descriptors = describe(reduced, corners);
    for (std::size_t k = 0; k < corners.size(); ++k) {
      if (!descriptors[k]) continue;
      features.push_back({rescaled(corners[k], reduced, image), *descriptors[k], static_cast<int>(level)});
    }
  }
  return features;
}

/// Where a landmark is looked for.
struct SearchArea {
  Eigen::Vector2d centre = Eigen::Vector2d::Zero();
  double radius_px = 0.0;
  double max_ratio = 1.0;  ///< Of its distance to that of the next in the area.
};

/// The feature that looks like a landmark, where none elsewhere in the area looks nearly like it.
std::optional<std::pair<int, int>> nearest(const Descriptor& descriptor, const std::vector<Feature>& features,
                                           const SearchArea& area) {
  constexpr int kMaxBits = 64;
  constexpr double kSamePlacePx = 6.0;
  int best = -1;
  int bits = kMaxBits + 1;
  std::vector<int> distances(features.size(), static_cast<int>(sizeof(Descriptor)) * 8);
  for (std::size_t k = 0; k < features.size(); ++k) {
    if ((features[k].pixel - area.centre).squaredNorm() > area.radius_px * area.radius_px) continue;
    distances[k] = distance_between(descriptor, features[k].descriptor);
    if (distances[k] >= bits) continue;
    bits = distances[k];
    best = static_cast<int>(k);
  }
  if (best < 0) return std::nullopt;
  const Eigen::Vector2d& place = features[static_cast<std::size_t>(best)].pixel;
  for (std::size_t k = 0; k < features.size(); ++k) {
    if (area.max_ratio * distances[k] < bits && (features[k].pixel - place).norm() > kSamePlacePx) return std::nullopt;
  }
  return std::pair{best, bits};
}

/// For each landmark the best match over all views, ids ascending.
std::map<TrackId, Found> match_landmarks(const std::vector<MapView>& views, const std::vector<Feature>& features,
                                         const Camera& camera, const RigidTransform& cam_from_world, SearchArea area) {
  std::map<TrackId, Found> found;
  for (std::size_t v = 0; v < views.size(); ++v) {
    std::vector<Eigen::Vector2d> pixels;
    for (const MapView::Landmark& landmark : views[v].landmarks) pixels.push_back(landmark.pixel);
    const auto descriptors = describe(views[v].image, pixels);
    for (std::size_t k = 0; k < descriptors.size(); ++k) {
      if (!descriptors[k]) continue;
      const auto expected = camera.project(cam_from_world * views[v].landmarks[k].point_in_world);
      if (!expected) continue;
      area.centre = *expected;
      const auto match = nearest(*descriptors[k], features, area);
      if (!match) continue;
      const Found candidate{static_cast<int>(v), static_cast<int>(k), match->first, match->second};
      const auto [entry, made] = found.try_emplace(views[v].landmarks[k].id, candidate);
      if (!made && candidate.distance < entry->second.distance) entry->second = candidate;
    }
  }
  return found;
}

/// The first image with the mean and the contrast of the second.
Image exposed_like(const Image& image, const Image& other) {
  cv::Scalar mean, sd, other_mean, other_sd;
  cv::meanStdDev(view_of(image), mean, sd);
  cv::meanStdDev(view_of(other), other_mean, other_sd);
  const double gain = other_sd[0] / std::max(1.0, sd[0]);
  Image result(image.width(), image.height());
  cv::Mat view = view_of(result);
  view_of(image).convertTo(view, CV_8U, gain, other_mean[0] - gain * mean[0]);
  return result;
}

/// With a black margin to the right and below.
Image padded(const Image& image, int width, int height) {
  Image result(width, height);
  view_of(image).copyTo(view_of(result)(cv::Rect(0, 0, image.width(), image.height())));
  return result;
}

/// What looks alike is followed from a view, enlarged as the landmarks have come nearer, into the image.
std::vector<std::optional<Eigen::Vector2d>> followed(const std::vector<MapView>& views, const Image& image,
                                                     const std::vector<Found>& found,
                                                     const std::vector<Feature>& features) {
  constexpr double kMaxShiftPx = 4.0;
  const KltOptions options{.window_px = 15, .levels = 1};
  std::vector<std::optional<Eigen::Vector2d>> result(found.size());
  for (std::size_t v = 0; v < views.size(); ++v) {
    const Image view = exposed_like(views[v].image, image);
    for (std::size_t level = 0; level < kReductions.size(); ++level) {
      std::vector<std::size_t> which;
      std::vector<Eigen::Vector2d> starts, guesses;
      const Image enlarged = level == 0 ? view : resized(view, kReductions[level]);
      for (std::size_t k = 0; k < found.size(); ++k) {
        const Feature& feature = features[static_cast<std::size_t>(found[k].feature)];
        if (found[k].view != static_cast<int>(v) || feature.level != static_cast<int>(level)) continue;
        which.push_back(k);
        const auto& landmark = views[v].landmarks[static_cast<std::size_t>(found[k].landmark)];
        starts.push_back(rescaled(landmark.pixel, view, enlarged));
        guesses.push_back(feature.pixel);
      }
      if (which.empty()) continue;
      const Pyramid from(enlarged, options.levels, options.window_px);
      const Pyramid to(padded(image, enlarged.width(), enlarged.height()), options.levels, options.window_px);
      const auto ends = track_points(from, to, starts, guesses, options);
      for (std::size_t k = 0; k < which.size(); ++k) {
        if (ends[k] && (*ends[k] - guesses[k]).norm() <= kMaxShiftPx) result[which[k]] = ends[k];
      }
    }
  }
  return result;
}

/// Landmarks and the features that are taken for them.
struct Candidates {
  std::vector<TrackId> ids;  ///< Ascending.
  std::vector<Found> found;
  std::vector<PointSight> sights;
};

Candidates candidates_of(const std::vector<MapView>& views, const std::vector<Feature>& features, const Camera& camera,
                         const RigidTransform& cam_from_world, const SearchArea& area) {
  Candidates candidates;
  for (const auto& [id, match] : match_landmarks(views, features, camera, cam_from_world, area)) {
    const auto& landmark =
        views[static_cast<std::size_t>(match.view)].landmarks[static_cast<std::size_t>(match.landmark)];
    const Feature& feature = features[static_cast<std::size_t>(match.feature)];
    candidates.ids.push_back(id);
    candidates.found.push_back(match);
    // A corner of a reduced image is as many pixels less exact.
    candidates.sights.push_back(
        {landmark.point_in_world, feature.pixel, kReductions[static_cast<std::size_t>(feature.level)]});
  }
  return candidates;
}

/// A pose that less than a share of the landmarks agrees with is chance.
Result<Resection> with_share(Result<Resection> pose, std::size_t landmarks, double min_share) {
  if (!pose) return pose;
  const std::size_t agreed = pose->inliers.size();
  if (static_cast<double>(agreed) >= min_share * static_cast<double>(landmarks)) return pose;
  return Error{ErrorCode::kTooFewMatches,
               fmt::format("only {} of {} landmarks agree with one pose", agreed, landmarks)};
}

/// To be confirmed by the landmarks that are found with it.
Result<Resection> rough_pose(const Candidates& candidates, const Camera& camera, ResectionOptions options, Rng& rng) {
  constexpr int kMinInliers = 12;
  constexpr double kMinShare = 0.25;
  options.min_inliers = std::min(options.min_inliers, kMinInliers);
  return with_share(resect(candidates.sights, camera, options, rng), candidates.sights.size(), kMinShare);
}

}  // namespace

Result<Relocalised> relocalise(const std::vector<MapView>& views, const Image& image, const Camera& camera,
                               const RigidTransform& cam_from_world_guess, const ResectionOptions& options, Rng& rng) {
  const std::vector<Feature> features = features_of(image);
  constexpr double kFar = 0.12;  // of the image's width
  constexpr double kNear = 0.02;
  constexpr double kMaxRatio = 0.85;
  SearchArea area{Eigen::Vector2d::Zero(), kFar * camera.width(), kMaxRatio};
  const auto rough =
      rough_pose(candidates_of(views, features, camera, cam_from_world_guess, area), camera, options, rng);
  if (!rough) return rough.error();

  // With the pose known there are more to be found, and all of them more exactly.
  area.radius_px = kNear * camera.width();
  area.max_ratio = 1.0;
  const Candidates near = candidates_of(views, features, camera, rough->cam_from_world, area);
  const auto ends = followed(views, image, near.found, features);
  std::vector<PointSight> sights = near.sights;
  for (std::size_t k = 0; k < ends.size(); ++k) {
    if (ends[k]) sights[k] = {sights[k].point_in_world, *ends[k], 1.0};
  }
  constexpr double kMinShare = 0.35;
  auto refined = with_share(refine_pose(sights, camera, rough->cam_from_world, options), sights.size(), kMinShare);
  if (!refined) return refined.error();
  Relocalised result{std::move(*refined), {}};
  for (const int k : result.pose.inliers) {
    result.sights.push_back({near.ids[static_cast<std::size_t>(k)], sights[static_cast<std::size_t>(k)].pixel});
  }
  return result;
}

}  // namespace groundscale
