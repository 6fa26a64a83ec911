#pragma once

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/calibration/residual_map.hpp"
#include "groundscale/odometry/scale_slope.hpp"

namespace groundscale::internal {

/// Cells with fewer residuals are left out.
inline constexpr int kLeastResiduals = 30;

/// What residual maps that are compared have in common.
struct MapScale {
  double magnification = 1.0;   ///< Of arrows over the image's own scale.
  double colour_step_px = 0.1;  ///< Of the mean residual, from one colour to the next.
};

/// The longest arrow of all maps spans its cell at most, and most of it.
MapScale common_scale(const std::vector<const ResidualMap*>& maps);

/// Of mean residuals, one a step; they darken, so that they tell in grey too.
inline constexpr std::array<std::string_view, 5> kResidualColours = {"#fffaf3", "#fee8cc", "#fdcf9b", "#fdb06a",
                                                                     "#f58a3c"};
inline constexpr std::string_view kLeftOutColour = "#ececec";

/// Arrows and colours over the frame of the image. @param name  For readers that see no pictures.
std::string residual_map_svg(const ResidualMap& map, const MapScale& scale, std::string_view name);

/// A colour or mark as it looks in a figure, to stand in the text beside it.
std::string colour_key(std::string_view colour);
enum class SlopeSeries { kBefore, kAfter };
std::string slope_key(SlopeSeries series);

struct SlopeFigure {
  std::string svg;
  int drawn = 0;    ///< Measurements that are drawn, of
  int within = 0;   ///< those within the figure's range,
  int outside = 0;  ///< and those that aren't.
};

/// Scale of the odometry over the ground's by distance, with the lines. @param before, after  Either may be null.
SlopeFigure slope_figure(const ScaleSlope* before, const ScaleSlope* after, std::string_view name);

}  // namespace groundscale::internal
