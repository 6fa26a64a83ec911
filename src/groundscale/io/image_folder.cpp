#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/image_decoder_internal.hpp"
#include "groundscale/io/image_folder_internal.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/times_file.hpp"

namespace groundscale::internal {
namespace {

namespace fs = std::filesystem;

constexpr double kMadeUpPeriod_s = 0.1;
constexpr int kKittiImages = 4;
constexpr std::string_view kImageEndings[] = {".png", ".jpg", ".jpeg", ".pgm", ".ppm",
                                              ".bmp", ".tif", ".tiff", ".webp"};

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool has_image_ending(const fs::path& path) {
  std::string ending = path.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return std::find(std::begin(kImageEndings), std::end(kImageEndings), ending) != std::end(kImageEndings);
}

/// Where images, times and calibration of a source lie.
struct Layout {
  std::string images;
  std::string root;
  std::optional<int> kitti_image;
};

Result<Layout> layout_of(const SequenceRequest& request) {
  const fs::path root = request.source;
  std::vector<int> present;
  for (int k = 0; k < kKittiImages; ++k) {
    if (fs::is_directory(root / fmt::format("image_{}", k))) present.push_back(k);
  }
  if (present.empty()) {
    if (!request.kitti_image) return Layout{request.source, request.source, std::nullopt};
    return bad_input(fmt::format("{}: no KITTI sequence (a folder with image_0 to image_3), --image {} has no meaning",
                                 request.source, *request.kitti_image));
  }
  const int image = request.kitti_image.value_or(present.front());
  if (std::find(present.begin(), present.end(), image) == present.end()) {
    return bad_input(
        fmt::format("{}: has no image_{}, there: image_{}", request.source, image, fmt::join(present, ", image_")));
  }
  return Layout{(root / fmt::format("image_{}", image)).string(), request.source, image};
}

class ImageFolder final : public Sequence {
 public:
  static Result<std::unique_ptr<Sequence>> open(const SequenceRequest& request) {
    const Result<Layout> layout = layout_of(request);
    if (!layout) return layout.error();
    Result<std::vector<std::string>> names = internal::image_names(layout->images);
    if (!names) return names.error();
    const int available = static_cast<int>(names->size());
    std::vector<double> times_s;
    if (const std::string path = (fs::path(layout->root) / "times.txt").string(); fs::exists(path)) {
      Result<std::vector<double>> times = read_times(path, available, "image");
      if (!times) return times.error();
      times_s = std::move(*times);
    }
    const Result<int> count = frames_to_read(request, available);
    if (!count) return count.error();
    std::unique_ptr<ImageFolder> folder(new ImageFolder(*layout, std::move(*names), std::move(times_s)));
    folder->first_ = folder->next_ = request.start;
    folder->count_ = *count;
    if (Result<void> first = folder->read_first(); !first) return first.error();
    return std::unique_ptr<Sequence>(std::move(folder));
  }

  std::optional<Frame> next() override {
    if (next_ >= first_ + count_) return std::nullopt;
    Frame frame{.index = next_, .time_s = time_of(next_), .image = {}, .problem = {}};
    const Result<Image> image = next_ == first_ ? first_image_ : decoder_.read(path_of(next_));
    first_image_ = Image();
    ++next_;
    if (!image) {
      frame.problem = image.error().message;
    } else if (image->width() != width_ || image->height() != height_) {
      frame.problem = fmt::format("{}: is {}x{}, the first image is {}x{}", path_of(frame.index), image->width(),
                                  image->height(), width_, height_);
    } else {
      frame.image = *image;
    }
    return frame;
  }

  int first_frame() const override { return first_; }
  int frame_count() const override { return count_; }
  int width() const override { return width_; }
  int height() const override { return height_; }
  std::vector<std::string> image_names() const override { return names_; }
  std::string calibration_path() const override { return calibration_in(layout_.root); }
  std::optional<int> kitti_image() const override { return layout_.kitti_image; }
  std::vector<std::string> warnings() const override { return {}; }
  bool has_times() const override { return !times_s_.empty(); }
  std::optional<TimeSpan> time_span() const override { return TimeSpan{time_of(first_), time_of(first_ + count_ - 1)}; }

 private:
  ImageFolder(Layout layout, std::vector<std::string> names, std::vector<double> times_s)
      : layout_(std::move(layout)), names_(std::move(names)), times_s_(std::move(times_s)) {}

  std::string path_of(int index) const {
    return (fs::path(layout_.images) / names_[static_cast<std::size_t>(index)]).string();
  }
  double time_of(int index) const {
    return has_times() ? times_s_[static_cast<std::size_t>(index)] : index * kMadeUpPeriod_s;
  }

  Result<void> read_first() {
    const Result<Image> image = decoder_.read(path_of(first_));
    if (!image) return bad_input(image.error().message + " (the first image gives the size, it must be readable)");
    first_image_ = *image;
    width_ = image->width();
    height_ = image->height();
    return {};
  }

  Layout layout_;
  std::vector<std::string> names_;
  std::vector<double> times_s_;
  ImageDecoder decoder_;
  Image first_image_;  ///< Until it was handed out.
  int first_ = 0;
  int count_ = 0;
  int next_ = 0;
  int width_ = 0;
  int height_ = 0;
};

}  // namespace

bool natural_less(std::string_view a, std::string_view b) {
  std::size_t i = 0;
  std::size_t j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_digit(a[i]) || !is_digit(b[j])) {
      if (a[i] != b[j]) return static_cast<unsigned char>(a[i]) < static_cast<unsigned char>(b[j]);
      ++i, ++j;
      continue;
    }
    const auto number = [](std::string_view text, std::size_t* at) {
      while (*at < text.size() && text[*at] == '0') ++*at;
      const std::size_t begin = *at;
      while (*at < text.size() && is_digit(text[*at])) ++*at;
      return text.substr(begin, *at - begin);
    };
    const std::string_view m = number(a, &i);
    const std::string_view n = number(b, &j);
    if (m.size() != n.size()) return m.size() < n.size();
    if (m != n) return m < n;
  }
  if ((i < a.size()) != (j < b.size())) return j < b.size();
  return a < b;
}

Result<std::vector<std::string>> image_names(const std::string& folder) {
  std::vector<std::string> names;
  try {
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (name.front() != '.' && has_image_ending(entry.path()) && !entry.is_directory()) names.push_back(name);
    }
  } catch (const fs::filesystem_error& e) {
    return bad_input(fmt::format("{}: can't be read: {}", folder, e.code().message()));
  }
  if (names.empty()) {
    return bad_input(fmt::format("{}: holds no images ({})", folder, fmt::join(kImageEndings, " ")));
  }
  std::sort(names.begin(), names.end(), natural_less);
  return names;
}

std::string calibration_in(const std::string& folder) {
  for (const char* name : {"camera.yaml", "calib.txt"}) {
    const fs::path path = fs::path(folder.empty() ? "." : folder) / name;
    std::error_code ignored;
    if (fs::exists(path, ignored)) return fs::absolute(path).lexically_normal().string();
  }
  return "";
}

Result<int> frames_to_read(const SequenceRequest& request, int available) {
  if (request.start < 0 || request.start >= available) {
    return bad_input(
        fmt::format("{}: start is frame {}, it must be from 0 to {}", request.source, request.start, available - 1));
  }
  if (request.frames && *request.frames < 1) {
    return bad_input(fmt::format("{}: {} frames asked for, it must be at least 1", request.source, *request.frames));
  }
  return std::min(available - request.start, request.frames.value_or(available));
}

Result<std::unique_ptr<Sequence>> open_image_folder(const SequenceRequest& request) {
  return ImageFolder::open(request);
}

}  // namespace groundscale::internal
