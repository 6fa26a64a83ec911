#pragma once

#include <string>
#include <utility>
#include <vector>

#include "groundscale/core/image.hpp"
#include "groundscale/core/result.hpp"
#include "groundscale/io/sequence.hpp"

namespace groundscale {

/// A folder with an image for each frame of a drive that says where the road is (docs/formats.md). The mask of a frame
/// has its image's name, whatever the ending; where the names have nothing in common, and for a video, the k-th mask in
/// natural order belongs to frame k of the source.
class RoadMasks {
 public:
  /// @return kBadInput: no such folder, no images in it, as many masks as images are needed by number and aren't there,
  ///         or none for any frame to be read, or the first of these can't be read or has not the images' size.
  static Result<RoadMasks> open(const std::string& folder, const Sequence& sequence);

  /// The mask of a frame, 0 = not road, 255 elsewhere. @return kBadInput where it is missing, can't be read or has
  /// another size.
  Result<Image> read(int frame) const;

 private:
  RoadMasks(std::string folder, int width, int height) : folder_(std::move(folder)), width_(width), height_(height) {}

  std::string folder_;
  int width_;
  int height_;
  std::vector<std::string> names_;  ///< A frame of the source each; "" where there is none.
};

}  // namespace groundscale
