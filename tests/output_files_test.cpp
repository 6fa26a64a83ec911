// Whether a command may write its files: a part of the program by itself.

#include <filesystem>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/temp_folder_internal.hpp"
#include "output_files.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::EndsWith;

std::string refusal(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs = {},
                    bool force = false) {
  const auto done = check_output_files(outputs, inputs, force);
  if (done) return "";
  EXPECT_EQ(done.error().code, ErrorCode::kBadInput);
  return done.error().message;
}

TEST(CheckOutputFiles, FreshOnesMayBeWritten) {
  const TempFolder folder;
  EXPECT_EQ(refusal({folder / "a.yaml", folder / "a.html"}, {"", folder / "b.yaml"}), "");
  EXPECT_EQ(refusal({"a_name_without_a_folder.yaml"}), "");
}

TEST(CheckOutputFiles, WhatExistsNeedsForceAlsoASecondFile) {
  const TempFolder folder;
  const std::string there = folder.file("a.html", "kept");
  EXPECT_EQ(refusal({folder / "a.yaml", there}), "--output " + there + ": exists; --force overwrites it");
  EXPECT_EQ(refusal({folder / "a.yaml", there}, {}, true), "");
}

TEST(CheckOutputFiles, WhatIsReadIsRefusedUnderAnyNameAndByForceToo) {
  const TempFolder folder;
  const std::string there = folder.file("a.yaml", "read");
  std::filesystem::create_directory(folder / "b");
  std::filesystem::create_symlink(there, folder / "link.yaml");
  EXPECT_THAT(refusal({folder / "b/../a.yaml"}, {there}, true), EndsWith("is read, another is needed"));
  EXPECT_THAT(refusal({folder / "link.yaml"}, {there}, true), EndsWith("is read, another is needed"));
}

TEST(CheckOutputFiles, AFolderIsNoFile) {
  const TempFolder folder;
  std::filesystem::create_directory(folder / "b");
  EXPECT_THAT(refusal({folder / "b"}, {}, true), EndsWith("is a folder, a file is needed"));
  EXPECT_THAT(refusal({folder / "nowhere/a.yaml"}), EndsWith("there is no folder " + (folder / "nowhere")));
}

}  // namespace
}  // namespace groundscale
