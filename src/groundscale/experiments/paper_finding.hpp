#pragma once

#include <optional>
#include <string>
#include <vector>

namespace groundscale {

/// Something that a paper found, and whether an experiment finds it too.
struct PaperFinding {
  std::string what;
  std::optional<bool> reproduced;  ///< Empty where there is nothing to measure.
  std::string measured;            ///< What says so.
};

/// "reproduced: what: measured", or "not reproduced: ...", "not measured: ...".
std::string in_words(const PaperFinding& finding);
/// A line each, as a list of Markdown.
std::string in_words(const std::vector<PaperFinding>& findings);

}  // namespace groundscale
