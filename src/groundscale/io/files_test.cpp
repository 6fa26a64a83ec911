#include "groundscale/io/files.hpp"

#include <filesystem>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/file_size_limit_internal.hpp"
#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::FileSizeLimit;
using internal::TempFolder;
using testing::HasSubstr;

TEST(Files, TextReadsBackByteForByteAndNothingLiesBeside) {
  const TempFolder folder;
  const std::string text("a\0b\r\n\xFF", 6);
  ASSERT_TRUE(write_text(folder / "text", text));
  const Result<std::string> back = read_text(folder / "text");
  ASSERT_TRUE(back);
  EXPECT_EQ(*back, text);
  int files = 0;
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder.path())) ++files;
  EXPECT_EQ(files, 1);
}

TEST(Files, AFolderIsNoTextFile) {
  const TempFolder folder;
  const Result<std::string> text = read_text(folder.path());
  ASSERT_FALSE(text);
  EXPECT_EQ(text.error().code, ErrorCode::kBadInput);
  EXPECT_THAT(text.error().message, HasSubstr("is a folder"));
}

TEST(Files, WhereNothingCanBeWrittenTheErrorIsKIoWithTheSystemsReason) {
  const Result<void> written = write_text("/no/such/folder/file", "text");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kIo);
  EXPECT_EQ(written.error().message, "/no/such/folder/file: can't be written: No such file or directory");
  const Result<LineWriter> writer = LineWriter::create("/no/such/folder/file");
  ASSERT_FALSE(writer);
  EXPECT_EQ(writer.error().code, ErrorCode::kIo);
}

TEST(Files, AFullDiskLeavesTheOldFileAsItWas) {
  const TempFolder folder;
  ASSERT_TRUE(write_text(folder / "text", "old"));
  {
    const FileSizeLimit limit(1000);
    const Result<void> written = write_text(folder / "text", std::string(100'000, 'x'));
    ASSERT_FALSE(written);
    EXPECT_EQ(written.error().message, folder / "text" + ": can't be written: File too large");
  }
  EXPECT_EQ(*read_text(folder / "text"), "old");
  EXPECT_FALSE(std::filesystem::exists(folder / "text.part"));
}

TEST(LineWriter, LinesAreThereAsSoonAsTheyAreWritten) {
  const TempFolder folder;
  Result<LineWriter> writer = LineWriter::create(folder / "lines");
  ASSERT_TRUE(writer);
  ASSERT_TRUE(writer->write("one"));
  EXPECT_EQ(*read_text(folder / "lines"), "one\n");
  ASSERT_TRUE(writer->write("two"));
  EXPECT_EQ(*read_text(folder / "lines"), "one\ntwo\n");
}

TEST(LineWriter, AFullDiskIsReportedAtOnceAndLeavesWholeLines) {
  const TempFolder folder;
  Result<LineWriter> writer = LineWriter::create(folder / "lines");
  ASSERT_TRUE(writer);
  int written = 0;
  {
    const FileSizeLimit limit(105);
    while (written < 20 && writer->write("123456789")) ++written;
  }
  EXPECT_EQ(written, 10);
  const std::string text = *read_text(folder / "lines");
  EXPECT_EQ(text.size(), 100U);
  EXPECT_EQ(text.substr(90), "123456789\n");
}

TEST(LineWriter, TheDeviceThatIsAlwaysFullSaysSo) {
  Result<LineWriter> writer = LineWriter::create("/dev/full");
  ASSERT_TRUE(writer);
  const Result<void> written = writer->write("line");
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().message, "/dev/full: can't be written: No space left on device");
}

}  // namespace
}  // namespace groundscale
