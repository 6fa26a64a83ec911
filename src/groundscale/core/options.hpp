#pragma once

#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// What a user is told about one option. `key` is the last part of the dotted name.
struct FieldInfo {
  std::string_view key;
  std::string_view unit;  ///< "" where there is none.
  std::string_view help;
  double min = -std::numeric_limits<double>::infinity();  ///< Bounds are inclusive; for numbers only.
  double max = std::numeric_limits<double>::infinity();
};

/// "from 0 to 5 px", "at least 0 px", "at most 5 px", or "" where there is no bound.
std::string range_text(const FieldInfo& info);

/// An enumeration as an option: names in the order of its values, which count from 0.
struct Choice {
  std::vector<std::string_view> names;
  std::function<int()> get;
  std::function<void(int)> set;
};

/// Names of an enumeration's values, in their order; specialised beside the enumeration.
template <class E>
std::vector<std::string_view> names_of();

/// The one description of an options struct, from which the YAML reader and writer, `--set`, `groundscale config` and
/// the docs' table are made. Each struct has `void visit_fields(Options&, FieldVisitor&)` beside it, which calls the
/// visitor once a field and `group` once a nested struct.
class FieldVisitor {
 public:
  virtual ~FieldVisitor() = default;
  virtual void field(const FieldInfo& info, bool& value) = 0;
  virtual void field(const FieldInfo& info, int& value) = 0;
  virtual void field(const FieldInfo& info, double& value) = 0;
  virtual void field(const FieldInfo& info, std::string& value) = 0;
  virtual void field(const FieldInfo& info, std::vector<double>& value) = 0;
  virtual void field(const FieldInfo& info, Choice value) = 0;

  template <class E>
  requires std::is_enum_v<E>
  void field(const FieldInfo& info, E& value) {
    field(info, Choice{names_of<E>(), [&value] { return static_cast<int>(value); },
                       [&value](int index) { value = static_cast<E>(index); }});
  }

  /// Fields of a nested struct, under `key`.
  template <class Options>
  void group(std::string_view key, Options& options) {
    enter(key);
    visit_fields(options, *this);
    leave();
  }

 protected:
  virtual void enter(std::string_view key) = 0;
  virtual void leave() = 0;
};

/// A visitor that knows the dotted name of the field it is at.
class NamedFieldVisitor : public FieldVisitor {
 protected:
  void enter(std::string_view key) override;
  void leave() override;
  std::string name_of(const FieldInfo& info) const { return prefix_ + std::string(info.key); }

 private:
  std::string prefix_;
};

namespace internal {
/// Collects the first field out of bounds.
class RangeCheck : public NamedFieldVisitor {
 public:
  using FieldVisitor::field;
  void field(const FieldInfo& info, bool& value) override;
  void field(const FieldInfo& info, int& value) override;
  void field(const FieldInfo& info, double& value) override;
  void field(const FieldInfo& info, std::string& value) override;
  void field(const FieldInfo& info, std::vector<double>& value) override;
  void field(const FieldInfo& info, Choice value) override;
  Result<void> result() const { return result_; }

 private:
  void check(const FieldInfo& info, double value);
  Result<void> result_;
};
}  // namespace internal

/// Every number within its bounds and finite; the error names field, value and bound.
template <class Options>
Result<void> check_ranges(const Options& options) {
  internal::RangeCheck check;
  Options copy = options;
  visit_fields(copy, check);
  return check.result();
}

}  // namespace groundscale
