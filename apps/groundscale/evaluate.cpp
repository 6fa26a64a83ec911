#include <cstdio>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "groundscale/evaluation/evaluate.hpp"
#include "groundscale/evaluation/figures.hpp"
#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/io/files.hpp"

namespace groundscale {
namespace {

struct EvaluateArguments {
  PairingRequest request;
  std::vector<double> lengths_m = kitti_lengths_m();
  std::string json;
};

/// Found out before the work, so that nothing is printed for wrong use.
Result<void> check_output(const std::string& json) {
  if (json.empty()) return {};
  std::error_code ignored;
  const std::filesystem::path folder = std::filesystem::absolute(json, ignored).parent_path();
  if (!std::filesystem::is_directory(folder, ignored)) {
    return Error{ErrorCode::kBadInput, fmt::format("--json {}: there is no folder {}", json, folder.string())};
  }
  if (std::filesystem::is_directory(json, ignored)) {
    return Error{ErrorCode::kBadInput, fmt::format("--json {}: is a folder, a file is expected", json)};
  }
  return {};
}

int evaluate_and_print(const EvaluateArguments& arguments) {
  if (const auto possible = check_output(arguments.json); !possible) return report_failure(possible.error());
  const Result<PairedDrive> drive = pair_drive(arguments.request);
  if (!drive) return report_failure(drive.error());
  const Result<Evaluation> evaluation = evaluate(*drive, arguments.lengths_m);
  if (!evaluation) return report_failure(evaluation.error());
  fmt::print("{}", evaluation_table(arguments.request, *drive, *evaluation));
  if (arguments.json.empty()) return kDone;
  const Result<void> written = write_text(arguments.json, evaluation_json(arguments.request, *drive, *evaluation));
  return written ? kDone : report_failure(written.error());
}

}  // namespace

void add_evaluate(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("evaluate",
                                         "Compares a trajectory with the truth; scale is never aligned unless the "
                                         "figure's name says so");
  const auto arguments = std::make_shared<EvaluateArguments>();
  PairingRequest& request = arguments->request;
  command
      ->add_option("ESTIMATE", request.estimate,
                   "A run's folder, or a trajectory (KITTI rows; TUM rows, matched by time)")
      ->required();
  command->add_option("--truth", request.truth, "True trajectory (KITTI or TUM rows)")
      ->required()
      ->option_text("FILE REQUIRED");
  command->add_option("--truth-offset", request.truth_offset, "Row i of the estimate is row i + N of the truth")
      ->option_text("N");
  command->add_option("--skip", request.skip, "Leave out the first N rows of the estimate")->option_text("N");
  command
      ->add_option("--lengths", arguments->lengths_m, "Segments of t_rel and r_rel in metres (default 100,200,...,800)")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->option_text("L,L,...");
  command->add_option("--json", arguments->json, "Write all figures to this file too, with full precision")
      ->option_text("FILE");
  command->callback([arguments, &exit_status] { exit_status = evaluate_and_print(*arguments); });
}

}  // namespace groundscale
