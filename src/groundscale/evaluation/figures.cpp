#include "groundscale/evaluation/figures.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace groundscale {
namespace {

constexpr double kPercent = 100.0;
constexpr double kDegPerRad = 180.0 / std::numbers::pi;
constexpr double kPercentPer100m = 100.0 * 100.0;

std::vector<Figure> errors_of_part(const std::string& prefix, const std::string& suffix,
                                   const std::optional<ScaleErrors>& errors, bool raw) {
  const auto figure = [&](const char* name, double ScaleErrors::*member, int decimals, bool sign, std::string meaning) {
    const std::optional<double> value = errors ? std::optional(kPercent * ((*errors).*member)) : std::nullopt;
    return Figure{prefix + name + suffix, value, "%", decimals, sign, errors ? errors->steps : 0, "steps",
                  std::move(meaning)};
  };
  std::vector<Figure> figures{
      figure("scale_bias", &ScaleErrors::bias, 3, true, "median step ratio - 1"),
      figure("scale_spread", &ScaleErrors::spread, 3, false, "median |ratio / median - 1|"),
      figure("within_10_percent", &ScaleErrors::within_10_percent, 2, false,
             "share of steps within 10 % of the median"),
      figure("scale_error_mean", &ScaleErrors::mean, 3, false, "mean |ratio - 1|"),
      figure(raw ? "p95" : "scale_error_p95", &ScaleErrors::p95, 3, false, "95th percentile of |ratio - 1|"),
  };
  if (raw) figures.push_back(figure("rms", &ScaleErrors::rms_log, 3, false, "rms of log(ratio)"));
  return figures;
}

void append(std::vector<Figure>& figures, std::vector<Figure> more) {
  for (Figure& figure : more) figures.push_back(std::move(figure));
}

std::vector<Figure> scale_figure_list(const std::string& prefix, const ScaleFigures& scale) {
  const bool raw = prefix == "raw_";
  std::vector<Figure> figures = errors_of_part(prefix, "", scale.all, raw);
  append(figures, errors_of_part(prefix, "_straight", scale.straight, raw));
  append(figures, errors_of_part(prefix, "_turn", scale.turn, raw));
  Figure drift{prefix + "scale_drift",
               std::nullopt,
               "% per 100 m",
               3,
               true,
               0,
               "steps",
               "slope of log(ratio) over the true distance, from 5 m on"};
  if (scale.drift) {
    drift.value = kPercentPer100m * scale.drift->log_per_m;
    drift.count = scale.drift->steps;
  }
  figures.push_back(drift);
  return figures;
}

/// t_rel and r_rel, `suffix` for one length.
std::vector<Figure> segment_figures(const std::string& prefix, const std::string& suffix,
                                    const std::optional<SegmentErrors>& errors, const std::string& meaning) {
  Figure t_rel{prefix + "t_rel" + suffix, std::nullopt, "%", 4, false, 0, "segments", meaning};
  Figure r_rel{prefix + "r_rel" + suffix, std::nullopt, "deg/100 m", 4, false, 0, "segments", meaning};
  if (errors) {
    t_rel.value = kPercent * errors->t_rel;
    r_rel.value = kPercent * kDegPerRad * errors->r_rel_rad_per_m;
    t_rel.count = r_rel.count = errors->segments;
  }
  return {t_rel, r_rel};
}

std::vector<Figure> path_figure_list(const std::string& prefix, const PathFigures& path, int rows) {
  const std::string lengths = fmt::format("{:.2f} m of {:.2f} m", path.estimated_m, path.true_m);
  std::vector<Figure> figures{
      {prefix + "length_ratio", path.estimated_m / path.true_m, "", 5, false, path.rotations, "steps", lengths},
      {prefix + "rotation_error", kDegPerRad * path.rotation_error_rad, "deg/frame", 4, false, path.rotations, "steps",
       "median"}};
  append(figures, segment_figures(prefix, "", path.kitti.all,
                                  path.kitti.all ? "KITTI devkit, no alignment" : "path too short: --lengths"));
  for (const KittiErrors::OfLength& length : path.kitti.by_length) {
    if (length.errors)
      append(figures, segment_figures(prefix, fmt::format("_{:g}m", length.length_m), length.errors, ""));
  }
  const auto absolute = [&](const char* name, double AbsoluteErrors::*member, const char* unit, int decimals,
                            const char* meaning) {
    const std::optional<double> value = path.absolute ? std::optional((*path.absolute).*member) : std::nullopt;
    figures.push_back({prefix + name, value, unit, decimals, false, path.absolute ? path.absolute->rows : rows, "poses",
                       path.absolute ? meaning : "nothing to align"});
  };
  absolute("ate_se3", &AbsoluteErrors::ate_se3_m, "m", 3, "rms, aligned by rotation and translation");
  absolute("ate_sim3", &AbsoluteErrors::ate_sim3_m, "m", 3, "rms, scale aligned as well");
  absolute("sim3_scale", &AbsoluteErrors::sim3_scale, "", 5, "its scale: above 1 the estimate is too short");
  return figures;
}

Figure share_figure(const char* name, const Share& share, const char* of, const char* meaning) {
  const std::optional<double> value = share.of > 0 ? std::optional(kPercent * share.value()) : std::nullopt;
  return {name, value, "%", 2, false, share.of, of, meaning};
}

std::vector<Figure> coverage_figures(const Coverage& coverage) {
  const auto whole = [](const std::optional<int>& value) {
    return value ? std::optional(static_cast<double>(*value)) : std::nullopt;
  };
  const int steps = coverage.accepted.of;
  return {share_figure("coverage", coverage.accepted, "steps", "with an accepted raw measurement"),
          share_figure("coverage_filtered", coverage.filtered, "steps", "with a filtered value"),
          share_figure("coverage_filtered_after_first", coverage.filtered_after_first, "steps",
                       "the same from the first accepted frame on"),
          {"first_accepted_frame", whole(coverage.first_accepted_frame), "", 0, false, steps, "steps",
           coverage.first_accepted_frame ? "frame number" : "no measurement was accepted"},
          {"moving_steps_before_first", whole(coverage.moving_steps_before_first), "", 0, false, steps, "steps",
           "moving steps before that frame"},
          share_figure("within_2_sd", coverage.within_2_sd.all, "steps", "|step error| <= 2 step_sd_m"),
          share_figure("within_2_sd_straight", coverage.within_2_sd.straight, "steps", "the same on straights"),
          share_figure("within_2_sd_turn", coverage.within_2_sd.turn, "steps", "and in turns"),
          share_figure("online_within_2_sd", coverage.online_within_2_sd.all, "steps",
                       "|online step error| <= 2 online_step_sd_m"),
          share_figure("online_within_2_sd_straight", coverage.online_within_2_sd.straight, "steps",
                       "the same on straights"),
          share_figure("online_within_2_sd_turn", coverage.online_within_2_sd.turn, "steps", "and in turns"),
          share_figure("raw_within_2_sd", coverage.raw_within_2_sd, "steps", "|raw error| <= 2 raw_step_sd_m")};
}

std::string rule_for_moving(const PairedDrive& drive, const StepRules& rules) {
  return drive.truth.has_times()
             ? fmt::format("true speed above {} m/s, times from {}", rules.min_speed_mps, drive.times_from)
             : fmt::format("true step above {} m, no times", rules.min_step_m);
}

std::string rule_for_turns(const PairedDrive& drive, const StepRules& rules) {
  const std::string limit = drive.truth.has_times() ? fmt::format("{} deg/s", rules.min_turn_rate_degps)
                                                    : fmt::format("{} deg a step", rules.min_turn_step_deg);
  return fmt::format("true yaw rate of at least {}, mean of {} steps", limit, rules.turn_window);
}

/// Not so for an empty value and for what overflows or has a logarithm of 0 in it.
bool is_number(const Figure& figure) { return figure.value && std::isfinite(*figure.value); }

std::string figure_line(const Figure& figure) {
  std::string value = "-";
  if (is_number(figure)) {
    value = figure.sign ? fmt::format("{:+.{}f}", *figure.value, figure.decimals)
                        : fmt::format("{:.{}f}", *figure.value, figure.decimals);
  }
  std::string line = fmt::format("  {:<33} {:>10} {:<11} {:>6} {:<8}  {}", figure.name, value, figure.unit,
                                 figure.count, figure.of, figure.meaning);
  line.erase(line.find_last_not_of(' ') + 1);
  return line + "\n";
}

}  // namespace

std::vector<FigureGroup> figures_of(const Evaluation& evaluation) {
  std::vector<FigureGroup> groups{{"final scale", scale_figure_list("", evaluation.scale)},
                                  {"final path", path_figure_list("", evaluation.path, evaluation.rows)}};
  if (evaluation.online_scale)
    groups.push_back({"online scale", scale_figure_list("online_", *evaluation.online_scale)});
  if (evaluation.online_path) {
    groups.push_back({"online path", path_figure_list("online_", *evaluation.online_path, evaluation.rows)});
  }
  if (evaluation.raw_scale) {
    groups.push_back({"accepted raw measurements", scale_figure_list("raw_", *evaluation.raw_scale)});
  }
  if (evaluation.coverage) groups.push_back({"coverage", coverage_figures(*evaluation.coverage)});
  // Without a run's folder nothing says how the rows came about.
  if (!evaluation.coverage) {
    groups[0].title = "scale";
    groups[1].title = "path";
  }
  return groups;
}

std::string evaluation_table(const PairingRequest& request, const PairedDrive& drive, const Evaluation& evaluation,
                             const StepRules& rules) {
  std::string text = fmt::format("estimate  {}: {} rows{}\n", request.estimate, evaluation.rows,
                                 request.skip > 0 ? fmt::format(", the first {} skipped", request.skip) : "");
  text += fmt::format("truth     {}: rows {} to {} of {}{}\n", request.truth, drive.truth_rows.front(),
                      drive.truth_rows.back(), drive.rows_of_truth,
                      drive.max_time_difference_s
                          ? fmt::format(", matched by time, at most {:.4f} s apart", *drive.max_time_difference_s)
                          : "");
  text += fmt::format("moving    {} of {} steps: {}\n", evaluation.moving_steps, evaluation.rows - 1,
                      rule_for_moving(drive, rules));
  text += fmt::format("turns     {} of the moving steps: {}\n", evaluation.turn_steps, rule_for_turns(drive, rules));
  for (const FigureGroup& group : figures_of(evaluation)) {
    text += fmt::format("\n{}\n", group.title);
    for (const Figure& figure : group.figures) text += figure_line(figure);
  }
  return text;
}

std::string evaluation_json(const PairingRequest& request, const PairedDrive& drive, const Evaluation& evaluation,
                            const StepRules& rules) {
  using Json = nlohmann::ordered_json;
  Json json;
  json["estimate"] = {{"path", request.estimate}, {"rows", evaluation.rows}, {"skip", request.skip}};
  json["truth"] = {{"path", request.truth},
                   {"first_row", drive.truth_rows.front()},
                   {"last_row", drive.truth_rows.back()},
                   {"rows", drive.rows_of_truth}};
  if (drive.max_time_difference_s) json["truth"]["max_time_difference_s"] = *drive.max_time_difference_s;
  json["moving"] = {
      {"steps", evaluation.moving_steps}, {"of", evaluation.rows - 1}, {"rule", rule_for_moving(drive, rules)}};
  json["turns"] = {
      {"steps", evaluation.turn_steps}, {"of", evaluation.moving_steps}, {"rule", rule_for_turns(drive, rules)}};
  Json& figures = json["figures"];
  for (const FigureGroup& group : figures_of(evaluation)) {
    for (const Figure& figure : group.figures) {
      figures[figure.name] = {{"value", is_number(figure) ? Json(*figure.value) : Json(nullptr)},
                              {"unit", figure.unit},
                              {"count", figure.count},
                              {"of", figure.of}};
    }
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace groundscale
