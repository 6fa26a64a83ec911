#include "groundscale/report/overlay.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {
namespace {

const cv::Scalar kGreen(80, 200, 80);
const cv::Scalar kRed(60, 60, 230);
const cv::Scalar kYellow(0, 230, 255);
const cv::Scalar kMagenta(220, 60, 220);
const cv::Scalar kWhite(255, 255, 255);
constexpr int kFraction = 4;

cv::Point sub_pixel(const Eigen::Vector2d& pixel) {
  constexpr double kOne = 1 << kFraction;
  constexpr double kBound = 30000.0;
  return {static_cast<int>(std::lround(std::clamp(pixel.x(), -kBound, kBound) * kOne)),
          static_cast<int>(std::lround(std::clamp(pixel.y(), -kBound, kBound) * kOne))};
}

void draw_line(cv::Mat& picture, const Eigen::Vector2d& from, const Eigen::Vector2d& to, const cv::Scalar& colour) {
  cv::line(picture, sub_pixel(from), sub_pixel(to), colour, 1, cv::LINE_AA, kFraction);
}

void tint(cv::Mat& picture, const Image& region) {
  if (region.empty()) return;
  cv::Mat tinted = picture.clone();
  tinted.setTo(cv::Scalar(200, 120, 40), view_of(region));
  constexpr double kStrength = 0.25;
  cv::addWeighted(tinted, kStrength, picture, 1.0 - kStrength, 0.0, picture);
}

/// So that what doesn't fit tells in grey too.
void draw_cross(cv::Mat& picture, const Eigen::Vector2d& middle, const cv::Scalar& colour) {
  const Eigen::Vector2d down(2.5, 2.5);
  const Eigen::Vector2d up(2.5, -2.5);
  draw_line(picture, middle - down, middle + down, colour);
  draw_line(picture, middle - up, middle + up, colour);
}

/// Lines of the plane 5, 10, 15, 20 m ahead and up to 4 m to each side.
std::vector<OverlayParts::Line> plane_lines(const GroundPlane& road, const Eigen::Vector3d& forward,
                                            const Camera& camera) {
  constexpr double kSideM = 4.0;
  const DrivenPath straight{(forward - road.normal_in_cam * road.normal_in_cam.dot(forward)).normalized(), 0.0};
  std::vector<OverlayParts::Line> lines;
  const auto line = [&](double along1, double aside1, double along2, double aside2) {
    constexpr int kPieces = 10;
    for (int k = 0; k < kPieces; ++k) {
      const auto at = [&](int i) {
        const double share = static_cast<double>(i) / kPieces;
        return camera.project(
            point_on_path(straight, road, along1 + share * (along2 - along1), aside1 + share * (aside2 - aside1)));
      };
      const auto from = at(k);
      const auto to = at(k + 1);
      if (from && to) lines.push_back({*from, *to});
    }
  };
  for (const double along : {5.0, 10.0, 15.0, 20.0}) line(along, -kSideM, along, kSideM);
  for (const double aside : {-4.0, -2.0, 0.0, 2.0, 4.0}) line(4.0, aside, 20.0, aside);
  return lines;
}

void add_matches(const Matches& matches, const std::vector<int>& inliers, bool road, OverlayParts& parts) {
  std::vector<bool> is_inlier(matches.size(), false);
  for (const int i : inliers) is_inlier[static_cast<std::size_t>(i)] = true;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    parts.matches.push_back({{matches[i].pixel1, matches[i].pixel2}, road, is_inlier[i]});
  }
}

/// A copy, perhaps a smaller one.
Image shrunk(const Image& image, int width, int height, int interpolation) {
  if (image.empty()) return {};
  Image small(width, height);
  cv::Mat target = view_of(small);
  cv::resize(view_of(image), target, target.size(), 0.0, 0.0, interpolation);
  return small;
}

void shrink(double factor, OverlayParts& parts) {
  const int width = std::max(1, static_cast<int>(std::lround(factor * parts.image.width())));
  const int height = std::max(1, static_cast<int>(std::lround(factor * parts.image.height())));
  parts.image = shrunk(parts.image, width, height, cv::INTER_AREA);
  parts.region = shrunk(parts.region, width, height, cv::INTER_NEAREST);
  // A pixel's centre has whole coordinates.
  const auto move = [factor](OverlayParts::Line& line) {
    for (Eigen::Vector2d* end : {&line.from, &line.to}) *end = (factor * (end->array() + 0.5) - 0.5).matrix();
  };
  for (OverlayParts::Line& line : parts.plane) move(line);
  for (OverlayParts::Match& match : parts.matches) move(match.line);
}

cv::Mat draw(const OverlayParts& parts) {
  cv::Mat picture;
  cv::cvtColor(view_of(parts.image), picture, cv::COLOR_GRAY2BGR);
  tint(picture, parts.region);
  for (const OverlayParts::Line& line : parts.plane) draw_line(picture, line.from, line.to, kWhite);
  for (const OverlayParts::Match& match : parts.matches) {
    const cv::Scalar& colour = match.road ? (match.fits ? kYellow : kMagenta) : (match.fits ? kGreen : kRed);
    draw_line(picture, match.line.from, match.line.to, colour);
    if (match.fits) {
      cv::circle(picture, sub_pixel(match.line.from), 2 << kFraction, colour, 1, cv::LINE_AA, kFraction);
    } else {
      draw_cross(picture, match.line.from, colour);
    }
  }
  return picture;
}

}  // namespace

OverlayParts overlay_parts(const Frame& frame, const Odometry& odometry, const Camera& camera, int most_width_px) {
  const FrameDetails details = odometry.details();
  OverlayParts parts;
  parts.image = details.reference_image.empty() ? frame.image : details.reference_image;
  if (parts.image.empty()) {
    parts.image = Image(camera.width(), camera.height());
    view_of(parts.image).setTo(0);
  }
  parts.region = details.region;
  if (!details.region.empty()) {
    parts.plane = plane_lines(details.road, odometry.mounting().forward_in_cam(), camera);
  }
  // Indices of inliers are those of ray pairs, which are the matches where every pixel has a ray.
  if (details.pairs.size() == details.matches.size()) add_matches(details.matches, details.inliers, false, parts);
  add_matches(details.road_matches, details.road_inliers, true, parts);
  if (most_width_px > 0) shrink(std::min(1.0, static_cast<double>(most_width_px) / parts.image.width()), parts);
  return parts;
}

Result<void> write_overlay(const std::string& folder, const Frame& frame, const Odometry& odometry,
                           const Camera& camera) {
  const FrameResult& result = odometry.results().back();
  cv::Mat picture = draw(overlay_parts(frame, odometry, camera, 0));

  constexpr double kDegree = std::numbers::pi / 180.0;
  std::string text = fmt::format("{} {}", result.frame, name_of(result.state));
  if (result.scaled) text += fmt::format("  step {:.3f} m", result.online_step_m);
  if (result.raw_over_online) text += fmt::format("  raw {:.3f} m", *result.raw_over_online * result.online_step_m);
  if (result.pitch_rad)
    text += fmt::format("  pitch {:.2f} roll {:.2f}", *result.pitch_rad / kDegree, *result.roll_rad / kDegree);
  text += fmt::format("  road {}/{}  {}", result.road_inliers, result.road_matches, result.reason);
  cv::putText(picture, text, {8, 18}, cv::FONT_HERSHEY_SIMPLEX, 0.5, {0, 0, 0}, 3, cv::LINE_AA);
  cv::putText(picture, text, {8, 18}, cv::FONT_HERSHEY_SIMPLEX, 0.5, kWhite, 1, cv::LINE_AA);

  const std::string path = fmt::format("{}/{:06}.png", folder, result.frame);
  bool written = false;
  try {
    written = cv::imwrite(path, picture);
  } catch (const cv::Exception&) {
    written = false;
  }
  if (!written) return Error{ErrorCode::kIo, fmt::format("{}: can't be written", path)};
  return {};
}

std::string overlay_jpeg(const OverlayParts& parts) {
  constexpr int kQuality = 80;
  std::vector<unsigned char> bytes;
  try {
    if (!cv::imencode(".jpg", draw(parts), bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality})) return "";
  } catch (const cv::Exception&) {
    return "";
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace groundscale
