#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/contamination_records_internal.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale::internal {
namespace {

using testing::HasSubstr;
using testing::Not;

std::vector<ContaminationRecord> example() {
  return {{"city", 1, "whole", 0.0, 0.01, "sparse", 0.02},   {"city", 2, "whole", 0.0, 0.00, "sparse", -0.04},
          {"city", 3, "whole", 0.0, 0.02, "sparse", {}},     {"city", 1, "whole", 0.5, 0.49, "sparse", 0.30},
          {"city", 1, "path", 0.0, 0.05, "sparse", 0.01},    {"city", 1, "mask", 0.5, 0.0, "sparse", {}},
          {"city", 1, "whole", 0.0, 0.01, "divining", -0.5}, {"city", 1, "whole", 0.5, 0.49, "divining", 0.5}};
}

TEST(ContaminationTable, HasBiasMedianP95AndCoverage) {
  const std::string csv = contamination_table(example()).csv();
  EXPECT_THAT(csv, HasSubstr("region,share,region_share,method,pairs,coverage,bias,median,p95\n"));
  // Of 2 %, -4 % and a refusal: the middle of -4 and 2 is -1, that of 2 and 4 is 3, the largest is 4.
  EXPECT_THAT(csv, HasSubstr("whole,0,1,sparse,3,66.6"));
  EXPECT_THAT(csv, HasSubstr(",-1,3,4\n"));
  EXPECT_THAT(csv, HasSubstr("mask,50,0,sparse,1,0,,,\n"));
  EXPECT_THAT(csv, Not(HasSubstr("mask,0,")));  // nobody got there
}

TEST(ContaminationTable, OverviewHasARowAShareAndAColumnAMethod) {
  const std::string text = contamination_overview(example(), kWholeRegion);
  EXPECT_THAT(text, HasSubstr("| share % | pairs | sparse | divining |"));
  EXPECT_THAT(text, HasSubstr("| 0 | 3 | 3.00 | 50.00 |\n| 50 | 1 | 30.00 | 50.00 |"));
}

TEST(ContaminationPlots, AreThoseOfTheRegionsThatHaveErrors) {
  std::vector<std::string> names;
  for (const Plot& plot : contamination_plots(example())) {
    if (has_points(plot)) names.push_back(plot.name);
  }
  EXPECT_THAT(names, testing::ElementsAre("error-whole", "error-path"));
}

TEST(ContaminationRecords, AreReadAsTheyWereWritten) {
  const TempFolder folder;
  ASSERT_TRUE(write_records(example(), folder / "pairs"));
  const auto read = read_records(folder / "pairs");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(records_table(*read).csv(), records_table(example()).csv());
  EXPECT_EQ(read_records(folder / "nowhere").error().code, ErrorCode::kIo);
}

}  // namespace
}  // namespace groundscale::internal
