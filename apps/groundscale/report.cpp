#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/report/run_folder.hpp"
#include "groundscale/report/run_report.hpp"
#include "output_files.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<std::string> folders;
  std::string output;
  std::string truth;
  bool force = false;
};

/// A folder that is named twice, by whatever name.
Result<void> check_distinct(const std::vector<std::string>& folders) {
  std::error_code ignored;
  for (std::size_t k = 0; k < folders.size(); ++k) {
    for (std::size_t j = 0; j < k; ++j) {
      if (!fs::equivalent(folders[j], folders[k], ignored)) continue;
      return Error{ErrorCode::kBadInput, fmt::format("{} is there twice: a run is shown once", folders[k])};
    }
  }
  return {};
}

/// What the report is made of is never written over.
std::vector<std::string> inputs_of(const ReportArguments& arguments) {
  std::vector<std::string> inputs = {arguments.truth};
  for (const std::string& folder : arguments.folders) {
    for (const char* file : {"trajectory.kitti", "trajectory.tum", "online.kitti", "online.tum", "frames.csv",
                             "summary.json", "config.yaml"}) {
      inputs.push_back((fs::path(folder) / file).string());
    }
  }
  return inputs;
}

Result<void> report(const ReportArguments& arguments) {
  if (const auto distinct = check_distinct(arguments.folders); !distinct) return distinct;
  const auto writable = check_output_files({arguments.output}, inputs_of(arguments), arguments.force);
  if (!writable) return writable;
  std::vector<RunFolder> runs;
  for (const std::string& folder : arguments.folders) {
    auto run = read_run_folder(folder, arguments.truth);
    if (!run) return run.error();
    if (!arguments.truth.empty() && !runs.empty() && runs.front().drive != run->drive) {
      return Error{ErrorCode::kBadInput,
                   fmt::format("--truth {}: is that of one drive, but {} is of {} and {} of {}", arguments.truth,
                               runs.front().folder, runs.front().drive, run->folder, run->drive)};
    }
    runs.push_back(std::move(*run));
  }
  const std::string html = runs.size() == 1 ? run_report_html(runs.front()) : comparison_html(runs);
  if (const auto written = write_text(arguments.output, html); !written) {
    return Error{ErrorCode::kBadInput, "--output " + written.error().message};  // nothing was written
  }
  fmt::print("report               {}\n", arguments.output);
  return {};
}

}  // namespace

void add_report(CLI::App& app, int& exit_status) {
  auto arguments = std::make_shared<ReportArguments>();
  CLI::App* command = app.add_subcommand("report", "A page about a run, or about several beside each other");
  command->add_option("DIR", arguments->folders, "Folders of runs")->required();
  command->add_option("--output", arguments->output, "HTML file")->required()->option_text("FILE REQUIRED");
  command->add_option("--truth", arguments->truth, "True trajectory of the drive; default is what each run was told")
      ->option_text("FILE");
  command->add_flag("--force", arguments->force, "Overwrite the output");
  command->callback([arguments, &exit_status] {
    const auto done = report(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
