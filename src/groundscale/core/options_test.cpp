#include "groundscale/core/options.hpp"

#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace groundscale {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

enum class Surface { kAsphalt, kGravel };
}  // namespace

template <>
std::vector<std::string_view> names_of<Surface>() {
  return {"asphalt", "gravel"};
}

namespace {

struct WheelOptions {
  double radius_m = 0.3;
};

struct CarOptions {
  bool lights = true;
  int seats = 4;
  std::string name = "car";
  std::vector<double> gears = {1.0, 2.0};
  Surface surface = Surface::kAsphalt;
  WheelOptions wheel;
  double weight_kg = 1000.0;
};

void visit_fields(WheelOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "radius_m", .unit = "m", .help = "", .min = 0.1, .max = 1.0}, options.radius_m);
}

void visit_fields(CarOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "lights", .unit = "", .help = ""}, options.lights);
  visitor.field({.key = "seats", .unit = "", .help = "", .min = 1, .max = 9}, options.seats);
  visitor.field({.key = "name", .unit = "", .help = ""}, options.name);
  visitor.field({.key = "gears", .unit = "", .help = "", .min = 0.5, .max = 8.0}, options.gears);
  visitor.field({.key = "surface", .unit = "", .help = ""}, options.surface);
  visitor.group("wheel", options.wheel);
  visitor.field({.key = "weight_kg", .unit = "kg", .help = "", .min = 1.0}, options.weight_kg);
}

/// Notes each field's dotted name, and what it is.
class Recorder : public NamedFieldVisitor {
 public:
  using FieldVisitor::field;
  void field(const FieldInfo& info, bool&) override { add(info, "bool"); }
  void field(const FieldInfo& info, int&) override { add(info, "int"); }
  void field(const FieldInfo& info, double&) override { add(info, "double"); }
  void field(const FieldInfo& info, std::string&) override { add(info, "string"); }
  void field(const FieldInfo& info, std::vector<double>&) override { add(info, "list"); }
  void field(const FieldInfo& info, Choice choice) override {
    add(info, std::string(choice.names[static_cast<std::size_t>(choice.get())]));
    choice.set(1 - choice.get());
  }
  const std::vector<std::string>& seen() const { return seen_; }

 private:
  void add(const FieldInfo& info, const std::string& what) { seen_.push_back(name_of(info) + ":" + what); }
  std::vector<std::string> seen_;
};

TEST(Options, AreVisitedInTheirOrderWithDottedNames) {
  CarOptions options;
  Recorder recorder;
  visit_fields(options, recorder);
  EXPECT_THAT(recorder.seen(), ElementsAre("lights:bool", "seats:int", "name:string", "gears:list", "surface:asphalt",
                                           "wheel.radius_m:double", "weight_kg:double"));
}

TEST(Options, AnEnumerationIsReadAndSetByItsNames) {
  CarOptions options;
  Recorder recorder;
  visit_fields(options, recorder);
  EXPECT_EQ(options.surface, Surface::kGravel);
}

TEST(CheckRanges, AcceptsDefaultsAndTheBoundsThemselves) {
  CarOptions options;
  EXPECT_TRUE(check_ranges(options));
  options.seats = 9;
  options.wheel.radius_m = 0.1;
  options.gears = {0.5, 8.0};
  EXPECT_TRUE(check_ranges(options));
}

TEST(CheckRanges, NamesFieldValueBoundAndUnit) {
  CarOptions options;
  options.wheel.radius_m = 1.5;
  const Result<void> checked = check_ranges(options);
  ASSERT_FALSE(checked);
  EXPECT_EQ(checked.error().code, ErrorCode::kBadInput);
  EXPECT_EQ(checked.error().message, "wheel.radius_m: 1.5 is out of range, it must be from 0.1 to 1 m");
}

TEST(CheckRanges, FindsWhatIsWrongInEveryKindOfNumber) {
  CarOptions seats, gears, weight, not_a_number;
  seats.seats = 0;
  gears.gears = {1.0, 9.0};
  weight.weight_kg = std::numeric_limits<double>::infinity();  // within its bounds, but no number to work with
  not_a_number.wheel.radius_m = std::numeric_limits<double>::quiet_NaN();
  for (const auto& [options, name] :
       {std::pair(seats, "seats: 0 "), std::pair(gears, "gears: 9 "), std::pair(weight, "weight_kg: inf "),
        std::pair(not_a_number, "radius_m: nan ")}) {
    const Result<void> checked = check_ranges(options);
    ASSERT_FALSE(checked) << name;
    EXPECT_THAT(checked.error().message, HasSubstr(name));
  }
}

TEST(CheckRanges, OfSeveralWrongFieldsNamesTheFirst) {
  CarOptions options;
  options.seats = 0;
  options.wheel.radius_m = 7.0;
  EXPECT_THAT(check_ranges(options).error().message, HasSubstr("seats"));
}

}  // namespace
}  // namespace groundscale
