#include "groundscale/road/road_detector.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include <opencv2/imgproc.hpp>

#include "groundscale/core/check.hpp"
#include "groundscale/road/warp_field_internal.hpp"
#include "groundscale/tracking/opencv_internal.hpp"

namespace groundscale {

Image carry_mask(const Image& mask_in_1, const RoadWarp& warp, const Camera& camera) {
  GS_CHECK(mask_in_1.width() == camera.width() && mask_in_1.height() == camera.height(), "a mask of the camera's size");
  const RigidTransform cam1_from_cam2 = warp.cam2_from_cam1.inverse();
  const Eigen::Vector3d road_in_cam2 = warp.road_in_cam1.seen_from(warp.cam2_from_cam1).inverse_form();
  const auto ray1_of_ray2 = [&](const Eigen::Vector3d& ray2) -> Eigen::Vector3d {
    return cam1_from_cam2.rotation * ray2 + cam1_from_cam2.translation * std::max(0.0, road_in_cam2.dot(ray2));
  };
  constexpr std::uint8_t kAllowed = 255;
  const WarpField field({0, 0, camera.width(), camera.height()}, camera, ray1_of_ray2);
  Image carried = field.warp(mask_in_1, kAllowed);
  cv::Mat view = view_of(carried);
  constexpr double kHalf = 127.0;
  cv::threshold(view, view, kHalf, kAllowed, cv::THRESH_BINARY);
  return carried;
}

Result<RoadDetector> RoadDetector::open(const RoadNetworkOptions& options, CameraPtr camera) {
  GS_CHECK(camera != nullptr, "a camera");
  auto network = RoadNetwork::open(options);
  if (!network) return network.error();
  return RoadDetector(std::move(*network), options.every, std::move(camera));
}

RoadDetector::RoadDetector(RoadNetwork network, int every, CameraPtr camera)
    : network_(std::move(network)), every_(every), camera_(std::move(camera)) {}

Image RoadDetector::advance(const Image& frame, const std::optional<RoadWarp>& frame_from_last) {
  GS_CHECK(frame.width() == camera_->width() && frame.height() == camera_->height(), "a frame of the camera's size");
  if (!mask_.empty() && frame_from_last && carried_ + 1 < every_) {
    ++carried_;
    mask_ = carry_mask(mask_, *frame_from_last, *camera_);
    return mask_;
  }
  const auto start = std::chrono::steady_clock::now();
  const auto mask = network_.detect(frame);
  network_s_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  GS_CHECK(mask.has_value(), "a network that ran when it was opened");
  mask_ = *mask;
  carried_ = 0;
  ++runs_;
  return mask_;
}

}  // namespace groundscale
