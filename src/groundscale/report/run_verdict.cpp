#include "groundscale/report/run_verdict.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "groundscale/estimation/robust.hpp"

namespace groundscale {
namespace {

// The rules of docs/report.md.
constexpr double kMuchLost = 0.1;  // of all frames
constexpr double kCovered = 0.5;   // of the moving frames
constexpr double kLongGapM = 200.0;
constexpr double kGoodSd = 0.02;  // of a step
constexpr double kPoorSd = 0.05;
constexpr double kLargeCorrection = 0.1;
constexpr double kGoodTRel = 0.02;
constexpr double kPoorTRel = 0.05;
constexpr double kGoodBias = 0.02;
constexpr double kBadBias = 0.1;
constexpr double kHonest = 0.8;  // within two standard deviations; 95 % are expected

std::string plural(int count, const std::string& noun) {
  return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

Finding scale_finding(const RunFolder& run) {
  if (!run.summary.first_scaled_frame) {
    return {Grade::kBad, "The road was never measured: the trajectory has no scale."};
  }
  const double share = run.summary.accepted / std::max(1.0, static_cast<double>(run.summary.moving));
  const double gap_m = longest_gap_m(run);
  const bool good = share >= kCovered && gap_m <= kLongGapM;
  return {
      good ? Grade::kGood : Grade::kReservation,
      fmt::format("The road was measured in {} of {} moving frames ({:.0f} %); the longest way without is {:.0f} m.",
                  run.summary.accepted, run.summary.moving, 100.0 * share, gap_m)};
}

std::optional<Finding> lost_finding(const RunSummary& summary) {
  if (summary.lost == 0 && summary.bridged == 0) return std::nullopt;
  const bool much = summary.lost > kMuchLost * summary.frames;
  const Grade grade = much ? Grade::kBad : summary.lost > 0 ? Grade::kReservation : Grade::kNote;
  const std::string lost =
      summary.lost > 0 ? plural(summary.lost, "frame") + " lost, straight on at constant speed" : "";
  const std::string bridged = summary.bridged > 0 ? plural(summary.bridged, "frame") + " bridged" : "";
  return Finding{grade, lost + (lost.empty() || bridged.empty() ? "" : "; ") + bridged + "."};
}

std::optional<Finding> sd_finding(const RunFolder& run) {
  const auto sd = median_relative_sd(run);
  if (!sd) return std::nullopt;
  return Finding{*sd <= kGoodSd   ? Grade::kGood
                 : *sd <= kPoorSd ? Grade::kNote
                                  : Grade::kReservation,
                 fmt::format("By its own account a step is known to {:.1f} % (one sd, median; the camera's height "
                             "taken as exact).",
                             100.0 * *sd)};
}

std::optional<Finding> slope_finding(const RunSummary& summary) {
  if (!summary.slope) return std::nullopt;
  const std::string verdict = calibration_verdict(*summary.slope);
  const Grade grade = verdict.starts_with("no sign")         ? Grade::kGood
                      : verdict.starts_with("too uncertain") ? Grade::kNote
                                                             : Grade::kReservation;
  return Finding{grade,
                 fmt::format("Against the road the map's scale drifts by {:+.1f} \u00b1 {:.1f} % per 100 m before "
                             "correction: {}.",
                             100.0 * summary.slope->per_100m, 100.0 * summary.slope->sd_per_100m, verdict)};
}

std::optional<Finding> corrections_finding(const RunSummary& summary) {
  if (summary.corrections.empty()) return std::nullopt;
  double largest = 0.0;
  for (const ScaleEvent& event : summary.corrections) largest = std::max(largest, std::abs(event.lambda - 1.0));
  return Finding{largest > kLargeCorrection ? Grade::kReservation : Grade::kNote,
                 fmt::format("The map was scaled {}, by up to {:.1f} %.",
                             plural(static_cast<int>(summary.corrections.size()), "time"), 100.0 * largest)};
}

void add_truth_findings(const Evaluation& evaluation, std::vector<Finding>& findings) {
  if (const auto& all = evaluation.path.kitti.all) {
    findings.push_back({all->t_rel <= kGoodTRel   ? Grade::kGood
                        : all->t_rel <= kPoorTRel ? Grade::kNote
                                                  : Grade::kReservation,
                        fmt::format("Against the truth: t_rel {:.2f} % over {}.", 100.0 * all->t_rel,
                                    plural(all->segments, "segment"))});
  }
  if (const auto& all = evaluation.scale.all) {
    const double bias = std::abs(all->bias);
    findings.push_back({bias <= kGoodBias  ? Grade::kGood
                        : bias <= kBadBias ? Grade::kReservation
                                           : Grade::kBad,
                        fmt::format("Against the truth: steps are {:+.2f} % off in the median.", 100.0 * all->bias)});
  }
  if (!evaluation.coverage) return;
  const Share& within = evaluation.coverage->online_within_2_sd.all;
  if (within.of == 0) return;
  const bool honest = within.value() >= kHonest;
  findings.push_back({honest ? Grade::kGood : Grade::kReservation,
                      fmt::format("{:.0f} % of the online steps lie within two standard deviations of the truth{}.",
                                  100.0 * within.value(), honest ? "" : ", 95 % should: they are stated too small")});
}

std::string headline(const RunVerdict& verdict) {
  const auto worst = std::find_if(verdict.findings.begin(), verdict.findings.end(),
                                  [&](const Finding& finding) { return finding.grade == verdict.grade; });
  switch (verdict.grade) {
    case Grade::kGood:
    case Grade::kNote:
      return "Nothing speaks against this run.";
    case Grade::kReservation: {
      const auto reservations = std::count_if(verdict.findings.begin(), verdict.findings.end(),
                                              [](const Finding& f) { return f.grade == Grade::kReservation; });
      return fmt::format("To be used with {}. {}", plural(static_cast<int>(reservations), "reservation"), worst->words);
    }
    case Grade::kBad:
      return "Not to be relied upon. " + worst->words;
  }
  return "";
}

}  // namespace

Finding height_finding(const RunSummary& summary) {
  return {Grade::kNote, fmt::format("All lengths rest on a camera height of {:.3f} m (from {}): 1 cm more makes them "
                                    "{:.2f} % longer.",
                                    summary.camera_height_m, summary.camera_height_from,
                                    1.0 / std::max(1e-9, summary.camera_height_m))};
}

double longest_gap_m(const RunFolder& run) {
  const std::vector<double> distances_m = run.distances_m();
  double longest_m = 0.0;
  std::optional<double> last_m;
  for (std::size_t k = 0; k < run.frames.size(); ++k) {
    if (last_m) longest_m = std::max(longest_m, distances_m[k] - *last_m);
    if (run.frames[k].accepted()) last_m = distances_m[k];
  }
  return longest_m;
}

std::optional<double> median_relative_sd(const RunFolder& run) {
  std::vector<double> sds;
  for (const FrameRow& row : run.frames) {
    if (row.state != "moving" || !row.online_step_sd_m || !row.online_step_m || !(*row.online_step_m > 0.0)) continue;
    sds.push_back(*row.online_step_sd_m / *row.online_step_m);
  }
  return sds.empty() ? std::nullopt : std::optional(median(std::move(sds)));
}

RunVerdict verdict_of(const RunFolder& run) {
  RunVerdict verdict;
  const auto add = [&verdict](const std::optional<Finding>& finding) {
    if (finding) verdict.findings.push_back(*finding);
  };
  add(scale_finding(run));
  add(lost_finding(run.summary));
  add(sd_finding(run));
  if (run.compared) add_truth_findings(run.compared->evaluation, verdict.findings);
  if (!run.truth_problem.empty()) {
    add(Finding{Grade::kNote, "Not compared with the truth: " + run.truth_problem + "."});
  }
  add(slope_finding(run.summary));
  add(corrections_finding(run.summary));
  add(height_finding(run.summary));
  if (!run.summary.warnings.empty()) {
    add(Finding{Grade::kReservation, fmt::format("The run gave {}, see below.",
                                                 plural(static_cast<int>(run.summary.warnings.size()), "warning"))});
  }
  for (const Finding& finding : verdict.findings) verdict.grade = std::max(verdict.grade, finding.grade);
  verdict.words = headline(verdict);
  return verdict;
}

}  // namespace groundscale
