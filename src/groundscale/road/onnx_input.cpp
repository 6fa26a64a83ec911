#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <limits>
#include <string_view>
#include <vector>

#include "groundscale/road/onnx_input_internal.hpp"

namespace groundscale::internal {
namespace {

struct ProtoField {
  std::uint64_t number = 0;
  std::uint64_t value = 0;  ///< Of a varint.
  std::string_view bytes;   ///< Of a message or text.
};

std::optional<std::uint64_t> take_varint(std::string_view& bytes) {
  std::uint64_t value = 0;
  for (unsigned shift = 0; shift < 64 && !bytes.empty(); shift += 7) {
    const auto byte = static_cast<std::uint8_t>(bytes.front());
    bytes.remove_prefix(1);
    value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
    if ((byte & 0x80U) == 0) return value;
  }
  return std::nullopt;
}

/// The next field of a message, which is shortened by it; nothing at its end and where it is broken.
std::optional<ProtoField> take_field(std::string_view& message) {
  constexpr std::uint64_t kVarint = 0;
  constexpr std::uint64_t k64Bit = 1;
  constexpr std::uint64_t kBytes = 2;
  constexpr std::uint64_t k32Bit = 5;
  const auto key = take_varint(message);
  if (!key) return std::nullopt;
  ProtoField field;
  field.number = *key >> 3U;
  const std::uint64_t type = *key & 7U;
  if (type == kVarint) {
    const auto value = take_varint(message);
    if (!value) return std::nullopt;
    field.value = *value;
    return field;
  }
  std::uint64_t length = type == k64Bit ? 8 : 4;
  if (type == kBytes) {
    const auto given = take_varint(message);
    if (!given) return std::nullopt;
    length = *given;
  } else if (type != k64Bit && type != k32Bit) {
    return std::nullopt;
  }
  if (length > message.size()) return std::nullopt;
  field.bytes = message.substr(0, length);
  message.remove_prefix(length);
  return field;
}

std::vector<ProtoField> fields_of(std::string_view message, std::uint64_t number) {
  std::vector<ProtoField> fields;
  while (const auto field = take_field(message)) {
    if (field->number == number) fields.push_back(*field);
  }
  return fields;
}

/// The nested message at the end of a path of field numbers; empty where there is none.
std::string_view nested(std::string_view message, std::initializer_list<std::uint64_t> path) {
  for (const std::uint64_t number : path) {
    const auto fields = fields_of(message, number);
    if (fields.empty()) return {};
    message = fields.front().bytes;
  }
  return message;
}

/// dim_value; 0 where it has a name instead, or is no size.
int size_of(const ProtoField& dimension) {
  const auto values = fields_of(dimension.bytes, 1);
  if (values.empty() || values.front().value > std::numeric_limits<int>::max()) return 0;
  return static_cast<int>(values.front().value);
}

}  // namespace

std::optional<NetworkInput> onnx_input(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  const std::string model{std::istreambuf_iterator<char>(file), {}};
  const std::string_view graph = nested(model, {7});
  // Old files list the weights among the inputs.
  std::vector<std::string_view> weights;
  for (const ProtoField& weight : fields_of(graph, 5)) weights.push_back(nested(weight.bytes, {8}));
  for (const ProtoField& input : fields_of(graph, 11)) {
    if (std::find(weights.begin(), weights.end(), nested(input.bytes, {1})) != weights.end()) continue;
    const auto dimensions = fields_of(nested(input.bytes, {2, 1, 2}), 1);
    if (dimensions.size() != 4) return std::nullopt;
    return NetworkInput{size_of(dimensions[1]), size_of(dimensions[2]), size_of(dimensions[3])};
  }
  return std::nullopt;
}

}  // namespace groundscale::internal
