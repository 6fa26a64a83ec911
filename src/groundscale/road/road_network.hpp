#pragma once

#include <memory>
#include <string>
#include <vector>

#include "groundscale/core/image.hpp"
#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// A neural network that says where the road is, and how it is to be fed and read. None is shipped.
struct RoadNetworkOptions {
  std::string file{};             ///< ONNX, or another single file that OpenCV's dnn loads; "": no network.
  int width = 0;                  ///< Of its input, with `height`; 0: what the ONNX file says.
  int height = 0;                 ///< Of its input.
  int channels = 0;               ///< Of its input, all the grey image; 0: what the ONNX file says, else 3.
  std::vector<double> mean{0.0};  ///< Input = (grey level - mean) * scale; one number, or one a channel.
  std::vector<double> scale{1.0 / 255.0};
  std::string output{};    ///< Name of the output; "": the only one, of several the last.
  int road_channel = 1;    ///< Of an output with several channels: road where this one is the largest.
  double threshold = 0.5;  ///< Of an output with one channel: road above it.
  int erode_px = 5;        ///< What the road loses at each of its edges, in pixels of the image.
  int every = 3;           ///< It is run for every n-th frame, and its mask carried along in between.

  /// Ranges; width and height together; as many of `mean` and `scale` as channels.
  Result<void> validate() const;
};

void visit_fields(RoadNetworkOptions& options, FieldVisitor& visitor);

/// Image in, mask of the road out, by a network in OpenCV's dnn on one thread of the CPU.
///
/// The image is shrunk or enlarged with its aspect ratio kept and put into the middle of the input; what is left about
/// it is grey. The output may be smaller than the input, of the same aspect ratio: 1 x channels x height x width, or 1
/// x height x width. It is interpolated to the image's pixels before it is compared. Layer fusion is off, since
/// OpenCV 4.6 answers wrongly with it for some networks. The same image gives the same bytes.
class RoadNetwork {
 public:
  /// Loads the file and runs it once, so that what doesn't fit is found here.
  /// @return kBadInput: options out of range, no such file, no network, an input size that is neither given nor in the
  ///         file or that the network can't take, no such output, an output that is no map, no such channel.
  static Result<RoadNetwork> open(const RoadNetworkOptions& options);
  ~RoadNetwork();
  RoadNetwork(RoadNetwork&&) noexcept;
  RoadNetwork& operator=(RoadNetwork&&) noexcept;

  /// @return Mask of the image's size: 255 road, 0 not. kNotConverged where the network fails, which after `open` it
  ///         does for want of memory at most.
  Result<Image> detect(const Image& image);

 private:
  struct Impl;
  explicit RoadNetwork(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace groundscale
