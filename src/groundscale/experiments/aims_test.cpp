#include "groundscale/experiments/aims.hpp"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

using testing::ElementsAre;

Contender contender(const std::string& label, double t_rel, double r_rel, int lost = 0) {
  Contender made{
      .label = label, .figures = {{"t_rel", t_rel}, {"r_rel", r_rel}}, .measures = {}, .run = {}, .remark = ""};
  made.run = MeasuredRun{};
  made.run->lost = lost;
  return made;
}

ContestedDrive drive(const std::string& name, std::vector<Contender> contenders) {
  return {.name = name,
          .drive = {.name = name, .folder = name},
          .truth = {},
          .contenders = std::move(contenders),
          .problems = {}};
}

std::vector<std::string> words(const std::vector<Aim>& aims) {
  std::vector<std::string> all;
  for (const Aim& aim : aims) all.push_back(in_words(aim));
  return all;
}

TEST(DriftAims, AreJudgedOnAverageAndOnTheWorstDrive) {
  const std::vector<ContestedDrive> drives = {
      drive("06", {contender("none", 5.0, 0.20), contender("filtered", 0.25, 0.2)}),
      drive("07", {contender("none", 4.0, 0.25), contender("filtered", 1.25, 0.3, 2)})};
  EXPECT_THAT(words(drift_aims(drives, "filtered")),
              ElementsAre("met: t_rel of `filtered` at most 1 % on average: 0.750 %, 2 drives",
                          "met: t_rel of `filtered` at most 2 % on each drive: 1.250 % on 07",
                          "met: r_rel of `filtered` at most 0.3 deg/100 m on average: 0.250 deg/100 m, 2 drives",
                          "not met: r_rel with and without correction apart by at most 0.02 deg/100 m on each drive: "
                          "0.050 deg/100 m on 07",
                          "not met: no frame of `filtered` lost: 2 on 2 drives"));
}

TEST(DriftAims, RealDrivesDoNotCount) {
  ContestedDrive real = drive("06", {contender("filtered", 9.0, 0.2)});
  real.drive.real = true;
  EXPECT_TRUE(drift_aims({real}, "filtered").empty());
}

TEST(DriftAims, WhatCanNotBeMeasuredIsNotMet) {
  ContestedDrive tiny = drive("06", {contender("filtered", 0.0, 0.0)});
  tiny.contenders.front().figures.clear();  // too short for a segment
  const auto aims = drift_aims({tiny}, "filtered");
  EXPECT_FALSE(aims.front().met.has_value());
  EXPECT_EQ(in_words(aims.front()), "nothing to measure: t_rel of `filtered` at most 1 % on average");
}

TEST(DistortionAims, WantACorrectionAndHalfTheError) {
  ContestedDrive bent = drive("00", {contender("none", 8.0, 0.2), contender("triggered", 4.5, 0.2)});
  EXPECT_THAT(words(distortion_aims({bent})),
              ElementsAre("nothing to measure: 00: `triggered` corrects at least once",
                          "not met: 00: `triggered` halves the t_rel of `none`: 4.500 % of 8.000 %"));
  bent.contenders.back().figures["t_rel"] = 3.5;
  bent.contenders.back().run->corrections = 2;
  EXPECT_THAT(words(distortion_aims({bent})),
              ElementsAre("met: 00: `triggered` corrects at least once: 2 times",
                          "met: 00: `triggered` halves the t_rel of `none`: 3.500 % of 8.000 %"));
}

TEST(CampusAims, EachRouteHasToDo) {
  const std::vector<ContestedDrive> routes = {drive("city", {contender("filtered", 1.0, 0.2)}),
                                              drive("hills", {contender("filtered", 3.5, 0.2)})};
  EXPECT_THAT(words(campus_aims(routes, "filtered")),
              ElementsAre("not met: t_rel of `filtered` at most 3 % on each drive: 3.500 % on hills"));
}

}  // namespace
}  // namespace groundscale
