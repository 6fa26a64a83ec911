#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "groundscale/io/config.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/yaml_internal.hpp"

namespace groundscale::internal {
namespace {

std::string place_text(const std::string& source_name, const YAML::Mark& mark, const std::string& key) {
  const std::string line = mark.line < 0 ? "" : fmt::format(":{}", mark.line + 1);
  return source_name + line + (key.empty() ? "" : ": " + printable(key));
}

}  // namespace

Result<YAML::Node> parse_yaml(const std::string& text, const std::string& source_name) {
  try {
    const std::vector<YAML::Node> documents = YAML::LoadAll(text);
    if (documents.empty()) return YAML::Node(YAML::NodeType::Null);
    if (documents.size() > 1) return bad_input(source_name + ": holds several YAML documents, it must be one");
    return documents.front();
  } catch (const YAML::Exception& e) {
    return bad_input(fmt::format("{}: isn't YAML: {}", place_text(source_name, e.mark, ""), printable(e.msg)));
  }
}

std::string YamlPlace::text() const { return place_text(source_name, node.Mark(), key); }

Error YamlPlace::error(const std::string& what) const { return bad_input(fmt::format("{}: {}", text(), what)); }

YamlPlace YamlPlace::child(const std::string& name) const {
  return {node[name], source_name, key.empty() ? name : key + "." + name};
}

Result<void> check_keys(const YamlPlace& map, const std::vector<std::string>& known) {
  if (!map.node.IsMap()) return map.error("must be a mapping (key: value)");
  std::vector<std::string> seen;
  for (const auto& entry : map.node) {
    const YamlPlace key{entry.first, map.source_name, map.key};
    if (!entry.first.IsScalar()) return key.error("a key must be a word");
    const std::string& name = entry.first.Scalar();
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      return key.error(fmt::format("unknown key {}, the nearest is '{}'", quoted(name), nearest_name(name, known)));
    }
    if (std::find(seen.begin(), seen.end(), name) != seen.end()) {
      return key.error(fmt::format("key {} is there twice", quoted(name)));
    }
    seen.push_back(name);
  }
  return {};
}

Result<double> number_of(const YamlPlace& scalar) {
  if (!scalar.node.IsScalar()) return scalar.error("must be a number");
  const std::optional<double> value = parse_number(scalar.node.Scalar());
  if (!value || !std::isfinite(*value)) {
    return scalar.error(fmt::format("{} must be a finite number", quoted(scalar.node.Scalar())));
  }
  return *value;
}

Result<std::vector<double>> numbers_of(const YamlPlace& list, int count) {
  if (!list.node.IsSequence() || static_cast<int>(list.node.size()) != count) {
    return list.error(fmt::format("must be a list of {} numbers", count));
  }
  std::vector<double> values;
  for (const YAML::Node& item : list.node) {
    const Result<double> value = number_of({item, list.source_name, list.key});
    if (!value) return value.error();
    values.push_back(*value);
  }
  return values;
}

}  // namespace groundscale::internal
