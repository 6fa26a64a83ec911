#pragma once

#include <map>
#include <string>
#include <vector>

#include "groundscale/report/run_charts_internal.hpp"
#include "groundscale/report/run_folder.hpp"
#include "groundscale/report/run_verdict.hpp"

namespace groundscale::internal {

// Pieces that reports on one run and on several have in common.

std::string verdict_html(const RunVerdict& verdict);

/// How often there was no accepted measurement for reasons of one kind.
struct ReasonCount {
  std::string kind;
  int count = 0;
  int first_frame = 0;
};
/// The commonest first; of equals the one that came first.
std::vector<ReasonCount> reasons_of(const RunFolder& run);

/// The sample frames with what was measured in each; "" where there are none.
std::string samples_html(const RunFolder& run);

/// What was driven, with which camera, by which program.
std::string facts_html(const RunFolder& run);

/// The configuration: first what differs from the defaults.
std::string settings_html(const RunFolder& run);

/// How often each run had no accepted measurement, a row a kind of reason, a column a run or, of many, all in words; ""
/// where there are none.
std::string reasons_table(const std::vector<NamedRun>& runs);

/// That there are more runs than kinds of curves; "" where there are not.
std::string styles_note(std::size_t runs);

/// "0, image_0" and the like: the last part of a folder's name, made longer where others end alike.
std::vector<std::string> short_names(const std::vector<RunFolder>& runs);

}  // namespace groundscale::internal
