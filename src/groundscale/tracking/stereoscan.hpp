#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/core/image.hpp"
#include "groundscale/core/options.hpp"

namespace groundscale {

/// Feature matching after Geiger, Ziegler, Stiller, "StereoScan: Dense 3d Reconstruction in Real-time" (IV 2011), for
/// one camera: extrema of a blob and a corner filter, compared by Sobel responses, found forth and back.
struct StereoScanOptions {
  int min_response = 80;            ///< Of a feature; the blob filter answers 16 a grey level, the corner filter 8.
  int nms_px = 4;                   ///< A feature is the strongest of its kind within so many pixels to each side,
  int coarse_nms_px = 9;            ///< one of the first pass within so many.
  int search_px = 120;              ///< Largest displacement to each side that the first pass looks for.
  int bin_px = 50;                  ///< Displacements of the first pass bound those of the second in bins of this size,
  int margin_px = 5;                ///< widened by so much.
  double max_flow_change_px = 5.0;  ///< A match is supported by a neighbour whose displacement differs by less.
  int min_support = 2;              ///< Neighbours (Delaunay) that must support it; 0: matches aren't judged so.
  double reach_px = 6.0;            ///< A point goes as the nearest matched feature does, no farther away than this.
};

void visit_fields(StereoScanOptions& options, FieldVisitor& visitor);

/// Blob minimum and maximum, corner minimum and maximum: only like is matched with like.
enum class FeatureKind : std::uint8_t { kBlobMin, kBlobMax, kCornerMin, kCornerMax };

struct Feature {
  std::int16_t x = 0;
  std::int16_t y = 0;
  FeatureKind kind = FeatureKind::kBlobMin;
  std::int16_t strength = 0;  ///< |filter response|
};

/// The features of an image. Made once an image and handed on: copies share what they hold. Deterministic;
/// O(pixels).
class FeatureSet {
 public:
  struct Data;  ///< In stereoscan_internal.hpp.

  FeatureSet() = default;
  FeatureSet(const Image& image, const StereoScanOptions& options);

  bool empty() const { return data_ == nullptr; }
  /// All of the second pass, in an order of their own: by kind and place. Empty where the image is too small.
  const std::vector<Feature>& features() const;
  const Image& image() const { return image_; }
  const Data& data() const { return *data_; }

 private:
  Image image_;
  std::shared_ptr<const Data> data_;
};

/// Indices into FeatureSet::features.
struct FeatureMatch {
  int first = 0;
  int second = 0;
};

/// Features of two images that find each other: the best of its kind (sum of absolute differences of the descriptors)
/// in the second image, whose own best in the first is the feature itself. A first pass over few features says where
/// the second one has to look; what no two neighbours support is left out.
/// @return In the order of the first image's features; whole pixels, `follow_features` is finer.
std::vector<FeatureMatch> match_features(const FeatureSet& first, const FeatureSet& second,
                                         const StereoScanOptions& options);

/// Where points of the first image lie in the second: each starts from the displacement of the nearest feature that is
/// matched, no farther away than `reach_px`, and is placed to a fraction of a pixel by least squares over the grey
/// levels of 11x11 pixels about it, which may differ by a constant.
/// @return A point each; nothing without such a feature, or where least squares lead more than 1.5 px away.
std::vector<std::optional<Eigen::Vector2d>> follow_features(const FeatureSet& first, const FeatureSet& second,
                                                            const std::vector<FeatureMatch>& matches,
                                                            const std::vector<Eigen::Vector2d>& points,
                                                            const StereoScanOptions& options);

}  // namespace groundscale
