#pragma once

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "groundscale/core/image.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/tracking/detect.hpp"
#include "groundscale/tracking/klt.hpp"
#include "groundscale/tracking/stereoscan.hpp"

namespace groundscale {

/// How points are found and followed.
enum class FrontEndKind { kKlt, kStereoScan };
template <>
std::vector<std::string_view> names_of<FrontEndKind>();

struct TrackingOptions {
  FrontEndKind front_end = FrontEndKind::kKlt;
  int max_tracks = 500;
  /// Patches stretch as they come near, which large windows take for motion: 16 px doubled the rotation's error.
  KltOptions klt{.window_px = 11};
  DetectOptions detect{.cell_px = 24, .min_gradient = 2.0, .reduction = 2, .border_px = 8};
  StereoScanOptions stereoscan{};
};

void visit_fields(TrackingOptions& options, FieldVisitor& visitor);

/// What `Tracker` leaves to one way or the other: it remembers the present image as that way needs it.
class FrontEnd {
 public:
  virtual ~FrontEnd() = default;
  virtual std::unique_ptr<FrontEnd> clone() const = 0;

  using Places = std::vector<std::optional<Eigen::Vector2d>>;
  /// The next image.
  /// @param points  Of the present one.
  /// @param steps   How each came here from the one before; nothing where that isn't known.
  /// @return Where each point lies in the next image; nothing where it is lost.
  virtual Places advance(const Image& next, const std::vector<Eigen::Vector2d>& points, const Places& steps) = 0;
  /// New points of the present image, evenly spread, no more than `count`.
  /// @param mask   Where points are wanted (not 0); empty: everywhere.
  /// @param taken  Where there are some already.
  virtual std::vector<Eigen::Vector2d> find(const Image& mask, const std::vector<Eigen::Vector2d>& taken,
                                            int count) const = 0;
};

std::unique_ptr<FrontEnd> make_front_end(const TrackingOptions& options);

/// Whether a pixel lies in the image of a mask and is wanted there (not 0); an empty mask wants every one.
bool wanted_by(const Image& mask, const Eigen::Vector2d& pixel);

}  // namespace groundscale
