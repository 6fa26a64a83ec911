#include "groundscale/experiments/aims.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

namespace groundscale {
namespace {

constexpr double kMeanTRel = 1.0;
constexpr double kMaxTRel = 2.0;
constexpr double kMeanRRel = 0.3;
constexpr double kRRelDifference = 0.02;
constexpr double kCampusTRel = 3.0;

struct Named {
  std::string drive;
  double value = 0.0;
};

std::vector<Named> values_of(const std::vector<ContestedDrive>& drives, const std::string& label,
                             const std::string& figure) {
  std::vector<Named> values;
  for (const ContestedDrive& drive : drives) {
    if (const auto value = drive.figure(label, figure)) values.push_back({drive.name, *value});
  }
  return values;
}

Aim mean_at_most(const std::vector<Named>& values, double bound, const std::string& what, const std::string& unit) {
  Aim aim{.what = fmt::format("{} at most {} {} on average", what, bound, unit), .met = {}, .measured = ""};
  if (values.empty()) return aim;
  const double sum = std::accumulate(values.begin(), values.end(), 0.0,
                                     [](double total, const Named& value) { return total + value.value; });
  const double mean = sum / static_cast<double>(values.size());
  aim.met = mean <= bound;
  aim.measured = fmt::format("{:.3f} {}, {} drives", mean, unit, values.size());
  return aim;
}

Aim each_at_most(const std::vector<Named>& values, double bound, const std::string& what, const std::string& unit) {
  Aim aim{.what = fmt::format("{} at most {} {} on each drive", what, bound, unit), .met = {}, .measured = ""};
  if (values.empty()) return aim;
  const auto largest =
      std::max_element(values.begin(), values.end(), [](const Named& a, const Named& b) { return a.value < b.value; });
  aim.met = largest->value <= bound;
  aim.measured = fmt::format("{:.3f} {} on {}", largest->value, unit, largest->drive);
  return aim;
}

std::vector<Named> differences_of(const std::vector<ContestedDrive>& drives, const std::string& best) {
  std::vector<Named> differences;
  for (const ContestedDrive& drive : drives) {
    const auto with = drive.figure(best, "r_rel");
    const auto without = drive.figure("none", "r_rel");
    if (with && without) differences.push_back({drive.name, std::abs(*with - *without)});
  }
  return differences;
}

std::vector<ContestedDrive> simulated(std::vector<ContestedDrive> drives) {
  std::erase_if(drives, [](const ContestedDrive& drive) { return drive.drive.real; });
  return drives;
}

}  // namespace

const Contender* ContestedDrive::find(const std::string& label) const {
  const auto found = std::find_if(contenders.begin(), contenders.end(),
                                  [&label](const Contender& contender) { return contender.label == label; });
  return found == contenders.end() ? nullptr : &*found;
}

std::optional<double> ContestedDrive::figure(const std::string& label, const std::string& figure_name) const {
  const Contender* contender = find(label);
  return contender == nullptr ? std::nullopt : contender->figure(figure_name);
}

std::string in_words(const Aim& aim) {
  if (!aim.met) return "nothing to measure: " + aim.what;
  return fmt::format("{}: {}: {}", *aim.met ? "met" : "not met", aim.what, aim.measured);
}

std::vector<Aim> drift_aims(const std::vector<ContestedDrive>& drives, const std::string& best) {
  const std::vector<ContestedDrive> judged = simulated(drives);
  if (judged.empty()) return {};
  const auto t_rel = values_of(judged, best, "t_rel");
  std::vector<Aim> aims = {
      mean_at_most(t_rel, kMeanTRel, fmt::format("t_rel of `{}`", best), "%"),
      each_at_most(t_rel, kMaxTRel, fmt::format("t_rel of `{}`", best), "%"),
      mean_at_most(values_of(judged, best, "r_rel"), kMeanRRel, fmt::format("r_rel of `{}`", best), "deg/100 m"),
      each_at_most(differences_of(judged, best), kRRelDifference, "r_rel with and without correction apart by",
                   "deg/100 m")};
  int lost = 0, runs = 0;
  for (const ContestedDrive& drive : judged) {
    const Contender* contender = drive.find(best);
    if (contender == nullptr || !contender->run) continue;
    lost += contender->run->lost;
    ++runs;
  }
  aims.push_back({.what = fmt::format("no frame of `{}` lost", best),
                  .met = runs > 0 ? std::optional(lost == 0) : std::nullopt,
                  .measured = fmt::format("{} on {} drives", lost, runs)});
  return aims;
}

std::vector<Aim> distortion_aims(const std::vector<ContestedDrive>& drives) {
  std::vector<Aim> aims;
  for (const ContestedDrive& drive : drives) {
    const Contender* triggered = drive.find("triggered");
    Aim corrects{.what = fmt::format("{}: `triggered` corrects at least once", drive.name), .met = {}, .measured = ""};
    if (triggered != nullptr && triggered->run && triggered->run->corrections) {
      corrects.met = *triggered->run->corrections > 0;
      corrects.measured = fmt::format("{} times", *triggered->run->corrections);
    }
    Aim halves{
        .what = fmt::format("{}: `triggered` halves the t_rel of `none`", drive.name), .met = {}, .measured = ""};
    const auto with = drive.figure("triggered", "t_rel");
    const auto without = drive.figure("none", "t_rel");
    if (with && without) {
      halves.met = *with <= 0.5 * *without;
      halves.measured = fmt::format("{:.3f} % of {:.3f} %", *with, *without);
    }
    aims.insert(aims.end(), {corrects, halves});
  }
  return aims;
}

std::vector<Aim> campus_aims(const std::vector<ContestedDrive>& drives, const std::string& best) {
  return {each_at_most(values_of(drives, best, "t_rel"), kCampusTRel, fmt::format("t_rel of `{}`", best), "%")};
}

}  // namespace groundscale
