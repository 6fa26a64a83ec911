#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace groundscale {

/// FNV-1a, 64 bits (Fowler, Noll, Vo): tells contents apart, against change and not against malice.
class Fnv1a {
 public:
  void add(const void* bytes, std::size_t count);
  void add(std::string_view text) { add(text.data(), text.size()); }
  /// By its bits.
  void add(double value) { add(&value, sizeof value); }

  /// 16 hexadecimal digits.
  std::string text() const;

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

}  // namespace groundscale
