#pragma once

#include <string>

#include "groundscale/core/result.hpp"

namespace CLI {
class App;
}

namespace groundscale {

/// Exit status of the program: the same for every command.
inline constexpr int kDone = 0;
inline constexpr int kFailedOnTheWay = 1;  ///< What was written stays valid.
inline constexpr int kWrongUse = 2;        ///< Wrong use or bad input; nothing was written.

/// A line "groundscale: ..." on stderr. Where that can't be written it is lost: a full disk must not end the program.
void say(const std::string& message);

/// Says on stderr what went wrong and gives the status for it: 2 for bad input, else 1.
int report_failure(const Error& error);

// One function a subcommand, one file each. It adds the subcommand with its options to `app`; when the command line
// names it, it does the work and leaves its status in `exit_status`. Results go to stdout, all else to stderr.
void add_run(CLI::App& app, int& exit_status);
void add_scale(CLI::App& app, int& exit_status);
void add_evaluate(CLI::App& app, int& exit_status);
void add_report(CLI::App& app, int& exit_status);
void add_calibrate(CLI::App& app, int& exit_status);
void add_height(CLI::App& app, int& exit_status);
void add_config(CLI::App& app, int& exit_status);
void add_simulate(CLI::App& app, int& exit_status);
void add_experiment(CLI::App& app, int& exit_status);

}  // namespace groundscale
