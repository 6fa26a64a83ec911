#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "groundscale/core/image.hpp"
#include "groundscale/core/result.hpp"

namespace cv {
class Mat;
}

namespace groundscale::internal {

/// Images to 8-bit grey, the same way for a whole sequence.
///
/// Colour becomes grey as 0.299 R + 0.587 G + 0.114 B. 16 bit becomes 8 by one factor, chosen at the first 16-bit
/// image and kept: its highest value tells the sensor's bits (8, 10, 12, 14 or 16, the fewest that hold it), and
/// 2^bits - 1 becomes 255; what is higher in later images becomes 255.
class ImageDecoder {
 public:
  /// @param bytes  The image file's content. The error is a reason without the file's name.
  Result<Image> decode(std::string_view bytes);
  /// @return kBadInput, "path: reason".
  Result<Image> read(const std::string& path);
  /// An image as OpenCV has it, 1, 3 (BGR) or 4 (BGRA) channels of 8 or 16 bit.
  Result<Image> convert(const cv::Mat& decoded);

 private:
  std::optional<double> grey_a_16bit_step_;
  std::string bytes_;  ///< Of the file read last: its memory is used again.
};

/// Why the file's bytes aren't the whole image (a PNG without its end chunk, a JPEG without its end marker), or
/// nothing. Decoders pass over this in silence and fill the rest with grey.
std::optional<std::string> truncation(std::string_view bytes);

}  // namespace groundscale::internal
