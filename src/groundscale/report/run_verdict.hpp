#pragma once

#include <string>
#include <vector>

#include "groundscale/report/run_folder.hpp"

namespace groundscale {

/// How much one should rely on what a finding is about.
enum class Grade { kGood, kNote, kReservation, kBad };

/// One thing that is to be said of a run.
struct Finding {
  Grade grade = Grade::kNote;
  std::string words;
};

/// What a run is worth, by the rules of docs/report.md.
struct RunVerdict {
  Grade grade = Grade::kGood;  ///< The worst of its findings.
  std::string words;           ///< In one or two sentences.
  std::vector<Finding> findings;
};

RunVerdict verdict_of(const RunFolder& run);

/// What all lengths rest on.
Finding height_finding(const RunSummary& summary);

/// The longest way without an accepted measurement of the road, from the first one on; 0 where there is none.
double longest_gap_m(const RunFolder& run);

/// Median of sd of the online step over the step, over moving frames that have one.
std::optional<double> median_relative_sd(const RunFolder& run);

}  // namespace groundscale
