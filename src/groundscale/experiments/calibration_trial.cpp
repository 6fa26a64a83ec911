#include "groundscale/experiments/calibration_trial.hpp"

#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "groundscale/calibration/calibrate.hpp"
#include "groundscale/calibration/focal_search.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/experiments/work_unit.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/odometry/run_source.hpp"
#include "groundscale/tracking/pyramid.hpp"

namespace groundscale {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kResultFile = "/calibration.json";
constexpr double kFocalSd = 0.01;  ///< Of FocalKnowledge::kWithSd, as a share.
constexpr double kPercent = 100.0;

/// The parameters that are judged, and what their figures' names begin with.
constexpr std::pair<CameraParameter, const char*> kJudged[] = {
    {CameraParameter::kRadial, "radial"}, {CameraParameter::kRow, "row"}, {CameraParameter::kFocal, "focal"}};

/// Errors of the focal length are in percent of the true one, others in their own unit.
double unit_of(CameraParameter parameter, const Camera& truth) {
  return parameter == CameraParameter::kFocal ? truth.focal_px() / kPercent : 1.0;
}

Result<CameraPtr> plain_pinhole(double focal_px, const Camera& like) {
  return PinholeCamera::create(
      {.fx = focal_px, .fy = focal_px, .cx = 0.5 * (like.width() - 1), .cy = 0.5 * (like.height() - 1)}, like.width(),
      like.height());
}

/// What a calibration works with.
struct Bench {
  std::vector<CalibrationDrive> drives;
  CameraSetup truth;
  OdometryOptions odometry;
};

Result<Bench> make_bench(const RenderedDrive& drive, const CalibrationTrial& trial, const RunSettings& settings) {
  Bench bench;
  auto truth = read_camera_file(drive.folder + "/camera.yaml", 0, 0);
  if (!truth) return Error{ErrorCode::kIo, truth.error().message};
  bench.truth = std::move(*truth);
  RunConfig config;
  const VisitOptions visit = [&config](FieldVisitor& visitor) { visit_fields(config, visitor); };
  for (const std::string& assignment : settings.assignments) {
    if (const auto done = apply_assignment(assignment, visit); !done) return done.error();
  }
  bench.odometry = config.odometry;
  SequenceRequest request{.source = drive.folder};
  if (trial.frames > 0) request.frames = trial.frames;
  bench.drives.push_back({drive.name, [request] {
                            use_one_thread();
                            return open_sequence(request, /*decode_ahead=*/true);
                          }});
  return bench;
}

/// Share by which lengths are off that a camera gives, against those of the true one.
Result<std::optional<double>> length_error(const Bench& bench, const CameraSetup& found) {
  CameraSetup truth = found;
  truth.camera = bench.truth.camera;
  const DriveRecorderOptions views = CalibrateOptions().views;
  std::vector<DrivePass> with_truth, with_found;
  for (const CalibrationDrive& drive : bench.drives) {
    auto first = drive_pass(drive, truth, bench.odometry, views);
    if (!first) return first.error();
    auto second = drive_pass(drive, found, bench.odometry, views);
    if (!second) return second.error();
    with_truth.push_back(std::move(*first));
    with_found.push_back(std::move(*second));
  }
  return length_change(with_truth, with_found);
}

/// Before, after, and how sure it is of what it found.
void add_parameters(const Calibration& calibration, const CameraSetup& start, const Camera& truth,
                    MeasuredTrial& measured) {
  for (const auto& [parameter, name] : kJudged) {
    const double unit = unit_of(parameter, truth);
    const double true_value = value_of(parameter, truth);
    const double error = (value_of(parameter, *calibration.setup.camera) - true_value) / unit;
    measured.figures[fmt::format("{}_start", name)] = (value_of(parameter, *start.camera) - true_value) / unit;
    measured.figures[fmt::format("{}_error", name)] = error;
    measured.figures[fmt::format("{}_error_px", name)] = error * unit / pixel_step(parameter, truth);
    for (const CalibratedParameter& found : calibration.parameters) {
      if (found.parameter != parameter) continue;
      if (!found.reason.empty()) {
        measured.stayed +=
            fmt::format("{}{}: {}", measured.stayed.empty() ? "" : "; ", file_name_of(parameter, truth), found.reason);
      } else if (found.sd > 0.0 && calibration.adopted) {
        measured.figures[fmt::format("{}_sd", name)] = found.sd / unit;
        measured.figures[fmt::format("{}_in_sd", name)] = error * unit / found.sd;
      }
    }
  }
}

/// What the two ways say of the radial coefficient, and the drift of the scale.
void add_ways(const Calibration& calibration, const Camera& truth, MeasuredTrial& measured) {
  auto& figures = measured.figures;
  const double true_value = value_of(CameraParameter::kRadial, truth);
  const auto add_way = [&](const std::string& name, const std::optional<ParameterEstimate>& way) {
    if (!way || !(way->sd > 0.0)) return;
    figures[name + "_error"] = way->value - true_value;
    figures[name + "_sd"] = way->sd;
  };
  add_way("tracks", calibration.radial_by_tracks);
  add_way("slope", calibration.radial_by_slope);
  const auto add_drift = [&](const std::string& name, const std::optional<ScaleSlope>& slope) {
    if (!slope) return;
    figures[name] = kPercent * slope->per_100m;
    figures[name + "_sd"] = kPercent * slope->sd_per_100m;
  };
  add_drift("drift_before", calibration.slope_before);
  add_drift("drift_after", calibration.slope_after);
}

MeasuredTrial measured_of(const Calibration& calibration, const CameraSetup& start, const Camera& truth) {
  MeasuredTrial measured;
  measured.adopted = calibration.adopted;
  measured.verdict = calibration.verdict;
  add_parameters(calibration, start, truth, measured);
  add_ways(calibration, truth, measured);
  auto& figures = measured.figures;
  if (calibration.held_out.before_px > 0.0) {
    figures["held_out_before_px"] = calibration.held_out.before_px;
    figures["held_out_after_px"] = calibration.held_out.after_px;
  }
  if (calibration.length_change) figures["length_change"] = kPercent * *calibration.length_change;
  figures["frames"] = calibration.frames;
  figures["length_m"] = calibration.length_m;
  figures["turned_deg"] = calibration.turned_deg;
  figures["passes"] = calibration.passes;
  figures["total_s"] = calibration.total_s;
  figures["times_one_pass"] = calibration.total_s / calibration.odometry_s;
  return measured;
}

Result<MeasuredTrial> calibrate_known(const Bench& bench, const CalibrationTrial& trial) {
  auto start = start_setup(bench.truth, trial.start);
  if (!start) return start.error();
  CalibrateOptions options;
  options.free_focal = trial.start.known == FocalKnowledge::kView || trial.start.known == FocalKnowledge::kNothing;
  if (trial.start.known == FocalKnowledge::kNothing) {
    const auto focal_px = search_focal(bench.drives.front(), *start, bench.odometry, options);
    if (!focal_px) return focal_px.error();
    auto camera = plain_pinhole(*focal_px, *bench.truth.camera);
    if (!camera) return camera.error();
    start->camera = *camera;
  }
  const auto calibration = calibrate(bench.drives, *start, bench.odometry, options);
  if (!calibration) return calibration.error();
  MeasuredTrial measured = measured_of(*calibration, *start, *bench.truth.camera);
  if (trial.lengths) {
    const auto error = length_error(bench, calibration->setup);
    if (!error) return error.error();
    if (*error) measured.figures["length_error"] = kPercent * **error;
  }
  return measured;
}

Result<void> write_trial(const MeasuredTrial& trial, const std::string& folder) {
  Json json;
  json["adopted"] = trial.adopted;
  json["verdict"] = trial.verdict;
  json["stayed"] = trial.stayed;
  for (const auto& [name, value] : trial.figures) json["figures"][name] = value ? Json(*value) : Json();
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return write_text(folder + kResultFile, json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<MeasuredTrial> read_trial(const std::string& folder) {
  const auto text = read_text(folder + kResultFile);
  if (!text) return Error{ErrorCode::kIo, text.error().message};
  try {
    const Json json = Json::parse(*text);
    MeasuredTrial trial;
    trial.adopted = json.at("adopted").get<bool>();
    trial.verdict = json.at("verdict").get<std::string>();
    trial.stayed = json.at("stayed").get<std::string>();
    for (const auto& [name, value] : json.at("figures").items()) {
      trial.figures[name] = value.is_null() ? std::nullopt : std::optional(value.get<double>());
    }
    return trial;
  } catch (const Json::exception& error) {
    return Error{ErrorCode::kIo, fmt::format("{}: a result in it can't be read: {}", folder, error.what())};
  }
}

Result<std::string> key_of(const RenderedDrive& drive, const CalibrationTrial& trial, const RunSettings& settings,
                           const std::string& program) {
  const auto digest = file_digest(program);
  if (!digest) return digest.error();
  return fmt::format("{}, program {}\ncalibration from {}; frames {}; lengths {}\n{}\n{}", program_version(), *digest,
                     in_words(trial.start), trial.frames, trial.lengths, shell_line(settings.assignments), drive.key);
}

}  // namespace

std::string in_words(const CalibrationStart& start) {
  std::string text;
  const auto add = [&text](const std::string& word) { text += (text.empty() ? "" : ", ") + word; };
  if (start.radial != 0.0) add(fmt::format("k1 {:+.3g}", start.radial));
  if (start.row_px != 0.0) add(fmt::format("cy {:+g} px", start.row_px));
  switch (start.known) {
    case FocalKnowledge::kGiven:
    case FocalKnowledge::kWithSd:
      if (start.focal != 0.0) add(fmt::format("f {:+g} %", kPercent * start.focal));
      if (start.known == FocalKnowledge::kWithSd) add("f freed");
      break;
    case FocalKnowledge::kView:
      add(start.focal == 0.0 ? std::string("--fov") : fmt::format("--fov with f {:+g} %", kPercent * start.focal));
      break;
    case FocalKnowledge::kNothing:
      add("nothing known");
      break;
  }
  return text.empty() ? "the truth" : text;
}

Result<CameraSetup> start_setup(const CameraSetup& truth, const CalibrationStart& start) {
  CameraSetup setup;
  setup.height_m = truth.height_m;
  const Camera& camera = *truth.camera;
  const double focal_px = camera.focal_px() * (1.0 + start.focal);
  if (start.known == FocalKnowledge::kView || start.known == FocalKnowledge::kNothing) {
    auto plain = plain_pinhole(focal_px, camera);
    if (!plain) return plain.error();
    setup.camera = *plain;
    return setup;
  }
  setup.camera = truth.camera;
  for (const auto& [parameter, value] :
       {std::pair(CameraParameter::kFocal, focal_px),
        std::pair(CameraParameter::kRow, value_of(CameraParameter::kRow, camera) + start.row_px),
        std::pair(CameraParameter::kRadial, value_of(CameraParameter::kRadial, camera) + start.radial)}) {
    auto moved = with_value(parameter, value, *setup.camera);
    if (!moved) return moved.error();
    setup.camera = *moved;
  }
  if (start.known == FocalKnowledge::kWithSd) setup.parameter_sds[CameraParameter::kFocal] = kFocalSd * focal_px;
  return setup;
}

std::optional<double> MeasuredTrial::figure(const std::string& name) const {
  const auto found = figures.find(name);
  return found == figures.end() ? std::nullopt : found->second;
}

Result<MeasuredTrial> measure_trial(const RenderedDrive& drive, const CalibrationTrial& trial,
                                    const RunSettings& settings, const std::string& folder,
                                    const ExperimentRequest& request) {
  const auto key = key_of(drive, trial, settings, request.program);
  if (!key) return key.error();
  const auto done = WorkUnit(folder, *key).complete(request.force, [&]() -> Result<void> {
    request.say(fmt::format("{}: calibrating from {}", drive.name, in_words(trial.start)));
    const auto bench = make_bench(drive, trial, settings);
    if (!bench) return bench.error();
    const auto measured = calibrate_known(*bench, trial);
    return measured ? write_trial(*measured, folder) : Result<void>(measured.error());
  });
  if (!done) return done.error();
  auto measured = read_trial(folder);
  if (!measured) return measured;
  measured->drive = drive.name;
  measured->start = trial.start;
  return measured;
}

}  // namespace groundscale
