// `run` writes report.html, and `report` puts runs beside each other; the rows of docs/bad-input.md about it.

#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bad_input_docs.hpp"
#include "groundscale/core/check.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/report/test_markup_internal.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::occurrences;
using internal::TempFolder;
using internal::what_is_wrong;
using testing::HasSubstr;
using testing::Not;

constexpr int kFrames = 14;

/// A drive and two runs on it, made once: `keyframe` with truth and `pairwise` without; and one of another drive.
const TempFolder& runs() {
  static const TempFolder folder;
  static const bool made = [] {
    const SyntheticDrive drive;
    drive.write_kitti(folder / "drive", kFrames);
    drive.write_kitti(folder / "other drive", 6);
    folder.file("truth.txt", drive.truth(kFrames));
    const std::vector<std::vector<std::string>> commands = {
        {folder / "drive", "--output", folder / "keyframe", "--truth", folder / "truth.txt"},
        {folder / "drive", "--output", folder / "pairwise", "--set", "odometry.mode=pairwise"},
        {folder / "other drive", "--output", folder / "elsewhere", "--no-report"}};
    for (std::vector<std::string> command : commands) {
      command.insert(command.begin(), "run");
      const ProgramRun run = run_program(command);
      GS_CHECK(run.status == 0, run.err);
    }
    return true;
  }();
  GS_CHECK(made, "the runs can't be made");
  return folder;
}

std::string text(const std::string& path) {
  const auto content = read_text(path);
  EXPECT_TRUE(content) << path;
  return content ? *content : "";
}

TEST(RunReport, IsWrittenByRunWithPicturesAndTruth) {
  const std::string html = text(runs() / "keyframe/report.html");
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_EQ(occurrences(html, "src=\"data:image/jpeg;base64,/9j/"), 8);  // how every JPEG file begins
  for (const char* part : {"Trajectory from above", "class=\"curve truth\"", "<th>scale_bias</th>", "Scale of the map",
                           "Against the truth: steps are", "All lengths rest on a camera height of 1.650 m",
                           "waiting for images", "keys that differ from their defaults"}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
  EXPECT_THAT(html, Not(HasSubstr("<script")));
  EXPECT_EQ(std::distance(fs::directory_iterator(runs() / "keyframe/samples"), fs::directory_iterator()), 9);
}

TEST(RunReport, HasNoMapInPairwiseModeAndNoTruthWhereThereIsNone) {
  const std::string html = text(runs() / "pairwise/report.html");
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, Not(HasSubstr("Scale of the map")));
  EXPECT_THAT(html, Not(HasSubstr("curve truth\"")));
}

TEST(RunReport, IsLeftOutOnRequestAndChangesNothingElse) {
  EXPECT_FALSE(fs::exists(runs() / "elsewhere/report.html"));
  EXPECT_FALSE(fs::exists(runs() / "elsewhere/samples"));
  const TempFolder folder;
  const ProgramRun run = run_program({"run", runs() / "drive", "--output", folder / "run", "--no-report"});
  ASSERT_EQ(run.status, 0) << run.err;
  for (const char* file : {"/trajectory.kitti", "/online.kitti", "/frames.csv", "/config.yaml"}) {
    EXPECT_EQ(text(folder / "run" + file), text(runs() / "keyframe" + file)) << file;
  }
}

TEST(RunReport, AnEarlierReportGoesWithItsRun) {
  const TempFolder folder;
  fs::copy(runs() / "pairwise", folder / "run", fs::copy_options::recursive);
  folder.file("run/samples/999999.jpg", "an old one");
  folder.file("run/samples/mine.txt", "kept");
  const ProgramRun run =
      run_program({"run", runs() / "other drive", "--output", folder / "run", "--force", "--no-report"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_FALSE(fs::exists(folder / "run/report.html"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder / "run/samples"), fs::directory_iterator()), 1);
  EXPECT_EQ(text(folder / "run/samples/mine.txt"), "kept");
}

TEST(Report, MakesTheSamePageAgain) {
  const TempFolder folder;
  const ProgramRun run = run_program({"report", runs() / "keyframe", "--output", folder / "again.html"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_EQ(text(folder / "again.html"), text(runs() / "keyframe/report.html"));
}

TEST(Report, TakesTheTruthThatItIsTold) {
  const TempFolder folder;
  const ProgramRun run =
      run_program({"report", runs() / "pairwise", "--truth", runs() / "truth.txt", "--output", folder / "r.html"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(text(folder / "r.html"), HasSubstr("class=\"curve truth\""));
}

TEST(Report, PutsRunsOfOneDriveBesideEachOther) {
  const TempFolder folder;
  const ProgramRun run =
      run_program({"report", runs() / "keyframe", runs() / "pairwise", "--output", folder / "both.html"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string html = text(folder / "both.html");
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("<tr><th>mode</th><td>keyframe</td><td>pairwise</td></tr>"));
  EXPECT_EQ(occurrences(html, "<h2>Curves"), 1);
  EXPECT_THAT(html, Not(HasSubstr("different drives")));
  // A figure against the truth for the one that has it.
  EXPECT_THAT(html, testing::ContainsRegex("<th>scale_bias, %</th><td>[-+][0-9.]+</td><td>\u2013</td>"));
}

TEST(Report, SaysThatRunsAreOfDifferentDrives) {
  const TempFolder folder;
  const ProgramRun run =
      run_program({"report", runs() / "keyframe", runs() / "elsewhere", "--output", folder / "both.html"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string html = text(folder / "both.html");
  EXPECT_EQ(what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("These runs are of 2 different drives:"));
  EXPECT_EQ(occurrences(html, "<h2>Curves"), 2);
}

/// A row of docs/bad-input.md: what `report` is told besides --output page.html, and what it says.
struct BadRow {
  std::string name;
  std::function<std::vector<std::string>(const TempFolder&)> arguments;
  std::string message;
};
// NOLINTNEXTLINE(readability-identifier-naming): the name that GoogleTest looks for
void PrintTo(const BadRow& row, std::ostream* stream) { *stream << row.name; }

class BadReport : public testing::TestWithParam<BadRow> {};

TEST_P(BadReport, IsRefusedAndWritesNothing) {
  const TempFolder folder;
  std::vector<std::string> arguments = GetParam().arguments(folder);
  arguments.insert(arguments.begin(), "report");
  if (std::find(arguments.begin(), arguments.end(), "--output") == arguments.end()) {
    arguments.insert(arguments.end(), {"--output", folder / "page.html"});
  }
  const ProgramRun run = run_program(arguments);
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr(GetParam().message));
  EXPECT_FALSE(fs::exists(folder / "page.html"));
  expect_in_bad_input_docs(GetParam().name, 2, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    Rows, BadReport,
    testing::Values(
        BadRow{"report without a run", [](const TempFolder&) { return std::vector<std::string>{}; }, "DIR is required"},
        BadRow{"report on a folder that isn't there",
               [](const TempFolder& f) { return std::vector<std::string>{f / "none"}; }, ": no such folder"},
        BadRow{"report on a folder of no run",
               [](const TempFolder&) { return std::vector<std::string>{runs() / "drive"}; },
               ": isn't the folder of a run (there is no summary.json)"},
        BadRow{"report on a run that didn't end",
               [](const TempFolder& f) {
                 f.file("begun/online.kitti", "");
                 return std::vector<std::string>{runs() / "keyframe", f / "begun"};
               },
               ": the run in it didn't end (there is no summary.json)"},
        BadRow{"report on a run whose files are damaged",
               [](const TempFolder& f) {
                 fs::copy(runs() / "pairwise", f / "run");
                 f.file("run/summary.json", "{");
                 return std::vector<std::string>{f / "run"};
               },
               ": isn't JSON with the figures of a run"},
        BadRow{"report on files of two runs",
               [](const TempFolder& f) {
                 fs::copy(runs() / "pairwise", f / "run");
                 fs::copy(runs() / "elsewhere/frames.csv", f / "run/frames.csv", fs::copy_options::overwrite_existing);
                 return std::vector<std::string>{f / "run"};
               },
               "they are not of one run"},
        BadRow{"report on one run twice",
               [](const TempFolder&) {
                 return std::vector<std::string>{runs() / "keyframe", runs() / "pairwise/../keyframe"};
               },
               " is there twice: a run is shown once"},
        BadRow{"report with a truth that doesn't fit",
               [](const TempFolder& f) {
                 return std::vector<std::string>{runs() / "keyframe", "--truth",
                                                 f.file("short.txt", SyntheticDrive().truth(3))};
               },
               "has 3 rows (0 to 2); a row for every frame of the drive is needed, the first for frame 0"},
        BadRow{"report with one truth for two drives",
               [](const TempFolder&) {
                 return std::vector<std::string>{runs() / "keyframe", runs() / "elsewhere", "--truth",
                                                 runs() / "truth.txt"};
               },
               ": is that of one drive, but "},
        BadRow{"report that exists already, without --force",
               [](const TempFolder& f) {
                 return std::vector<std::string>{runs() / "keyframe", "--output", f.file("kept.html", "kept")};
               },
               ": exists; --force overwrites it"},
        BadRow{"report over a file of the run",
               [](const TempFolder&) {
                 return std::vector<std::string>{runs() / "keyframe", "--force", "--output",
                                                 runs() / "keyframe/frames.csv"};
               },
               ": is read, another is needed"},
        BadRow{"report into a folder that isn't there",
               [](const TempFolder& f) {
                 return std::vector<std::string>{runs() / "keyframe", "--output", f / "none/page.html"};
               },
               ": there is no folder "},
        BadRow{"report into what is a folder",
               [](const TempFolder& f) {
                 fs::create_directories(f / "folder");
                 return std::vector<std::string>{runs() / "keyframe", "--force", "--output", f / "folder"};
               },
               ": is a folder, a file is needed"},
        BadRow{"report that can't be written",
               [](const TempFolder& f) {
                 fs::create_directories(f / "page.html.part");  // where it is written before it is renamed
                 return std::vector<std::string>{runs() / "keyframe"};
               },
               ": can't be written: Is a directory"}),
    [](const testing::TestParamInfo<BadRow>& row) { return test_name_of(row.param.name); });

TEST(BadReportOutput, KeepsWhatWasThere) {
  const TempFolder folder;
  const std::string kept = folder.file("kept.html", "kept");
  EXPECT_EQ(run_program({"report", runs() / "keyframe", "--output", kept}).status, 2);
  EXPECT_EQ(text(kept), "kept");
  EXPECT_EQ(run_program({"report", runs() / "keyframe", "--output", kept, "--force"}).status, 0);
  EXPECT_THAT(text(kept), testing::StartsWith("<!DOCTYPE html>"));
}

}  // namespace
}  // namespace groundscale
