#include "groundscale/experiments/method_choice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/road/ground_methods.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

TEST(ChooseGroundMethods, TakesThoseOfTheDefaultsThatThereAre) {
  const auto chosen = choose_ground_methods({}, {"divining", "sparse"});
  ASSERT_TRUE(chosen);
  ASSERT_EQ(chosen->size(), 1U);
  EXPECT_EQ(chosen->front().name, "sparse");
  EXPECT_EQ(choose_ground_methods({}, {})->size(), ground_methods().size());
}

TEST(ChooseGroundMethods, ListsThoseThereAreWhereOneIsUnknown) {
  const auto unknown = choose_ground_methods({"sparse", "divining"}, {});
  ASSERT_FALSE(unknown);
  EXPECT_EQ(unknown.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(unknown.error().message, HasSubstr("\"divining\" is no method, known: " + ground_method_names()));
  EXPECT_THAT(choose_ground_methods({"sparse", "sparse"}, {}).error().message, HasSubstr("\"sparse\" is named twice"));
}

TEST(AssignedOptions, LieOverTheStart) {
  OdometryOptions start;
  start.ground.plane.max_error_px = 7.0;
  const auto options = assigned_options(start, {"ground.plane.huber_px=2"});
  ASSERT_TRUE(options);
  EXPECT_EQ(options->ground.plane.max_error_px, 7.0);
  EXPECT_EQ(options->ground.plane.huber_px, 2.0);
  EXPECT_EQ(assigned_options(start, {"ground.plane.hubr_px=2"}).error().code, ErrorCode::kBadInput);
}

}  // namespace
}  // namespace groundscale
