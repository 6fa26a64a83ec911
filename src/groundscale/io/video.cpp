#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core.hpp>
#include <opencv2/videoio.hpp>

#include "groundscale/io/image_decoder_internal.hpp"
#include "groundscale/io/image_folder_internal.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/video_internal.hpp"

namespace groundscale::internal {
namespace {

/// Quarter turns clockwise that bring the stored frames upright. OpenCV 4.6 reports the angle as FFmpeg counts it,
/// against the clock; from 4.7 on it is clockwise.
int quarter_turns_clockwise(const cv::VideoCapture& capture) {
  const double angle_deg = capture.get(cv::CAP_PROP_ORIENTATION_META);
  const bool clockwise = cv::getVersionMajor() > 4 || (cv::getVersionMajor() == 4 && cv::getVersionMinor() >= 7);
  const int turns = static_cast<int>(std::lround((clockwise ? angle_deg : -angle_deg) / 90.0));
  return ((turns % 4) + 4) % 4;
}

cv::Mat turned(const cv::Mat& stored, int quarter_turns) {
  if (quarter_turns == 0) return stored;
  constexpr cv::RotateFlags kFlags[] = {cv::ROTATE_90_CLOCKWISE, cv::ROTATE_180, cv::ROTATE_90_COUNTERCLOCKWISE};
  cv::Mat upright;
  cv::rotate(stored, upright, kFlags[quarter_turns - 1]);
  return upright;
}

/// FFmpeg renders plain text as a film of it. No video begins without a byte that no text has.
bool is_text(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  constexpr std::size_t kEnough = 512;
  std::string head(kEnough, '\0');
  file.read(head.data(), static_cast<std::streamsize>(kEnough));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return !head.empty() && std::all_of(head.begin(), head.end(), [](char c) {
    const auto byte = static_cast<unsigned char>(c);
    return byte >= 0x20 || c == '\n' || c == '\r' || c == '\t';
  });
}

Result<cv::VideoCapture> open_capture(const std::string& path) {
  cv::VideoCapture capture;
  if (is_text(path))
    return bad_input(path + ": can't be opened as a video (and is no folder of images): it holds text");
  try {
    if (capture.open(path, cv::CAP_FFMPEG) && capture.isOpened()) {
      capture.set(cv::CAP_PROP_ORIENTATION_AUTO, 0.0);
      return capture;
    }
  } catch (const cv::Exception&) {
    // Told below: the reason is in OpenCV's terms, not the user's.
  }
  return bad_input(path + ": can't be opened as a video (and is no folder of images)");
}

/// Frames that the container declares. Where it declares none, all are counted once.
Result<int> declared_frames(const std::string& path, const cv::VideoCapture& capture) {
  const double declared = capture.get(cv::CAP_PROP_FRAME_COUNT);
  if (declared >= 1.0 && declared < 1e9) return static_cast<int>(declared);
  Result<cv::VideoCapture> counting = open_capture(path);
  if (!counting) return counting.error();
  int count = 0;
  while (counting->grab()) ++count;
  return std::max(count, 1);
}

class Video final : public Sequence {
 public:
  static Result<std::unique_ptr<Sequence>> open(const SequenceRequest& request) {
    if (request.kitti_image) {
      return bad_input(
          fmt::format("{}: no KITTI sequence (a folder with image_0 to image_3), --image {} has no meaning",
                      request.source, *request.kitti_image));
    }
    Result<cv::VideoCapture> capture = open_capture(request.source);
    if (!capture) return capture.error();
    const Result<int> declared = declared_frames(request.source, *capture);
    if (!declared) return declared.error();
    const Result<int> count = frames_to_read(request, *declared);
    if (!count) return count.error();
    std::unique_ptr<Video> video(new Video(request, *capture, *declared));
    video->count_ = *count;
    if (Result<void> first = video->read_first(); !first) return first.error();
    return std::unique_ptr<Sequence>(std::move(video));
  }

  std::optional<Frame> next() override {
    std::optional<Frame> frame = std::exchange(first_frame_, std::nullopt);
    if (!frame) frame = read();
    return frame;
  }

  int first_frame() const override { return request_.start; }
  int frame_count() const override { return count_; }
  int width() const override { return width_; }
  int height() const override { return height_; }
  std::string calibration_path() const override {
    const std::string path = calibration_in(std::filesystem::path(request_.source).parent_path().string());
    return std::filesystem::path(path).filename() == "camera.yaml" ? path : "";
  }
  std::vector<std::string> warnings() const override { return warnings_; }
  bool has_times() const override { return true; }

 private:
  Video(SequenceRequest request, const cv::VideoCapture& capture, int declared)
      : request_(std::move(request)),
        capture_(capture),  // shares the decoder
        declared_(declared),
        quarter_turns_(quarter_turns_clockwise(capture_)),
        times_(capture_.get(cv::CAP_PROP_FPS)) {}

  Result<void> read_first() {
    while (next_ < request_.start && grab()) ++next_;
    std::optional<Frame> frame = next_ == request_.start ? read() : std::nullopt;
    if (!frame || frame->image.empty()) {
      const std::string reason = frame ? frame->problem : "the video ends before it";
      return Error{ErrorCode::kIo, fmt::format("{}: frame {}, the first asked for, can't be decoded: {}",
                                               request_.source, request_.start, reason)};
    }
    first_frame_ = std::move(frame);
    return {};
  }

  /// Decodes the next frame and tells its time.
  bool grab() {
    if (!capture_.grab()) return false;
    constexpr double kSecondsPerMs = 1e-3;
    time_s_ = times_.next(kSecondsPerMs * capture_.get(cv::CAP_PROP_POS_MSEC));
    return true;
  }

  std::optional<Frame> read() {
    if (ended_ || (request_.frames && next_ >= request_.start + *request_.frames)) return std::nullopt;
    try {
      if (grab()) return retrieve();
    } catch (const cv::Exception& e) {
      warnings_.push_back(fmt::format("{}: frame {} can't be decoded: {}", request_.source, next_, e.err));
    }
    ended_ = true;
    if (next_ < declared_) {
      warnings_.push_back(fmt::format("{}: declares {} frames, {} were decoded: the video ends early", request_.source,
                                      declared_, next_));
    }
    return std::nullopt;
  }

  Frame retrieve() {
    Frame frame{.index = next_++, .time_s = time_s_, .image = {}, .problem = {}};
    cv::Mat stored;
    if (!capture_.retrieve(stored) || stored.empty()) {
      frame.problem = fmt::format("{}: frame {} can't be decoded", request_.source, frame.index);
    } else {
      accept(turned(stored, quarter_turns_), &frame);
    }
    return frame;
  }

  void accept(const cv::Mat& upright, Frame* frame) {
    if (width_ == 0) {
      width_ = upright.cols;
      height_ = upright.rows;
    }
    if (upright.cols != width_ || upright.rows != height_) {
      frame->problem = fmt::format("{}: frame {} is {}x{}, the first is {}x{}", request_.source, frame->index,
                                   upright.cols, upright.rows, width_, height_);
      return;
    }
    const Result<Image> image = decoder_.convert(upright);
    if (image) {
      frame->image = *image;
    } else {
      frame->problem = fmt::format("{}: frame {}: {}", request_.source, frame->index, image.error().message);
    }
  }

  SequenceRequest request_;
  cv::VideoCapture capture_;
  int declared_;
  int quarter_turns_;
  RisingTimes times_;
  ImageDecoder decoder_;
  std::optional<Frame> first_frame_;  ///< Until it was handed out.
  double time_s_ = 0.0;               ///< Of the frame grabbed last.
  int count_ = 0;
  int next_ = 0;
  int width_ = 0;
  int height_ = 0;
  bool ended_ = false;
  std::vector<std::string> warnings_;
};

}  // namespace

RisingTimes::RisingTimes(double frames_per_second) : nominal_step_s_(1.0 / 30.0) {
  if (std::isfinite(frames_per_second) && frames_per_second > 0.0) nominal_step_s_ = 1.0 / frames_per_second;
}

double RisingTimes::next(double presented_s) {
  const bool as_presented = std::isfinite(presented_s) && (!last_s_ || presented_s > *last_s_);
  if (!last_s_) {
    last_s_ = as_presented ? presented_s : 0.0;
  } else {
    const double time_s = as_presented ? presented_s : *last_s_ + median_step_s();
    if (as_presented && last_as_presented_) steps_s_.push_back(time_s - *last_s_);
    last_s_ = time_s;
  }
  last_as_presented_ = as_presented;
  return *last_s_;
}

double RisingTimes::median_step_s() const {
  if (steps_s_.empty()) return nominal_step_s_;
  std::vector<double> sorted = steps_s_;
  const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

Result<std::unique_ptr<Sequence>> open_video(const SequenceRequest& request) { return Video::open(request); }

}  // namespace groundscale::internal
