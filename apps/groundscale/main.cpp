#include <cstdio>
#include <exception>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "groundscale/core/log.hpp"

namespace groundscale {

void say(const std::string& message) { std::fputs(fmt::format("groundscale: {}\n", message).c_str(), stderr); }

int report_failure(const Error& error) {
  say(error.message);
  return error.code == ErrorCode::kBadInput ? kWrongUse : kFailedOnTheWay;
}

namespace {

int run_program(int argc, char** argv) {
  CLI::App app{"groundscale: metric scale for monocular visual odometry from the ground plane", "groundscale"};
  app.set_version_flag("--version", "groundscale " GROUNDSCALE_VERSION);
  app.require_subcommand(1);
  int exit_status = kDone;
  add_run(app, exit_status);
  add_calibrate(app, exit_status);
  add_height(app, exit_status);
  add_scale(app, exit_status);
  add_evaluate(app, exit_status);
  add_report(app, exit_status);
  add_simulate(app, exit_status);
  add_experiment(app, exit_status);
  add_config(app, exit_status);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kWrongUse;  // --help and --version come this way too
  }
  return exit_status;
}

}  // namespace
}  // namespace groundscale

int main(int argc, char** argv) {
  using namespace groundscale;
  set_log_sink([](std::string_view message) { say(fmt::format("warning: {}", message)); });
  int exit_status = kFailedOnTheWay;
  try {
    exit_status = run_program(argc, argv);
  } catch (const std::exception& error) {
    say(fmt::format("failed: {}", error.what()));
  }
  if (std::fflush(stdout) != 0 || std::ferror(stdout) != 0) {
    say("the results could not be written to the standard output");
    if (exit_status == kDone) exit_status = kFailedOnTheWay;
  }
  return exit_status;
}
