#pragma once

#include <string>
#include <vector>

#include "groundscale/core/image.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// Reads one image (8 or 16 bit, grey or colour) as 8-bit grey, as docs/formats.md says; made for masks, whose zero
/// stays zero. EXIF orientation isn't applied.
/// @return kBadInput with path and reason where it is missing, truncated or can't be decoded.
Result<Image> read_image(const std::string& path);

/// The bytes of an image file in the format that an ending (".png", ".jpg") names. @return kIo.
Result<std::string> encode_image(const Image& image, const std::string& ending);

/// The bytes of a 16-bit grey PNG, as KITTI has depth: metres times 256, rounded; 0: none. Beyond 255.99 m it is none.
/// @param depths_m  width * height of them, row by row.
Result<std::string> encode_depth(const std::vector<float>& depths_m, int width, int height);

/// Depths along the optical axis, a pixel each, row by row; 0: none.
struct DepthImage {
  int width = 0;
  int height = 0;
  std::vector<float> depths_m;
};

/// Reads what encode_depth makes. @return kBadInput with path and reason.
Result<DepthImage> read_depth(const std::string& path);

/// Writes an image in the format that the name's ending says (.png, .jpg). @return kIo.
Result<void> write_image(const std::string& path, const Image& image);

}  // namespace groundscale
