#pragma once

#include <string>

#include "groundscale/core/image.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// Reads one image (8 or 16 bit, grey or colour) as 8-bit grey, as docs/formats.md says; made for masks, whose zero
/// stays zero. EXIF orientation isn't applied.
/// @return kBadInput with path and reason where it is missing, truncated or can't be decoded.
Result<Image> read_image(const std::string& path);

/// Writes an image in the format that the name's ending says (.png, .jpg). @return kIo.
Result<void> write_image(const std::string& path, const Image& image);

}  // namespace groundscale
