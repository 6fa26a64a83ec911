#include "groundscale/io/config.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/yaml_internal.hpp"

namespace groundscale {
namespace {

using internal::bad_input;
using internal::quoted;
using internal::shortest;

/// What a user wrote for one key: a scalar or a list, and how messages call its place ("file:3: section.key").
struct Given {
  std::string place;
  bool is_list = false;
  std::vector<std::string> words;  ///< One for a scalar.
};
using GivenByName = std::map<std::string, Given>;

template <class Value>
std::optional<Value> parsed(const std::string& word);
template <>
std::optional<bool> parsed(const std::string& word) {
  if (word == "true") return true;
  if (word == "false") return false;
  return std::nullopt;
}
template <>
std::optional<int> parsed(const std::string& word) {
  const std::optional<long long> value = internal::parse_integer(word);
  if (!value || *value < std::numeric_limits<int>::min() || *value > std::numeric_limits<int>::max()) return {};
  return static_cast<int>(*value);
}
template <>
std::optional<double> parsed(const std::string& word) {
  const std::optional<double> value = internal::parse_number(word);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

/// Reads what was given for each field; sets it only with `commit`. Keeps the first error.
class Reader final : public NamedFieldVisitor {
 public:
  using FieldVisitor::field;
  Reader(const GivenByName& given, bool commit) : given_(given), commit_(commit) {}

  void field(const FieldInfo& info, bool& value) override { read(info, "true or false", value); }
  void field(const FieldInfo& info, int& value) override { read_bounded(info, "a whole number", value); }
  void field(const FieldInfo& info, double& value) override { read_bounded(info, "a finite number", value); }
  void field(const FieldInfo& info, std::string& value) override {
    const Given* given = scalar(info, "a text");
    if (given != nullptr && commit_) value = given->words.front();
  }

  void field(const FieldInfo& info, std::vector<double>& value) override {
    const Given* given = find(info);
    if (given == nullptr) return;
    std::vector<double> numbers;
    for (const std::string& word : given->words) {
      const std::optional<double> number = given->is_list ? parsed<double>(word) : std::nullopt;
      if (!number) return fail(*given, fmt::format("{} must be a list of finite numbers", quoted(word)));
      if (!in_range(info, *given, *number)) return;
      numbers.push_back(*number);
    }
    if (commit_) value = std::move(numbers);
  }

  void field(const FieldInfo& info, Choice value) override {
    const Given* given = scalar(info, fmt::format("one of {}", fmt::join(value.names, ", ")));
    if (given == nullptr) return;
    const std::string& word = given->words.front();
    const auto name = std::find(value.names.begin(), value.names.end(), word);
    if (name == value.names.end()) {
      const std::vector<std::string> names(value.names.begin(), value.names.end());
      return fail(*given, fmt::format("{} is none of {}, the nearest is '{}'", quoted(word), fmt::join(names, ", "),
                                      nearest_name(word, names)));
    }
    if (commit_) value.set(static_cast<int>(name - value.names.begin()));
  }

  Result<void> result() const { return result_; }

 private:
  const Given* find(const FieldInfo& info) const {
    const auto given = given_.find(name_of(info));
    return given == given_.end() || !result_ ? nullptr : &given->second;
  }

  const Given* scalar(const FieldInfo& info, const std::string& wanted) {
    const Given* given = find(info);
    if (given == nullptr || !given->is_list) return given;
    fail(*given, fmt::format("is a list, it must be {}", wanted));
    return nullptr;
  }

  template <class Value>
  bool read(const FieldInfo& info, const std::string& wanted, Value& value) {
    const Given* given = scalar(info, wanted);
    if (given == nullptr) return false;
    const std::optional<Value> read = parsed<Value>(given->words.front());
    if (!read) {
      fail(*given, fmt::format("{} must be {}", quoted(given->words.front()), wanted));
      return false;
    }
    if constexpr (!std::is_same_v<Value, bool>) {
      if (!in_range(info, *given, *read)) return false;
    }
    if (commit_) value = *read;
    return true;
  }

  template <class Value>
  void read_bounded(const FieldInfo& info, const std::string& kind, Value& value) {
    const std::string range = range_text(info);
    read(info, range.empty() ? kind : kind + " " + range, value);
  }

  bool in_range(const FieldInfo& info, const Given& given, double value) {
    if (value >= info.min && value <= info.max) return true;
    fail(given, fmt::format("{} is out of range, it must be {}", shortest(value), range_text(info)));
    return false;
  }

  void fail(const Given& given, const std::string& what) {
    if (result_) result_ = bad_input(fmt::format("{}: {}", given.place, what));
  }

  const GivenByName& given_;
  bool commit_;
  Result<void> result_;
};

/// All dotted names of fields.
std::vector<std::string> field_names(const VisitOptions& visit) {
  std::vector<std::string> names;
  for (const FieldRow& row : field_rows(visit)) names.push_back(row.name);
  return names;
}

std::string last_part(const std::string& name) { return name.substr(name.rfind('.') + 1); }

/// The nearest known name; a name with the same last part is nearer than any other.
std::string nearest_field(const std::string& name, const std::vector<std::string>& known) {
  std::vector<std::string> same_key;
  for (const std::string& candidate : known) {
    if (last_part(candidate) == last_part(name)) same_key.push_back(candidate);
  }
  return nearest_name(name, same_key.empty() ? known : same_key);
}

/// Where the first field of a group is; the end where the name is no group's.
std::vector<std::string>::const_iterator first_in_group(const std::string& name,
                                                        const std::vector<std::string>& known) {
  return std::find_if(known.begin(), known.end(),
                      [group = name + "."](const std::string& field) { return field.starts_with(group); });
}

Result<void> set_fields(const GivenByName& given, const VisitOptions& visit) {
  const std::vector<std::string> known = field_names(visit);
  for (const auto& [name, value] : given) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    if (const auto inside = first_in_group(name, known); inside != known.end()) {
      return bad_input(fmt::format("{}: is a section, a key of it is '{}'", value.place, *inside));
    }
    return bad_input(fmt::format("{}: unknown key, the nearest is '{}'", value.place, nearest_field(name, known)));
  }
  for (const bool commit : {false, true}) {
    Reader reader(given, commit);
    visit(reader);
    if (!reader.result()) return reader.result();
  }
  return {};
}

/// Collects the leaves of a mapping under their dotted names.
Result<void> flatten(const internal::YamlPlace& map, const std::vector<std::string>& known, GivenByName* given) {
  for (const auto& entry : map.node) {
    if (!entry.first.IsScalar()) return map.error("a key must be a word");
    const std::string name = (map.key.empty() ? "" : map.key + ".") + entry.first.Scalar();
    const internal::YamlPlace key{entry.first, map.source_name, name};
    const internal::YamlPlace value{entry.second, map.source_name, name};
    if (first_in_group(name, known) != known.end()) {
      if (value.node.IsNull()) continue;
      if (!value.node.IsMap()) return key.error("is a section, it must hold keys");
      if (Result<void> inner = flatten(value, known, given); !inner) return inner;
      continue;
    }
    Given leaf{.place = key.text(), .is_list = value.node.IsSequence(), .words = {}};
    if (value.node.IsScalar()) leaf.words.push_back(value.node.Scalar());
    if (value.node.IsSequence()) {
      for (const YAML::Node& item : value.node) leaf.words.push_back(item.IsScalar() ? item.Scalar() : "[...]");
    }
    const bool is_known = std::find(known.begin(), known.end(), name) != known.end();
    if (is_known && !value.node.IsScalar() && !value.node.IsSequence()) return key.error("has no value");
    if (!given->emplace(name, std::move(leaf)).second) return key.error("is there twice");
  }
  return {};
}

std::string yaml_text(const std::string& text) {
  std::string quoted_text = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      quoted_text += std::string("\\") + c;
    } else if (static_cast<unsigned char>(c) < ' ') {
      quoted_text += fmt::format("\\x{:02x}", static_cast<int>(c));
    } else {
      quoted_text += c;
    }
  }
  return quoted_text + "\"";
}

/// Calls `emit(info, type, value as YAML)` for every field.
class Writer : public NamedFieldVisitor {
 public:
  using FieldVisitor::field;
  void field(const FieldInfo& info, bool& value) final { emit(info, "bool", value ? "true" : "false"); }
  void field(const FieldInfo& info, int& value) final { emit(info, "int", std::to_string(value)); }
  void field(const FieldInfo& info, double& value) final { emit(info, "number", shortest(value)); }
  void field(const FieldInfo& info, std::string& value) final { emit(info, "text", yaml_text(value)); }
  void field(const FieldInfo& info, std::vector<double>& value) final {
    emit(info, "list", fmt::format("[{}]", fmt::join(value, ", ")));
  }
  void field(const FieldInfo& info, Choice value) final {
    names_ = fmt::format("{}", fmt::join(value.names, ", "));
    emit(info, "choice", std::string(value.names.at(static_cast<std::size_t>(value.get()))));
  }

 protected:
  virtual void emit(const FieldInfo& info, std::string type, std::string value) = 0;
  std::string names_;  ///< Of the choice at hand.
};

class YamlWriter final : public Writer {
 public:
  std::string text;

 protected:
  void enter(std::string_view key) override {
    text += indent_ + std::string(key) + ":\n";
    indent_ += "  ";
  }
  void leave() override { indent_.resize(indent_.size() - 2); }
  void emit(const FieldInfo& info, std::string, std::string value) override {
    text += fmt::format("{}{}: {}\n", indent_, info.key, value);
  }

 private:
  std::string indent_;
};

class RowWriter final : public Writer {
 public:
  std::vector<FieldRow> rows;

 protected:
  void emit(const FieldInfo& info, std::string type, std::string value) override {
    FieldInfo without_unit = info;
    without_unit.unit = "";
    std::string range = type == "choice" ? names_ : range_text(without_unit);
    rows.push_back({name_of(info), std::move(type), std::move(value), std::string(info.unit), std::move(range),
                    std::string(info.help)});
  }
};

/// Levenshtein's distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, diagonal + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

Result<void> apply_yaml(const std::string& text, const std::string& source_name, const VisitOptions& visit) {
  const Result<YAML::Node> root = internal::parse_yaml(text, source_name);
  if (!root) return root.error();
  if (root->IsNull()) return {};
  if (!root->IsMap()) return bad_input(source_name + ": must hold keys as in 'key: value'");
  GivenByName given;
  if (Result<void> flat = flatten({*root, source_name, ""}, field_names(visit), &given); !flat) return flat;
  return set_fields(given, visit);
}

Result<void> apply_assignment(std::string_view assignment, const VisitOptions& visit) {
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos) return bad_input(quoted(assignment) + " must be KEY=VALUE");
  const std::string name(internal::trimmed(assignment.substr(0, equals)));
  if (name.empty()) return bad_input(quoted(assignment) + " must be KEY=VALUE");
  std::string_view value = assignment.substr(equals + 1);
  Given given{.place = internal::printable(name), .is_list = false, .words = {std::string(value)}};
  const std::vector<FieldRow> rows = field_rows(visit);
  const auto row = std::find_if(rows.begin(), rows.end(), [&](const FieldRow& r) { return r.name == name; });
  if (row != rows.end() && row->type == "list") {
    given = {.place = internal::printable(name), .is_list = true, .words = {}};
    value = internal::trimmed(value);
    if (value.size() >= 2 && value.front() == '[' && value.back() == ']') value = value.substr(1, value.size() - 2);
    while (!internal::trimmed(value).empty()) {
      const std::size_t comma = value.find(',');
      given.words.emplace_back(internal::trimmed(value.substr(0, comma)));
      value = comma == std::string_view::npos ? "" : value.substr(comma + 1);
    }
  } else if (row != rows.end() && row->type != "text") {
    given.words.front() = std::string(internal::trimmed(value));
  }
  return set_fields({{name, given}}, visit);
}

std::string to_yaml(const VisitOptions& visit) {
  YamlWriter writer;
  visit(writer);
  return writer.text;
}

std::vector<FieldRow> field_rows(const VisitOptions& visit) {
  RowWriter writer;
  visit(writer);
  return writer.rows;
}

std::string nearest_name(std::string_view word, const std::vector<std::string>& candidates) {
  std::string nearest;
  std::size_t smallest = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= smallest) continue;
    smallest = distance;
    nearest = candidate;
  }
  return nearest;
}

}  // namespace groundscale
