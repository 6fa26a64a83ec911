#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <yaml-cpp/yaml.h>

#include "groundscale/core/result.hpp"

namespace groundscale::internal {

/// Parses a YAML text; the exception of a broken one becomes kBadInput "source:line: reason".
Result<YAML::Node> parse_yaml(const std::string& text, const std::string& source_name);

/// A node of a YAML file, and how messages call its place.
struct YamlPlace {
  YAML::Node node;
  std::string source_name;
  std::string key;  ///< Dotted name; "" for the whole file.

  /// "file:line: key" for messages.
  std::string text() const;
  /// kBadInput "file:line: key: what".
  Error error(const std::string& what) const;

  YamlPlace child(const std::string& name) const;
  bool has(const std::string& name) const { return node.IsMap() && node[name].IsDefined(); }
};

/// Every key of a mapping is one of `known` and there once; else an error that names the nearest.
Result<void> check_keys(const YamlPlace& map, const std::vector<std::string>& known);

/// A scalar as a finite number.
Result<double> number_of(const YamlPlace& scalar);
/// A list of `count` finite numbers.
Result<std::vector<double>> numbers_of(const YamlPlace& list, int count);

}  // namespace groundscale::internal
