#include "groundscale/experiments/measured_run.hpp"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/odometry/run_source.hpp"

namespace groundscale {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kEvaluationFile = "/evaluation.json";
constexpr const char* kProcessFile = "/process.json";

/// What decides a run on a drive, wherever both lie.
std::vector<std::string> run_arguments(const RunSettings& settings) {
  std::vector<std::string> arguments = {"run"};
  for (const std::string& assignment : settings.assignments) {
    arguments.insert(arguments.end(), {"--set", assignment});
  }
  if (settings.seed) arguments.insert(arguments.end(), {"--seed", fmt::to_string(*settings.seed)});
  return arguments;
}

/// What depends on where the drive lies. Its config.yaml, which says where the road is in view, comes from what its key
/// tells.
std::vector<std::string> place_arguments(const RenderedDrive& drive, const RunSettings& settings) {
  std::vector<std::string> arguments;
  const auto add = [&arguments](const char* option, const std::string& value) {
    arguments.insert(arguments.end(), {option, value});
  };
  const std::string config = drive.folder + "/config.yaml";
  std::error_code ignored;
  if (!drive.real && std::filesystem::is_regular_file(config, ignored)) add("--config", config);
  if (!settings.camera.empty()) add("--camera", settings.camera);
  if (drive.frames > 0) add("--frames", fmt::to_string(drive.frames));
  return arguments;
}

/// Version and bytes of the program, settings, camera, drive.
Result<std::string> key_of(const RenderedDrive& drive, const RunSettings& settings, const std::string& program) {
  const auto digest = file_digest(program);
  if (!digest) return digest.error();
  std::string deciding = shell_line(run_arguments(settings));
  if (!settings.camera.empty()) {
    const auto camera = file_digest(settings.camera);
    if (!camera) return camera.error();
    deciding += " camera " + *camera;
  }
  return fmt::format("{}, program {}\n{}\n{}", program_version(), *digest, deciding, drive.key);
}

std::vector<std::string> evaluate_arguments(const RenderedDrive& drive, const std::string& folder) {
  return {"evaluate", folder, "--truth", drive.truth(), "--json", folder + kEvaluationFile};
}

/// What the process took, beside its results.
Result<void> write_process(const std::string& folder, const ChildResult& process) {
  Json json;
  json["peak_memory_mb"] = process.peak_memory_mb;
  json["wall_s"] = process.wall_s;
  json["cpu_s"] = process.cpu_s;
  json["processor"] = processor_name();
  return write_text(folder + kProcessFile, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<Json> read_json(const std::string& path) {
  const auto text = read_text(path);
  if (!text) return Error{ErrorCode::kIo, text.error().message};
  Json json = Json::parse(*text, nullptr, /*allow_exceptions=*/false);
  if (json.is_discarded()) return Error{ErrorCode::kIo, path + ": isn't JSON"};
  return json;
}

/// Fields of the three JSON files; throws where one of them is missing.
void take_fields(const Json& evaluation, const Json& summary, const Json& process, MeasuredRun& run) {
  for (const auto& [name, figure] : evaluation.at("figures").items()) {
    const Json& value = figure.at("value");
    run.figures[name] = value.is_null() ? std::nullopt : std::optional(value.get<double>());
  }
  for (const auto& [name, value] : summary.at("matching").items())
    run.figures["matching_" + name] = value.get<double>();
  run.refused_share = 1.0 - summary.at("accepted_measurements").get<double>() /
                                std::max(1.0, summary.at("states").at("moving").get<double>());
  run.lost = summary.at("states").value("lost", 0);
  if (const auto events = summary.find("scale_corrections"); events != summary.end()) {
    run.corrections = static_cast<int>(events->size());
  }
  run.moving_steps = evaluation.at("moving").at("steps").get<int>();
  run.turn_steps = evaluation.at("turns").at("steps").get<int>();
  run.frames = summary.at("frames").get<int>();
  run.median_ms = summary.at("time").at("median_ms_a_frame").get<double>();
  run.p95_ms = summary.at("time").at("p95_ms_a_frame").get<double>();
  run.warnings = summary.at("warnings").get<std::vector<std::string>>();
  run.peak_memory_mb = process.at("peak_memory_mb").get<double>();
  run.wall_s = process.at("wall_s").get<double>();
  run.processor = process.at("processor").get<std::string>();
}

Result<void> read_results(MeasuredRun& run) {
  const auto evaluation = read_json(run.folder + kEvaluationFile);
  if (!evaluation) return evaluation.error();
  const auto summary = read_json(run.folder + "/summary.json");
  if (!summary) return summary.error();
  const auto process = read_json(run.folder + kProcessFile);
  if (!process) return process.error();
  try {
    take_fields(*evaluation, *summary, *process, run);
  } catch (const Json::exception& error) {
    return Error{ErrorCode::kIo, fmt::format("{}: a result in it can't be read: {}", run.folder, error.what())};
  }
  return {};
}

Result<double> length_of(const std::string& truth, int frames) {
  const auto trajectory = read_trajectory(truth);
  if (!trajectory) return Error{ErrorCode::kIo, trajectory.error().message};
  double length_m = 0.0;
  const auto& poses = trajectory->world_from_cam;
  const std::size_t rows = std::min(poses.size(), static_cast<std::size_t>(frames));
  for (std::size_t k = 1; k < rows; ++k) length_m += (poses[k].translation - poses[k - 1].translation).norm();
  return length_m;
}

}  // namespace

Result<void> RunSettings::validate() const {
  RunConfig config;
  const VisitOptions visit = [&config](FieldVisitor& visitor) { visit_fields(config, visitor); };
  for (const std::string& assignment : assignments) {
    if (const auto done = apply_assignment(assignment, visit); !done) return done;
  }
  return config.validate();
}

std::optional<double> MeasuredRun::figure(const std::string& name) const {
  const auto found = figures.find(name);
  return found == figures.end() ? std::nullopt : found->second;
}

Result<MeasuredRun> measure_run(const RenderedDrive& drive, const RunSettings& settings, const std::string& folder,
                                const ExperimentRequest& request) {
  std::vector<std::string> arguments = run_arguments(settings);
  arguments.insert(arguments.begin() + 1, {drive.folder, "--output", folder});
  for (std::string& argument : place_arguments(drive, settings)) arguments.push_back(std::move(argument));
  const std::vector<std::string> evaluation = evaluate_arguments(drive, folder);
  MeasuredRun run;
  run.folder = folder;
  run.commands = {step_command(arguments), step_command(evaluation)};

  const auto key = key_of(drive, settings, request.program);
  if (!key) return key.error();
  if (request.quiet) arguments.emplace_back("--quiet");
  const auto done = WorkUnit(folder, *key).complete(request.force, [&]() -> Result<void> {
    request.say(fmt::format("{}: running", drive.name));
    const auto process = run_step(request, arguments);
    if (!process) return process.error();
    if (const auto written = write_process(folder, *process); !written) return written;
    const auto compared = run_step(request, evaluation, folder + "/evaluation.txt");
    return compared ? Result<void>() : compared.error();
  });
  if (!done) return done.error();
  if (const auto read = read_results(run); !read) return read.error();
  const auto length_m = length_of(drive.truth(), run.frames);
  if (!length_m) return length_m.error();
  run.length_m = *length_m;
  return run;
}

}  // namespace groundscale
