#include "groundscale/road/road_network.hpp"

#include <algorithm>
#include <cmath>
#include <exception>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/dnn.hpp>
#include <opencv2/imgproc.hpp>

#include "groundscale/road/onnx_input_internal.hpp"
#include "groundscale/tracking/opencv_internal.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {
namespace {

constexpr int kMaxSide = 8192;

/// OpenCV tells of its exceptions on the standard error as well; our messages are enough.
class QuietOpenCv {
 public:
  QuietOpenCv() : level_(cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT)) {}
  ~QuietOpenCv() { cv::utils::logging::setLogLevel(level_); }
  QuietOpenCv(const QuietOpenCv&) = delete;
  QuietOpenCv& operator=(const QuietOpenCv&) = delete;

 private:
  cv::utils::logging::LogLevel level_;
};

Error bad_option(std::string_view key, const std::string& what) {
  return {ErrorCode::kBadInput, fmt::format("road.network.{}: {}", key, what)};
}

/// First line of what OpenCV, or the protobuf library beneath it, says.
std::string reason_of(const std::exception& e) {
  const auto* from_opencv = dynamic_cast<const cv::Exception*>(&e);
  const std::string text = from_opencv == nullptr ? e.what() : from_opencv->err;
  return text.substr(0, text.find('\n'));
}

/// Where an image lies in the network's input.
struct Letterbox {
  cv::Rect inner;

  Letterbox(const Image& image, const cv::Size& input) {
    const double scale =
        std::min(static_cast<double>(input.width) / image.width(), static_cast<double>(input.height) / image.height());
    const auto side = [scale](int length, int most) {
      return std::clamp(static_cast<int>(std::lround(scale * length)), 1, most);
    };
    const cv::Size size(side(image.width(), input.width), side(image.height(), input.height));
    inner = {(input.width - size.width) / 2, (input.height - size.height) / 2, size.width, size.height};
  }
};

cv::Mat letterboxed(const Image& image, const cv::Rect& inner, const cv::Size& input) {
  constexpr int kPadGrey = 114;  // what such networks are commonly trained with
  cv::Mat boxed(input, CV_8U, cv::Scalar(kPadGrey));
  cv::Mat part = boxed(inner);
  const bool shrinks = inner.width < image.width();
  cv::resize(view_of(image), part, inner.size(), 0.0, 0.0, shrinks ? cv::INTER_AREA : cv::INTER_LINEAR);
  return boxed;
}

/// How much the road's channel is above the highest of the others, or the only one above the threshold.
cv::Mat margin_of(const cv::Mat& output, const RoadNetworkOptions& options) {
  const bool map = output.dims == 3;
  const int channels = map ? 1 : output.size[1];
  const cv::Size size(output.size[map ? 2 : 3], output.size[map ? 1 : 2]);
  const auto channel = [&](int c) {
    return cv::Mat(size, CV_32F, const_cast<float*>(map ? output.ptr<float>(0) : output.ptr<float>(0, c)));
  };
  if (channels == 1) return channel(0) - options.threshold;
  cv::Mat others(size, CV_32F, cv::Scalar(-std::numeric_limits<float>::max()));
  for (int c = 0; c < channels; ++c) {
    if (c != options.road_channel) cv::max(others, channel(c), others);
  }
  return channel(options.road_channel) - others;
}

/// Brings the margin, a map of the whole input, to the image's pixels and compares it with 0.
void from_output(const cv::Mat& margin, const cv::Rect& inner, const cv::Size& input, cv::Mat& mask) {
  struct Axis {
    double scale;   ///< Pixels of the output for one of the image.
    double offset;  ///< Of the middle of the image's first pixel, from that of the output's first that counts.
    int begin, end;

    /// What lies beside the image in the input doesn't count: only pixels of the output whose middle is within it.
    Axis(int output_length, int input_length, int inner_begin, int inner_length, int image_length) {
      const double output_from_input = static_cast<double>(output_length) / input_length;
      const double first = output_from_input * inner_begin;
      const double last = output_from_input * (inner_begin + inner_length);
      begin = std::clamp(static_cast<int>(std::ceil(first - 0.5)), 0, output_length - 1);
      end = std::clamp(static_cast<int>(std::floor(last - 0.5)) + 1, begin + 1, output_length);
      scale = (last - first) / image_length;
      offset = first - begin + 0.5 * scale - 0.5;
    }
  };
  const Axis x(margin.cols, input.width, inner.x, inner.width, mask.cols);
  const Axis y(margin.rows, input.height, inner.y, inner.height, mask.rows);
  const cv::Matx23d output_from_image(x.scale, 0.0, x.offset, 0.0, y.scale, y.offset);
  cv::Mat full;
  cv::warpAffine(margin(cv::Range(y.begin, y.end), cv::Range(x.begin, x.end)), full, output_from_image, mask.size(),
                 cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_REPLICATE);
  cv::compare(full, 0.0, mask, cv::CMP_GT);
}

/// Size of the input as the options or the file say it.
Result<internal::NetworkInput> input_of(const RoadNetworkOptions& options) {
  internal::NetworkInput input = internal::onnx_input(options.file).value_or(internal::NetworkInput{});
  if (options.width > 0) {
    input.width = options.width;
    input.height = options.height;
  }
  if (options.channels > 0) input.channels = options.channels;
  if (input.channels == 0) input.channels = 3;
  if (input.width == 0 || input.height == 0) {
    return bad_option("width", fmt::format("{} doesn't say its input's size, width and height must", options.file));
  }
  if (input.width > kMaxSide || input.height > kMaxSide || (input.channels != 1 && input.channels != 3)) {
    return bad_option("file",
                      fmt::format("{}: its input is {} x {} x {}, it must have 1 or 3 channels and up to {} px a "
                                  "side",
                                  options.file, input.channels, input.height, input.width, kMaxSide));
  }
  for (const auto& [key, values] : {std::pair{"mean", &options.mean}, std::pair{"scale", &options.scale}}) {
    if (values->size() == 1 || values->size() == static_cast<std::size_t>(input.channels)) continue;
    return bad_option(key, fmt::format("{} numbers, the network's input has {} channels: one number, or one a channel",
                                       values->size(), input.channels));
  }
  return input;
}

/// "1 x 2 x 192 x 640".
std::string text_of(const cv::MatSize& size) {
  std::string text;
  for (int i = 0; i < size.dims(); ++i) text += fmt::format("{}{}", i == 0 ? "" : " x ", size[i]);
  return text;
}

Result<void> check_output(const cv::Mat& output, const std::string& name, const RoadNetworkOptions& options) {
  const bool map = (output.dims == 3 || output.dims == 4) && output.size[0] == 1 && output.type() == CV_32F;
  if (!map) {
    return bad_option("output", fmt::format("{}: '{}' is {}, it must be 1 x channels x height x width", options.file,
                                            name, text_of(output.size)));
  }
  const int channels = output.dims == 4 ? output.size[1] : 1;
  if (channels > 1 && options.road_channel >= channels) {
    return bad_option("road_channel", fmt::format("{} is out of range, '{}' of {} has channels 0 to {}",
                                                  options.road_channel, name, options.file, channels - 1));
  }
  return {};
}

Result<std::string> output_name(const cv::dnn::Net& net, const RoadNetworkOptions& options) {
  const std::vector<std::string> names = net.getUnconnectedOutLayersNames();
  if (names.empty()) return bad_option("file", options.file + ": has no output");
  if (options.output.empty()) return names.back();
  if (std::find(names.begin(), names.end(), options.output) != names.end()) return options.output;
  return bad_option(
      "output", fmt::format("{} has no output '{}', it has: {}", options.file, options.output, fmt::join(names, ", ")));
}

}  // namespace

void visit_fields(RoadNetworkOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "file",
                 .unit = "",
                 .help = "network that says where the road is, as ONNX (docs/formats.md); \"\" is none"},
                options.file);
  visitor.field({.key = "width",
                 .unit = "px",
                 .help = "of the network's input, together with height; 0 is what the file says",
                 .min = 0,
                 .max = kMaxSide},
                options.width);
  visitor.field({.key = "height", .unit = "px", .help = "of the network's input", .min = 0, .max = kMaxSide},
                options.height);
  visitor.field({.key = "channels",
                 .unit = "",
                 .help = "of the network's input, 1 or 3; 0 is what the file says, else 3",
                 .min = 0,
                 .max = 3},
                options.channels);
  visitor.field({.key = "mean",
                 .unit = "grey levels",
                 .help = "its input is (grey level - mean) * scale; one number, or one a channel",
                 .min = -1000,
                 .max = 1000},
                options.mean);
  visitor.field(
      {.key = "scale", .unit = "", .help = "of the same; 1 / 255 where it expects 0 to 1", .min = -1e3, .max = 1e3},
      options.scale);
  visitor.field(
      {.key = "output", .unit = "", .help = "the network's output; \"\" is the only one, of several the last"},
      options.output);
  visitor.field({.key = "road_channel",
                 .unit = "",
                 .help = "road is where this channel of the output, counted from 0, is the largest",
                 .min = 0,
                 .max = 9999},
                options.road_channel);
  visitor.field({.key = "threshold",
                 .unit = "",
                 .help = "where the output has one channel: road is above this",
                 .min = -1e6,
                 .max = 1e6},
                options.threshold);
  visitor.field({.key = "erode_px", .unit = "px", .help = "taken off at the road's edges", .min = 0, .max = 100},
                options.erode_px);
  visitor.field({.key = "every",
                 .unit = "frames",
                 .help = "the network is run for every n-th frame that moves, and its mask carried along in between",
                 .min = 1,
                 .max = 1000},
                options.every);
}

Result<void> RoadNetworkOptions::validate() const {
  if (const auto ranges = check_ranges(*this); !ranges) return ranges;
  if ((width == 0) != (height == 0)) {
    return bad_option("width", fmt::format("{} with a height of {}: both must be given, or neither", width, height));
  }
  if (channels == 2) return bad_option("channels", "is 2, it must be 0, 1 or 3");
  for (const auto& [key, values] : {std::pair{"mean", &mean}, std::pair{"scale", &scale}}) {
    if (values->size() == 1 || values->size() == 3) continue;
    return bad_option(key, fmt::format("{} numbers, one or one a channel expected", values->size()));
  }
  return {};
}

struct RoadNetwork::Impl {
  RoadNetworkOptions options;
  internal::NetworkInput input;
  std::string output;
  cv::dnn::Net net;

  cv::Size input_size() const { return {input.width, input.height}; }

  /// Grey, 8 bit, of the input's size. May throw.
  cv::Mat run(const cv::Mat& grey) {
    const int sizes[] = {1, input.channels, input.height, input.width};
    cv::Mat blob(4, sizes, CV_32F);
    const auto of_channel = [](const std::vector<double>& values, int c) {
      return values.size() == 1 ? values.front() : values[static_cast<std::size_t>(c)];
    };
    for (int c = 0; c < input.channels; ++c) {
      cv::Mat plane(input_size(), CV_32F, blob.ptr<float>(0, c));
      const double scale = of_channel(options.scale, c);
      grey.convertTo(plane, CV_32F, scale, -scale * of_channel(options.mean, c));
    }
    net.setInput(blob);
    return net.forward(output);
  }
};

RoadNetwork::RoadNetwork(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RoadNetwork::~RoadNetwork() = default;
RoadNetwork::RoadNetwork(RoadNetwork&&) noexcept = default;
RoadNetwork& RoadNetwork::operator=(RoadNetwork&&) noexcept = default;

Result<RoadNetwork> RoadNetwork::open(const RoadNetworkOptions& options) {
  if (const auto valid = options.validate(); !valid) return valid.error();
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(options.file, ignored)) {
    return bad_option("file", fmt::format("{}: no such file", options.file));
  }
  use_one_thread();
  const QuietOpenCv quiet;
  auto impl = std::make_unique<Impl>();
  impl->options = options;
  try {
    impl->net = cv::dnn::readNet(options.file);
    impl->net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
    impl->net.setPreferableTarget(cv::dnn::DNN_TARGET_CPU);
    impl->net.enableFusion(false);
  } catch (const std::exception& e) {
    return bad_option("file", fmt::format("{}: isn't a network that OpenCV can load ({})", options.file, reason_of(e)));
  }
  const auto input = input_of(options);
  if (!input) return input.error();
  impl->input = *input;
  try {
    const auto name = output_name(impl->net, options);
    if (!name) return name.error();
    impl->output = *name;
    const cv::Mat output = impl->run(cv::Mat::zeros(impl->input_size(), CV_8U));
    if (const auto fits = check_output(output, *name, options); !fits) return fits.error();
  } catch (const std::exception& e) {
    return bad_option("file", fmt::format("{}: can't be run on an input of {} x {} x {} ({})", options.file,
                                          input->channels, input->height, input->width, reason_of(e)));
  }
  return RoadNetwork(std::move(impl));
}

Result<Image> RoadNetwork::detect(const Image& image) {
  GS_CHECK(!image.empty(), "an image");
  Image mask(image.width(), image.height());
  cv::Mat view = view_of(mask);
  try {
    const cv::Rect inner = Letterbox(image, impl_->input_size()).inner;
    const cv::Mat output = impl_->run(letterboxed(image, inner, impl_->input_size()));
    from_output(margin_of(output, impl_->options), inner, impl_->input_size(), view);
    const int side = 2 * impl_->options.erode_px + 1;
    // The image's own edge is no edge of the road.
    if (side > 1) cv::erode(view, view, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  } catch (const std::exception& e) {
    return Error{ErrorCode::kNotConverged, fmt::format("{}: {}", impl_->options.file, reason_of(e))};
  }
  return mask;
}

}  // namespace groundscale
