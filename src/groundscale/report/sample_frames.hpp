#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/io/sequence.hpp"
#include "groundscale/odometry/odometry.hpp"

namespace groundscale {

/// A frame's picture for a report, and why it is shown.
struct SampleFrame {
  int frame = 0;        ///< Its number in the source.
  std::string why;      ///< "error", "deviation", "refused" or "spread".
  double value = 0.0;   ///< Error: |log(step / true step)|. Deviation: in standard deviations.
  std::string picture;  ///< Bytes of a JPEG file.
};

/// Picks frames to look at while a drive goes on, of which only its end tells which they are: the worst, the refused,
/// and others spread evenly.
///
/// What a picture is drawn from is put aside when its frame enters (overlay_parts, at most 960 px wide), so that most
/// frames cost nothing; at most 4 + 6 + 8 are held, and only those that are chosen in the end are drawn. A frame enters
/// the worst where it is worse by a tenth than the least of them, or than the one that lies within 2 % of the drive of
/// it, whose place it takes: worst ones that lie apart.
class SampleFrames {
 public:
  /// @param frames  That the drive has, as far as that is known.
  explicit SampleFrames(int frames) : frames_(frames) {}

  /// The latest frame. @param true_step_m  Distance of the truth to the frame before; empty without truth: what counts
  /// then is by how many of its sds a measurement deviates from the filtered step.
  void take(const Frame& frame, const Odometry& odometry, const Camera& camera, std::optional<double> true_step_m);

  /// Draws the picture of a frame that was put aside: bytes of a JPEG file.
  using DrawPicture = std::function<std::string()>;
  using PutAside = std::function<DrawPicture()>;
  /// The rules by themselves: what `take` does with a frame's result. @param put_aside  Called where it enters.
  void take(const FrameResult& result, std::optional<double> true_step_m, const PutAside& put_aside);

  /// The worst (up to three), one of each of the two commonest refusals, the rest spread evenly; eight in all where
  /// there are so many, by their numbers.
  std::vector<SampleFrame> chosen() const;

  /// A frame that may be chosen.
  struct Candidate {
    SampleFrame sample;  ///< Without its picture.
    DrawPicture draw;
  };

 private:
  void take_worst(const FrameResult& result, std::optional<double> true_step_m, const PutAside& put_aside);
  void take_refused(const FrameResult& result, const PutAside& put_aside);
  void take_spread(const FrameResult& result, const PutAside& put_aside);

  int frames_ = 0;
  int taken_ = 0;
  std::vector<Candidate> worst_;
  std::vector<Candidate> spread_;
  struct Refusals {
    int count = 0;
    Candidate shown;
  };
  std::map<std::string, Refusals> refused_;
};

/// A reason without its numbers, so that reasons of one kind are the same text: "speed ... m/s is too low".
std::string kind_of_reason(std::string_view reason);

/// Writes pictures and `samples.csv` (docs/formats.md) into a folder, which is made. @return kIo.
Result<void> write_samples(const std::string& folder, const std::vector<SampleFrame>& samples);
/// What lies there; nothing without a samples.csv. Pictures that are missing stay empty.
/// @return kBadInput for a samples.csv that is none.
Result<std::vector<SampleFrame>> read_samples(const std::string& folder);

}  // namespace groundscale
