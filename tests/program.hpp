#pragma once

#include <sys/wait.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "groundscale/core/check.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {

/// What a run of the built program left behind.
struct ProgramRun {
  int status = -1;  ///< Exit status; -1 where it ended by a signal.
  std::string out;
  std::string err;
};

/// Where this process's runs keep what they render; never the user's own folder, and new every time, since what older
/// builds kept there must not pass for what this one renders.
inline const internal::TempFolder& cache_folder() {
  static const internal::TempFolder folder;
  return folder;
}

/// Runs the program that CTest names in GROUNDSCALE_PROGRAM, without a terminal.
inline ProgramRun run_program(const std::vector<std::string>& arguments) {
  const char* program = std::getenv("GROUNDSCALE_PROGRAM");
  GS_CHECK(program != nullptr, "GROUNDSCALE_PROGRAM names the program; CTest sets it");
  const internal::TempFolder folder;
  const auto quoted = [](const std::string& word) {
    std::string text = "'";
    for (const char c : word) text += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return text + "'";
  };
  std::string command = "XDG_CACHE_HOME=" + quoted(cache_folder().path()) + " " + quoted(program);
  for (const std::string& argument : arguments) command.append(" ").append(quoted(argument));
  command.append(" < /dev/null > ").append(quoted(folder / "out")).append(" 2> ").append(quoted(folder / "err"));
  const int raw = std::system(command.c_str());
  ProgramRun run;
  run.status = WIFEXITED(raw) ? WEXITSTATUS(raw) : -1;
  run.out = read_text(folder / "out").value();
  run.err = read_text(folder / "err").value();
  return run;
}

}  // namespace groundscale
