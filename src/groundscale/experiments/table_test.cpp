#include "groundscale/experiments/table.hpp"

#include <limits>

#include <gtest/gtest.h>

namespace groundscale {
namespace {

Table example() {
  Table table({{.name = "drive", .title = "drive", .text = true},
               {.name = "bias", .title = "bias %", .sign = true},
               {.name = "frames", .title = "frames", .decimals = 0, .averaged = false}});
  table.add_row({std::string("a,b|c"), 0.125, 10.0});
  table.add_row({std::string("d"), std::nullopt, 20.0});
  table.add_row({std::string("e"), -0.5, std::numeric_limits<double>::quiet_NaN()});
  return table;
}

TEST(Table, CsvHasFullPrecisionAndIsEmptyWhereThereIsNoValue) {
  EXPECT_EQ(example().csv(), "drive,bias,frames\n\"a,b|c\",0.125,10\nd,,20\ne,-0.5,\n");
}

TEST(Table, MarkdownShowsTheChosenColumnsAndMeansOverWhatThereIs) {
  EXPECT_EQ(example().markdown({"drive", "frames", "bias"}),
            "| drive | frames | bias % |\n"
            "|---|---:|---:|\n"
            "| a,b\\|c | 10 | +0.12 |\n"
            "| d | 20 |  |\n"
            "| e |  | -0.50 |\n"
            "| mean |  | -0.19 |\n");
}

TEST(Table, ASingleRowHasNoMean) {
  Table table({{.name = "drive", .title = "drive", .text = true}, {.name = "x", .title = "x"}});
  table.add_row({std::string("a"), 1.0});
  EXPECT_EQ(table.markdown({"drive", "x"}), "| drive | x |\n|---|---:|\n| a | 1.00 |\n");
}

}  // namespace
}  // namespace groundscale
