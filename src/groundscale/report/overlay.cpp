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

void draw_matches(cv::Mat& picture, const Matches& matches, const std::vector<int>& inliers, const cv::Scalar& good,
                  const cv::Scalar& bad) {
  std::vector<bool> is_inlier(matches.size(), false);
  for (const int i : inliers) is_inlier[static_cast<std::size_t>(i)] = true;
  for (std::size_t i = 0; i < matches.size(); ++i) {
    const cv::Scalar& colour = is_inlier[i] ? good : bad;
    draw_line(picture, matches[i].pixel1, matches[i].pixel2, colour);
    cv::circle(picture, sub_pixel(matches[i].pixel1), 2 << kFraction, colour, 1, cv::LINE_AA, kFraction);
  }
}

/// Lines of the plane 5, 10, 15, 20 m ahead and up to 4 m to each side.
void draw_plane(cv::Mat& picture, const GroundPlane& road, const Eigen::Vector3d& forward, const Camera& camera) {
  constexpr double kSideM = 4.0;
  const DrivenPath straight{(forward - road.normal_in_cam * road.normal_in_cam.dot(forward)).normalized(), 0.0};
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
      if (from && to) draw_line(picture, *from, *to, kWhite);
    }
  };
  for (const double along : {5.0, 10.0, 15.0, 20.0}) line(along, -kSideM, along, kSideM);
  for (const double aside : {-4.0, -2.0, 0.0, 2.0, 4.0}) line(4.0, aside, 20.0, aside);
}

cv::Mat draw_overlay(const Frame& frame, const Odometry& odometry, const Camera& camera) {
  const FrameDetails& details = odometry.details();
  const Image& base = details.reference_image.empty() ? frame.image : details.reference_image;
  cv::Mat picture;
  if (base.empty()) {
    picture = cv::Mat::zeros(camera.height(), camera.width(), CV_8UC3);
  } else {
    cv::cvtColor(view_of(base), picture, cv::COLOR_GRAY2BGR);
  }
  tint(picture, details.region);
  if (!details.region.empty()) draw_plane(picture, details.road, odometry.mounting().forward_in_cam(), camera);
  // Indices of inliers are those of ray pairs, which are the matches where every pixel has a ray.
  if (details.pairs.size() == details.matches.size())
    draw_matches(picture, details.matches, details.inliers, kGreen, kRed);
  draw_matches(picture, details.road_matches, details.road_inliers, kYellow, kMagenta);
  return picture;
}

}  // namespace

Result<void> write_overlay(const std::string& folder, const Frame& frame, const Odometry& odometry,
                           const Camera& camera) {
  const FrameResult& result = odometry.results().back();
  cv::Mat picture = draw_overlay(frame, odometry, camera);

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

std::string overlay_jpeg(const Frame& frame, const Odometry& odometry, const Camera& camera, int most_width_px) {
  constexpr int kQuality = 80;
  std::vector<unsigned char> bytes;
  try {
    cv::Mat picture = draw_overlay(frame, odometry, camera);
    if (picture.cols > most_width_px) {
      const double factor = static_cast<double>(most_width_px) / picture.cols;
      cv::Mat smaller;
      cv::resize(picture, smaller, {}, factor, factor, cv::INTER_AREA);
      picture = smaller;
    }
    if (!cv::imencode(".jpg", picture, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality})) return "";
  } catch (const cv::Exception&) {
    return "";
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace groundscale
