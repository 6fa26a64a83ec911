#pragma once

#include <chrono>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace groundscale {

/// Adds up how long the stages of a piece of work take. Never read by the work itself: results don't depend on time.
class StageClock {
 public:
  /// The time since the last call (or since construction) belongs to `stage`.
  void lap(std::string_view stage) {
    const auto now = std::chrono::steady_clock::now();
    add(stage, std::chrono::duration<double>(now - last_).count());
    last_ = now;
  }
  /// The time since the last call belongs to nobody.
  void skip() { last_ = std::chrono::steady_clock::now(); }
  void add(std::string_view stage, double seconds) {
    for (auto& [name, total] : seconds_) {
      if (name == stage) {
        total += seconds;
        return;
      }
    }
    seconds_.emplace_back(stage, seconds);
  }
  /// Stages in the order of their first lap, seconds in all.
  const std::vector<std::pair<std::string, double>>& seconds() const { return seconds_; }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
  std::vector<std::pair<std::string, double>> seconds_;
};

}  // namespace groundscale
