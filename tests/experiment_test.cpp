// groundscale experiment: what it writes, that it goes on where it was, and what it refuses.

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <memory>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/plot.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/report/test_markup_internal.hpp"
#include "program.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

using Words = std::vector<std::string>;

ProgramRun drives(const std::string& output, const Words& more = {}) {
  Words arguments = {"experiment", "drives",   "--output", output,        "--preset",
                     "small",      "--frames", "7",        "--sequences", "straight,city"};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

/// Columns of a CSV file without quotes, by their names.
std::map<std::string, Words> columns_of(const std::string& path) {
  std::istringstream lines(*read_text(path));
  std::map<std::string, Words> columns;
  Words names;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream cells(line);
    const bool heading = names.empty();
    std::size_t k = 0;
    for (std::string cell; std::getline(cells, cell, ','); ++k) {
      if (heading) names.push_back(cell);
      if (!heading) columns[names.at(k)].push_back(cell);
    }
  }
  return columns;
}

double median_of(const Words& words) {
  std::vector<double> values;
  for (const std::string& word : words) {
    if (!word.empty()) values.push_back(std::stod(word));
  }
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// One finished experiment for all tests; each works on a copy.
class DrivesExperiment : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    original = std::make_unique<TempFolder>();
    first = drives(*original / "out");
  }
  static void TearDownTestSuite() { original.reset(); }
  void SetUp() override {
    ASSERT_EQ(first.status, gnuplot_is_there() ? 0 : 1) << first.err;
    fs::copy(*original / "out", output, fs::copy_options::recursive);
  }
  std::string text(const std::string& name) const { return read_text(output + "/" + name).value(); }
  void write(const std::string& name, const std::string& content) const {
    ASSERT_TRUE(write_text(output + "/" + name, content));
  }

  static inline std::unique_ptr<TempFolder> original;
  static inline ProgramRun first;
  TempFolder folder;
  std::string output = folder / "out";
};

TEST_F(DrivesExperiment, WritesTableReportFiguresAndEachCommand) {
  const auto columns = columns_of(output + "/drives.csv");
  EXPECT_THAT(columns.at("drive"), testing::ElementsAre("straight", "city"));
  EXPECT_THAT(columns.at("frames"), testing::ElementsAre("7", "7"));
  for (const char* name : {"length_m", "raw_scale_bias", "raw_scale_spread", "scale_bias", "scale_spread",
                           "raw_scale_bias_straight", "coverage", "median_ms", "peak_memory_mb"}) {
    for (const std::string& cell : columns.at(name)) EXPECT_NO_THROW(std::ignore = std::stod(cell)) << name;
  }
  const std::string report = text("drives.md");
  EXPECT_THAT(report, HasSubstr("groundscale experiment drives --output "));
  EXPECT_THAT(report, HasSubstr("groundscale simulate --output "));
  EXPECT_THAT(report, HasSubstr("drives/city/run --truth "));
  EXPECT_THAT(report, HasSubstr("| mean |"));
  EXPECT_THAT(first.out, HasSubstr("| city | 7 |"));
  for (const char* name : {"trajectory-city", "scale-city", "trajectory-straight", "scale-straight"}) {
    EXPECT_TRUE(fs::exists(output + "/figures/" + name + ".gp")) << name;
    EXPECT_TRUE(fs::exists(output + "/figures/" + name + ".csv")) << name;
    if (!gnuplot_is_there()) continue;
    EXPECT_TRUE(fs::exists(output + "/figures/" + name + ".svg")) << name;
    EXPECT_TRUE(fs::exists(output + "/figures/" + name + ".png")) << name;
  }
}

TEST_F(DrivesExperiment, ReportIsAPageToo) {
  const std::string html = text("report.html");
  EXPECT_EQ(internal::what_is_wrong(html), "");
  EXPECT_THAT(html, HasSubstr("<h1>Experiment drives: "));
  EXPECT_THAT(html, HasSubstr("<td class=\"text\">city</td><td>7</td>"));
  EXPECT_THAT(html, HasSubstr("<pre>groundscale experiment drives --output "));
  if (gnuplot_is_there()) {
    EXPECT_EQ(internal::occurrences(html, "src=\"data:image/svg+xml;base64,"), 4);
    EXPECT_THAT(html, Not(HasSubstr("Not there:")));
  }
  // Each run has its own.
  EXPECT_EQ(internal::what_is_wrong(text("drives/city/run/report.html")), "");
}

TEST_F(DrivesExperiment, FiguresOfScaleAreThoseOfTheSteps) {
  const auto steps = columns_of(output + "/figures/scale-straight.csv");
  const auto figures = columns_of(output + "/drives.csv");
  // Rounding of both files alone lies between them.
  EXPECT_NEAR(100.0 * (median_of(steps.at("raw_straight")) - 1.0), std::stod(figures.at("raw_scale_bias")[0]), 1e-9);
  EXPECT_NEAR(100.0 * (median_of(steps.at("final")) - 1.0), std::stod(figures.at("scale_bias")[0]), 1e-9);
}

TEST_F(DrivesExperiment, ResumedDoesNothingAgainAndWritesTheSameBytes) {
  write("drives/city/run/online.tum", "marked");
  write("drives/city/drive/image_0/000003.png", "marked");
  const std::string table = text("drives.csv");
  const ProgramRun again = drives(output);
  EXPECT_EQ(again.status, first.status) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("rendering")));
  EXPECT_THAT(again.err, Not(HasSubstr("running")));
  EXPECT_EQ(text("drives/city/run/online.tum"), "marked");
  EXPECT_EQ(text("drives/city/drive/image_0/000003.png"), "marked");
  EXPECT_EQ(text("drives.csv"), table);
  const std::string report = text("drives.md");
  ASSERT_EQ(drives(output).status, first.status);
  EXPECT_EQ(text("drives.md"), report);
}

TEST_F(DrivesExperiment, AnotherSettingRunsAgainOnTheSameDrives) {
  const std::string before = text("drives/city/run/frames.csv");
  const ProgramRun changed = drives(output, {"--set", "road.region.far_m=15"});
  EXPECT_EQ(changed.status, first.status) << changed.err;
  EXPECT_THAT(changed.err, Not(HasSubstr("rendering")));
  EXPECT_THAT(changed.err, HasSubstr("straight: running"));
  EXPECT_THAT(changed.err, HasSubstr("city: running"));
  EXPECT_NE(text("drives/city/run/frames.csv"), before);
}

TEST_F(DrivesExperiment, WhatWasInterruptedIsDoneAgainTheRestIsNot) {
  std::string key = text("drives/city/run.key");
  ASSERT_TRUE(key.starts_with("done\n"));
  write("drives/city/run.key", "begun\n" + key.substr(5));
  fs::remove(output + "/drives/city/run/summary.json");
  const ProgramRun again = drives(output);
  EXPECT_EQ(again.status, first.status) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("straight: running")));
  EXPECT_THAT(again.err, HasSubstr("city: running"));
  EXPECT_TRUE(fs::exists(output + "/drives/city/run/summary.json"));
}

TEST_F(DrivesExperiment, ADriveThatFailsLeavesTheOthersAlone) {
  write("drives/city/drive/image_0/000000.png", "no image");
  const ProgramRun failed = drives(output, {"--set", "road.region.far_m=15"});
  EXPECT_EQ(failed.status, 1);
  EXPECT_THAT(failed.err, HasSubstr("can't be decoded as an image"));  // what the step itself says
  EXPECT_THAT(failed.err, HasSubstr("groundscale: drive city: status 2 of: groundscale run "));
  EXPECT_THAT(text("drives.csv"), HasSubstr("straight,7"));
  EXPECT_THAT(text("drives.csv"), Not(HasSubstr("city")));
  EXPECT_THAT(text("drives.md"), HasSubstr("**Not complete:**"));
}

TEST_F(DrivesExperiment, AFolderThatIsNotItsOwnIsLeftAlone) {
  fs::remove(output + "/drives/city/drive.key");
  const ProgramRun refused = drives(output);
  EXPECT_EQ(refused.status, 1);
  EXPECT_THAT(refused.err, HasSubstr("isn't from an experiment"));
  EXPECT_TRUE(fs::exists(output + "/drives/city/drive/image_0/000006.png"));
}

TEST_F(DrivesExperiment, WithoutGnuplotThereIsEverythingElseAndTheFiguresComeLater) {
  fs::remove_all(output + "/figures");
  const std::string path = std::getenv("PATH");
  setenv("PATH", "/nonexistent", 1);
  const ProgramRun without = drives(output);
  setenv("PATH", path.c_str(), 1);
  EXPECT_EQ(without.status, 1);
  EXPECT_THAT(without.err, HasSubstr("gnuplot can't be run"));
  EXPECT_THAT(without.err, HasSubstr("gnuplot-nox"));
  EXPECT_TRUE(fs::exists(output + "/figures/scale-city.csv"));
  EXPECT_FALSE(fs::exists(output + "/figures/scale-city.svg"));
  for (const char* report : {"drives.md", "report.html"}) EXPECT_THAT(text(report), HasSubstr("not drawn"));
  if (!gnuplot_is_there()) return;
  const ProgramRun with = drives(output);
  EXPECT_EQ(with.status, 0) << with.err;
  EXPECT_THAT(with.err, Not(HasSubstr("running")));
  EXPECT_TRUE(fs::exists(output + "/figures/scale-city.svg"));
}

TEST(Experiment, ListNamesAll) {
  const ProgramRun list = run_program({"experiment", "--list"});
  EXPECT_EQ(list.status, 0);
  EXPECT_THAT(list.out, HasSubstr("drives "));
  EXPECT_THAT(list.err, IsEmpty());
}

TEST(Experiment, RefusesAnOptionThatItDoesNotHave) {
  const TempFolder folder;
  for (const char* name : {"drives", "realism", "vo-kitti", "campus", "calibration", "scale-kitti", "synthetic",
                           "contamination", "timing", "matching"}) {
    const ProgramRun refused = run_program({"experiment", name, "--output", folder / "out", "--clips", folder / "none",
                                            "--kitti", folder / "none", "--trails", "3"});
    EXPECT_EQ(refused.status, 2) << name;
    EXPECT_THAT(refused.err, HasSubstr("--trails")) << name;
    EXPECT_FALSE(fs::exists(folder / "out")) << name;
  }
}

/// Wrong use, in a row of docs/bad-input.md.
struct Refused {
  std::string name;
  Words arguments;  ///< "OUT" stands for the output folder, "FOLDER" for the one around it.
  std::string message;
};

std::ostream& operator<<(std::ostream& stream, const Refused& row) { return stream << row.name; }

class ExperimentRefuses : public testing::TestWithParam<Refused> {};

TEST_P(ExperimentRefuses, WithAMessageAndWritesNothing) {
  const TempFolder folder;
  folder.file("own/words.txt", "precious");
  folder.file("other/experiment.txt", "groundscale experiment timing\n");
  folder.file("kitti/poses/00.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n");
  folder.file("kitti/poses/07.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0 0 1 0 0 0 0 1 1\n1 0 0 0 0 1 0 0 0 0 1 2\n");
  folder.file("tum/00.txt", "0 0 0 0 0 0 0 1\n1 0 0 1 0 0 0 1\n");
  folder.file("images/notes.txt", "");
  ASSERT_TRUE(write_image(folder / "images/000000.png", Image(60, 40)));
  Words arguments = {"experiment"};
  for (std::string word : GetParam().arguments) {
    const std::size_t at = word.find("FOLDER");
    if (at != std::string::npos) word.replace(at, std::string("FOLDER").size(), folder.path());
    arguments.push_back(word == "OUT" ? folder / "out" : word);
  }
  const ProgramRun refused = run_program(arguments);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr(GetParam().message));
  EXPECT_THAT(refused.out, IsEmpty());
  EXPECT_FALSE(fs::exists(folder / "out"));
  EXPECT_FALSE(fs::exists(folder / "own/experiment.txt"));
  EXPECT_EQ(*read_text(folder / "own/words.txt"), "precious");
}

INSTANTIATE_TEST_SUITE_P(
    Rows, ExperimentRefuses,
    testing::ValuesIn(std::vector<Refused>{
        {"unknown experiment", {"circles", "--output", "OUT"}, "'circles' is no experiment, known:\ndrives "},
        {"no experiment", {}, "the name of an experiment is missing, known:\ndrives "},
        {"no output", {"drives"}, "--output is required"},
        {"unknown route", {"drives", "--output", "OUT", "--sequences", "circle"}, "'circle' is no route, known: city"},
        {"unknown sequence",
         {"drives", "--output", "OUT", "--kitti", "FOLDER/kitti", "--sequences", "42"},
         "there are: 00, 07"},
        {"default sequence missing",
         {"drives", "--output", "OUT", "--kitti", "FOLDER/kitti"},
         "'06' is no sequence of"},
        {"no poses", {"drives", "--output", "OUT", "--kitti", "FOLDER/own"}, "holds no poses/NN.txt"},
        {"sequence twice", {"drives", "--output", "OUT", "--sequences", "city,city:5"}, "'city' is there twice"},
        {"no number of frames",
         {"drives", "--output", "OUT", "--sequences", "city:few"},
         "after ':' there must be a number of frames, at least 2"},
        {"unknown preset", {"drives", "--output", "OUT", "--preset", "large"}, "'large' is no preset, known: kitti"},
        {"unknown key",
         {"drives", "--output", "OUT", "--set", "ground.metod=sparse"},
         "ground.metod: unknown key, the nearest is 'ground.method'"},
        {"output of one's own", {"drives", "--output", "FOLDER/own"}, "exists and isn't empty; --force overwrites it"},
        {"output of another experiment",
         {"drives", "--output", "FOLDER/other"},
         "holds the experiment 'timing'; --force overwrites it"},
        {"unknown mode",
         {"vo-kitti", "--output", "OUT", "--modes", "none,loops"},
         "--modes: 'loops' is no mode, known: none, triggered, filtered, continuous, pairwise"},
        {"clips and kitti",
         {"vo-kitti", "--output", "OUT", "--clips", "FOLDER/own", "--kitti", "FOLDER/kitti"},
         "--clips and --kitti can't both be given"},
        {"clips and kitti, other experiment",
         {"timing", "--output", "OUT", "--clips", "FOLDER/own", "--kitti", "FOLDER/kitti"},
         "--clips and --kitti can't both be given"},
        {"no clips", {"vo-kitti", "--output", "OUT", "--clips", "FOLDER/own"}, "holds no NN/image_0"},
        {"compare without poses",
         {"vo-kitti", "--output", "OUT", "--compare", "orb"},
         "--compare 'orb': must be NAME=POSES or NAME@sim3=POSES"},
        {"compare with another alignment",
         {"vo-kitti", "--output", "OUT", "--compare", "orb@se3=x"},
         "--compare 'orb@se3=x': the name may end in @sim3 and has no other '@'"},
        {"compare under a mode's name",
         {"vo-kitti", "--output", "OUT", "--compare", "filtered=x"},
         "'filtered' has a meaning here, another name is needed"},
        {"compare twice",
         {"vo-kitti", "--output", "OUT", "--compare", "orb=x", "--compare", "orb=y"},
         "--compare: 'orb' is there twice"},
        {"compare one file with several drives",
         {"vo-kitti", "--output", "OUT", "--kitti", "FOLDER/kitti", "--sequences", "all", "--compare", "orb=x.txt"},
         "x.txt is one file, but there are 2 drives"},
        {"compare with nothing",
         {"vo-kitti", "--output", "OUT", "--kitti", "FOLDER/kitti", "--sequences", "00", "--compare", "orb=/{}"},
         "holds nothing for any drive, 00.txt for example"},
        {"compare too few rows",
         {"vo-kitti", "--output", "OUT", "--sequences", "city", "--compare", "orb=FOLDER/kitti/poses/00.txt"},
         "2 rows, but the drive has "},
        {"compare TUM rows",
         {"vo-kitti", "--output", "OUT", "--kitti", "FOLDER/kitti", "--sequences", "00", "--compare", "orb=FOLDER/tum"},
         "has TUM rows; KITTI rows (12 numbers, row i is frame i) are needed"},
        {"distortion of a fisheye",
         {"vo-kitti", "--output", "OUT", "--preset", "campus", "--distortion", "0.01"},
         "--distortion: the camera of preset 'campus' is no pinhole"},
        {"unknown method",
         {"synthetic", "--output", "OUT", "--methods", "sparse,divining"},
         "--methods: \"divining\" is no method, known: sparse"},
        {"method twice",
         {"synthetic", "--output", "OUT", "--methods", "sparse,sparse"},
         "--methods: \"sparse\" is named twice"},
        {"method that needs images",
         {"synthetic", "--output", "OUT", "--methods", "sparse,dense"},
         "--methods: \"dense\" needs images, made-up matches have none; those that don't: sparse, "},
        {"region out of the image",
         {"synthetic", "--output", "OUT", "--region", "5000,10,6000,10,6000,90"},
         "--region: no pixel of the image (1241 x 376) lies in it"},
        {"region of two corners",
         {"synthetic", "--output", "OUT", "--region", "10,10,60,10"},
         "--region: x,y of three corners at least are needed"},
        {"source that is not there",
         {"synthetic", "--output", "OUT", "--source", "FOLDER/nowhere"},
         "nowhere: no such folder or file"},
        {"source without camera",
         {"synthetic", "--output", "OUT", "--source", "FOLDER/images"},
         "no calibration: neither camera.yaml nor calib.txt lies there"},
    }),
    [](const auto& row) {
      std::string name = row.param.name;
      std::erase_if(name, [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; });
      return name;
    });

}  // namespace
}  // namespace groundscale
