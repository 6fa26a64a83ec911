// `scale`: several ways to measure the ground on the same matches.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bad_input_docs.hpp"
#include "groundscale/evaluation/evaluate.hpp"
#include "groundscale/evaluation/pairing.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/report/test_markup_internal.hpp"
#include "groundscale/road/ground_methods.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

constexpr int kFrames = 8;

TEST(Scale, MeasuresByEveryMethodAndComparesThemWithTheTruth) {
  const internal::TempFolder folder;
  const SyntheticDrive drive;
  drive.write_kitti(folder / "drive", kFrames);
  const std::string truth = folder.file("truth.txt", drive.truth(kFrames));
  const ProgramRun run = run_program({"scale", folder / "drive", "--output", folder / "output", "--truth", truth});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string csv = read_text(folder / "output/methods.csv").value();
  for (const PlaneMethod& method : ground_methods()) {
    const std::string name(method.name);
    EXPECT_THAT(run.out, HasSubstr(name + "\n  measured")) << name;
    EXPECT_THAT(csv, HasSubstr("1," + name + ",")) << name;
    // What each has made of the drive is a run's folder.
    const ProgramRun evaluation = run_program({"evaluate", folder / ("output/" + name), "--truth", truth});
    EXPECT_EQ(evaluation.status, 0) << evaluation.err;
  }
  EXPECT_THAT(run.out, HasSubstr("step / true step - 1"));
}

/// Steps, bias, spread and 95th percentile as the page has them.
std::string cells(const std::string& name, const std::optional<ScaleErrors>& errors) {
  if (!errors) return "<th>" + name + "</th><td>0</td>";
  return fmt::format("<th>{}</th><td>{}</td><td>{:+.2f}</td><td>{:.2f}</td><td>{:.2f}</td>", name, errors->steps,
                     100.0 * errors->bias, 100.0 * errors->spread, 100.0 * errors->p95);
}

TEST(Scale, ItsPageHasTheFiguresOfEvaluate) {
  const internal::TempFolder folder;
  const SyntheticDrive drive;
  drive.write_kitti(folder / "drive", kFrames);
  const std::string truth = folder.file("truth.txt", drive.truth(kFrames));
  const ProgramRun run = run_program({"scale", folder / "drive", "--output", folder / "output", "--truth", truth,
                                      "--methods", "sparse,triangulation,dense"});
  ASSERT_EQ(run.status, 0) << run.err;
  const std::string html = read_text(folder / "output/report.html").value();
  EXPECT_EQ(internal::what_is_wrong(html), "");
  for (const std::string name : {"sparse", "triangulation", "dense"}) {
    const auto paired = pair_drive({.estimate = folder / ("output/" + name), .truth = truth});
    ASSERT_TRUE(paired) << paired.error().message;
    const auto evaluation = evaluate(*paired, kitti_lengths_m());
    ASSERT_TRUE(evaluation) << evaluation.error().message;
    EXPECT_THAT(html, HasSubstr(cells(name, evaluation->raw_scale->all)));
    EXPECT_THAT(html, HasSubstr(cells(name, evaluation->online_scale->all)));
    EXPECT_THAT(html, HasSubstr(fmt::format("<a href=\"{0}/report.html\">{0}</a>", name)));
    EXPECT_TRUE(std::filesystem::exists(folder / ("output/" + name + "/report.html")));
  }
  for (const char* part : {"Nearest to the truth: ", "</svg>roll</li>", "<h2>Configuration</h2>", "tracking</text>",
                           "among the worst: step "}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST(Scale, WithForceTakesAwayTheMethodsOfAnEarlierOneAndNothingElse) {
  const internal::TempFolder folder;
  SyntheticDrive{}.write_kitti(folder / "drive", 4);
  const auto scale = [&](const std::string& methods) {
    return run_program({"scale", folder / "drive", "--output", folder / "output", "--force", "--methods", methods});
  };
  ASSERT_EQ(scale("sparse,triangulation,decomposition").status, 0);
  folder.file("output/decomposition/mine.txt", "kept");
  folder.file("output/dense/mine.txt", "a method's name, but no run");
  folder.file("output/notes/summary.json", "no method's name");
  const ProgramRun run = scale("sparse");
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(read_text(folder / "output/methods.csv").value(), testing::Not(HasSubstr("triangulation")));
  EXPECT_TRUE(std::filesystem::exists(folder / "output/sparse/summary.json"));
  EXPECT_FALSE(std::filesystem::exists(folder / "output/triangulation"));
  std::vector<std::string> left;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "output/decomposition")) {
    left.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(left, testing::ElementsAre("mine.txt"));
  EXPECT_TRUE(std::filesystem::exists(folder / "output/dense/mine.txt"));
  EXPECT_TRUE(std::filesystem::exists(folder / "output/notes/summary.json"));
}

TEST(Scale, TakesOnlyTheMethodsThatAreNamed) {
  const internal::TempFolder folder;
  const SyntheticDrive drive;
  drive.write_kitti(folder / "drive", 4);
  const ProgramRun run = run_program({"scale", folder / "drive", "--output", folder / "output", "--methods", "sparse"});
  ASSERT_EQ(run.status, 0) << run.err;
  int folders = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder / "output")) folders += entry.is_directory();
  EXPECT_EQ(folders, 2);  // its run, and sample frames
  EXPECT_EQ(run.out.find("step / true"), std::string::npos);
}

struct Refusal {
  std::string name;
  std::string message;
  std::vector<std::string> arguments;
};

class ScaleRefuses : public testing::TestWithParam<Refusal> {};

TEST_P(ScaleRefuses, WithTwoAndWritesNothing) {
  const internal::TempFolder folder;
  SyntheticDrive{}.write_kitti(folder / "drive", 3);
  std::vector<std::string> arguments = {"scale", folder / "drive", "--output", folder / "output"};
  arguments.insert(arguments.end(), GetParam().arguments.begin(), GetParam().arguments.end());
  const ProgramRun run = run_program(arguments);
  EXPECT_EQ(run.status, 2);
  EXPECT_THAT(run.err, HasSubstr(GetParam().message));
  EXPECT_FALSE(std::filesystem::exists(folder / "output"));
  expect_in_bad_input_docs(GetParam().name, 2, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(
    BadInput, ScaleRefuses,
    testing::Values(Refusal{"unknown method", "\"spares\" is no method, known: sparse", {"--methods", "sparse,spares"}},
                    Refusal{"method named twice", "\"sparse\" is named twice", {"--methods", "sparse,sparse"}},
                    Refusal{"region with no pixels in the image",
                            "no road is in view: road.region.polygon_px lies outside the image",
                            {"--set", "road.region.polygon_px=[2000, 100, 2100, 100, 2100, 200]"}}),
    [](const auto& refusal) { return test_name_of(refusal.param.name); });

}  // namespace
}  // namespace groundscale
