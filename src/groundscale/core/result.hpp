#pragma once

#include <string>
#include <utility>
#include <variant>

#include "groundscale/core/check.hpp"

namespace groundscale {

/// Why something that can be foreseen did not work. Bugs of the caller are GS_CHECK's business.
enum class ErrorCode {
  kBadInput,          ///< A file, value or option given by the user is wrong; nothing was written.
  kIo,                ///< Reading or writing failed on the way (disk full, device gone).
  kTooFewMatches,     ///< Not enough observations for the estimate.
  kDegenerateMotion,  ///< Standing still or pure rotation: the quantity can't be seen.
  kNotGround,         ///< What was found isn't the road.
  kNotConverged,      ///< An iteration ended without a usable result.
};

struct Error {
  ErrorCode code = ErrorCode::kBadInput;
  std::string message;  ///< What was wrong, where, and what would be right.
};

/// A value or the reason why there is none. Member names as in std::expected.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }

  const T& value() const& {
    GS_CHECK(has_value(), "value() of a Result that holds an error");
    return *std::get_if<0>(&state_);
  }
  T& value() & {
    GS_CHECK(has_value(), "value() of a Result that holds an error");
    return *std::get_if<0>(&state_);
  }
  T&& value() && {
    GS_CHECK(has_value(), "value() of a Result that holds an error");
    return std::move(*std::get_if<0>(&state_));
  }
  const Error& error() const {
    GS_CHECK(!has_value(), "error() of a Result that holds a value");
    return *std::get_if<1>(&state_);
  }

  const T& operator*() const& { return value(); }
  T& operator*() & { return value(); }
  T&& operator*() && { return std::move(*this).value(); }
  const T* operator->() const { return &value(); }
  T* operator->() { return &value(); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : failed_(true), error_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return !failed_; }
  explicit operator bool() const { return !failed_; }
  const Error& error() const {
    GS_CHECK(failed_, "error() of a Result that holds a value");
    return error_;
  }

 private:
  bool failed_ = false;
  Error error_;
};

}  // namespace groundscale
