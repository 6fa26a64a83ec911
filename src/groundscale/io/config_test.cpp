#include "groundscale/io/config.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {

enum class Sauce { kRed, kGreen };
template <>
std::vector<std::string_view> names_of<Sauce>() {
  return {"red", "green"};
}

struct Inner {
  double width_m = 2.5;
  std::vector<double> corners;
  Sauce sauce = Sauce::kGreen;
};

struct Outer {
  bool verbose = false;
  int count = 3;
  double limit = 0.1;
  std::string folder;
  Inner inner;
};

void visit_fields(Inner& options, FieldVisitor& v) {
  v.field({.key = "width_m", .unit = "m", .help = "Width of it.", .min = 0.0, .max = 10.0}, options.width_m);
  v.field({.key = "corners", .unit = "px", .help = "Corners.", .min = 0.0}, options.corners);
  v.field({.key = "sauce", .unit = "", .help = "Which one."}, options.sauce);
}

void visit_fields(Outer& options, FieldVisitor& v) {
  v.field({.key = "verbose", .unit = "", .help = "Talks."}, options.verbose);
  v.field({.key = "count", .unit = "", .help = "How many.", .min = 1.0}, options.count);
  v.field({.key = "limit", .unit = "", .help = "Any number."}, options.limit);
  v.field({.key = "folder", .unit = "", .help = "Where."}, options.folder);
  v.group("inner", options.inner);
}

namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

VisitOptions visit_of(Outer* options) {
  return [options](FieldVisitor& v) { visit_fields(*options, v); };
}

std::string yaml_error(const std::string& text) {
  Outer options;
  const Result<void> applied = apply_yaml(text, "my.yaml", visit_of(&options));
  if (applied) return "no error";
  EXPECT_EQ(applied.error().code, ErrorCode::kBadInput);
  return applied.error().message;
}

std::string set_error(const std::string& text) {
  Outer options;
  const Result<void> applied = apply_assignment(text, visit_of(&options));
  return applied ? "no error" : applied.error().message;
}

TEST(Config, YamlSetsWhatItNamesAndLeavesTheRest) {
  Outer options;
  const Result<void> applied = apply_yaml("verbose: true\r\nfolder: /a b\ninner:\n  corners: [1, 2.5]\n  sauce: red\n",
                                          "my.yaml", visit_of(&options));
  ASSERT_TRUE(applied) << applied.error().message;
  EXPECT_TRUE(options.verbose);
  EXPECT_EQ(options.folder, "/a b");
  EXPECT_THAT(options.inner.corners, ElementsAre(1.0, 2.5));
  EXPECT_EQ(options.inner.sauce, Sauce::kRed);
  EXPECT_EQ(options.count, 3);
  EXPECT_EQ(options.inner.width_m, 2.5);
}

TEST(Config, AnEmptyFileOrSectionChangesNothing) {
  Outer options;
  EXPECT_TRUE(apply_yaml("", "my.yaml", visit_of(&options)));
  EXPECT_TRUE(apply_yaml("# only words\n", "my.yaml", visit_of(&options)));
  EXPECT_TRUE(apply_yaml("inner:\n", "my.yaml", visit_of(&options)));
  EXPECT_EQ(options.inner.width_m, 2.5);
}

TEST(Config, UnknownKeysNameTheNearestWithFileAndLine) {
  EXPECT_THAT(yaml_error("count: 2\nverbos: true\n"),
              HasSubstr("my.yaml:2: verbos: unknown key, the nearest is 'verbose'"));
  EXPECT_THAT(yaml_error("inner:\n  width: 2\n"),
              HasSubstr("my.yaml:2: inner.width: unknown key, the nearest is 'inner.width_m'"));
  EXPECT_THAT(yaml_error("width_m: 2\n"), HasSubstr("the nearest is 'inner.width_m'"));  // the section forgotten
  EXPECT_THAT(set_error("iner.sauce=red"), HasSubstr("iner.sauce: unknown key, the nearest is 'inner.sauce'"));
  EXPECT_THAT(set_error("inner=2"), HasSubstr("inner: is a section, a key of it is 'inner.width_m'"));
}

TEST(Config, ValuesOutOfRangeNameTheBound) {
  EXPECT_THAT(yaml_error("inner: {width_m: 11}\n"),
              HasSubstr("my.yaml:1: inner.width_m: 11 is out of range, it must be from 0 to 10 m"));
  EXPECT_THAT(yaml_error("count: 0\n"), HasSubstr("count: 0 is out of range, it must be at least 1"));
  EXPECT_THAT(yaml_error("inner: {corners: [3, -1]}\n"), HasSubstr("inner.corners: -1 is out of range"));
  EXPECT_THAT(set_error("inner.width_m=-1e-9"), HasSubstr("inner.width_m: -1e-09 is out of range"));
}

TEST(Config, WrongTypesSayWhatWouldBeRight) {
  EXPECT_THAT(yaml_error("verbose: 1\n"), HasSubstr("verbose: '1' must be true or false"));
  EXPECT_THAT(yaml_error("count: 2.5\n"), HasSubstr("count: '2.5' must be a whole number at least 1"));
  EXPECT_THAT(yaml_error("count: 99999999999999999999\n"), HasSubstr("must be a whole number"));
  EXPECT_THAT(yaml_error("count: 3000000000\n"), HasSubstr("must be a whole number"));
  EXPECT_THAT(yaml_error("limit: .nan\n"), HasSubstr("limit: '.nan' must be a finite number"));
  EXPECT_THAT(yaml_error("limit: nan\n"), HasSubstr("must be a finite number"));
  EXPECT_THAT(yaml_error("limit: 1e999\n"), HasSubstr("must be a finite number"));
  EXPECT_THAT(yaml_error("limit: 2 m\n"), HasSubstr("'2 m' must be a finite number"));
  EXPECT_THAT(yaml_error("limit: [1]\n"), HasSubstr("is a list, it must be a finite number"));
  EXPECT_THAT(yaml_error("limit:\n"), HasSubstr("my.yaml:1: limit: has no value"));
  EXPECT_THAT(yaml_error("limit: {a: 1}\n"), HasSubstr("limit: has no value"));
  EXPECT_THAT(yaml_error("inner: 5\n"), HasSubstr("inner: is a section, it must hold keys"));
  EXPECT_THAT(yaml_error("inner: {corners: 5}\n"), HasSubstr("'5' must be a list of finite numbers"));
  EXPECT_THAT(yaml_error("inner: {corners: [[1]]}\n"), HasSubstr("must be a list of finite numbers"));
  EXPECT_THAT(yaml_error("inner: {sauce: gren}\n"),
              HasSubstr("inner.sauce: 'gren' is none of red, green, the nearest is 'green'"));
  EXPECT_THAT(yaml_error("limit: 1\nlimit: 2\n"), HasSubstr("my.yaml:2: limit: is there twice"));
  EXPECT_THAT(yaml_error("- a\n"), HasSubstr("must hold keys"));
  EXPECT_THAT(yaml_error("a: [1\n"), HasSubstr("isn't YAML"));
}

TEST(Config, AnErrorLeavesEverythingAsItWas) {
  Outer options;
  EXPECT_FALSE(apply_yaml("count: 9\ninner: {width_m: 99}\n", "my.yaml", visit_of(&options)));
  EXPECT_EQ(options.count, 3);
}

TEST(Config, AssignmentsSetOneField) {
  Outer options;
  const VisitOptions visit = visit_of(&options);
  ASSERT_TRUE(apply_assignment("inner.width_m= 4", visit));
  ASSERT_TRUE(apply_assignment("folder=a=b", visit));
  ASSERT_TRUE(apply_assignment("inner.corners=1, 2,3", visit));
  EXPECT_EQ(options.inner.width_m, 4.0);
  EXPECT_EQ(options.folder, "a=b");
  EXPECT_THAT(options.inner.corners, ElementsAre(1.0, 2.0, 3.0));
  ASSERT_TRUE(apply_assignment("inner.corners=[7]", visit));
  EXPECT_THAT(options.inner.corners, ElementsAre(7.0));
  ASSERT_TRUE(apply_assignment("inner.corners=[]", visit));
  EXPECT_THAT(options.inner.corners, IsEmpty());
  EXPECT_THAT(set_error("count"), HasSubstr("'count' must be KEY=VALUE"));
  EXPECT_THAT(set_error("count="), HasSubstr("count: '' must be a whole number"));
  EXPECT_THAT(set_error("inner.corners=1,,2"), HasSubstr("'' must be a list of finite numbers"));
}

TEST(Config, WhatIsWrittenReadsBackToTheSameBits) {
  Outer options;
  options.verbose = true;
  options.count = std::numeric_limits<int>::max();
  options.limit = std::nextafter(1.0 / 3.0, 1.0);
  options.folder = "a \"b\"\\c: #d\n\t\x01 ü '";
  options.inner.width_m = std::numeric_limits<double>::denorm_min();
  options.inner.corners = {0.1, 1e300, 123456789.123456789};
  options.inner.sauce = Sauce::kRed;
  const std::string text = to_yaml(visit_of(&options));
  Outer back;
  const Result<void> applied = apply_yaml(text, "back.yaml", visit_of(&back));
  ASSERT_TRUE(applied) << applied.error().message << "\n" << text;
  EXPECT_EQ(back.verbose, options.verbose);
  EXPECT_EQ(back.count, options.count);
  EXPECT_EQ(back.limit, options.limit);
  EXPECT_EQ(back.folder, options.folder);
  EXPECT_EQ(back.inner.width_m, options.inner.width_m);
  EXPECT_EQ(back.inner.corners, options.inner.corners);
  EXPECT_EQ(back.inner.sauce, options.inner.sauce);
  EXPECT_EQ(to_yaml(visit_of(&back)), text);
}

TEST(Config, NumbersAreAsShortAsTheyCanBe) {
  Outer options;
  options.limit = 0.1;
  EXPECT_EQ(
      to_yaml(visit_of(&options)),
      "verbose: false\ncount: 3\nlimit: 0.1\nfolder: \"\"\ninner:\n  width_m: 2.5\n  corners: []\n  sauce: green\n");
}

TEST(Config, RowsTellAUserEverything) {
  Outer options;
  const std::vector<FieldRow> rows = field_rows(visit_of(&options));
  ASSERT_EQ(rows.size(), 7U);
  EXPECT_EQ(rows[1].name, "count");
  EXPECT_EQ(rows[1].type, "int");
  EXPECT_EQ(rows[1].range, "at least 1");
  EXPECT_EQ(rows[4].name, "inner.width_m");
  EXPECT_EQ(rows[4].type, "number");
  EXPECT_EQ(rows[4].value, "2.5");
  EXPECT_EQ(rows[4].unit, "m");
  EXPECT_EQ(rows[4].range, "from 0 to 10");
  EXPECT_EQ(rows[4].help, "Width of it.");
  EXPECT_EQ(rows[6].type, "choice");
  EXPECT_EQ(rows[6].value, "green");
  EXPECT_EQ(rows[6].range, "red, green");
}

TEST(NearestName, HasTheSmallestEditDistance) {
  const std::vector<std::string> names = {"filter", "fitter", "height"};
  EXPECT_EQ(nearest_name("heigth", names), "height");
  EXPECT_EQ(nearest_name("filtr", names), "filter");
  EXPECT_EQ(nearest_name("", {}), "");
}

}  // namespace
}  // namespace groundscale
