#pragma once

#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <string_view>

#include <fmt/format.h>

namespace groundscale {

/// Frame, rate and a word about the result, on one line of a terminal; nothing where there is none.
class Progress {
 public:
  Progress(bool wanted, int frames) : shown_(wanted && isatty(STDERR_FILENO) != 0), frames_(frames) {}
  ~Progress() {
    if (shown_) fmt::print(stderr, "\r\033[K");
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void show(int done, std::string_view result) {
    constexpr double kIntervalS = 0.2;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
    if (!shown_ || seconds - last_ < kIntervalS) return;
    last_ = seconds;
    fmt::print(stderr, "\rframe {} of {}, {:.1f} a second{}{}\033[K", done, frames_, done / seconds,
               result.empty() ? "" : ", ", result);
    std::fflush(stderr);
  }

 private:
  bool shown_;
  int frames_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  double last_ = 0.0;
};

}  // namespace groundscale
