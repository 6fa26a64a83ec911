#include <condition_variable>
#include <deque>
#include <mutex>
#include <thread>
#include <utility>

#include "groundscale/io/decode_ahead_internal.hpp"

namespace groundscale::internal {
namespace {

class DecodeAhead final : public Sequence {
 public:
  explicit DecodeAhead(std::unique_ptr<Sequence> sequence)
      : sequence_(std::move(sequence)),
        first_(sequence_->first_frame()),
        count_(sequence_->frame_count()),
        width_(sequence_->width()),
        height_(sequence_->height()),
        image_names_(sequence_->image_names()),
        calibration_path_(sequence_->calibration_path()),
        kitti_image_(sequence_->kitti_image()),
        has_times_(sequence_->has_times()),
        time_span_(sequence_->time_span()),
        warnings_(sequence_->warnings()),
        reader_([this] { read(); }) {}

  ~DecodeAhead() override {
    {
      const std::lock_guard lock(mutex_);
      stopped_ = true;
    }
    changed_.notify_all();
    reader_.join();
  }

  DecodeAhead(const DecodeAhead&) = delete;
  DecodeAhead& operator=(const DecodeAhead&) = delete;

  std::optional<Frame> next() override {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [this] { return !queue_.empty(); });
    Entry entry = queue_.front();
    if (entry.frame) queue_.pop_front();  // the end stays, so that it can be asked for again
    lock.unlock();
    changed_.notify_all();
    warnings_ = std::move(entry.warnings);
    return std::move(entry.frame);
  }

  int first_frame() const override { return first_; }
  int frame_count() const override { return count_; }
  int width() const override { return width_; }
  int height() const override { return height_; }
  std::vector<std::string> image_names() const override { return image_names_; }
  std::string calibration_path() const override { return calibration_path_; }
  std::optional<int> kitti_image() const override { return kitti_image_; }
  std::vector<std::string> warnings() const override { return warnings_; }
  bool has_times() const override { return has_times_; }
  std::optional<TimeSpan> time_span() const override { return time_span_; }

 private:
  /// What next() returned, and the warnings after it.
  struct Entry {
    std::optional<Frame> frame;
    std::vector<std::string> warnings;
  };
  static constexpr std::size_t kFramesAhead = 4;

  void read() {
    for (bool more = true; more;) {
      Entry entry{sequence_->next(), sequence_->warnings()};
      more = entry.frame.has_value();
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return stopped_ || queue_.size() < kFramesAhead; });
      if (stopped_) return;
      queue_.push_back(std::move(entry));
      lock.unlock();
      changed_.notify_all();
    }
  }

  std::unique_ptr<Sequence> sequence_;  // the reader's alone once it runs
  int first_;
  int count_;
  int width_;
  int height_;
  std::vector<std::string> image_names_;
  std::string calibration_path_;
  std::optional<int> kitti_image_;
  bool has_times_;
  std::optional<TimeSpan> time_span_;
  std::vector<std::string> warnings_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Entry> queue_;
  bool stopped_ = false;
  std::thread reader_;  // last, so that it starts when all else is there
};

}  // namespace

std::unique_ptr<Sequence> decode_ahead(std::unique_ptr<Sequence> sequence) {
  return std::make_unique<DecodeAhead>(std::move(sequence));
}

}  // namespace groundscale::internal
