#pragma once

#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/options.hpp"
#include "groundscale/core/result.hpp"

namespace groundscale {

/// Walks the fields of any options struct: `[&](FieldVisitor& v) { visit_fields(options, v); }`.
using VisitOptions = std::function<void(FieldVisitor&)>;

/// Sets the fields that a YAML text names; the others stay. Unknown keys, wrong types and values out of range are
/// errors that name source, line, key, and the nearest key or the bound; nothing is set then.
Result<void> apply_yaml(const std::string& text, const std::string& source_name, const VisitOptions& visit);

/// One `section.key=value` of the command line; errors as in apply_yaml. A list is `1,2,3` or `[1, 2, 3]`.
Result<void> apply_assignment(std::string_view assignment, const VisitOptions& visit);

/// Nested YAML of all fields, numbers in the shortest form that reads back to the same bits.
std::string to_yaml(const VisitOptions& visit);

struct FieldRow {
  std::string name, type, value, unit, range, help;
};
/// All fields with their present values, for `groundscale config` and docs/configuration.md. `type` is bool, int,
/// number, text, list or choice; `range` is as in range_text without the unit, for a choice its names.
std::vector<FieldRow> field_rows(const VisitOptions& visit);

/// Of `candidates` the one with the smallest edit distance to `word`, the first of equals; "" where there is none.
std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates);

}  // namespace groundscale
