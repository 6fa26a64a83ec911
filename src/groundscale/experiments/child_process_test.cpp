#include "groundscale/experiments/child_process.hpp"

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

ChildCommand shell(const std::string& script) { return {.program = "/bin/sh", .arguments = {"-c", script}}; }

TEST(ChildProcess, ItsStatusAndItsOutputComeBack) {
  const TempFolder folder;
  ChildCommand command = shell("echo out; exit 3");
  command.output = folder / "out";
  const auto result = run_child(command);
  ASSERT_TRUE(result) << result.error().message;
  EXPECT_EQ(result->status, 3);
  EXPECT_EQ(*read_text(folder / "out"), "out\n");
}

TEST(ChildProcess, WorksInTheFolderItIsTold) {
  const TempFolder folder;
  ChildCommand command = shell("touch here");
  command.folder = folder.path();
  ASSERT_TRUE(run_child(command));
  EXPECT_TRUE(std::filesystem::exists(folder / "here"));
}

TEST(ChildProcess, OneThatASignalEndsIsToldFromOneThatEndsItself) {
  const auto result = run_child(shell("kill -9 $$"));
  ASSERT_TRUE(result);
  EXPECT_EQ(result->status, 128 + 9);
}

TEST(ChildProcess, ReadsNothing) {
  const auto result = run_child(shell("read word"));  // would wait for ever at a terminal
  ASSERT_TRUE(result);
  EXPECT_NE(result->status, 0);
}

TEST(ChildProcess, PeakMemoryIsThatOfTheChild) {
  // tail keeps all that it may have to print: 64 MB, in a process that needs 2 MB else.
  const auto large = run_child(shell("head -c 67108864 /dev/zero | tail -c 67108864"));
  ASSERT_TRUE(large);
  EXPECT_GT(large->peak_memory_mb, 64.0);
  EXPECT_LT(large->peak_memory_mb, 160.0);
}

TEST(ChildProcess, TimesAreThoseOfTheChild) {
  const auto result = run_child(shell("sleep 0.2"));
  ASSERT_TRUE(result);
  EXPECT_GE(result->wall_s, 0.2);
  EXPECT_LT(result->cpu_s, 0.2);  // it slept
}

TEST(ChildProcess, AProgramThatIsNotThereIsAnErrorWithTheSystemsReason) {
  const auto result = run_child({.program = "/no/such/program", .arguments = {}});
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().code, ErrorCode::kIo);
  EXPECT_THAT(result.error().message, HasSubstr("/no/such/program: can't be started: No such file"));
}

TEST(ChildProcess, AnOutputThatCanNotBeWrittenIsAnError) {
  ChildCommand command = shell("true");
  command.output = "/no/such/folder/out";
  const auto result = run_child(command);
  ASSERT_FALSE(result);
  EXPECT_THAT(result.error().message, HasSubstr("/no/such/folder/out: can't be written"));
}

TEST(ShellLine, AShellSplitsItIntoTheSameWords) {
  const TempFolder folder;
  const std::vector<std::string> words = {"printf", "%s|", "plain", "two words", "it's", "", "a$b`c\"d*", "--x=1,2"};
  ChildCommand command = shell(shell_line(words));
  command.output = folder / "out";
  ASSERT_TRUE(run_child(command));
  EXPECT_EQ(*read_text(folder / "out"), "plain|two words|it's||a$b`c\"d*|--x=1,2|");
}

TEST(ShellLine, LeavesPlainWordsAsTheyAre) {
  EXPECT_EQ(shell_line({"groundscale", "--set", "a.b=1", "two words"}), "groundscale --set a.b=1 'two words'");
}

TEST(CommandOfThisProcess, BeginsWithTheProgramsName) {
  EXPECT_THAT(command_of_this_process(), testing::StartsWith("groundscale"));
}

}  // namespace
}  // namespace groundscale
