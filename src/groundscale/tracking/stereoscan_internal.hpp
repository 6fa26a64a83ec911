#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "groundscale/core/image.hpp"
#include "groundscale/tracking/stereoscan.hpp"

namespace groundscale {

namespace internal {

/// What features are found and compared by, a value a pixel, rows without gaps; 0 in the outer two rows and columns
/// (Sobel: 128).
struct FilterResponses {
  int width = 0;
  int height = 0;
  /// -1 on the rim, +1 around the middle, +8 in it: 0 on a flat or sloping patch.
  std::vector<std::int16_t> blob;
  /// +-1 in the quadrants, 0 between them: -1 top left.
  std::vector<std::int16_t> corner;
  /// Derivatives to the right and downwards, (1 4 6 4 1) across and (-1 -2 0 2 1) along, over 16, about 128.
  std::vector<std::uint8_t> sobel_x, sobel_y;
};

/// All four in one pass. Nothing but zeros where the image is smaller than 5x5.
FilterResponses filter_image(const Image& image);

struct ExtremumOptions {
  int width = 0;  ///< Of the image.
  int height = 0;
  int n = 3;  ///< The neighbourhood is (2 n + 1)^2.
  int min_response = 1;
  int border = 0;  ///< Extrema keep so far from the edge, and n.
};
struct Extrema {
  std::vector<Feature> minima, maxima;  ///< By blocks; `kind` is left alone.
};
/// Extrema of one filter, a block of (n + 1)^2 at a time (Neubeck, Van Gool 2006): larger (smaller) than all of their
/// neighbourhood that comes before them in reading order, no smaller (larger) than what comes after.
Extrema find_extrema(const std::vector<std::int16_t>& response, const ExtremumOptions& options);

/// Pixels that descriptors reach to each side, filters included.
inline constexpr int kFeatureBorder = 7;

/// Sobel responses at 16 places within 11x11: first those to the right, then those downwards.
using Descriptor = std::array<std::uint8_t, 32>;

/// Where a patch of 11x11 pixels about `point` lies in the second image, by Gauss-Newton from a start that is right to
/// about a pixel. Grey levels may differ by a constant.
/// @return Nothing where the patch leaves an image, has no texture in one direction, or moves away from its start.
std::optional<Eigen::Vector2d> refine_match(const Image& first, const Image& second, const Eigen::Vector2d& point,
                                            const Eigen::Vector2d& start);

/// For each match whether enough of its neighbours in the Delaunay triangulation of the first image's points move
/// alike.
std::vector<char> supported(const std::vector<Eigen::Vector2f>& points, const std::vector<Eigen::Vector2f>& flows,
                            const Image& first, const StereoScanOptions& options);

/// Features in bins of the image, and their descriptors.
struct FeatureLayer {
  static constexpr int kKinds = 4;
  static constexpr int kBinPx = 24;

  int columns = 0;
  int rows = 0;
  std::vector<Feature> features;        ///< By kind, row and column of their bin.
  std::vector<Descriptor> descriptors;  ///< One each.
  std::vector<int> starts;              ///< First feature of each bin of each kind, and the end.

  const int* bin(FeatureKind kind, int column, int row) const {
    return &starts[static_cast<std::size_t>((static_cast<int>(kind) * rows + row) * columns + column)];
  }
};

}  // namespace internal

struct FeatureSet::Data {
  internal::FeatureLayer dense, coarse;
};

}  // namespace groundscale
