#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/odometry/run_source.hpp"
#include "groundscale/simulation/camera_presets.hpp"
#include "groundscale/simulation/route.hpp"
#include "groundscale/simulation/simulation_options.hpp"

namespace groundscale {
namespace {

struct ConfigArguments {
  std::string config_file;
  std::vector<std::string> assignments;
  bool markdown = false;
  bool simulation = false;
};

std::string section_of(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  return dot == std::string::npos ? "" : name.substr(0, dot);
}

/// A '|' would end the cell.
std::string cell(const std::string& text) {
  std::string escaped;
  for (const char c : text) escaped += c == '|' ? std::string("\\|") : std::string(1, c);
  return escaped;
}

/// A table a section.
void print_tables(const std::vector<FieldRow>& rows) {
  std::string section = "-";
  for (const FieldRow& row : rows) {
    if (section_of(row.name) != section) {
      section = section_of(row.name);
      fmt::print("\n## {}\n\n| key | default | unit | range | what it does |\n|---|---|---|---|---|\n",
                 section.empty() ? "General" : "`" + section + "`");
    }
    fmt::print("| `{}` | `{}` | {} | {} | {} |\n", row.name, cell(row.value), row.unit, cell(row.range),
               cell(row.help));
  }
}

/// docs/configuration.md.
void print_markdown(const std::vector<FieldRow>& rows) {
  fmt::print(
      "# Configuration\n\n"
      "Every key of `groundscale run`, for `--set section.key=value` or a YAML file for `--config`. Made by\n"
      "`groundscale config --markdown`; a check keeps it in step with the code. Those of `groundscale simulate` are "
      "in\n"
      "[simulation-options.md](simulation-options.md).\n");
  print_tables(rows);
}

std::vector<FieldRow> simulation_rows(SimulationOptions options) {
  return field_rows([&options](FieldVisitor& visitor) { visit_fields(options, visitor); });
}

/// What differs from the first rows in the others, as cells: "`key` value, `key` value".
std::string differences(const std::vector<FieldRow>& from, const std::vector<FieldRow>& to) {
  std::string text;
  for (std::size_t k = 0; k < from.size(); ++k) {
    if (from[k].value == to[k].value) continue;
    text += fmt::format("{}`{}` {}", text.empty() ? "" : ", ", to[k].name, to[k].value);
  }
  return text;
}

/// docs/simulation-options.md.
Result<void> print_simulation_markdown() {
  const std::vector<FieldRow> rows = simulation_rows({});
  fmt::print(
      "# Options of the simulation\n\n"
      "Every key of `groundscale simulate`, for `--set section.key=value`. Made by `groundscale config --simulation\n"
      "--markdown`; a check keeps it in step with the code. What they are about: [simulation.md](simulation.md).\n\n"
      "A preset, then the file of `--camera`, then the route, then `--set` change the defaults:\n\n"
      "| | changes |\n|---|---|\n");
  for (const std::string_view name : camera_preset_names()) {
    const auto preset = find_camera_preset(name);
    if (!preset) return preset.error();
    fmt::print("| preset `{}` | {} |\n", name, differences(rows, simulation_rows(preset->options)));
  }
  for (const std::string_view name : route_names()) {
    const auto route = find_route(name);
    if (!route) return route.error();
    SimulationOptions options;
    set_surroundings(route->surroundings, options.world);
    const std::string changes = differences(rows, simulation_rows(options));
    if (!changes.empty()) fmt::print("| route `{}` | {} |\n", name, changes);
  }
  print_tables(rows);
  return {};
}

void print_table(const std::vector<FieldRow>& rows) {
  std::size_t name = 0, value = 0, unit = 0;  // widths
  for (const FieldRow& row : rows) {
    name = std::max(name, row.name.size());
    value = std::max(value, row.value.size());
    unit = std::max(unit, row.unit.size());
  }
  for (const FieldRow& row : rows) {
    const std::string range = row.range.empty() ? "" : fmt::format(" [{}]", row.range);
    fmt::print("{:<{}}  {:>{}} {:<{}}  {}{}\n", row.name, name, row.value, value, row.unit, unit, row.help, range);
  }
}

Result<void> print_simulation(const ConfigArguments& arguments) {
  if (arguments.markdown) return print_simulation_markdown();
  SimulationOptions options;
  const VisitOptions visit = [&options](FieldVisitor& visitor) { visit_fields(options, visitor); };
  for (const std::string& assignment : arguments.assignments) {
    if (Result<void> done = apply_assignment(assignment, visit); !done) return done;
  }
  if (Result<void> valid = validate(options); !valid) return valid;
  print_table(field_rows(visit));
  return {};
}

Result<void> print_config(const ConfigArguments& arguments) {
  if (arguments.simulation) return print_simulation(arguments);
  RunConfig options;
  const VisitOptions visit = [&options](FieldVisitor& visitor) { visit_fields(options, visitor); };
  if (!arguments.config_file.empty()) {
    const Result<std::string> text = read_text(arguments.config_file);
    if (!text) return text.error();
    if (Result<void> done = apply_yaml(*text, arguments.config_file, visit); !done) return done;
  }
  for (const std::string& assignment : arguments.assignments) {
    if (Result<void> done = apply_assignment(assignment, visit); !done) return done;
  }
  if (Result<void> valid = options.validate(); !valid) return valid;
  const std::vector<FieldRow> rows = field_rows(visit);
  arguments.markdown ? print_markdown(rows) : print_table(rows);
  return {};
}

}  // namespace

void add_config(CLI::App& app, int& exit_status) {
  CLI::App* command = app.add_subcommand("config", "Every key of the configuration: value, unit, range, what it does");
  const auto arguments = std::make_shared<ConfigArguments>();
  command->add_flag("--markdown", arguments->markdown, "As docs/configuration.md");
  CLI::Option* file =
      command->add_option("--config", arguments->config_file, "Show the values with this file")->option_text("FILE");
  command->add_flag("--simulation", arguments->simulation, "Those of simulate; as docs/simulation-options.md")
      ->excludes(file);
  command->add_option("--set", arguments->assignments, "Show the values with this one set")
      ->expected(1)
      ->take_all()
      ->option_text("KEY=VALUE");
  command->callback([arguments, &exit_status] {
    const Result<void> done = print_config(*arguments);
    exit_status = done ? kDone : report_failure(done.error());
  });
}

}  // namespace groundscale
