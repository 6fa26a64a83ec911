#pragma once

#include <optional>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "groundscale/plane/methods.hpp"

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
  double along_flow = 0.0;     ///< Gradient of the warped image along the pixel's flow, grey levels/px.
  PhotometricVector by_state;  ///< Of -difference.
};

/// Sums over the pixels.
struct PhotometricSums {
  PhotometricMatrix information = PhotometricMatrix::Zero();  ///< sum f w rho'' J^T J / s^2, f = factor.
  PhotometricVector gradient = PhotometricVector::Zero();     ///< sum f w rho' J / s^2, of the cost.
  double cost = 0.0;                                          ///< sum f w rho(difference / s) over sum f w.
  double weight = 0.0;                                        ///< sum f w.
  int pixels = 0;
};

/// The road region of two images at one size. The second is warped to the first as the start has it, and only then are
/// both smoothed and made smaller: road that has come near is as sharp then as it was far away.
class PhotometricLevel {
 public:
  /// @param start  Which pixels both images see.
  PhotometricLevel(const RoadObservations& observations, const PhotometricState& start, const DenseOptions& options,
                   int level);

  const std::vector<RoadPixel>& pixels() const { return pixels_; }
  int squares() const { return static_cast<int>(factors_.size()); }

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

  /// Makes each square count as a road point. One whose pixels say q of a shift along the flow (1/px^2) has a position
  /// of sd sqrt(1 / q + point_sd^2): the road isn't a plane, whatever its texture. So its pixels count by square_worth
  /// / (1 + q point_sd^2), and no strong edge outvotes the rest of the road.
  void weigh_squares(const PhotometricState& state, double sd, const PlaneOptions& options);
  double factor(const RoadPixel& pixel) const { return factors_[static_cast<std::size_t>(pixel.square)]; }

  /// @param with_motion  Else only what concerns m, gain and offset is filled.
  PhotometricSums sums(const PhotometricState& state, double sd, double loss_bound, bool with_motion) const;

 private:
  struct Sample;
  std::optional<Sample> sample(const Eigen::Vector2d& pixel1) const;

  CameraPtr camera_;
  double scale_;                  ///< Full pixels per pixel of this level.
  Eigen::Matrix3d ray1_of_ray2_;  ///< By the start.
  cv::Rect area_;                 ///< Of the first image.
  cv::Mat second_;  ///< Warped, of area_: grey level and its derivatives by full pixels, four floats each.
  std::vector<RoadPixel> pixels_;
  std::vector<double> factors_;  ///< Of the squares.
};

}  // namespace groundscale
