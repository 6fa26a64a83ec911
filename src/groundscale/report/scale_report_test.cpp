#include "groundscale/report/scale_report.hpp"

#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/report/test_markup_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using internal::what_is_wrong;
using testing::HasSubstr;
using testing::Not;

const std::string kHeader =
    "frame,method,raw_step_m,raw_step_sd_m,online_step_m,pitch_deg,roll_deg,inliers,time_ms,reason\n";

/// Two methods, the second 10 % too long and refused at each fifth frame.
std::string methods_csv() {
  std::string csv = kHeader;
  for (int k = 1; k <= 20; ++k) {
    csv += fmt::format("{},sparse,1.0,0.02,1.0,0.5,0.1,40,1.5,\n", k);
    csv += fmt::format("{},dense,1.1,0.02,1.1,0.5,0.1,40,{},{}\n", k, 20 + k % 3,
                       k % 5 == 0 ? "\"sd of 3.1 %, <large>\"" : "");
  }
  return csv;
}

std::string error_of(const std::string& text) {
  const TempFolder folder;
  const auto read = read_methods_table(folder.file("methods.csv", text));
  if (read) return "no error";
  EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
  return read.error().message;
}

TEST(MethodsTable, IsReadByNames) {
  const TempFolder folder;
  const auto methods = read_methods_table(folder.file(
      "methods.csv",
      "extra,reason,time_ms,inliers,roll_deg,pitch_deg,online_step_m,raw_step_sd_m,raw_step_m,method,frame\n"
      "x,,2.5,30,-0.1,0.2,1.1,0.05,1.2,dense,7\nx,too "
      "few,,,,,1.1,,,sparse,7\nx,,2.5,30,-0.1,0.2,1.1,0.05,1.2,dense,8\n"));
  ASSERT_TRUE(methods) << methods.error().message;
  ASSERT_EQ(methods->size(), 2U);
  EXPECT_EQ(methods->front().method, "dense");
  ASSERT_EQ(methods->front().rows.size(), 2U);
  EXPECT_EQ(methods->front().rows[0].raw_step_m, 1.2);
  EXPECT_EQ(methods->front().rows[0].roll_deg, -0.1);
  EXPECT_TRUE(methods->front().rows[1].accepted());
  EXPECT_EQ(methods->back().rows[0].reason, "too few");
  EXPECT_FALSE(methods->back().rows[0].accepted());
}

TEST(MethodsTable, IsRefusedWithItsPlaceWhereItIsWrong) {
  EXPECT_THAT(error_of("frame,method\n"), HasSubstr("methods.csv:1: no column 'raw_step_m'"));
  EXPECT_THAT(error_of(kHeader), HasSubstr("methods.csv: has no row"));
  EXPECT_THAT(error_of(kHeader + "1,a\n"), HasSubstr("methods.csv:2: 2 fields, the header has 10"));
  EXPECT_THAT(error_of(kHeader + "-1,a,,,,,,,,\n"), HasSubstr("methods.csv:2: frame is '-1'"));
  EXPECT_THAT(error_of(kHeader + "1,a,nan,,,,,,,\n"), HasSubstr("methods.csv:2: raw_step_m is 'nan'"));
  EXPECT_THAT(error_of(""), HasSubstr("methods.csv: empty"));
}

TEST(MethodsPage, HoldsMethodsAgainstTheFirstWithoutTruth) {
  const TempFolder folder;
  folder.file("methods.csv", methods_csv());
  ASSERT_TRUE(write_scale_report(folder.path()));
  const std::string html = read_text(folder / "report.html").value();
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("Scale by 2 methods"));
  EXPECT_THAT(html, HasSubstr("Steps over the filtered step of sparse"));
  // Bias 10 %, no spread; 16 of 20 accepted; times 20, 21, 22 ms in turn.
  EXPECT_THAT(html,
              HasSubstr("<th>dense</th><td>20</td><td>16</td><td>10.00</td><td>0.00</td><td>10.00</td><td>10.00</td>"
                        "<td>0.00</td><td>21.00</td>"));
  EXPECT_THAT(html, HasSubstr("<th>sd of ... %, &lt;large&gt;</th><td>0</td><td>4</td>"));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(MethodsPage, HoldsMethodsAgainstTheTruthThatTheSummaryNames) {
  const TempFolder folder;
  folder.file("methods.csv", methods_csv());
  std::string rows;
  for (int k = 0; k <= 20; ++k) rows += kitti_row({Eigen::Matrix3d::Identity(), {0.0, 0.0, 1.25 * k}}) + "\n";
  const std::string truth = folder.file("truth.txt", rows);
  folder.file("summary.json",
              R"({"source": "a <drive>", "frames": 21, "warnings": ["careful"], "truth": ")" + truth + "\"}");
  ASSERT_TRUE(write_scale_report(folder.path()));
  std::string html = read_text(folder / "report.html").value();
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("Steps over the truth"));
  EXPECT_THAT(html, HasSubstr("<th>sparse</th><td>20</td><td>20</td><td>-20.00</td>"));
  EXPECT_THAT(html, HasSubstr("<dt>source</dt><dd>a &lt;drive&gt;</dd>"));
  EXPECT_THAT(html, HasSubstr("<li>careful</li>"));
  std::filesystem::remove(truth);
  ASSERT_TRUE(write_scale_report(folder.path()));
  html = read_text(folder / "report.html").value();
  EXPECT_THAT(html, HasSubstr("the truth can&#39;t be read: "));
  EXPECT_THAT(html, HasSubstr("Steps over the filtered step of sparse"));
}

TEST(MethodsPage, IsNotWrittenFromWhatIsWrong) {
  const TempFolder folder;
  EXPECT_FALSE(write_scale_report(folder.path()));
  folder.file("methods.csv", methods_csv());
  folder.file("summary.json", "{");
  const auto written = write_scale_report(folder.path());
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("summary.json: isn't JSON"));
  EXPECT_FALSE(std::filesystem::exists(folder / "report.html"));
}

}  // namespace
}  // namespace groundscale
