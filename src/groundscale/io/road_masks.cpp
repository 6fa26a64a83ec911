#include "groundscale/io/road_masks.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/io/image_file.hpp"
#include "groundscale/io/image_folder_internal.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::bad_input;

std::string stem_of(const std::string& name) { return fs::path(name).stem().string(); }

/// Masks in the order of the frames that have the same name; empty where none has.
std::vector<std::string> by_name(const std::vector<std::string>& masks, const std::vector<std::string>& frames) {
  std::map<std::string, std::string> mask_of;
  for (const std::string& mask : masks) mask_of.emplace(stem_of(mask), mask);
  std::vector<std::string> names;
  bool any = false;
  for (const std::string& frame : frames) {
    const auto mask = mask_of.find(stem_of(frame));
    any = any || mask != mask_of.end();
    names.push_back(mask == mask_of.end() ? "" : mask->second);
  }
  return any ? names : std::vector<std::string>();
}

}  // namespace

Result<RoadMasks> RoadMasks::open(const std::string& folder, const Sequence& sequence) {
  std::error_code ignored;
  if (!fs::is_directory(folder, ignored)) return bad_input(fmt::format("--road-masks {}: no such folder", folder));
  const Result<std::vector<std::string>> found = internal::image_names(folder);
  if (!found) return bad_input("--road-masks " + found.error().message);
  const std::vector<std::string> frames = sequence.image_names();
  RoadMasks masks(folder, sequence.width(), sequence.height());
  masks.names_ = by_name(*found, frames);
  if (masks.names_.empty()) {
    if (!frames.empty() && found->size() != frames.size()) {
      return bad_input(
          fmt::format("--road-masks {}: {} masks, none with the name of an image, and {} images: it must "
                      "have a mask an image, or masks with the images' names",
                      folder, found->size(), frames.size()));
    }
    masks.names_ = *found;
  }
  const int end = sequence.first_frame() + sequence.frame_count();
  for (int frame = sequence.first_frame(); frame < end && frame < static_cast<int>(masks.names_.size()); ++frame) {
    if (masks.names_[static_cast<std::size_t>(frame)].empty()) continue;
    if (const auto first = masks.read(frame); !first) return bad_input("--road-masks " + first.error().message);
    return masks;
  }
  return bad_input(
      fmt::format("--road-masks {}: has no mask for frames {} to {}", folder, sequence.first_frame(), end - 1));
}

Result<Image> RoadMasks::read(int frame) const {
  if (frame < 0 || frame >= static_cast<int>(names_.size()) || names_[static_cast<std::size_t>(frame)].empty()) {
    return bad_input(fmt::format("{}: has no mask for frame {}", folder_, frame));
  }
  const std::string path = (fs::path(folder_) / names_[static_cast<std::size_t>(frame)]).string();
  const Result<Image> image = read_image(path);
  if (!image) return image;
  if (image->width() != width_ || image->height() != height_) {
    return bad_input(
        fmt::format("{}: is {}x{}, the images are {}x{}", path, image->width(), image->height(), width_, height_));
  }
  Image mask(width_, height_);
  const auto count = static_cast<std::ptrdiff_t>(width_) * height_;
  std::transform(image->data(), image->data() + count, mask.data(),
                 [](std::uint8_t road) { return static_cast<std::uint8_t>(road == 0 ? 0 : 255); });
  return mask;
}

}  // namespace groundscale
