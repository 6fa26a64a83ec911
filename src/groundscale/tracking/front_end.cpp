#include "groundscale/tracking/front_end.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>

#include "groundscale/tracking/bucketing.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {
namespace {

/// Corners (Shi, Tomasi 1994), followed by image alignment (Lucas, Kanade 1981).
class KltFrontEnd : public FrontEnd {
 public:
  explicit KltFrontEnd(const TrackingOptions& options) : klt_(options.klt), detect_(options.detect) {}
  std::unique_ptr<FrontEnd> clone() const override { return std::make_unique<KltFrontEnd>(*this); }

  Places advance(const Image& next, const std::vector<Eigen::Vector2d>& points, const Places& steps) override {
    Pyramid pyramid(next, klt_.levels, klt_.window_px);
    Places found(points.size());
    if (!present_.empty() && !points.empty()) found = follow(pyramid, points, steps);
    present_ = std::move(pyramid);
    return found;
  }

  std::vector<Eigen::Vector2d> find(const Image& mask, const std::vector<Eigen::Vector2d>& taken,
                                    int count) const override {
    return thin_out(detect_corners(present_.image(), mask, taken, detect_), count);
  }

 private:
  /// Points with a history go on as they went, which few levels of the pyramid can correct; new ones need all of them,
  /// and start where they are.
  Places follow(const Pyramid& next, const std::vector<Eigen::Vector2d>& points, const Places& steps) const {
    constexpr int kLevelsWithHistory = 2;
    KltOptions few = klt_;
    few.levels = std::min(few.levels, kLevelsWithHistory);
    Places found(points.size());
    for (const bool old : {true, false}) {
      std::vector<Eigen::Vector2d> starts;
      std::vector<Eigen::Vector2d> guesses;
      std::vector<std::size_t> which;
      for (std::size_t i = 0; i < points.size(); ++i) {
        if (steps[i].has_value() != old) continue;
        which.push_back(i);
        starts.push_back(points[i]);
        guesses.push_back(points[i] + steps[i].value_or(Eigen::Vector2d::Zero()));
      }
      const auto part = track_points(present_, next, starts, guesses, old ? few : klt_);
      for (std::size_t k = 0; k < which.size(); ++k) found[which[k]] = part[k];
    }
    return found;
  }

  KltOptions klt_;
  DetectOptions detect_;
  Pyramid present_;
};

/// Features of both images, matched in a circle (Geiger, Ziegler, Stiller 2011).
class StereoScanFrontEnd : public FrontEnd {
 public:
  explicit StereoScanFrontEnd(const TrackingOptions& options)
      : options_(options.stereoscan), cell_px_(options.detect.cell_px) {}
  std::unique_ptr<FrontEnd> clone() const override { return std::make_unique<StereoScanFrontEnd>(*this); }

  Places advance(const Image& next, const std::vector<Eigen::Vector2d>& points, const Places& /*steps*/) override {
    FeatureSet features(next, options_);
    const std::vector<FeatureMatch> matches = match_features(present_, features, options_);
    Places found = follow_features(present_, features, matches, points, options_);
    proven_.assign(features.features().size(), 0);
    for (const FeatureMatch& match : matches) proven_[static_cast<std::size_t>(match.second)] = 1;
    present_ = std::move(features);
    return found;
  }

  /// Features that were matched with the image before are likely to be matched with the next one as well.
  std::vector<Eigen::Vector2d> find(const Image& mask, const std::vector<Eigen::Vector2d>& taken,
                                    int count) const override {
    const std::vector<Feature>& features = present_.features();
    std::vector<std::size_t> order;
    for (std::size_t k = 0; k < features.size(); ++k) {
      if (wanted_by(mask, {features[k].x, features[k].y})) order.push_back(k);
    }
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      return proven_[a] != proven_[b] ? proven_[a] > proven_[b] : features[a].strength > features[b].strength;
    });
    std::vector<Eigen::Vector2d> places;
    for (const std::size_t k : order) places.emplace_back(features[k].x, features[k].y);
    std::vector<Eigen::Vector2d> chosen;
    for (const std::size_t k : pick_evenly(places, taken, cell_px_, count)) chosen.push_back(places[k]);
    return chosen;
  }

 private:
  StereoScanOptions options_;
  int cell_px_;
  FeatureSet present_;
  std::vector<char> proven_;  ///< Of each feature of the present image: matched with the one before.
};

}  // namespace

template <>
std::vector<std::string_view> names_of<FrontEndKind>() {
  return {"klt", "stereoscan"};
}

std::unique_ptr<FrontEnd> make_front_end(const TrackingOptions& options) {
  if (options.front_end == FrontEndKind::kStereoScan) return std::make_unique<StereoScanFrontEnd>(options);
  return std::make_unique<KltFrontEnd>(options);
}

bool wanted_by(const Image& mask, const Eigen::Vector2d& pixel) {
  if (mask.empty()) return true;
  const int x = static_cast<int>(std::lround(pixel.x()));
  const int y = static_cast<int>(std::lround(pixel.y()));
  return x >= 0 && y >= 0 && x < mask.width() && y < mask.height() && mask.at(x, y) != 0;
}

void visit_fields(TrackingOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "front_end", .unit = "", .help = "how points of the whole image are found and followed"},
                options.front_end);
  visitor.field(
      {.key = "max_tracks", .unit = "", .help = "points followed over the whole image", .min = 50, .max = 20000},
      options.max_tracks);
  visitor.field(
      {.key = "cell_px", .unit = "px", .help = "one new point at most in each cell of this size", .min = 8, .max = 200},
      options.detect.cell_px);
  visitor.field({.key = "min_gradient",
                 .unit = "grey levels/px",
                 .help = "weakest texture that a new point may have (klt)",
                 .min = 0.1,
                 .max = 100},
                options.detect.min_gradient);
  visitor.field(
      {.key = "window_px", .unit = "px", .help = "side of the patch that is followed (klt)", .min = 5, .max = 61},
      options.klt.window_px);
  visitor.field(
      {.key = "levels", .unit = "", .help = "halvings of the image for large motion (klt)", .min = 0, .max = 8},
      options.klt.levels);
  visitor.field({.key = "max_round_trip_px",
                 .unit = "px",
                 .help = "how far a point may be from where it started after tracking forth and back (klt)",
                 .min = 0.01,
                 .max = 10},
                options.klt.max_round_trip_px);
  visitor.group("stereoscan", options.stereoscan);
}

}  // namespace groundscale
