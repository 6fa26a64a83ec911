#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/evaluation/evaluate.hpp"

namespace groundscale {

/// One number of an evaluation, as it is printed: in percent, degrees, metres.
struct Figure {
  std::string name;
  std::optional<double> value;  ///< Empty where there is nothing to measure.
  std::string unit;
  int decimals = 3;
  bool sign = false;  ///< Printed with its sign.
  int count = 0;      ///< How many stand behind it.
  std::string of;     ///< Of what: "steps", "segments", "poses".
  std::string meaning;
};

/// Figures under one heading.
struct FigureGroup {
  std::string title;
  std::vector<Figure> figures;
};

/// All figures of an evaluation in the order in which they are printed; their names are those of docs/evaluation.md.
std::vector<FigureGroup> figures_of(const Evaluation& evaluation);

/// What was compared with what, and all figures, a line each.
std::string evaluation_table(const PairingRequest& request, const PairedDrive& drive, const Evaluation& evaluation,
                             const StepRules& rules = {});

/// The same as JSON with full precision: `figures.<name>` is {value, unit, count, of}; value is null where there is
/// nothing to measure. Same bytes for the same input.
std::string evaluation_json(const PairingRequest& request, const PairedDrive& drive, const Evaluation& evaluation,
                            const StepRules& rules = {});

}  // namespace groundscale
