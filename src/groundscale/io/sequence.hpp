#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "groundscale/core/image.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// One image of a drive.
struct Frame {
  int index = 0;        ///< In the source, from 0; the same whatever --start is.
  double time_s = 0.0;  ///< Never falls from frame to frame.
  Image image;          ///< Empty where it could not be read (then `problem` says why).
  std::string problem;
};

struct TimeSpan {
  double first_s = 0.0;
  double last_s = 0.0;
};

/// Images of a drive in their order. Opening reads no more than the first image.
class Sequence {
 public:
  virtual ~Sequence() = default;

  /// The next frame, or nothing at the end. A frame that can't be decoded, or whose size differs from the first one's,
  /// comes out with an empty image and the reason.
  virtual std::optional<Frame> next() = 0;

  virtual int first_frame() const = 0;
  /// Frames from first_frame on, as declared; a video may end earlier or later.
  virtual int frame_count() const = 0;
  virtual int width() const = 0;
  virtual int height() const = 0;
  /// File names of the source's images, all from 0 on whatever first_frame is; empty for a video.
  virtual std::vector<std::string> image_names() const { return {}; }
  /// Absolute path of a calibration that lies with the images (camera.yaml before calib.txt), or "".
  virtual std::string calibration_path() const = 0;
  /// Whether the source has KITTI odometry's layout, and which image folder (0..3) is read.
  virtual std::optional<int> kitti_image() const { return std::nullopt; }
  /// What was wrong with the source as a whole so far ("declares 300 frames, 287 were decoded"); what was wrong with a
  /// frame comes with the frame.
  virtual std::vector<std::string> warnings() const = 0;
  /// Times of the first and the last frame that are to come, where they are known before these are read.
  virtual std::optional<TimeSpan> time_span() const { return std::nullopt; }
  /// False where times are made up (an image folder without times.txt: 10 Hz).
  virtual bool has_times() const = 0;
};

struct SequenceRequest {
  std::string source;                             ///< KITTI odometry folder, image folder or video file.
  std::optional<int> kitti_image = std::nullopt;  ///< --image; default: image_0, else the first that is there.
  int start = 0;
  std::optional<int> frames = std::nullopt;  ///< At most so many.
};

/// Opens a source (docs/formats.md). With `decode_ahead` a thread decodes a few frames ahead; the frames are the same.
/// The first frame must be readable: its size is the sequence's.
/// @return kBadInput where there is nothing to read; kIo where a video's first frame can't be decoded.
Result<std::unique_ptr<Sequence>> open_sequence(const SequenceRequest& request, bool decode_ahead);

}  // namespace groundscale
