#include <cmath>
#include <limits>
#include <regex>
#include <set>
#include <string>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/report/chart_internal.hpp"
#include "groundscale/report/page_internal.hpp"
#include "groundscale/report/test_markup_internal.hpp"

namespace groundscale::internal {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

std::vector<ChartPoint> wave(int count) {
  std::vector<ChartPoint> points;
  for (int k = 0; k < count; ++k) points.push_back({1.0 * k, std::sin(0.01 * k)});
  return points;
}

Chart chart_of(std::vector<ChartCurve> curves) {
  Chart chart;
  chart.name = "a <chart>";
  chart.x_name = "x & more";
  chart.y_name = "y";
  chart.curves = std::move(curves);
  return chart;
}

/// Numbers of a path, in their order.
std::vector<double> numbers_of(const std::string& html, const std::string& shape) {
  std::smatch path;
  if (!std::regex_search(html, path, std::regex("class=\"" + shape + "\" d=\"([^\"]*)\""))) return {};
  const std::string text = path[1];
  std::vector<double> numbers;
  const std::regex number("-?[0-9]+[.]?[0-9]*");
  for (std::sregex_iterator at(text.begin(), text.end(), number), end; at != end; ++at) {
    numbers.push_back(std::stod(at->str()));
  }
  return numbers;
}

TEST(Thinned, KeepsFewPointsAsTheyAre) { EXPECT_EQ(thinned(wave(10), 10).size(), 10U); }

TEST(Thinned, KeepsEndsExtremesAndGaps) {
  std::vector<ChartPoint> points = wave(10000);
  points[1234].y = 7.0;
  points[4321].y = -9.0;
  points[6000].y = kNone;
  const auto kept = thinned(points, 300);
  EXPECT_LT(kept.size(), 310U);
  EXPECT_EQ(kept.front().x, 0.0);
  EXPECT_EQ(kept.back().x, 9999.0);
  double low = 0.0;
  double high = 0.0;
  int gaps = 0;
  for (const ChartPoint& p : kept) {
    low = std::min(low, std::isnan(p.y) ? low : p.y);
    high = std::max(high, std::isnan(p.y) ? high : p.y);
    gaps += std::isnan(p.y) ? 1 : 0;
  }
  EXPECT_EQ(low, -9.0);
  EXPECT_EQ(high, 7.0);
  EXPECT_EQ(gaps, 1);
  EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end(), [](const auto& a, const auto& b) { return a.x < b.x; }));
}

TEST(ChartHtml, IsWellFormedForEveryKindOfCurve) {
  std::vector<ChartCurve> curves;
  int style = kTruthStyle;
  for (const Drawn drawn :
       {Drawn::kLine, Drawn::kDots, Drawn::kRings, Drawn::kCrosses, Drawn::kSquares, Drawn::kTriangles,
        Drawn::kDiamonds, Drawn::kPluses, Drawn::kWedges, Drawn::kDashes, Drawn::kUprights}) {
    curves.push_back({"<name>", drawn, style++, wave(20)});
  }
  Chart chart = chart_of(curves);
  chart.bands = {{"band", {{0.0, -1.0, 1.0}, {5.0, kNone, kNone}, {10.0, -2.0, 2.0}, {12.0, -1.0, 1.0}}}};
  chart.events = {3.0};
  chart.event_name = "event";
  chart.level = 0.0;
  const std::string html = chart_html(chart, "caption <b>");
  EXPECT_EQ(what_is_wrong(page("t", html)), "");
  EXPECT_THAT(html, Not(HasSubstr("nan")));
  EXPECT_EQ(occurrences(html, "&lt;name&gt;"), 11);
}

TEST(ChartHtml, EveryStyleHasDashesOrABreadthOfItsOwn) {
  const std::string style = page("t", "");
  std::set<std::string> seen;
  std::set<Drawn> marks;
  for (int k = 0; k < kCurveStyles; ++k) {
    // Colours apart: what is left in grey. The first style is a line as it comes.
    std::smatch own;
    const std::regex rule(fmt::format("\\n\\.curve\\.s{} \\{{ ([^}}]*)\\}}", k));
    EXPECT_EQ(std::regex_search(style, own, rule), k > 0) << k;
    seen.insert(k > 0 ? own[1].str() : "");
    marks.insert(mark_of(k));
    EXPECT_THAT(style, HasSubstr(fmt::format("\n.s{} {{ stroke: #", k)));
  }
  EXPECT_EQ(seen.size(), static_cast<std::size_t>(kCurveStyles));
  EXPECT_EQ(marks.size(), static_cast<std::size_t>(kCurveStyles));
}

TEST(ChartHtml, ALongNameOfAnAxisStaysWithinALowFigure) {
  Chart chart = chart_of({{"", Drawn::kLine, 0, {{0.0, 0.0}, {300.0, 1.0}}}});
  chart.equal_axes = true;
  chart.y_name = "to its right, m";
  const std::string html = chart_html(chart, "");
  std::smatch at;
  ASSERT_TRUE(std::regex_search(html, at, std::regex("translate\\(20 ([0-9.]+)\\) rotate")));
  EXPECT_GE(std::stod(at[1]), 6.5 * 15);  // 15 letters of 13 units, half of them above
}

TEST(ChartHtml, IsEmptyWhereThereIsNothingToDraw) {
  EXPECT_EQ(chart_html(chart_of({}), ""), "");
  EXPECT_EQ(chart_html(chart_of({{"none", Drawn::kLine, 0, {{1.0, kNone}}}}), ""), "");
}

TEST(ChartHtml, ASinglePointAndALevelLineHaveARange) {
  for (const double y : {0.0, 5.0, -1e6}) {
    const std::string html = chart_html(chart_of({{"one", Drawn::kDots, 0, {{2.0, y}}}}), "");
    EXPECT_EQ(what_is_wrong(page("t", html)), "");
    EXPECT_THAT(html, Not(HasSubstr("nan")));
    EXPECT_THAT(html, Not(HasSubstr("inf")));
  }
}

TEST(ChartHtml, ALineIsBrokenWhereThereIsNoValue) {
  std::vector<ChartPoint> points = wave(9);
  points[4].y = kNone;
  const std::string html = chart_html(chart_of({{"", Drawn::kLine, 0, points}}), "");
  std::smatch path;
  ASSERT_TRUE(std::regex_search(html, path, std::regex("class=\"curve s0\" d=\"([^\"]*)\"")));
  EXPECT_EQ(occurrences(path[1].str(), "M"), 2);
  EXPECT_EQ(occurrences(path[1].str(), "L"), 6);
}

TEST(ChartHtml, CountsWhatLiesOutsideAndWhatIsNotDrawn) {
  std::vector<ChartPoint> points = wave(5000);
  for (const int k : {100, 2000, 3000}) points[static_cast<std::size_t>(k)].y = 1e4;
  const std::string html = chart_html(chart_of({{"", Drawn::kRings, 0, points}}), "");
  EXPECT_THAT(html, HasSubstr("of 4997 marks are drawn. 3 values lie outside."));
}

TEST(ChartHtml, AMetreIsAsLongInBothDirectionsWhereAxesAreEqual) {
  // A rectangle of 30 m by 10 m, drawn as a line.
  Chart chart = chart_of({{"", Drawn::kLine, 0, {{0.0, 0.0}, {30.0, 0.0}, {30.0, 10.0}, {0.0, 10.0}}}});
  chart.equal_axes = true;
  for (const bool down : {false, true}) {
    chart.y_grows_down = down;
    const auto n = numbers_of(chart_html(chart, ""), "curve s0");
    ASSERT_EQ(n.size(), 8U);
    EXPECT_NEAR((n[2] - n[0]) / 30.0, std::abs(n[5] - n[3]) / 10.0, 0.02);  // coordinates have one decimal
    EXPECT_EQ(n[5] > n[3], down);
    EXPECT_GT(n[2] - n[0], 0.5 * kPlotWidth);
  }
}

TEST(Bars, AreAsLongAsTheirValues) {
  const std::string html = bars_html({{"a <stage>", 2.0, "2 ms"}, {"b", 1.0, "1 ms"}, {"c", 0.0, "0 ms"}}, "times");
  EXPECT_EQ(what_is_wrong(page("t", html)), "");
  std::vector<double> widths;
  const std::regex bar("class=\"bar\" [^>]*width=\"([0-9.]+)\"");
  for (std::sregex_iterator at(html.begin(), html.end(), bar), end; at != end; ++at)
    widths.push_back(std::stod((*at)[1]));
  ASSERT_EQ(widths.size(), 3U);
  EXPECT_NEAR(widths[0], 2.0 * widths[1], 0.11);  // coordinates have one decimal
  EXPECT_EQ(widths[2], 0.0);
  EXPECT_EQ(bars_html({}, "none"), "");
}

}  // namespace
}  // namespace groundscale::internal
