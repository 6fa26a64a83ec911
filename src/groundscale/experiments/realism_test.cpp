#include "groundscale/experiments/realism.hpp"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;

/// What is said about these options, before anything is written.
std::string refusal(const TempFolder& folder, const RealismOptions& options) {
  ExperimentRequest request;
  request.output = folder / "out";
  const auto outcome = run_realism(options, {}, request);
  EXPECT_FALSE(std::filesystem::exists(request.output));
  if (outcome) return "";
  EXPECT_EQ(outcome.error().code, ErrorCode::kBadInput);
  return outcome.error().message;
}

TEST(Realism, NeedsTheTruthOfARealDrive) {
  const TempFolder folder;
  RealismOptions options;
  options.clips = folder / "clips";
  options.drives.kitti = folder / "kitti";
  EXPECT_THAT(refusal(folder, options), HasSubstr("clips/00/poses.txt"));
}

TEST(Realism, NeedsTheWholeSequencesPoses) {
  const TempFolder folder;
  std::filesystem::create_directories(folder / "clips/00");
  folder.file("clips/00/poses.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n");
  RealismOptions options;
  options.clips = folder / "clips";
  options.drives.kitti = folder / "kitti";
  options.drives.sequences = {"00"};
  EXPECT_THAT(refusal(folder, options), HasSubstr("holds no poses/NN.txt"));
}

}  // namespace
}  // namespace groundscale
