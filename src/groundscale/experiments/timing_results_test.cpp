#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/timing_results_internal.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale::internal {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TimedRow row(const std::string& name, bool method, double ms) {
  return {.name = name, .method = method, .ms = {0.5 * ms, ms, 4.0 * ms}, .refused = method ? 1 : 0};
}

Timings example() {
  return {{row("tracking", false, 10.0), row("motion", false, 4.0), row("road matching", false, 6.0),
           row("sparse", true, 2.0), row("triangulation", true, 1.0), row("decomposition", true, 1.5),
           row("dense", true, 24.0)}};
}

TEST(TimingTable, HasMediansRatiosAndWholeFrames) {
  const std::string csv = timing_table(example()).csv();
  EXPECT_THAT(csv, HasSubstr("tracking,before,3,,10,40,,\n"));
  EXPECT_THAT(csv, HasSubstr("dense,method,3,1,24,96,12,44\n"));  // 24 / 2; 10 + 4 + 6 + 24
}

TEST(TimingFindings, AreJudgedAloneAndWithAllThatComesBefore) {
  const std::string findings = in_words(timing_findings(example()));
  EXPECT_THAT(findings, HasSubstr("- reproduced: dense is slowest by far (the method alone): 12.00 times"));
  EXPECT_THAT(findings,
              HasSubstr("- reproduced: triangulation, decomposition and sparse take alike (the method alone): "
                        "slowest 2.00 times the fastest"));
  // (20 + 24) / (20 + 2) and (20 + 2) / (20 + 1)
  EXPECT_THAT(findings, HasSubstr("- not reproduced: dense is slowest by far (with tracking, motion and road "
                                  "matching): 2.00 times"));
  EXPECT_THAT(findings, HasSubstr("slowest 1.05 times the fastest"));
}

TEST(TimingFindings, AreNotMeasuredWithoutTheirMethods) {
  Timings timings = example();
  timings.rows.pop_back();
  const std::string findings = in_words(timing_findings(timings));
  EXPECT_THAT(findings, HasSubstr("- not measured: dense is slowest by far (the method alone)"));
  EXPECT_THAT(findings, HasSubstr("- reproduced: triangulation, decomposition and sparse take alike"));
}

TEST(TimingAims, AreMetUpToTheirLimits) {
  std::vector<std::string> words;
  for (const Aim& aim : timing_aims(example())) words.push_back(in_words(aim));
  EXPECT_THAT(words, testing::Each(HasSubstr("met: ")));
  EXPECT_THAT(words, testing::Not(testing::Contains(HasSubstr("not met"))));
  Timings slow = example();
  slow.rows[3] = row("sparse", true, 3.1);
  EXPECT_EQ(timing_aims(slow)[0].met, false);
}

TEST(Timings, AreReadAsTheyWereWrittenAndDrivesAddUp) {
  const TempFolder folder;
  ASSERT_TRUE(write_timings(example(), folder / "times"));
  auto read = read_timings(folder / "times");
  ASSERT_TRUE(read) << read.error().message;
  append(example(), *read);
  EXPECT_THAT(read->find("sparse")->ms, ElementsAre(1.0, 2.0, 8.0, 1.0, 2.0, 8.0));
  EXPECT_EQ(read->find("sparse")->refused, 2);
  EXPECT_EQ(read->find("nothing"), nullptr);
}

TEST(ThreadCpu, GrowsWithWork) {
  const double before_s = thread_cpu_s();
  volatile double sum = 0.0;
  for (int k = 0; k < 3000000; ++k) sum = sum + 1.0 / (1.0 + k);
  EXPECT_GT(thread_cpu_s(), before_s);
}

}  // namespace
}  // namespace groundscale::internal
