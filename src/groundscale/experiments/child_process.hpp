#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// A program to be run to its end. It reads nothing; its standard error is the caller's.
struct ChildCommand {
  std::string program;                 ///< A path, or a name that is looked up in PATH.
  std::vector<std::string> arguments;  ///< Without the program's own name.
  std::string output = "/dev/null";    ///< File for its standard output.
  std::string folder{};                ///< It works there; "": where the caller does.
};

/// What a child came to and what it took.
struct ChildResult {
  int status = 0;  ///< Exit status; 128 + n where signal n ended it.
  double wall_s = 0.0;
  double cpu_s = 0.0;  ///< User and system, all threads.
  /// Largest resident set. The kernel counts from the caller's own peak: a child smaller than its caller shows that.
  double peak_memory_mb = 0.0;
};

/// Starts the child, waits for it, and measures it. A child does not outlive its caller.
/// @return kIo where it can't be started or its output can't be written; a status other than 0 is no error.
Result<ChildResult> run_child(const ChildCommand& command);

/// The program itself, as a child is to run it: the same binary, even where its file has been replaced since.
inline constexpr std::string_view kThisProgram = "/proc/self/exe";

/// Words as one line that a shell splits into the same words.
std::string shell_line(const std::vector<std::string>& words);

/// The command that started this process, as shell_line has it, with `groundscale` for the program's path.
std::string command_of_this_process();

}  // namespace groundscale
