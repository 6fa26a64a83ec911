#include "groundscale/experiments/matching.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/experiments/matching_pairs.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/experiments/report_parts.hpp"
#include "groundscale/experiments/table.hpp"
#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

constexpr double kKmh = 3.6;
constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// Pairs that count together.
struct Group {
  std::string name;
  std::vector<const MatchedPair*> pairs;
};

struct FinishedDrive {
  RenderedDrive drive;
  std::vector<MatchedPair> pairs;
};

Table empty_table() {
  std::vector<Column> columns = {{.name = "pairs_of", .title = "", .text = true},
                                 {.name = "front_end", .title = "front end", .text = true},
                                 {.name = "pairs", .title = "pairs", .decimals = 0},
                                 {.name = "matches", .title = "matches a pair", .decimals = 0},
                                 {.name = "within_half_px", .title = "within 0.5 px %", .decimals = 1},
                                 {.name = "within_1_px", .title = "1 px %", .decimals = 1},
                                 {.name = "within_2_px", .title = "2 px %", .decimals = 1},
                                 {.name = "median_px", .title = "median error px", .decimals = 3},
                                 {.name = "p95_px", .title = "95 % below px", .decimals = 2},
                                 {.name = "time_ms", .title = "ms a pair (median)", .decimals = 1}};
  for (Column& column : columns) column.averaged = false;
  return Table(std::move(columns));
}

void add_rows(const Group& group, Table& table) {
  for (const std::string& way : matching_ways()) {
    std::vector<double> errors, times, counts;
    for (const MatchedPair* pair : group.pairs) {
      if (pair->way != way) continue;
      errors.insert(errors.end(), pair->errors_px.begin(), pair->errors_px.end());
      times.push_back(pair->time_ms);
      counts.push_back(static_cast<double>(pair->errors_px.size()));
    }
    if (counts.empty()) continue;
    std::vector<Cell> cells = {group.name, way, static_cast<double>(counts.size()), quantile(counts, 0.5)};
    const bool any = !errors.empty();
    for (const double limit : {0.5, 1.0, 2.0}) {
      const auto within = std::count_if(errors.begin(), errors.end(), [limit](double e) { return e < limit; });
      cells.emplace_back(any ? std::optional(100.0 * static_cast<double>(within) / static_cast<double>(errors.size()))
                             : std::nullopt);
    }
    for (const double share : {0.5, 0.95}) {
      cells.emplace_back(any ? std::optional(quantile(errors, share)) : std::nullopt);
    }
    cells.emplace_back(quantile(times, 0.5));
    table.add_row(std::move(cells));
  }
}

std::vector<Group> groups_of(const std::vector<FinishedDrive>& drives) {
  std::vector<Group> groups;
  Group all{"all", {}};
  for (const FinishedDrive& drive : drives) {
    Group group{drive.drive.name, {}};
    for (const MatchedPair& pair : drive.pairs) group.pairs.push_back(&pair);
    all.pairs.insert(all.pairs.end(), group.pairs.begin(), group.pairs.end());
    groups.push_back(std::move(group));
  }
  constexpr std::array<double, 6> kSpeeds = {0.0, 20.0, 40.0, 60.0, 80.0, kNoLimit};  // km/h
  for (std::size_t k = 0; k + 1 < kSpeeds.size(); ++k) {
    Group group{kSpeeds[k + 1] < kNoLimit ? fmt::format("{:g} to {:g} km/h", kSpeeds[k], kSpeeds[k + 1])
                                          : fmt::format("from {:g} km/h", kSpeeds[k]),
                {}};
    for (const MatchedPair* pair : all.pairs) {
      const double speed = kKmh * pair->speed_mps;
      if (speed >= kSpeeds[k] && speed < kSpeeds[k + 1]) group.pairs.push_back(pair);
    }
    if (!group.pairs.empty()) groups.push_back(std::move(group));
  }
  groups.push_back(std::move(all));
  return groups;
}

/// Share of matches over the error that they have at most.
Plot errors_plot(const std::vector<FinishedDrive>& drives) {
  Plot plot{.name = "errors",
            .title = "Road matches within an error of their true transfer",
            .x_label = "error (px)",
            .y_label = "matches within it, a pair (mean)",
            .columns = {"error_px"},
            .rows = {},
            .curves = {},
            .settings = {"set yrange [0:*]", "set key right bottom"}};
  std::vector<std::vector<double>> errors;
  std::vector<double> pairs;
  for (const std::string& way : matching_ways()) {
    plot.columns.push_back(way);
    plot.curves.push_back({.title = way, .x = 0, .y = static_cast<int>(plot.columns.size()) - 1});
    errors.emplace_back();
    pairs.push_back(0.0);
    for (const FinishedDrive& drive : drives) {
      for (const MatchedPair& pair : drive.pairs) {
        if (pair.way != way) continue;
        errors.back().insert(errors.back().end(), pair.errors_px.begin(), pair.errors_px.end());
        pairs.back() += 1.0;
      }
    }
    std::sort(errors.back().begin(), errors.back().end());
  }
  for (int k = 0; k <= 60; ++k) {
    const double limit = 0.05 * k;
    std::vector<std::optional<double>> row = {limit};
    for (std::size_t way = 0; way < errors.size(); ++way) {
      const auto within = std::lower_bound(errors[way].begin(), errors[way].end(), limit) - errors[way].begin();
      row.emplace_back(pairs[way] > 0.0 ? std::optional(static_cast<double>(within) / pairs[way]) : std::nullopt);
    }
    plot.rows.push_back(std::move(row));
  }
  return plot;
}

Result<FinishedDrive> finish_drive(const DriveChoice& choice, const DriveOptions& options,
                                   const OdometryOptions& odometry, const RunSettings& settings,
                                   const ExperimentRequest& request) {
  const fs::path folder = fs::path(request.output) / "drives" / choice.name;
  auto drive = obtain_drive(choice, options, (folder / "drive").string(), request);
  if (!drive) return drive.error();
  const auto program = file_digest(request.program);
  if (!program) return program.error();
  const std::string pairs = (folder / "pairs").string();
  const std::string key = fmt::format("{}, program {}\n{}\n{}", program_version(), *program,
                                      fmt::join(settings.assignments, " "), drive->key);
  const auto done = WorkUnit(pairs, key).complete(request.force, [&]() -> Result<void> {
    request.say(fmt::format("{}: matching", choice.name));
    const auto matched = match_pairs(drive->folder, odometry);
    if (!matched) return matched.error();
    std::error_code ignored;
    fs::create_directories(pairs, ignored);
    return write_text(pairs + "/pairs.csv", pairs_csv(*matched));
  });
  if (!done) return done.error();
  auto read = read_pairs(pairs + "/pairs.csv");
  if (!read) return read.error();
  if (read->empty()) {
    return internal::bad_input(
        "no pair can be matched: it takes three frames, and road before a camera that moves from the second on");
  }
  return FinishedDrive{std::move(*drive), std::move(*read)};
}

Result<ExperimentOutcome> report(const std::vector<FinishedDrive>& drives, std::vector<std::string> problems,
                                 const ExperimentRequest& request) {
  const fs::path output = request.output;
  Table table = empty_table();
  for (const Group& group : groups_of(drives)) add_rows(group, table);
  if (const auto written = write_text((output / "matching.csv").string(), table.csv()); !written) {
    return written.error();
  }
  std::vector<std::string> names;
  for (const Column& column : table.columns()) names.push_back(column.name);
  std::vector<Plot> plots = {errors_plot(drives)};
  const bool drawn = write_figures(request.output, plots, problems);
  ExperimentOutcome outcome;
  outcome.table = table.markdown(names);
  outcome.report = (output / "matching.md").string();
  outcome.problems = problems;
  std::string text =
      fmt::format("# Experiment `{}`: {}\n\n    {}\n\n{}, {}. With full precision: `matching.csv`.\n\n{}\n",
                  kMatchingName, kMatchingSummary, request.command, program_version(), processor_name(), outcome.table);
  text += bullet_list(problems) + figures_section(plots, drawn) + "## Step by step\n\n";
  for (const FinishedDrive& drive : drives) text += fmt::format("    {}\n", drive.drive.command);
  if (const auto written = write_report(outcome.report, text); !written) return written.error();
  return outcome;
}

}  // namespace

Result<ExperimentOutcome> run_matching(DriveOptions options, const RunSettings& settings,
                                       const ExperimentRequest& request) {
  OdometryOptions odometry;
  for (const std::string& assignment : settings.assignments) {
    const auto done =
        apply_assignment(assignment, [&odometry](FieldVisitor& visitor) { visit_fields(odometry, visitor); });
    if (!done) return done.error();
  }
  if (const auto valid = odometry.validate(); !valid) return valid.error();
  options.depth = options.road_masks = true;
  const auto choices = choose_drives(options);
  if (!choices) return choices.error();
  if (const auto free = check_experiment_folder(kMatchingName, request); !free) return free.error();
  const auto lock = claim_experiment_folder(kMatchingName, request);
  if (!lock) return lock.error();
  std::vector<FinishedDrive> drives;
  std::vector<std::string> problems;
  for (const DriveChoice& choice : *choices) {
    auto drive = finish_drive(choice, options, odometry, settings, request);
    if (drive) {
      drives.push_back(std::move(*drive));
    } else {
      problems.push_back(fmt::format("drive {}: {}", choice.name, drive.error().message));
    }
  }
  if (!drives.empty()) return report(drives, std::move(problems), request);
  return Error{ErrorCode::kIo, fmt::format("no drive came to its end: {}", fmt::join(problems, "; "))};
}

}  // namespace groundscale
