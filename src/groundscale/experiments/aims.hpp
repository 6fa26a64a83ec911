#pragma once

#include <optional>
#include <string>
#include <vector>

#include "groundscale/experiments/contender.hpp"
#include "groundscale/experiments/rendered_drive.hpp"

namespace groundscale {

/// A drive with all trajectories of it.
struct ContestedDrive {
  std::string name;
  RenderedDrive drive;
  Trajectory truth;  ///< Begins at the identity.
  std::vector<Contender> contenders;
  std::vector<std::string> problems;  ///< What failed on it.

  const Contender* find(const std::string& label) const;
  /// Of a contender; empty where it isn't there.
  std::optional<double> figure(const std::string& label, const std::string& figure_name) const;
};

/// Something that is to be reached, and whether it is.
struct Aim {
  std::string what;
  std::optional<bool> met;  ///< Empty where there is nothing to measure.
  std::string measured;
};
/// "met: what: measured"
std::string in_words(const Aim& aim);

/// With scale correction, on simulated drives: t_rel at most 1 % on average and 2 % on each, r_rel at most 0.3 deg/100
/// m and no more than 0.02 from that without, no frame lost.
/// @param best  The mode that is judged. Real drives and other systems don't count.
std::vector<Aim> drift_aims(const std::vector<ContestedDrive>& drives, const std::string& best);
/// On drives with another distortion than the run believes in: `triggered` corrects, and halves t_rel of `none`.
std::vector<Aim> distortion_aims(const std::vector<ContestedDrive>& drives);
/// With a fisheye that looks to the side: t_rel at most 3 % on each drive.
std::vector<Aim> campus_aims(const std::vector<ContestedDrive>& drives, const std::string& best);

}  // namespace groundscale
