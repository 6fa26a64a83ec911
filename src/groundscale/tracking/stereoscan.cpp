#include "groundscale/tracking/stereoscan.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <limits>

#include "groundscale/core/check.hpp"
#include "groundscale/tracking/stereoscan_internal.hpp"

namespace groundscale {
namespace {

using internal::Descriptor;
using internal::FeatureLayer;

int difference(const Descriptor& a, const Descriptor& b) {
  int sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::abs(a[k] - b[k]);
  return sum;
}

/// Displacements that are looked for, ends included.
struct Window {
  int left = std::numeric_limits<int>::max();
  int right = std::numeric_limits<int>::min();
  int top = std::numeric_limits<int>::max();
  int bottom = std::numeric_limits<int>::min();

  bool empty() const { return left > right; }
  void include(int dx, int dy) {
    left = std::min(left, dx);
    right = std::max(right, dx);
    top = std::min(top, dy);
    bottom = std::max(bottom, dy);
  }
  void include(const Window& other) {
    if (other.empty()) return;
    include(other.left, other.top);
    include(other.right, other.bottom);
  }
  void widen(int margin) {
    left -= margin;
    right += margin;
    top -= margin;
    bottom += margin;
  }
};

/// Where to look from each place of an image: everywhere alike, or by what a first pass has found thereabouts.
class FlowBounds {
 public:
  explicit FlowBounds(int search_px) : bin_px_(std::numeric_limits<int>::max()), windows_(1, Window{}) {
    windows_[0].include(0, 0);
    windows_[0].widen(search_px);
  }

  FlowBounds(const Image& image, const StereoScanOptions& options)
      : bin_px_(options.bin_px),
        columns_((image.width() + bin_px_ - 1) / bin_px_),
        rows_((image.height() + bin_px_ - 1) / bin_px_),
        windows_(static_cast<std::size_t>(columns_ * rows_)) {}

  void include(const Feature& from, const Feature& to) { windows_[bin_of(from)].include(to.x - from.x, to.y - from.y); }

  /// After all are in: each bin takes in its neighbours, since flow changes within it; one that knows nothing takes
  /// what there is farther away.
  void close(const StereoScanOptions& options) {
    std::vector<Window> closed(windows_.size());
    for (int row = 0; row < rows_; ++row) {
      for (int column = 0; column < columns_; ++column) {
        Window& window = closed[static_cast<std::size_t>(row * columns_ + column)];
        for (int ring = 1; window.empty() && ring <= std::max(columns_, rows_); ++ring) {
          window = around(column, row, ring);
        }
        if (window.empty()) window.include(0, 0);
        window.widen(options.margin_px);
      }
    }
    windows_ = std::move(closed);
  }

  const Window& at(const Feature& feature) const { return windows_[bin_of(feature)]; }

 private:
  std::size_t bin_of(const Feature& feature) const {
    return static_cast<std::size_t>(feature.y / bin_px_ * columns_ + feature.x / bin_px_);
  }
  Window around(int column, int row, int ring) const {
    Window window;
    for (int v = std::max(0, row - ring); v <= std::min(rows_ - 1, row + ring); ++v) {
      for (int u = std::max(0, column - ring); u <= std::min(columns_ - 1, column + ring); ++u) {
        window.include(windows_[static_cast<std::size_t>(v * columns_ + u)]);
      }
    }
    return window;
  }

  int bin_px_;
  int columns_ = 1;
  int rows_ = 1;
  std::vector<Window> windows_;
};

constexpr int kNone = -1;

/// The feature of `layer` that is most like one of another image, within bounds; the first of equals.
int best_in(const FeatureLayer& layer, const Feature& feature, const Descriptor& descriptor, const Window& window) {
  const int left = feature.x + window.left;
  const int right = feature.x + window.right;
  const int top = feature.y + window.top;
  const int bottom = feature.y + window.bottom;
  const int first_column = std::max(0, left / FeatureLayer::kBinPx);
  const int last_column = std::min(layer.columns - 1, right / FeatureLayer::kBinPx);
  const int first_row = std::max(0, top / FeatureLayer::kBinPx);
  const int last_row = std::min(layer.rows - 1, bottom / FeatureLayer::kBinPx);
  int best = kNone;
  int least = std::numeric_limits<int>::max();
  if (right < 0 || bottom < 0 || first_column > last_column) return best;
  for (int row = first_row; row <= last_row; ++row) {
    const int begin = *layer.bin(feature.kind, first_column, row);
    const int end = *(layer.bin(feature.kind, last_column, row) + 1);
    for (int k = begin; k < end; ++k) {
      const Feature& other = layer.features[static_cast<std::size_t>(k)];
      if (other.x < left || other.x > right || other.y < top || other.y > bottom) continue;
      const int value = difference(descriptor, layer.descriptors[static_cast<std::size_t>(k)]);
      if (value < least) {
        least = value;
        best = k;
      }
    }
  }
  return best;
}

/// Forth and back: those that come back to where they started.
std::vector<FeatureMatch> match_in_circle(const FeatureLayer& first, const FeatureLayer& second,
                                          const FlowBounds& forth, const FlowBounds& back) {
  constexpr int kUnknown = -2;
  std::vector<int> returns(second.features.size(), kUnknown);
  std::vector<FeatureMatch> matches;
  for (std::size_t i = 0; i < first.features.size(); ++i) {
    const Feature& feature = first.features[i];
    const int there = best_in(second, feature, first.descriptors[i], forth.at(feature));
    if (there == kNone) continue;
    const auto j = static_cast<std::size_t>(there);
    if (returns[j] == kUnknown) {
      returns[j] = best_in(first, second.features[j], second.descriptors[j], back.at(second.features[j]));
    }
    if (returns[j] == static_cast<int>(i)) matches.push_back({static_cast<int>(i), there});
  }
  return matches;
}

void keep_supported(std::vector<FeatureMatch>& matches, const FeatureLayer& first, const FeatureLayer& second,
                    const Image& image, const StereoScanOptions& options) {
  if (options.min_support == 0) return;
  std::vector<Eigen::Vector2f> points, flows;
  for (const FeatureMatch& match : matches) {
    const Feature& a = first.features[static_cast<std::size_t>(match.first)];
    const Feature& b = second.features[static_cast<std::size_t>(match.second)];
    points.emplace_back(a.x, a.y);
    flows.emplace_back(b.x - a.x, b.y - a.y);
  }
  const std::vector<char> kept = internal::supported(points, flows, image, options);
  std::size_t count = 0;
  for (std::size_t k = 0; k < matches.size(); ++k) {
    if (kept[k] != 0) matches[count++] = matches[k];
  }
  matches.resize(count);
}

/// The matched feature that is nearest to a point, of all kinds.
int nearest_feature(const FeatureLayer& layer, const std::vector<int>& partner_of, const Eigen::Vector2d& point,
                    double reach_px) {
  const auto bin = [](double place, int count) {
    return std::clamp(static_cast<int>(std::floor(place / FeatureLayer::kBinPx)), 0, count - 1);
  };
  int best = kNone;
  double least = reach_px * reach_px;
  for (int kind = 0; kind < FeatureLayer::kKinds; ++kind) {
    for (int row = bin(point.y() - reach_px, layer.rows); row <= bin(point.y() + reach_px, layer.rows); ++row) {
      const auto of = static_cast<FeatureKind>(kind);
      const int begin = *layer.bin(of, bin(point.x() - reach_px, layer.columns), row);
      const int end = *(layer.bin(of, bin(point.x() + reach_px, layer.columns), row) + 1);
      for (int k = begin; k < end; ++k) {
        if (partner_of[static_cast<std::size_t>(k)] == kNone) continue;
        const Feature& feature = layer.features[static_cast<std::size_t>(k)];
        const double distance = (Eigen::Vector2d(feature.x, feature.y) - point).squaredNorm();
        if (distance > least || (distance == least && best != kNone)) continue;
        least = distance;
        best = k;
      }
    }
  }
  return best;
}

}  // namespace

std::vector<FeatureMatch> match_features(const FeatureSet& first, const FeatureSet& second,
                                         const StereoScanOptions& options) {
  if (first.empty() || second.empty()) return {};
  const FeatureLayer& coarse1 = first.data().coarse;
  const FeatureLayer& coarse2 = second.data().coarse;
  const FlowBounds anywhere(options.search_px);
  std::vector<FeatureMatch> coarse = match_in_circle(coarse1, coarse2, anywhere, anywhere);
  keep_supported(coarse, coarse1, coarse2, first.image(), options);

  FlowBounds forth(first.image(), options);
  FlowBounds back(second.image(), options);
  for (const FeatureMatch& match : coarse) {
    const Feature& a = coarse1.features[static_cast<std::size_t>(match.first)];
    const Feature& b = coarse2.features[static_cast<std::size_t>(match.second)];
    forth.include(a, b);
    back.include(b, a);
  }
  forth.close(options);
  back.close(options);
  std::vector<FeatureMatch> matches = match_in_circle(first.data().dense, second.data().dense, forth, back);
  keep_supported(matches, first.data().dense, second.data().dense, first.image(), options);
  return matches;
}

std::vector<std::optional<Eigen::Vector2d>> follow_features(const FeatureSet& first, const FeatureSet& second,
                                                            const std::vector<FeatureMatch>& matches,
                                                            const std::vector<Eigen::Vector2d>& points,
                                                            const StereoScanOptions& options) {
  std::vector<std::optional<Eigen::Vector2d>> found(points.size());
  if (first.empty() || second.empty()) return found;
  const FeatureLayer& layer1 = first.data().dense;
  const FeatureLayer& layer2 = second.data().dense;
  std::vector<int> partner_of(layer1.features.size(), kNone);
  for (const FeatureMatch& match : matches) partner_of[static_cast<std::size_t>(match.first)] = match.second;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int from = nearest_feature(layer1, partner_of, points[i], options.reach_px);
    if (from == kNone) continue;
    const Feature& a = layer1.features[static_cast<std::size_t>(from)];
    const Feature& b = layer2.features[static_cast<std::size_t>(partner_of[static_cast<std::size_t>(from)])];
    const Eigen::Vector2d start = points[i] + Eigen::Vector2d(b.x - a.x, b.y - a.y);
    found[i] = internal::refine_match(first.image(), second.image(), points[i], start);
  }
  return found;
}

}  // namespace groundscale
