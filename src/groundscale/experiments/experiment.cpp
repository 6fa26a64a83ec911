#include "groundscale/experiments/experiment.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <system_error>
#include <thread>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

constexpr std::string_view kMarkBegins = "groundscale experiment ";

std::string mark_file(const std::string& folder) { return (std::filesystem::path(folder) / "experiment.txt").string(); }

/// Name of the experiment whose folder this is; "" where it is none's.
std::string experiment_in(const std::string& folder) {
  const auto mark = read_text(mark_file(folder));
  if (!mark || !mark->starts_with(kMarkBegins)) return "";
  return mark->substr(kMarkBegins.size(), mark->find('\n') - kMarkBegins.size());
}

}  // namespace

std::string program_version() { return "groundscale " GROUNDSCALE_VERSION; }

std::string processor_name() {
  const auto text = read_text("/proc/cpuinfo");
  std::string name = "unknown processor";
  for (const internal::Line& line : internal::split_lines(text ? std::string_view(*text) : std::string_view())) {
    const std::size_t colon = line.text.find(':');
    if (!line.text.starts_with("model name") || colon == std::string_view::npos) continue;
    name = internal::printable(internal::trimmed(line.text.substr(colon + 1)));
    break;
  }
  return fmt::format("{} ({} processors)", name, std::thread::hardware_concurrency());
}

Result<void> check_experiment_folder(std::string_view name, const ExperimentRequest& request) {
  const std::string present = experiment_in(request.output);
  if (present == name) return {};
  if (!present.empty() && !request.force) {
    return internal::bad_input(fmt::format("--output {}: holds the experiment '{}'; --force overwrites it",
                                           request.output, internal::printable(present)));
  }
  return check_output_folder("--output", request.output, request.force);
}

Result<FolderLock> claim_experiment_folder(std::string_view name, const ExperimentRequest& request) {
  if (const auto made = make_output_folder("--output", request.output); !made) return made.error();
  const int folder = open(request.output.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0) return internal::bad_input(fmt::format("--output {}: can't be opened", request.output));
  FolderLock lock(nullptr, [folder](void*) { close(folder); });
  if (flock(folder, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    return internal::bad_input(fmt::format("--output {}: another experiment is at work there", request.output));
  }
  const auto written = write_text(mark_file(request.output), fmt::format("{}{}\n", kMarkBegins, name));
  if (!written) return internal::bad_input("--output " + written.error().message);  // nothing was done yet
  return lock;
}

Result<ChildResult> run_step(const ExperimentRequest& request, const std::vector<std::string>& arguments,
                             const std::string& output) {
  const auto result = run_child({.program = request.program, .arguments = arguments, .output = output});
  if (!result || result->status == 0) return result;
  return Error{ErrorCode::kIo, fmt::format("status {} of: {}", result->status, step_command(arguments))};
}

std::string step_command(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {"groundscale"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return shell_line(words);
}

}  // namespace groundscale
