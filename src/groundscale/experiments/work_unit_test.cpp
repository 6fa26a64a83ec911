#include "groundscale/experiments/work_unit.hpp"

#include <filesystem>
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

/// Work that counts how often it is done.
class Counted : public testing::Test {
 protected:
  Result<void> complete(const std::string& key, bool anew = false) {
    return WorkUnit(unit, key).complete(anew, [this]() -> Result<void> {
      EXPECT_FALSE(fs::exists(unit)) << "work begins without leftovers";
      fs::create_directories(unit);
      ++times;
      return write_text(unit + "/result", "result");
    });
  }

  TempFolder folder;
  std::string unit = folder / "units/one";
  int times = 0;
};

TEST_F(Counted, IsDoneOnceWhileTheKeyStays) {
  EXPECT_FALSE(WorkUnit(unit, "key").done());
  ASSERT_TRUE(complete("key"));
  EXPECT_TRUE(WorkUnit(unit, "key").done());
  ASSERT_TRUE(complete("key"));
  EXPECT_EQ(times, 1);
}

TEST_F(Counted, AnotherKeyDoesItAgain) {
  ASSERT_TRUE(complete("key"));
  ASSERT_TRUE(complete("key and more"));
  EXPECT_EQ(times, 2);
  EXPECT_FALSE(WorkUnit(unit, "key").done());
}

TEST_F(Counted, IsDoneAgainWhereThatIsAskedFor) {
  ASSERT_TRUE(complete("key"));
  ASSERT_TRUE(complete("key", /*anew=*/true));
  EXPECT_EQ(times, 2);
}

TEST_F(Counted, AResultThatIsGoneIsMadeAgain) {
  ASSERT_TRUE(complete("key"));
  fs::remove_all(unit);
  ASSERT_TRUE(complete("key"));
  EXPECT_EQ(times, 2);
}

TEST_F(Counted, WorkThatFailedOrWasInterruptedIsNotDone) {
  const Result<void> failed = WorkUnit(unit, "key").complete(false, [this]() -> Result<void> {
    fs::create_directories(unit);
    return Error{ErrorCode::kIo, "disk full"};
  });
  ASSERT_FALSE(failed);
  EXPECT_EQ(failed.error().message, "disk full");
  EXPECT_FALSE(WorkUnit(unit, "key").done());
  ASSERT_TRUE(complete("key"));  // its half result is gone first
  EXPECT_EQ(times, 1);
}

TEST_F(Counted, WhatIsSomebodyElsesIsLeftAlone) {
  fs::create_directories(unit);
  ASSERT_TRUE(write_text(unit + "/precious", "kept"));
  const Result<void> refused = complete("key", /*anew=*/true);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(refused.error().message, HasSubstr("isn't from an experiment"));
  EXPECT_EQ(*read_text(unit + "/precious"), "kept");
  EXPECT_EQ(times, 0);
}

TEST(FileDigest, IsFnv1aOfTheBytes) {
  const TempFolder folder;
  // Published test vectors of FNV-1a, 64 bits.
  EXPECT_EQ(*file_digest(folder.file("empty", "")), "cbf29ce484222325");
  EXPECT_EQ(*file_digest(folder.file("a", "a")), "af63dc4c8601ec8c");
  EXPECT_EQ(*file_digest(folder.file("foobar", "foobar")), "85944171f73967e8");
  EXPECT_FALSE(file_digest(folder / "nowhere"));
}

}  // namespace
}  // namespace groundscale
