#include "groundscale/tracking/klt.hpp"

#include <algorithm>

#include <opencv2/video/tracking.hpp>

#include "groundscale/core/check.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {
namespace {

struct Flow {
  std::vector<cv::Point2f> points;
  std::vector<std::uint8_t> found;
};

Flow flow(const Pyramid& from, const Pyramid& to, const std::vector<cv::Point2f>& points,
          const std::vector<cv::Point2f>& guesses, int levels, const KltOptions& options) {
  Flow result{guesses, {}};
  constexpr double kMinEigenvalue = 1e-5;  // a window without texture in one direction
  std::vector<float> error;
  cv::calcOpticalFlowPyrLK(
      from.levels().images, to.levels().images, points, result.points, result.found, error,
      {options.window_px, options.window_px}, levels,
      {cv::TermCriteria::COUNT | cv::TermCriteria::EPS, options.max_iterations, options.min_step_px},
      cv::OPTFLOW_USE_INITIAL_FLOW, kMinEigenvalue);
  return result;
}

}  // namespace

std::vector<std::optional<Eigen::Vector2d>> track_points(const Pyramid& first, const Pyramid& second,
                                                         const std::vector<Eigen::Vector2d>& points,
                                                         const std::vector<Eigen::Vector2d>& guesses,
                                                         const KltOptions& options) {
  GS_CHECK(points.size() == guesses.size(), "a guess for each point");
  std::vector<std::optional<Eigen::Vector2d>> result(points.size());
  if (points.empty()) return result;
  std::vector<cv::Point2f> starts(points.size());
  std::vector<cv::Point2f> expected(points.size());
  std::transform(points.begin(), points.end(), starts.begin(), to_cv);
  std::transform(guesses.begin(), guesses.end(), expected.begin(), to_cv);

  const Flow forth = flow(first, second, starts, expected, options.levels, options);
  // The way back starts where the point came from: it has to stay there, which one level can tell.
  const Flow back = flow(second, first, forth.points, starts, /*levels=*/0, options);
  const auto width = static_cast<float>(second.image().width() - 1);
  const auto height = static_cast<float>(second.image().height() - 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const cv::Point2f& end = forth.points[i];
    if (forth.found[i] == 0 || back.found[i] == 0) continue;
    if (!(end.x >= 0.0F && end.y >= 0.0F && end.x <= width && end.y <= height)) continue;
    if (cv::norm(back.points[i] - starts[i]) > options.max_round_trip_px) continue;
    result[i] = from_cv(end);
  }
  return result;
}

}  // namespace groundscale
