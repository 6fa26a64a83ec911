#include "groundscale/experiments/plot.hpp"

#include <cstdlib>
#include <filesystem>
#include <limits>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;
using testing::HasSubstr;
using testing::StartsWith;

Plot example() {
  return {.name = "step",
          .title = "The road's scale_bias",
          .x_label = "distance m",
          .y_label = "ratio",
          .columns = {"distance_m", "raw", "final"},
          .rows = {{0.0, 1.01, std::nullopt}, {1.5, std::nullopt, 1.0}, {2.5, 0.99, 1.02}},
          .curves = {{.title = "raw", .y = 1, .style = CurveStyle::kPoints}, {.title = "final", .y = 2}}};
}

TEST(Plot, DataLeaveEmptyWhatIsNotThereAndWhatIsNoNumber) {
  Plot plot = example();
  plot.rows[2][1] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(plot_data(plot), "distance_m,raw,final\n0,1.01,\n1.5,,1\n2.5,,1.02\n");
}

TEST(Plot, ScriptNamesDataColumnsAndBothPictures) {
  const std::string script = plot_script(example());
  EXPECT_THAT(script, HasSubstr("'step.csv' skip 1 using 1:2"));
  EXPECT_THAT(script, HasSubstr("'step.csv' skip 1 using 1:3"));
  EXPECT_THAT(script, HasSubstr("set output 'step.svg'"));
  EXPECT_THAT(script, HasSubstr("set output 'step.png'"));
  EXPECT_THAT(script, HasSubstr("set title 'The road''s scale_bias'"));
}

TEST(Plot, ABandLiesBetweenTwoColumnsWithoutATitleAndBarsAreBoxes) {
  Plot plot = example();
  plot.curves[0] = {.title = "", .y = 1, .style = CurveStyle::kBand, .y_high = 2};
  plot.curves[1].style = CurveStyle::kBars;
  const std::string script = plot_script(plot);
  EXPECT_THAT(script, HasSubstr("'step.csv' skip 1 using 1:2:3 with filledcurves"));
  EXPECT_THAT(script, HasSubstr("noborder linecolor rgb '#000000' notitle"));
  EXPECT_THAT(script, HasSubstr("'step.csv' skip 1 using 1:3 with boxes"));
}

TEST(Plot, WithoutDrawingDataAndScriptAreThere) {
  const TempFolder folder;
  ASSERT_TRUE(write_plot(folder.path(), example(), /*draw=*/false));
  EXPECT_EQ(*read_text(folder / "step.csv"), plot_data(example()));
  EXPECT_EQ(*read_text(folder / "step.gp"), plot_script(example()));
  EXPECT_FALSE(fs::exists(folder / "step.svg"));
}

class DrawnPlot : public testing::Test {
 protected:
  void SetUp() override {
    if (!gnuplot_is_there()) GTEST_SKIP() << "gnuplot is not installed (scripts/setup.sh installs it)";
  }
  void expect_pictures() {
    EXPECT_THAT(*read_text(folder / "step.svg"), HasSubstr("<svg"));
    EXPECT_THAT(*read_text(folder / "step.png"), StartsWith("\x89PNG"));
  }
  TempFolder folder;
};

TEST_F(DrawnPlot, PicturesAreDrawnBesideTheScriptAndNotAgain) {
  ASSERT_TRUE(write_plot(folder.path(), example(), true));
  expect_pictures();
  ASSERT_TRUE(write_text(folder / "step.png", "marked"));
  ASSERT_TRUE(write_plot(folder.path(), example(), true));
  EXPECT_EQ(*read_text(folder / "step.png"), "marked") << "nothing changed, so nothing is drawn";
  Plot changed = example();
  changed.rows[0][1] = 1.02;
  ASSERT_TRUE(write_plot(folder.path(), changed, true));
  expect_pictures();
}

TEST_F(DrawnPlot, AreDrawnLaterWhereGnuplotWasMissingAtFirst) {
  ASSERT_TRUE(write_plot(folder.path(), example(), false));
  ASSERT_TRUE(write_plot(folder.path(), example(), true));
  expect_pictures();
}

TEST_F(DrawnPlot, AreTheSameBytesAgain) {
  const TempFolder other;
  ASSERT_TRUE(write_plot(folder.path(), example(), true));
  ASSERT_TRUE(write_plot(other.path(), example(), true));
  for (const char* name : {"step.svg", "step.png"}) EXPECT_TRUE(*read_text(folder / name) == *read_text(other / name));
}

TEST_F(DrawnPlot, AFailureLeavesDataAndScriptAndNoPicture) {
  Plot plot = example();
  plot.settings = {"set no such thing"};
  const auto drawn = write_plot(folder.path(), plot, true);
  ASSERT_FALSE(drawn);
  EXPECT_THAT(drawn.error().message, HasSubstr("gnuplot ended with status"));
  EXPECT_TRUE(fs::exists(folder / "step.gp"));
  EXPECT_FALSE(fs::exists(folder / "step.svg"));
}

}  // namespace
}  // namespace groundscale
