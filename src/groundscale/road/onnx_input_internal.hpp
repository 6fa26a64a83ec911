#pragma once

#include <optional>
#include <string>

namespace groundscale::internal {

/// Size of a network's input, 1 x channels x height x width; 0 where the file leaves it open.
struct NetworkInput {
  int channels = 0;
  int height = 0;
  int width = 0;
};

/// What an ONNX file says about its first input, which OpenCV 4.6 doesn't tell. Walks the protobuf messages
/// (onnx.proto3: ModelProto.graph.input[].type.tensor_type.shape.dim[].dim_value) and nothing else.
/// @return Nothing where the file isn't ONNX or its input has not four dimensions.
std::optional<NetworkInput> onnx_input(const std::string& path);

}  // namespace groundscale::internal
