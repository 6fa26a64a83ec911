#include "groundscale/report/scale_report.hpp"

#include <array>
#include <filesystem>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "groundscale/report/test_markup_internal.hpp"
#include "groundscale/report/test_run_internal.hpp"

namespace groundscale {
namespace {

using internal::occurrences;
using internal::TempFolder;
using internal::what_is_wrong;
using internal::WrittenRun;
using testing::HasSubstr;
using testing::Not;

constexpr int kFrames = 41;

std::string error_of(const std::string& text) {
  const TempFolder folder;
  const auto read = read_method_times(folder.file("methods.csv", text));
  if (read) return "no error";
  EXPECT_EQ(read.error().code, ErrorCode::kBadInput);
  return read.error().message;
}

/// What `scale` leaves of two methods: steps of 1 m by `sparse`; by `dense` the same but 10 % too long where a single
/// frame is measured, refused at the end.
struct WrittenScale {
  WrittenRun matcher{.frames = kFrames, .config = "road:\n  region:\n    near_m: 6\n"};
  WrittenRun sparse{.frames = kFrames};
  WrittenRun dense{.frames = kFrames, .raw_off = 0.1};

  void write(const TempFolder& folder) const {
    matcher.write(folder, "out");
    sparse.write(folder, "out/sparse");
    dense.write(folder, "out/dense");
    std::string csv = "frame,method,raw_step_m,time_ms,reason\n0,sparse,,,\n0,dense,,,\n";
    for (int k = 1; k < kFrames; ++k) csv += fmt::format("{0},sparse,1,1.5,\n{0},dense,1.1,{1},\n", k, 20 + k % 3);
    folder.file("out/methods.csv", csv);
  }

  /// All three are told the truth.
  void tell(const std::string& truth) {
    for (WrittenRun* run : {&matcher, &sparse, &dense}) run->truth = "\"" + truth + "\"";
  }
};

std::string page_of(const TempFolder& folder) {
  const auto written = write_scale_report(folder / "out");
  EXPECT_TRUE(written) << written.error().message;
  return read_text(folder / "out/report.html").value();
}

/// Steps of 0.8, 1 and 1.25 m in turn, and a last one of 0.15 m, too short to count as moving.
std::string uneven_truth() {
  std::string rows;
  double z_m = 0.0;
  for (int k = 0; k < kFrames; ++k) {
    rows += kitti_row({Eigen::Matrix3d::Identity(), {0.0, 0.0, z_m}}) + "\n";
    z_m += k == kFrames - 2 ? 0.15 : std::array{0.8, 1.0, 1.25}[static_cast<std::size_t>(k % 3)];
  }
  return rows;
}

TEST(MethodTimes, AreReadByNames) {
  const TempFolder folder;
  const auto methods =
      read_method_times(folder.file("methods.csv", "extra,time_ms,method\nx,2.5,dense\nx,,sparse\nx,3.5,dense\n"));
  ASSERT_TRUE(methods) << methods.error().message;
  ASSERT_EQ(methods->size(), 2U);
  EXPECT_EQ(methods->front().method, "dense");
  EXPECT_THAT(methods->front().time_ms, testing::ElementsAre(2.5, 3.5));
  EXPECT_EQ(methods->back().method, "sparse");
  EXPECT_THAT(methods->back().time_ms, testing::IsEmpty());
}

TEST(MethodTimes, AreRefusedWithTheirPlaceWhereTheyAreWrong) {
  const std::string header = "frame,method,time_ms\n";
  EXPECT_THAT(error_of("frame,method\n"), HasSubstr("methods.csv:1: no column 'time_ms'"));
  EXPECT_THAT(error_of(header), HasSubstr("methods.csv: has no row"));
  EXPECT_THAT(error_of(header + "1,a\n"), HasSubstr("methods.csv:2: 2 fields, the header has 3"));
  EXPECT_THAT(error_of(header + "1,a,nan\n"), HasSubstr("methods.csv:2: time_ms is 'nan'"));
  EXPECT_THAT(error_of(""), HasSubstr("methods.csv: empty"));
}

TEST(MethodsPage, HasTheErrorsOfEvaluateAgainstTheTruth) {
  const TempFolder folder;
  WrittenScale scale;
  scale.tell(folder.file("truth.txt", uneven_truth()));
  scale.write(folder);
  const std::string html = page_of(folder);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("<h2>Errors against the truth</h2>"));
  // 39 moving steps, 13 of each length. Raw ratios of dense are 1.375, 1.1 and 0.88: median 1.1, a spread of 0, 0.2 and
  // 0.25 about it, errors of 0.375, 0.1 and 0.12. No turns.
  EXPECT_THAT(html, HasSubstr("<th>dense</th><td>39</td><td>+10.00</td><td>20.00</td><td>37.50</td>"
                              "<td>39</td><td>+10.00</td><td>20.00</td><td>37.50</td>"
                              "<td>0</td><td>\u2013</td><td>\u2013</td><td>\u2013</td></tr>"));
  // Filtered ratios of both are 1.25, 1 and 0.8.
  EXPECT_THAT(html, testing::ContainsRegex("<th>dense</th><td>39</td><td>[-+]0.00</td><td>20.00</td><td>25.00</td>"));
  EXPECT_THAT(html, testing::ContainsRegex("<p class=\"verdict good\">Nearest to the truth: sparse [(]bias [-+]0.0 %, "
                                           "95 % within 25.0 %[)].</p>"));
  EXPECT_THAT(html, Not(HasSubstr("nan")));
}

TEST(MethodsPage, HoldsMethodsAgainstTheFirstWithoutTruth) {
  const TempFolder folder;
  WrittenScale scale;
  scale.dense.step_m = 1.05;
  scale.dense.refused_from = 31;
  scale.write(folder);
  const std::string html = page_of(folder);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("<h2>Errors against the filtered steps of sparse</h2>"));
  // Filtered steps are 5 % longer; of 40, 30 were measured, 15.5 % longer.
  EXPECT_THAT(html, HasSubstr("<th>dense</th><td>40</td><td>+5.00</td><td>0.00</td><td>5.00</td>"));
  EXPECT_THAT(html, HasSubstr("<th>dense</th><td>30</td><td>+15.50</td><td>0.00</td><td>15.50</td>"));
  EXPECT_THAT(html, HasSubstr("<p class=\"verdict\">There is no truth: which method is right can&#39;t be said. In the "
                              "median their filtered steps lie within 5.0 % of those of sparse.</p>"));
  EXPECT_THAT(html, HasSubstr("<b>Good.</b> sparse: measured in 40 of 41 moving frames (98 %).</li>"));
  EXPECT_THAT(html, HasSubstr("<b>Reservation.</b> dense: measured in 30 of 41 moving frames (73 %); filtered steps: "
                              "bias +5.0 %, 95 % within 5.0 %.</li>"));
}

TEST(MethodsPage, HasAllThatAReportHas) {
  const TempFolder folder;
  WrittenScale scale;
  scale.matcher.warnings = "[\"careful\"]";
  scale.dense.refused_from = 31;
  scale.write(folder);
  folder.file("out/samples/samples.csv", "frame,why,value,picture\n7,spread,0,000007.jpg\n");
  folder.file("out/samples/000007.jpg", "a picture");
  const std::string html = page_of(folder);
  EXPECT_EQ(what_is_wrong(html), "");
  for (const char* part :
       {"Scale by 2 methods", "<dt>camera height</dt>", "Trajectory from above", "src=\"data:image/jpeg;base64,",
        "<li>careful</li>", "2 keys that differ from their defaults", "road.region.near_m",
        "<a href=\"dense/report.html\">dense</a></th><td>41</td><td>73.2</td>", "tracking</text>", "1.50 ms",
        "21.00 ms", "frames without an accepted measurement",
        "speed ... m/s, too low &lt;b&gt;</th><td>0</td><td>10</td>"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  // A chart of pitch and roll a method.
  EXPECT_EQ(occurrences(html, "aria-label=\"Pitch and roll of the road by distance\""), 2);
  EXPECT_EQ(occurrences(html, "</svg>pitch</li>"), 2);
  EXPECT_EQ(occurrences(html, "</svg>roll</li>"), 2);
}

TEST(MethodsPage, TellsReasonsOfManyMethodsInWords) {
  const TempFolder folder;
  WrittenRun{.frames = kFrames}.write(folder, "out");
  std::string csv = "method,time_ms\n";
  for (int k = 0; k < 5; ++k) {
    const std::string name = fmt::format("m_{}", k);
    WrittenRun{.frames = kFrames, .refused_from = kFrames - k}.write(folder, "out/" + name);
    csv += name + ",1\n";
  }
  folder.file("out/methods.csv", csv);
  const std::string html = page_of(folder);
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("too low &lt;b&gt;</th><td>10</td><td>m_4 4, m_3 3, m_2 2, m_1 1</td></tr>"));
  EXPECT_THAT(html, HasSubstr("<th>first frame</th><td>5</td>"));
}

TEST(MethodsPage, SaysThatATruthIsGone) {
  const TempFolder folder;
  WrittenScale scale;
  scale.tell(folder / "gone.txt");
  scale.write(folder);
  const std::string html = page_of(folder);
  EXPECT_THAT(html, HasSubstr("<li>nothing can be compared with the truth: "));
  EXPECT_THAT(html, HasSubstr("Errors against the filtered steps of sparse"));
}

TEST(MethodsPage, IsNotWrittenFromWhatIsWrong) {
  const TempFolder folder;
  WrittenScale().write(folder);
  std::filesystem::remove(folder / "out/dense/summary.json");
  const auto written = write_scale_report(folder / "out");
  ASSERT_FALSE(written);
  EXPECT_THAT(written.error().message, HasSubstr("dense: the run in it didn't end"));
  EXPECT_FALSE(std::filesystem::exists(folder / "out/report.html"));
}

}  // namespace
}  // namespace groundscale
