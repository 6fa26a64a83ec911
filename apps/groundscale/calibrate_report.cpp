#include "calibrate_report.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>
#include <string_view>

#include <fmt/format.h>

#include "groundscale/camera/parameters.hpp"
#include "groundscale/io/camera_file.hpp"

namespace groundscale {
namespace {

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

/// As exact as its error is known: the sd with two digits.
std::string number(double value, double sd) {
  constexpr int kMostDecimals = 12;
  const int decimals = sd > 0.0 ? 1 - static_cast<int>(std::floor(std::log10(sd))) : kMostDecimals;
  return fmt::format("{:.{}f}", value, std::clamp(decimals, 0, kMostDecimals));
}

std::string with_sd(double value, double sd) { return number(value, sd) + " +- " + number(sd, sd); }

std::string slope_text(const ScaleSlope& slope) {
  return fmt::format("{:+.1f} +- {:.1f} % per 100 m", 100.0 * slope.per_100m, 100.0 * slope.sd_per_100m);
}

std::string mounting_text(const CameraSetup& setup) {
  return fmt::format("pitch {:.2f}, roll {:.2f}, yaw {:.2f} degrees, from straight stretches",
                     kDegPerRad * setup.pitch_rad.value_or(0.0), kDegPerRad * setup.roll_rad.value_or(0.0),
                     kDegPerRad * setup.yaw_rad.value_or(0.0));
}

bool same_mounting(const CameraSetup& a, const CameraSetup& b) {
  return a.pitch_rad == b.pitch_rad && a.roll_rad == b.roll_rad && a.yaw_rad == b.yaw_rad;
}

std::string unit_of(CameraParameter parameter, const Camera& camera) {
  if (parameter != CameraParameter::kRadial) return "px";
  return camera.model() == "ocam" ? "1/px" : "";
}

}  // namespace

std::string CalibrationWords::height_text() const {
  if (!plan_.camera.setup.height_m) return fmt::format("{:g} m (assumed)", kAssumedHeightM);
  return fmt::format("{:g} m ({})", *plan_.camera.setup.height_m, plan_.camera.height_from);
}

std::vector<CalibrationReport::Fact> CalibrationWords::origins() const {
  std::vector<Fact> facts = {{"start", plan_.camera.camera_from}};
  if (plan_.camera.setup.height_m) {
    facts.push_back({"camera height", height_text() + ", as given: groundscale height finds it, drives alone can't"});
  } else {
    facts.push_back({"camera height",
                     fmt::format("not known ({:g} m were assumed): groundscale height finds it", kAssumedHeightM)});
  }
  for (const CalibrationPlan::Drive& drive : plan_.drives) {
    facts.push_back({"drive", fmt::format("{}, frames {} to {}", drive.source, drive.first_frame,
                                          drive.first_frame + drive.frames - 1)});
  }
  facts.push_back({"seen", fmt::format("{} frames, {:.0f} m, {:.0f} degrees of turning", calibration_.frames,
                                       calibration_.length_m, calibration_.turned_deg)});
  return facts;
}

std::vector<CalibrationReport::Fact> CalibrationWords::parameters() const {
  std::vector<Fact> facts;
  for (const CalibratedParameter& parameter : calibration_.parameters) {
    const std::string name(file_name_of(parameter.parameter, *calibration_.setup.camera));
    if (!parameter.reason.empty()) {
      facts.push_back({name, fmt::format("{:.6g}, stays: {}", parameter.before, parameter.reason)});
      continue;
    }
    std::string text = number(parameter.before, parameter.sd) + " -> " + with_sd(parameter.after, parameter.sd);
    if (!calibration_.adopted) text += ", not taken over";
    facts.push_back({name, text});
  }
  return facts;
}

std::vector<CalibrationReport::Fact> CalibrationWords::evidence() const {
  std::vector<Fact> facts;
  const ParameterEstimate& tracks = calibration_.radial_by_tracks;
  if (tracks.sd > 0.0) {
    const auto& slope = calibration_.radial_by_slope;
    const std::string name(file_name_of(CameraParameter::kRadial, *calibration_.setup.camera));
    facts.push_back({name + " in two ways",
                     fmt::format("{} by the tracks, {} by the drift of the scale", with_sd(tracks.value, tracks.sd),
                                 slope ? with_sd(slope->value, slope->sd) : "nothing")});
  }
  if (calibration_.slope_before) {
    const std::string after = calibration_.slope_after ? ", " + slope_text(*calibration_.slope_after) + " after" : "";
    facts.push_back({"drift of the scale", slope_text(*calibration_.slope_before) + " before" + after});
  }
  if (calibration_.held_out.before_px > 0.0) {
    facts.push_back({"error of tracks", fmt::format("{:.3f} px before, {:.3f} px after, of those that took no part",
                                                    calibration_.held_out.before_px, calibration_.held_out.after_px)});
  }
  if (calibration_.adopted && !same_mounting(calibration_.setup, plan_.camera.setup)) {
    facts.push_back({"mounting", mounting_text(calibration_.setup)});
  }
  return facts;
}

std::string CalibrationWords::verdict() const {
  if (!calibration_.adopted) {
    if (plan_.focal_known) return calibration_.verdict + "; lengths don't change";
    return calibration_.verdict + "; it is a mere start, which nothing confirms: the focal length isn't known";
  }
  const std::string against = plan_.focal_known ? "the old calibration" : "the pinhole it began with";
  if (!calibration_.length_change) {
    return fmt::format("{}; by how much lengths change is not known, since the ground was seen too rarely",
                       calibration_.verdict);
  }
  const double change = *calibration_.length_change;
  return fmt::format("{}; at a camera height of {}, every length becomes {:.2f} % {} than with {}",
                     calibration_.verdict, height_text(), 100.0 * std::abs(change), change < 0.0 ? "shorter" : "longer",
                     against);
}

std::string text_of(const std::vector<CalibrationReport::Fact>& facts) {
  std::string text;
  for (const CalibrationReport::Fact& fact : facts) text += fmt::format("{:<20} {}\n", fact.label, fact.value);
  return text;
}

CalibrationReport calibration_report(const CalibrationPlan& plan, const Calibration& calibration,
                                     const std::string& output) {
  const CalibrationWords words(plan, calibration);
  CalibrationReport report;
  report.title = "Calibration of a camera: " + std::filesystem::path(output).filename().string();
  report.verdict = words.verdict();
  report.adopted = calibration.adopted;
  const Camera& camera = *calibration.setup.camera;
  for (const CalibratedParameter& parameter : calibration.parameters) {
    const bool only_found = !calibration.adopted && parameter.reason.empty();
    report.parameters.push_back({std::string(file_name_of(parameter.parameter, camera)),
                                 unit_of(parameter.parameter, camera), parameter.before, parameter.after, parameter.sd,
                                 only_found ? "found, but not taken over" : parameter.reason});
  }
  report.facts = {{"made by", "groundscale " GROUNDSCALE_VERSION}};
  for (const auto& facts : {words.origins(), words.evidence()}) {
    report.facts.insert(report.facts.end(), facts.begin(), facts.end());
  }
  report.residuals_before = calibration.held_out.residuals_before;
  report.residuals_after = calibration.held_out.residuals_after;
  const auto slope_of = [](const std::vector<std::optional<ScaleSlope>>& slopes, std::size_t drive) {
    return drive < slopes.size() ? slopes[drive] : std::nullopt;
  };
  for (std::size_t k = 0; k < plan.drives.size(); ++k) {
    report.drifts.push_back(
        {plan.drives[k].source, slope_of(calibration.slopes_before, k), slope_of(calibration.slopes_after, k)});
  }
  std::string mask_name;
  if (!calibration.setup.vehicle_mask.empty()) {
    mask_name = std::filesystem::path(vehicle_mask_path(output)).filename().string();
  }
  report.camera_before = camera_file_text(plan.camera.setup, mask_name);
  report.camera_after = camera_file_text(calibration.setup, mask_name);
  return report;
}

}  // namespace groundscale
