#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "groundscale/plane/dense_options.hpp"
#include "groundscale/plane/observations.hpp"

namespace groundscale {

/// What the pixels of the road are aligned by: ray2 = R ray1 + t (m . ray1), and the second image's grey levels times
/// gain plus offset.
struct PhotometricState {
  RigidTransform motion;
  Eigen::Vector3d m = Eigen::Vector3d::Zero();
  double gain = 1.0;
  double offset = 0.0;

  Eigen::Matrix3d homography() const { return motion.rotation + motion.translation * m.transpose(); }
};

/// Places of the parameters in vectors and matrices: rotation vector left of R, t, m, gain, offset.
inline constexpr int kPhotometricSize = 11;
using PhotometricVector = Eigen::Matrix<double, kPhotometricSize, 1>;
using PhotometricMatrix = Eigen::Matrix<double, kPhotometricSize, kPhotometricSize>;

/// A pixel of the region in the reference view.
struct RoadPixel {
  Eigen::Vector3d ray;
  double grey = 0.0;
  double weight = 1.0;
  int square = 0;  ///< Of pixels whose errors may be correlated.
};

/// What one pixel says: difference = grey1 - gain grey2 - offset, and its derivative.
struct PixelError {
  double difference = 0.0;
  double grey2 = 0.0;
  double along_flow = 0.0;     ///< Gradient of the second image along the pixel's flow, grey levels/px.
  PhotometricVector by_state;  ///< Of -difference.
};

/// Sums over the pixels.
struct PhotometricSums {
  PhotometricMatrix information = PhotometricMatrix::Zero();  ///< sum w rho'' J^T J / s^2.
  PhotometricVector gradient = PhotometricVector::Zero();     ///< sum w rho' J / s^2, of the cost.
  double cost = 0.0;                                          ///< sum w rho(difference / s) over sum w.
  double weight = 0.0;                                        ///< sum w.
  double per_px2 = 0.0;  ///< What all pixels say of a common shift along the flow, 1/px^2.
  /// How many squares that say the same would say as much: (sum of what they say)^2 / sum of its square (Kish 1965).
  double effective_squares = 0.0;
  int pixels = 0;
};

/// The road region of two images at one size.
class PhotometricLevel {
 public:
  /// @param start  Which pixels both images see.
  PhotometricLevel(const RoadObservations& observations, const PhotometricState& start, const DenseOptions& options,
                   int level);

  const std::vector<RoadPixel>& pixels() const { return pixels_; }
  int squares() const { return squares_; }

  /// Nothing where the second image doesn't show the pixel.
  std::optional<PixelError> error(const RoadPixel& pixel, const PhotometricState& state) const;
  /// Grey level of the second image there.
  std::optional<double> grey2(const RoadPixel& pixel, const Eigen::Matrix3d& homography) const;

  /// 1.4826 times the median of the absolute differences, at least that of rounding to grey levels.
  double robust_sd(const PhotometricState& state) const;
  /// Weighted zero-mean normalised correlation; -1 where fewer than a fifth of the pixels are seen.
  double correlation(const Eigen::Matrix3d& homography) const;
  /// Gain and offset that make mean and sd of the second image's pixels those of the first.
  void match_brightness(PhotometricState& state) const;

  /// @param with_motion  Else only what concerns m, gain and offset is filled.
  PhotometricSums sums(const PhotometricState& state, double sd, double loss_bound, bool with_motion) const;

 private:
  struct Sample;
  std::optional<Sample> sample(const Eigen::Vector2d& pixel2) const;

  CameraPtr camera_;
  double scale_;  ///< Full pixels per pixel of this level.
  cv::Rect area2_;
  cv::Mat second_;  ///< Of area2_: grey level and its derivatives by full pixels, four floats each.
  std::vector<RoadPixel> pixels_;
  int squares_ = 0;
};

}  // namespace groundscale
