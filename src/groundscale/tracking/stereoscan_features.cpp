#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>

#include "groundscale/core/check.hpp"
#include "groundscale/tracking/stereoscan_internal.hpp"

namespace groundscale {
namespace {

using internal::Descriptor;
using internal::FeatureLayer;
using internal::FilterResponses;

struct Offset {
  int x, y;
};
/// Dense in the middle, where both views agree best, and out to all sides.
constexpr std::array<Offset, 16> kPlaces = {{{-1, -1},
                                             {1, -1},
                                             {-1, 1},
                                             {1, 1},
                                             {0, -3},
                                             {-3, 0},
                                             {3, 0},
                                             {0, 3},
                                             {-2, -5},
                                             {2, -5},
                                             {-5, -2},
                                             {5, -2},
                                             {-5, 2},
                                             {5, 2},
                                             {-2, 5},
                                             {2, 5}}};

Descriptor describe(const FilterResponses& responses, const Feature& feature) {
  Descriptor descriptor;
  for (std::size_t k = 0; k < kPlaces.size(); ++k) {
    const auto at = static_cast<std::size_t>((feature.y + kPlaces[k].y) * responses.width + feature.x + kPlaces[k].x);
    descriptor[k] = responses.sobel_x[at];
    descriptor[k + kPlaces.size()] = responses.sobel_y[at];
  }
  return descriptor;
}

std::vector<Feature> find_features(const FilterResponses& responses, const StereoScanOptions& options) {
  std::vector<Feature> all;
  const internal::ExtremumOptions extremum{.width = responses.width,
                                           .height = responses.height,
                                           .n = options.nms_px,
                                           .min_response = options.min_response,
                                           .border = internal::kFeatureBorder};
  const auto take = [&all](const std::vector<Feature>& some, FeatureKind kind) {
    for (Feature feature : some) {
      feature.kind = kind;
      all.push_back(feature);
    }
  };
  const internal::Extrema blobs = find_extrema(responses.blob, extremum);
  take(blobs.minima, FeatureKind::kBlobMin);
  take(blobs.maxima, FeatureKind::kBlobMax);
  const internal::Extrema corners = find_extrema(responses.corner, extremum);
  take(corners.minima, FeatureKind::kCornerMin);
  take(corners.maxima, FeatureKind::kCornerMax);
  return all;
}

/// Features sorted into bins.
FeatureLayer layer_of(const FilterResponses& responses, const std::vector<Feature>& features) {
  FeatureLayer layer;
  layer.columns = (responses.width + FeatureLayer::kBinPx - 1) / FeatureLayer::kBinPx;
  layer.rows = (responses.height + FeatureLayer::kBinPx - 1) / FeatureLayer::kBinPx;
  const auto bin_of = [&layer](const Feature& feature) {
    return static_cast<std::size_t>((static_cast<int>(feature.kind) * layer.rows + feature.y / FeatureLayer::kBinPx) *
                                        layer.columns +
                                    feature.x / FeatureLayer::kBinPx);
  };
  layer.starts.assign(static_cast<std::size_t>(FeatureLayer::kKinds * layer.rows * layer.columns) + 1, 0);
  for (const Feature& feature : features) ++layer.starts[bin_of(feature) + 1];
  for (std::size_t k = 1; k < layer.starts.size(); ++k) layer.starts[k] += layer.starts[k - 1];
  std::vector<int> next = layer.starts;
  layer.features.resize(features.size());
  layer.descriptors.resize(features.size());
  for (const Feature& feature : features) {
    const auto place = static_cast<std::size_t>(next[bin_of(feature)]++);
    layer.features[place] = feature;
    layer.descriptors[place] = describe(responses, feature);
  }
  return layer;
}

/// Those that no stronger feature of their kind lies near, the first of equals.
std::vector<Feature> strongest_of(const FeatureLayer& layer, int n) {
  std::vector<Feature> strongest;
  for (std::size_t i = 0; i < layer.features.size(); ++i) {
    const Feature& feature = layer.features[i];
    const int first_column = std::max(0, (feature.x - n) / FeatureLayer::kBinPx);
    const int last_column = std::min(layer.columns - 1, (feature.x + n) / FeatureLayer::kBinPx);
    const int first_row = std::max(0, (feature.y - n) / FeatureLayer::kBinPx);
    const int last_row = std::min(layer.rows - 1, (feature.y + n) / FeatureLayer::kBinPx);
    bool beaten = false;
    for (int row = first_row; row <= last_row && !beaten; ++row) {
      const auto begin = static_cast<std::size_t>(*layer.bin(feature.kind, first_column, row));
      const auto end = static_cast<std::size_t>(*(layer.bin(feature.kind, last_column, row) + 1));
      for (std::size_t k = begin; k < end && !beaten; ++k) {
        const Feature& other = layer.features[k];
        const bool stronger = other.strength > feature.strength || (other.strength == feature.strength && k < i);
        beaten = stronger && std::abs(other.x - feature.x) <= n && std::abs(other.y - feature.y) <= n;
      }
    }
    if (!beaten) strongest.push_back(feature);
  }
  return strongest;
}

}  // namespace

void visit_fields(StereoScanOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "min_response",
                 .unit = "",
                 .help = "of a feature; the blob filter answers 16 a grey level, the corner filter 8",
                 .min = 1,
                 .max = 4080},
                options.min_response);
  visitor.field({.key = "nms_px",
                 .unit = "px",
                 .help = "a feature is the strongest of its kind within so much to each side",
                 .min = 1,
                 .max = 50},
                options.nms_px);
  visitor.field({.key = "coarse_nms_px", .unit = "px", .help = "the same in the first pass", .min = 1, .max = 100},
                options.coarse_nms_px);
  visitor.field({.key = "search_px",
                 .unit = "px",
                 .help = "largest displacement to each side that the first pass looks for",
                 .min = 1,
                 .max = 1000},
                options.search_px);
  visitor.field({.key = "bin_px",
                 .unit = "px",
                 .help = "bins in which displacements of the first pass bound those of the second",
                 .min = 10,
                 .max = 1000},
                options.bin_px);
  visitor.field({.key = "margin_px", .unit = "px", .help = "by which these bounds are widened", .min = 1, .max = 100},
                options.margin_px);
  visitor.field({.key = "max_flow_change_px",
                 .unit = "px",
                 .help = "a match is supported by a neighbour whose displacement differs by less",
                 .min = 0.1,
                 .max = 100},
                options.max_flow_change_px);
  visitor.field(
      {.key = "min_support", .unit = "", .help = "neighbours that must support a match; 0: none", .min = 0, .max = 5},
      options.min_support);
  visitor.field({.key = "reach_px",
                 .unit = "px",
                 .help = "a point starts from the displacement of the nearest matched feature within so much",
                 .min = 0.5,
                 .max = 100},
                options.reach_px);
}

FeatureSet::FeatureSet(const Image& image, const StereoScanOptions& options) : image_(image) {
  constexpr int kLargest = 32767;
  GS_CHECK(image.width() <= kLargest && image.height() <= kLargest, "places of features are 16-bit");
  const FilterResponses responses = internal::filter_image(image);
  auto data = std::make_shared<Data>();
  data->dense = layer_of(responses, find_features(responses, options));
  data->coarse = layer_of(responses, strongest_of(data->dense, options.coarse_nms_px));
  data_ = std::move(data);
}

const std::vector<Feature>& FeatureSet::features() const {
  GS_CHECK(data_ != nullptr, "a set that was made from an image");
  return data_->dense.features;
}

}  // namespace groundscale
