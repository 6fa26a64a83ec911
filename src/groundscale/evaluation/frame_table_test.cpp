#include "groundscale/evaluation/frame_table.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

const std::string kHeader =
    "frame,time_s,state,step_m,step_sd_m,online_step_m,raw_step_m,raw_step_sd_m,pitch_deg,roll_deg,matches,"
    "road_matches,road_inliers,reason\n";

Result<std::vector<FrameRow>> table(const std::string& content) {
  const TempFolder folder;
  return read_frame_table(folder.file("frames.csv", content));
}

std::string error_of(const std::string& content) {
  const auto rows = table(content);
  if (rows) return "no error";
  EXPECT_EQ(rows.error().code, ErrorCode::kBadInput);
  return rows.error().message;
}

TEST(FrameTable, KeepsNumbersAndLeavesEmptyFieldsEmpty) {
  const auto rows = table(kHeader + "15,1.5,moving,1,,,,,,,,,,\n16,1.6,moving,1.02,0.03,1.04,1.06,0.05,1,0,9,8,7,\n");
  ASSERT_TRUE(rows) << rows.error().message;
  ASSERT_EQ(rows->size(), 2U);
  EXPECT_EQ(rows->front().frame, 15);
  EXPECT_FALSE(rows->front().step_sd_m || rows->front().online_step_m || rows->front().raw_step_m);
  EXPECT_EQ(rows->back().time_s, 1.6);
  EXPECT_EQ(rows->back().step_sd_m, 0.03);
  EXPECT_EQ(rows->back().online_step_m, 1.04);
  EXPECT_EQ(rows->back().raw_step_m, 1.06);
  EXPECT_EQ(rows->back().raw_step_sd_m, 0.05);
}

TEST(FrameTable, ReadsWhatReportsShowWhereItIsThere) {
  const auto rows = table(kHeader + "16,1.6,moving,1.02,0.03,1.04,1.06,0.05,-1,0.5,9,8,7,\n");
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_EQ(rows->front().state, "moving");
  EXPECT_EQ(rows->front().step_m, 1.02);
  EXPECT_EQ(rows->front().pitch_deg, -1.0);
  EXPECT_EQ(rows->front().roll_deg, 0.5);
  EXPECT_EQ(rows->front().road_matches, 8.0);
  EXPECT_EQ(rows->front().road_inliers, 7.0);
  EXPECT_FALSE(rows->front().map_scale || rows->front().drift_ratio);
}

TEST(FrameTable, AMeasurementIsAcceptedWhereThereIsOneAndNoReasonAgainstIt) {
  const auto rows = table(kHeader +
                          "0,0,still,,,,,,,,,,,\n1,0.1,moving,,,,1.1,0.1,,,,,,\n2,0.2,moving,,,,1.1,0.1,,,,,,"
                          "normal\n3,0.3,lost,,,,,,,,,,,too_few\n");
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_FALSE((*rows)[0].accepted());
  EXPECT_TRUE((*rows)[1].accepted());
  EXPECT_FALSE((*rows)[2].accepted());
  EXPECT_FALSE((*rows)[3].accepted());
}

TEST(FrameTable, FindsColumnsByNameSoThatMoreMayFollowAndReadsQuotedFields) {
  const auto rows = table(
      "extra,reason,frame,time_s,step_sd_m,online_step_m,raw_step_m,raw_step_sd_m\r\n"
      "x,\"speed, \"\"odd\"\"\",4,,,,1.5,\r\n");
  ASSERT_TRUE(rows) << rows.error().message;
  EXPECT_EQ(rows->front().frame, 4);
  EXPECT_EQ(rows->front().reason, "speed, \"odd\"");
  EXPECT_FALSE(rows->front().time_s);
  EXPECT_EQ(rows->front().raw_step_m, 1.5);
}

TEST(FrameTable, ErrorsNameLineAndColumn) {
  EXPECT_THAT(error_of(""), HasSubstr("empty"));
  EXPECT_THAT(error_of("frame,time_s\n"), HasSubstr(":1: no column 'step_sd_m'"));
  EXPECT_THAT(error_of(kHeader + "0,0,still\n"), HasSubstr(":2: 3 fields, the header has 14"));
  EXPECT_THAT(error_of(kHeader + "0,0,moving,,,,nan,,,,,,,\n"), HasSubstr(":2: raw_step_m is 'nan'"));
  EXPECT_THAT(error_of(kHeader + "0,0,moving,,,-1,,,,,,,,\n"), HasSubstr(":2: online_step_m is '-1'"));
  EXPECT_THAT(error_of(kHeader + "a,0,moving,,,,,,,,,,,\n"), HasSubstr(":2: frame is 'a'"));
}

TEST(FrameTable, FramesRiseAndTimesDoNotFall) {
  EXPECT_THAT(error_of(kHeader + "1,0,still,,,,,,,,,,,\n1,0.1,still,,,,,,,,,,,\n"),
              HasSubstr(":3: frame 1 after frame 1"));
  EXPECT_THAT(error_of(kHeader + "1,0.2,still,,,,,,,,,,,\n2,0.1,still,,,,,,,,,,,\n"), HasSubstr(":3: time falls"));
  EXPECT_THAT(error_of(kHeader + "1,,still,,,,,,,,,,,\n2,0.1,still,,,,,,,,,,,\n"),
              HasSubstr(":3: time_s must be there"));
}

}  // namespace
}  // namespace groundscale
