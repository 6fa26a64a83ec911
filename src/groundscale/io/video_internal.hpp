#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/io/sequence.hpp"

namespace groundscale::internal {

/// Frame times of a video from its presentation times, which OpenCV 4.6 hands out as 0 for the last frames and twice
/// for some: one that doesn't rise is replaced by the time before plus the median frame time so far.
class RisingTimes {
 public:
  /// @param frames_per_second  As the container declares it, for the time before a median is known; 30 if not above 0.
  explicit RisingTimes(double frames_per_second);
  double next(double presented_s);

 private:
  double median_step_s() const;
  double nominal_step_s_;
  std::optional<double> last_s_;
  std::vector<double> steps_s_;  ///< Between neighbours whose times both were as presented.
  bool last_as_presented_ = false;
};

/// A video file. Its rotation as the container says is applied by quarter turns; frames before `start` are decoded and
/// dropped, so that frame numbers and times are exact.
Result<std::unique_ptr<Sequence>> open_video(const SequenceRequest& request);

}  // namespace groundscale::internal
