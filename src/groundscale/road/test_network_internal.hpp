#pragma once

#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "groundscale/core/check.hpp"

namespace groundscale {

/// For tests: a network of one convolution, written as the bytes of an ONNX file (onnx.proto3). Every output channel
/// adds up a square of the input, the same weight for all of it, and a bias.
struct TestNetwork {
  int width = 0;  ///< Of the input; 0: left open in the file.
  int height = 0;
  int channels = 3;
  std::vector<float> weights;  ///< An output channel each.
  std::vector<float> biases;
  int side = 1;    ///< Of the square, odd; the input is padded by zeros.
  int stride = 1;  ///< The output is that much smaller.

  /// Road (channel 1) where the grey level is below 128.
  static TestNetwork dark_is_road(int width, int height) {
    return {.width = width, .height = height, .weights = {0.0F, -1.0F / 3.0F}, .biases = {0.0F, 0.5F}};
  }
  /// Road everywhere, or nowhere.
  static TestNetwork always(bool road, int width, int height) {
    return {.width = width, .height = height, .weights = {0.0F, 0.0F}, .biases = {road ? -1.0F : 1.0F, 0.0F}};
  }

  std::string onnx() const {
    const std::string graph = field(1, node()) + field(2, "test") + field(5, tensor("w", kernel(), kernel_sizes())) +
                              field(5, tensor("b", biases, {outputs()})) +
                              field(11, value_info("image", {1, channels, height, width})) +
                              field(12, value_info("road", {1, outputs(), height / stride, width / stride}));
    constexpr int kOperators = 12;
    return field(1, 7) + field(7, graph) + field(8, field(2, kOperators));
  }

 private:
  static std::string varint(std::uint64_t value) {
    std::string bytes;
    for (; value >= 0x80; value >>= 7U) bytes += static_cast<char>(value | 0x80U);
    return bytes + static_cast<char>(value);
  }
  static std::string field(unsigned number, int value) {
    return varint(number << 3U) + varint(static_cast<std::uint64_t>(value));
  }
  static std::string field(unsigned number, const std::string& bytes) {
    return varint(number << 3U | 2U) + varint(bytes.size()) + bytes;
  }
  static std::string attribute(const std::string& name, const std::vector<int>& values) {
    constexpr int kInts = 7;
    std::string bytes = field(1, name) + field(20, kInts);
    for (const int value : values) bytes += field(8, value);
    return bytes;
  }
  static std::string tensor(const std::string& name, const std::vector<float>& values, const std::vector<int>& sizes) {
    std::string bytes;
    for (const int size : sizes) bytes += field(1, size);
    std::string raw(values.size() * sizeof(float), '\0');
    std::memcpy(raw.data(), values.data(), raw.size());
    return bytes + field(2, 1) + field(8, name) + field(9, raw);
  }
  static std::string value_info(const std::string& name, const std::vector<int>& sizes) {
    std::string shape;
    for (const int size : sizes) shape += field(1, size > 0 ? field(1, size) : field(2, "any"));
    return field(1, name) + field(2, field(1, field(1, 1) + field(2, shape)));
  }

  int outputs() const { return static_cast<int>(biases.size()); }
  std::vector<int> kernel_sizes() const { return {outputs(), channels, side, side}; }
  std::vector<float> kernel() const {
    std::vector<float> values;
    for (const float weight : weights)
      values.insert(values.end(), static_cast<std::size_t>(channels * side * side), weight);
    return values;
  }
  std::string node() const {
    const int pad = side / 2;
    return field(1, "image") + field(1, "w") + field(1, "b") + field(2, "road") + field(3, "conv") + field(4, "Conv") +
           field(5, attribute("kernel_shape", {side, side})) + field(5, attribute("pads", {pad, pad, pad, pad})) +
           field(5, attribute("strides", {stride, stride}));
  }
};

/// A file that goes with the object.
class TestFile {
 public:
  TestFile(const std::string& name, const std::string& bytes) {
    std::string folder = (std::filesystem::temp_directory_path() / "groundscale_XXXXXX").string();
    GS_CHECK(mkdtemp(folder.data()) != nullptr, "no temporary folder");
    folder_ = folder;
    std::ofstream(path(name), std::ios::binary) << bytes;
    path_ = path(name);
  }
  explicit TestFile(const TestNetwork& network) : TestFile("network.onnx", network.onnx()) {}
  ~TestFile() {
    std::error_code ignored;
    std::filesystem::remove_all(folder_, ignored);
  }
  TestFile(const TestFile&) = delete;
  TestFile& operator=(const TestFile&) = delete;

  const std::string& path() const { return path_; }

 private:
  std::string path(const std::string& name) const { return (folder_ / name).string(); }
  std::filesystem::path folder_;
  std::string path_;
};

}  // namespace groundscale
