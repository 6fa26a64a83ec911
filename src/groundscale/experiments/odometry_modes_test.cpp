#include "groundscale/experiments/odometry_modes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/measured_run.hpp"

namespace groundscale {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST(Modes, WithoutACorrectionAndTheDefaultWhereNoneIsNamed) {
  const auto modes = choose_modes({});
  ASSERT_TRUE(modes);
  EXPECT_THAT(*modes, ElementsAre("none", default_mode()));
  EXPECT_EQ(best_mode(*modes), default_mode());
}

TEST(Modes, EachIsAConfigurationThatRunTakes) {
  EXPECT_THAT(mode_names(), ElementsAre("none", "triggered", "filtered", "continuous", "pairwise"));
  for (const std::string& mode : mode_names()) {
    const RunSettings settings{.assignments = mode_assignments(mode), .seed = {}};
    const auto valid = settings.validate();
    EXPECT_TRUE(valid) << mode << ": " << valid.error().message;
  }
}

TEST(Modes, TheLastSpeaksWhereTheDefaultIsNotAmongThem) {
  EXPECT_EQ(best_mode({"none", "triggered"}), "triggered");
  EXPECT_EQ(best_mode({default_mode(), "none"}), default_mode());
}

TEST(Modes, UnknownAndRepeatedOnesAreRefused) {
  EXPECT_THAT(choose_modes({"none", "loops"}).error().message,
              HasSubstr("'loops' is no mode, known: none, triggered, filtered, continuous, pairwise"));
  EXPECT_EQ(choose_modes({"none", "none"}).error().message, "--modes: 'none' is there twice");
}

}  // namespace
}  // namespace groundscale
