#include "groundscale/experiments/experiment.hpp"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

ExperimentRequest into(const std::string& folder) {
  ExperimentRequest request;
  request.output = folder;
  request.program = "/bin/sh";
  return request;
}

TEST(ExperimentFolder, ANewOneAnEmptyOneAndItsOwnMayBeUsed) {
  const TempFolder folder;
  EXPECT_TRUE(check_experiment_folder("drives", into(folder / "new")));
  EXPECT_FALSE(std::filesystem::exists(folder / "new")) << "a check writes nothing";
  EXPECT_TRUE(check_experiment_folder("drives", into(folder.path())));
  ASSERT_TRUE(claim_experiment_folder("drives", into(folder / "new")));
  EXPECT_TRUE(check_experiment_folder("drives", into(folder / "new")));
}

TEST(ExperimentFolder, OneOfAnotherExperimentIsNamed) {
  const TempFolder folder;
  ASSERT_TRUE(claim_experiment_folder("timing", into(folder.path())));
  const auto refused = check_experiment_folder("drives", into(folder.path()));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(refused.error().message, HasSubstr("holds the experiment 'timing'; --force overwrites it"));
  ExperimentRequest forced = into(folder.path());
  forced.force = true;
  EXPECT_TRUE(check_experiment_folder("drives", forced));
}

TEST(ExperimentFolder, OneThatHoldsSomethingElseNeedsForce) {
  const TempFolder folder;
  folder.file("experiment.txt", "words of somebody's own");
  const auto refused = check_experiment_folder("drives", into(folder.path()));
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().message, HasSubstr("exists and isn't empty; --force overwrites it"));
}

TEST(ExperimentFolder, IsForOneAtATime) {
  const TempFolder folder;
  {
    const auto lock = claim_experiment_folder("drives", into(folder.path()));
    ASSERT_TRUE(lock);
    const auto second = claim_experiment_folder("drives", into(folder.path()));
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().code, ErrorCode::kBadInput);
    EXPECT_THAT(second.error().message, HasSubstr("another experiment is at work there"));
  }
  EXPECT_TRUE(claim_experiment_folder("drives", into(folder.path())));
}

TEST(ExperimentFolder, OneThatCanNotBeMadeIsBadInput) {
  const TempFolder folder;
  const auto refused = claim_experiment_folder("drives", into(folder.file("file", "") + "/below"));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
}

TEST(Step, OneThatFailsIsAnErrorThatNamesTheCommand) {
  const auto failed = run_step(into(""), {"-c", "exit 4"});
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().code, ErrorCode::kIo);
  EXPECT_EQ(failed.error().message, "status 4 of: groundscale -c 'exit 4'");
  EXPECT_TRUE(run_step(into(""), {"-c", "exit 0"}));
}

TEST(ProcessorName, SaysHowManyThereAre) { EXPECT_THAT(processor_name(), HasSubstr("processors)")); }

}  // namespace
}  // namespace groundscale
