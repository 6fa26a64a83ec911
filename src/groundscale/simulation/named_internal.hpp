#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "groundscale/core/result.hpp"

namespace groundscale::internal {

/// What a table of names and makers has under a name; kBadInput that lists the known ones where there is none.
/// @param kind  What the table holds, for the message: "'circle' is no route, known: city, straight".
template <class Named, std::size_t Count>
auto make_named(const Named (&table)[Count], std::string_view name, std::string_view kind)
    -> Result<decltype(table[0].make())> {
  std::string known;
  for (const Named& entry : table) {
    if (entry.name == name) return entry.make();
    known.append(known.empty() ? "" : ", ").append(entry.name);
  }
  return Error{ErrorCode::kBadInput, fmt::format("'{}' is no {}, known: {}", name, kind, known)};
}

}  // namespace groundscale::internal
