#include "groundscale/core/hash.hpp"

#include <fmt/format.h>

namespace groundscale {

void Fnv1a::add(const void* bytes, std::size_t count) {
  const auto* byte = static_cast<const unsigned char*>(bytes);
  for (std::size_t k = 0; k < count; ++k) value_ = (value_ ^ byte[k]) * 0x100000001b3ULL;
}

std::string Fnv1a::text() const { return fmt::format("{:016x}", value_); }

}  // namespace groundscale
