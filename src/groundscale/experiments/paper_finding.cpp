#include "groundscale/experiments/paper_finding.hpp"

#include <fmt/format.h>

namespace groundscale {

std::string in_words(const PaperFinding& finding) {
  const char* verdict = "not measured";
  if (finding.reproduced) verdict = *finding.reproduced ? "reproduced" : "not reproduced";
  return fmt::format("{}: {}: {}", verdict, finding.what, finding.measured);
}

std::string in_words(const std::vector<PaperFinding>& findings) {
  std::string text;
  for (const PaperFinding& finding : findings) text += fmt::format("- {}\n", in_words(finding));
  return text;
}

}  // namespace groundscale
