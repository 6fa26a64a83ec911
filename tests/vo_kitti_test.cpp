// groundscale experiment vo-kitti: several modes and other systems on the same drives, simulated and given.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/experiments/plot.hpp"
#include "program.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;
using testing::HasSubstr;
using testing::Not;

using Words = std::vector<std::string>;

ProgramRun vo_kitti(const std::string& output, const Words& more) {
  Words arguments = {"experiment", "vo-kitti", "--output", output};
  arguments.insert(arguments.end(), more.begin(), more.end());
  return run_program(arguments);
}

/// 0 where figures can be drawn.
int done() { return gnuplot_is_there() ? 0 : 1; }

/// One finished experiment on two routes for all tests; each works on a copy.
class VoKitti : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    original = std::make_unique<TempFolder>();
    first = vo_kitti(*original / "out", options());
  }
  static void TearDownTestSuite() { original.reset(); }
  void SetUp() override {
    ASSERT_EQ(first.status, done()) << first.err;
    fs::copy(*original / "out", output, fs::copy_options::recursive);
  }
  static Words options(const std::string& modes = "none,pairwise") {
    return {"--preset", "small", "--frames", "9", "--sequences", "straight,city", "--modes", modes};
  }
  std::string text(const std::string& name) const { return read_text(output + "/" + name).value(); }

  static inline std::unique_ptr<TempFolder> original;
  static inline ProgramRun first;
  TempFolder folder;
  std::string output = folder / "out";
};

TEST_F(VoKitti, HasARowADriveAndModeTheirMeansAndFigures) {
  const std::string table = text("vo-kitti.csv");
  for (const char* row : {"\nstraight,simulated,9,", "\ncity,simulated,9,", "\nmean of 2,,,,none,", ",pairwise,"}) {
    EXPECT_THAT(table, HasSubstr(row));
  }
  EXPECT_THAT(text("drives/city/none/config.yaml"), HasSubstr("scale_correction: none"));
  EXPECT_THAT(text("drives/city/pairwise/config.yaml"), HasSubstr("mode: pairwise"));
  for (const char* name : {"trajectory-city", "trajectory-straight"}) {
    EXPECT_TRUE(fs::exists(output + "/figures/" + name + ".csv")) << name;
    EXPECT_EQ(fs::exists(output + "/figures/" + name + ".svg"), gnuplot_is_there()) << name;
  }
  const std::string report = text("vo-kitti.md");
  EXPECT_THAT(report, HasSubstr("## Aims"));
  EXPECT_THAT(report, HasSubstr("--set odometry.mode=keyframe --set odometry.scale_correction=none"));
  EXPECT_THAT(report, Not(HasSubstr("not done yet")));
}

TEST_F(VoKitti, AnotherModeRunsWhatIsNewAndNothingElse) {
  const ProgramRun again = vo_kitti(output, options());
  EXPECT_EQ(again.status, done()) << again.err;
  EXPECT_THAT(again.err, Not(HasSubstr("running")));
  const ProgramRun more = vo_kitti(output, options("none,triggered,pairwise"));
  EXPECT_EQ(more.status, done()) << more.err;
  EXPECT_THAT(more.err, Not(HasSubstr("rendering")));
  EXPECT_THAT(more.err, HasSubstr("city: mode none\ncity: mode triggered\ncity: running\ncity: mode pairwise\n"));
}

TEST_F(VoKitti, ComparesAnotherSystemAndSaysHow) {
  // The truth itself, on one drive alone.
  fs::create_directories(folder / "orb");
  fs::copy_file(output + "/drives/city/drive/poses.txt", folder / "orb/city.txt");
  Words arguments = options();
  arguments.insert(arguments.end(),
                   {"--compare", "orb=" + (folder / "orb"), "--compare", "orb@sim3=" + (folder / "orb/{}.txt")});
  const ProgramRun compared = vo_kitti(output, arguments);
  EXPECT_EQ(compared.status, done()) << compared.err;
  EXPECT_THAT(compared.err, Not(HasSubstr("running")));
  EXPECT_THAT(compared.out, HasSubstr("| city | simulated | 9 | orb |"));
  EXPECT_THAT(compared.out, HasSubstr("| city | simulated | 9 | orb (aligned by sim3) |"));
  EXPECT_THAT(compared.out, Not(HasSubstr("| straight | simulated | 9 | orb")));
  EXPECT_THAT(compared.out, HasSubstr("| mean of 1 |"));
  EXPECT_THAT(text("vo-kitti.md"), HasSubstr("- orb: no trajectory of straight"));
  EXPECT_THAT(text("figures/trajectory-city.csv"), HasSubstr(",orb_x_m,orb_z_m,orb__aligned_by_sim3__x_m,"));
}

TEST_F(VoKitti, TakesDrivesThatAreThereAndRepeatsThemWithOtherSeeds) {
  fs::create_directories(folder / "clips");
  fs::copy(output + "/drives/city/drive", folder / "clips/city", fs::copy_options::recursive);
  const ProgramRun clips = vo_kitti(folder / "more", {"--clips", folder / "clips", "--modes", "none", "--seeds", "2"});
  EXPECT_EQ(clips.status, done()) << clips.err;
  EXPECT_THAT(clips.err, Not(HasSubstr("rendering")));
  EXPECT_FALSE(fs::exists(folder / "more/drives/city/drive"));
  // The same images and settings: the same trajectory, wherever they lie.
  EXPECT_EQ(*read_text(folder / "more/drives/city/none/trajectory.kitti"), text("drives/city/none/trajectory.kitti"));
  const std::string report = *read_text(folder / "more/vo-kitti.md");
  EXPECT_THAT(report, HasSubstr("## Seeds: `none` on city"));
  EXPECT_THAT(report, HasSubstr("the same seed a second time gives the same bytes"));
  EXPECT_TRUE(fs::exists(folder / "more/seeds.csv"));
}

TEST(VoKittiDistortion, IsRenderedAndNotBelieved) {
  const TempFolder folder;
  const ProgramRun bent = vo_kitti(folder / "out", {"--preset", "small", "--frames", "5", "--sequences", "straight",
                                                    "--modes", "none", "--distortion", "0.02"});
  EXPECT_EQ(bent.status, done()) << bent.err;
  EXPECT_THAT(*read_text(folder / "out/drives/straight/drive/camera.yaml"), HasSubstr("k1: 0.02"));
  const std::string config = *read_text(folder / "out/drives/straight/none/config.yaml");
  EXPECT_THAT(config, HasSubstr("cameras/believed.yaml"));
  EXPECT_THAT(*read_text(folder / "out/cameras/believed.yaml"), Not(HasSubstr("0.02")));
  EXPECT_THAT(*read_text(folder / "out/vo-kitti.md"), HasSubstr("`triggered` corrects at least once"));
}

}  // namespace
}  // namespace groundscale
