#pragma once

#include <memory>
#include <optional>
#include <string_view>

#include <Eigen/Core>

namespace groundscale {

/// A central camera: pixel <-> ray. Pixels count from the centre of the top left pixel (0, 0), x right, y down.
/// Camera axes: x right, y down, z forward. Rays are unit vectors where they come out, of any length where they go in.
class Camera {
 public:
  virtual ~Camera() = default;

  virtual std::string_view model() const = 0;
  int width() const { return width_; }
  int height() const { return height_; }

  /// Pixel of a ray; nothing where the model isn't valid (behind a pinhole, beyond the field of a fisheye, where the
  /// distortion folds back). The pixel may lie outside the image.
  virtual std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray) const = 0;

  /// The same with the derivative of the pixel by the ray (2x3).
  virtual std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& ray,
                                                 Eigen::Matrix<double, 2, 3>* pixel_by_ray) const = 0;

  /// Unit ray of a pixel, the inverse of project; nothing where no ray of the valid field maps there.
  virtual std::optional<Eigen::Vector3d> ray(const Eigen::Vector2d& pixel) const = 0;

  /// Pixels per radian in the middle of the image: turns pixel thresholds into angles.
  virtual double focal_px() const = 0;

  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() < width_ - 0.5 && pixel.y() < height_ - 0.5;
  }

 protected:
  Camera(int width, int height) : width_(width), height_(height) {}
  Camera(const Camera&) = default;
  Camera& operator=(const Camera&) = default;

 private:
  int width_;
  int height_;
};

using CameraPtr = std::shared_ptr<const Camera>;

}  // namespace groundscale
