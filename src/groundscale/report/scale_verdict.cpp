#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "groundscale/report/scale_report.hpp"

namespace groundscale {
namespace {

// The rules of docs/report.md.
constexpr double kCovered = 0.5;  // of the moving frames
constexpr double kGoodBias = 0.02;
constexpr double kBadBias = 0.1;

double coverage_of(const MethodRun& method) {
  const RunSummary& s = method.run.summary;
  return s.moving > 0 ? static_cast<double>(s.accepted) / s.moving : 0.0;
}

/// Of its filtered steps; nothing where there are none, or nothing to compare with.
std::optional<ScaleErrors> errors_of(const MethodRun& method) {
  const ComparedRun* compared = method.compared();
  if (compared == nullptr || !compared->evaluation.online_scale) return std::nullopt;
  return compared->evaluation.online_scale->all;
}

std::string words_of(const ScaleErrors& errors) {
  return fmt::format("bias {:+.1f} %, 95 % within {:.1f} %", 100.0 * errors.bias, 100.0 * errors.p95);
}

Grade grade_of(double bias) {
  if (std::abs(bias) <= kGoodBias) return Grade::kGood;
  return std::abs(bias) <= kBadBias ? Grade::kReservation : Grade::kBad;
}

Finding finding_of(const MethodRun& method, bool is_reference) {
  const RunSummary& s = method.run.summary;
  if (!s.first_scaled_frame) return {Grade::kBad, method.name() + ": the road was never measured."};
  Finding finding{coverage_of(method) >= kCovered ? Grade::kGood : Grade::kReservation,
                  fmt::format("{}: measured in {} of {} moving frames ({:.0f} %)", method.name(), s.accepted, s.moving,
                              100.0 * coverage_of(method))};
  if (const auto errors = errors_of(method); errors && !is_reference) {
    finding.grade = std::max(finding.grade, grade_of(errors->bias));
    finding.words += "; filtered steps: " + words_of(*errors);
  }
  finding.words += ".";
  return finding;
}

/// The one with the least error among those that measure often enough.
const MethodRun* nearest_of(const MethodsReport& report) {
  const MethodRun* nearest = nullptr;
  for (const MethodRun& method : report.methods) {
    if (!errors_of(method) || coverage_of(method) < kCovered) continue;
    if (nearest == nullptr || errors_of(method)->p95 < errors_of(*nearest)->p95) nearest = &method;
  }
  return nearest;
}

void judge_by_truth(const MethodsReport& report, RunVerdict& verdict) {
  const MethodRun* nearest = nearest_of(report);
  if (nearest == nullptr) {
    verdict.grade = Grade::kBad;
    verdict.words = "No method measured the road in half of the moving frames.";
    return;
  }
  const ScaleErrors errors = *errors_of(*nearest);
  verdict.grade = grade_of(errors.bias);
  verdict.words = report.methods.size() == 1
                      ? fmt::format("Against the truth: {}.", words_of(errors))
                      : fmt::format("Nearest to the truth: {} ({}).", nearest->name(), words_of(errors));
}

void judge_by_first(const MethodsReport& report, RunVerdict& verdict) {
  const MethodRun* farthest = nullptr;
  for (const MethodRun& method : report.methods) {
    if (!errors_of(method)) continue;
    if (farthest == nullptr || std::abs(errors_of(method)->bias) > std::abs(errors_of(*farthest)->bias)) {
      farthest = &method;
    }
  }
  if (farthest == nullptr) {
    verdict.grade = Grade::kBad;
    verdict.words = report.methods.front().name() + " never measured the road: there is nothing to compare with.";
    return;
  }
  verdict.grade = std::min(grade_of(errors_of(*farthest)->bias), Grade::kReservation);
  verdict.words = "There is no truth: which method is right can't be said.";
  if (report.methods.size() > 1) {
    verdict.words += fmt::format(" In the median their filtered steps lie within {:.1f} % of those of {}.",
                                 100.0 * std::abs(errors_of(*farthest)->bias), report.methods.front().name());
  }
}

}  // namespace

RunVerdict verdict_of(const MethodsReport& report) {
  RunVerdict verdict;
  if (report.by_truth()) {
    judge_by_truth(report, verdict);
  } else {
    judge_by_first(report, verdict);
  }
  for (const MethodRun& method : report.methods) {
    const bool is_reference = !report.by_truth() && &method == &report.methods.front();
    verdict.findings.push_back(finding_of(method, is_reference));
  }
  verdict.findings.push_back(height_finding(report.matcher.summary));
  return verdict;
}

}  // namespace groundscale
