#pragma once

#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/core/result.hpp"
#include "groundscale/experiments/child_process.hpp"

namespace groundscale {

/// What every experiment is told.
struct ExperimentRequest {
  std::string output;                              ///< Folder for everything that it writes.
  std::string command = "groundscale experiment";  ///< As it was typed, for the report.
  std::string program{kThisProgram};               ///< Runs the single steps.
  bool force = false;  ///< Write into a folder that holds something else; do again what is done.
  bool quiet = false;  ///< Steps show no progress.
  std::function<void(std::string_view)> say = [](std::string_view) {};  ///< What is being done, a line at a time.
};

/// What came of it.
struct ExperimentOutcome {
  std::string report;                 ///< The Markdown file.
  std::string table;                  ///< The main figures, as Markdown.
  std::vector<std::string> problems;  ///< Parts that failed; what could be done lies there all the same.
};

/// "groundscale 0.1.0"
std::string program_version();

/// The processor's name and number of cores as the system has them, for figures of time: "Name (2 processors)".
std::string processor_name();

/// Whether an experiment may work in its folder: it isn't there, is empty, holds the same experiment (which is then
/// resumed), or `force` is set. Writes nothing. @return kBadInput.
Result<void> check_experiment_folder(std::string_view name, const ExperimentRequest& request);
/// Held while an experiment works in its folder, so that no second one does.
using FolderLock = std::shared_ptr<void>;
/// Makes the folder and marks it as this experiment's, in `experiment.txt`. @pre check_experiment_folder.
/// @return kBadInput where it can't be made or another process is at work in it.
Result<FolderLock> claim_experiment_folder(std::string_view name, const ExperimentRequest& request);

/// A step: runs the program itself with these arguments. What it says on its standard error goes to ours.
/// @param output  File for its standard output.
/// @return kIo with the command where it ends with another status than 0.
Result<ChildResult> run_step(const ExperimentRequest& request, const std::vector<std::string>& arguments,
                             const std::string& output = "/dev/null");
/// The same step as it can be typed.
std::string step_command(const std::vector<std::string>& arguments);

}  // namespace groundscale
