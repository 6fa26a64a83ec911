// `run` with `scale.speed`: a speed log gives the scale where no ground is seen, end to end on a small drive made here;
// and the rows of docs/bad-input.md about it.

#include <algorithm>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/evaluation/frame_table.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kFrames = 60;
constexpr int kMaskedFrom = 6;   // where the masks end that see road,
constexpr int kUnseenFrom = 35;  // and where points of it that were seen before are left behind
constexpr double kTrueMps = 8.0;
constexpr double kAheadS = 100.0;

std::string speeds(double mps, double last_s = 7.0) {
  std::string rows = "time_s,speed_mps\n";
  for (double t = 0.0; t <= last_s; t += 1.0) rows += fmt::format("{},{}\n", t + kAheadS, mps);
  return rows;
}

/// A place beside the drive and its masks, which are made once.
class Setting {
 public:
  Setting() : shared_(shared()) {}

  std::string path(const std::string& name) const { return folder_ / name; }
  std::string write(const std::string& name, const std::string& text) const { return folder_.file(name, text); }
  std::string output(const std::string& name = "output") const { return folder_ / name; }

  ProgramRun run(const std::vector<std::string>& settings, const std::string& masks = "part",
                 const std::string& name = "output") const {
    std::vector<std::string> arguments = {"run", shared_ / "drive", "--output", output(name), "--quiet"};
    if (!masks.empty()) arguments.insert(arguments.end(), {"--road-masks", shared_ / masks});
    for (const std::string& setting : settings) arguments.insert(arguments.end(), {"--set", setting});
    return run_program(arguments);
  }
  ProgramRun with_log(const std::string& rows, const std::string& masks = "part",
                      std::vector<std::string> more = {}) const {
    more.insert(more.end(),
                {"scale.speed=" + write("speed.csv", rows), fmt::format("scale.speed_offset_s={}", kAheadS)});
    return run(more, masks);
  }
  std::string text(const std::string& name) const { return read_text(folder_ / name).value(); }
  /// A number of summary.json, by its key.
  double figure(const std::string& key) const {
    const std::string json = text("output/summary.json");
    const std::size_t at = json.find('"' + key + "\": ");
    GS_CHECK(at != std::string::npos, key);
    return std::stod(json.substr(at + key.size() + 4));
  }
  /// Length by the frames that see no road, online.
  double unseen_m() const {
    const auto rows = read_frame_table(output() + "/frames.csv").value();
    double length_m = 0.0;
    for (const FrameRow& row : rows) {
      if (row.frame >= kUnseenFrom) length_m += row.online_step_m.value();
    }
    return length_m;
  }

 private:
  static const TempFolder& shared() {
    static const TempFolder folder;
    static const bool written = [] {
      const SyntheticDrive drive;
      drive.write_kitti(folder / "drive", kFrames);
      for (const std::string masks : {"part", "none"}) {
        std::filesystem::create_directories(folder / masks);
        for (int k = 0; k < kFrames; ++k) {
          Image mask(drive.width, drive.height);
          const bool road = masks == "part" && k < kMaskedFrom;
          std::fill_n(mask.data(), drive.width * drive.height, static_cast<std::uint8_t>(road ? 255 : 0));
          GS_CHECK(write_image(folder / (masks + "/" + drive.image_name(k)), mask).has_value(), "a mask is written");
        }
      }
      return true;
    }();
    GS_CHECK(written, "the fixture can't be written");
    return folder;
  }

  const TempFolder& shared_;
  TempFolder folder_;
};

constexpr double kUnseenM = 0.1 * kTrueMps * (kFrames - kUnseenFrom);

class SpeedLogOfRun : public testing::TestWithParam<const char*> {
 protected:
  std::vector<std::string> mode() const { return {std::string("odometry.mode=") + GetParam()}; }
  Setting s;
};

TEST_P(SpeedLogOfRun, MovesTheScaleWhereNoGroundIsSeen) {
  ASSERT_EQ(s.run(mode()).status, 0);
  const double without_m = s.unseen_m();
  EXPECT_THAT(s.text("output/summary.json"), Not(HasSubstr("speed_log")));
  std::filesystem::remove_all(s.output());

  const ProgramRun run = s.with_log(speeds(1.1 * kTrueMps), "part", mode());
  ASSERT_EQ(run.status, 0) << run.err;
  // Two to five seconds of a log that is 10 % too fast; what the ground said before counts as well.
  EXPECT_GT(s.unseen_m() / without_m, 1.02);
  EXPECT_LT(s.unseen_m() / kUnseenM, 1.1);
  EXPECT_GE(s.figure("frames_scaled"), kFrames - kUnseenFrom);
  EXPECT_NEAR(s.figure("ratio_to_ground"), 1.1, 0.02);
  const auto rows = read_frame_table(s.output() + "/frames.csv").value();
  for (const FrameRow& row : rows) {
    if (row.frame >= kUnseenFrom) {
      EXPECT_THAT(row.reason, HasSubstr("road")) << row.frame;
    }
  }
}

TEST_P(SpeedLogOfRun, GivesTheScaleOfADriveWhoseGroundIsNeverSeen) {
  const ProgramRun run = s.with_log(speeds(kTrueMps), "none", mode());
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the scale is the speed log's alone"));
  // The log is exact; a step is as noisy as two views are.
  EXPECT_NEAR(s.unseen_m() / kUnseenM, 1.0, 0.03);
  EXPECT_NEAR(s.figure("length_m") / (0.1 * kTrueMps * (kFrames - 1)), 1.0, 0.03);
  EXPECT_EQ(s.figure("accepted_measurements"), 0);
}

TEST_P(SpeedLogOfRun, SpeedsInAnotherUnitAreNamedAndNotUsed) {
  ASSERT_EQ(s.run(mode()).status, 0);
  const std::string without = s.text("output/online.kitti");
  std::filesystem::remove_all(s.output());
  const ProgramRun run = s.with_log(speeds(3.6 * kTrueMps), "part", mode());
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("times those by the ground, and aren't used where they differ so much; are they in "
                                 "km/h? m/s are needed"));
  EXPECT_EQ(s.figure("frames_scaled"), 0);
  EXPECT_TRUE(s.text("output/online.kitti") == without);
}

INSTANTIATE_TEST_SUITE_P(Modes, SpeedLogOfRun, testing::Values("keyframe", "pairwise"),
                         [](const auto& mode) { return std::string(mode.param); });

TEST(SpeedLog, TheConfigurationRepeatsTheRun) {
  const Setting s;
  ASSERT_EQ(s.with_log(speeds(kTrueMps)).status, 0);
  const ProgramRun again =
      run_program({"run", "--config", s.path("output/config.yaml"), "--output", s.output("again"), "--quiet"});
  ASSERT_EQ(again.status, 0) << again.err;
  for (const char* file : {"/trajectory.kitti", "/online.kitti", "/frames.csv", "/config.yaml"}) {
    EXPECT_TRUE(s.text(std::string("output") + file) == s.text(std::string("again") + file)) << file;
  }
}

TEST(SpeedLog, AGapIsNamed) {
  const Setting s;
  std::string rows = "time_s,speed_mps\n";
  for (const double t : {0.0, 0.5, 1.0, 1.5, 2.0, 4.0, 4.5, 5.0, 5.5, 6.0}) {
    rows += fmt::format("{},{}\n", t + kAheadS, kTrueMps);
  }
  const ProgramRun run = s.with_log(rows);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the log knows nothing of 20 of 59 frames; the first of 1 gaps in the drive is from "
                                 "2.0 to 4.0 s by the video's clock"));
}

struct BadCase {
  const char* name;
  std::function<ProgramRun(const Setting&)> run;
  const char* message;
};

std::ostream& operator<<(std::ostream& stream, const BadCase& bad) { return stream << bad.name; }

class SpeedLogBadInput : public testing::TestWithParam<BadCase> {};

TEST_P(SpeedLogBadInput, IsNamedAndNothingIsWritten) {
  const Setting s;
  const ProgramRun run = GetParam().run(s);
  EXPECT_EQ(run.status, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr(GetParam().message));
  EXPECT_FALSE(std::filesystem::exists(s.output()));
}

INSTANTIATE_TEST_SUITE_P(
    All, SpeedLogBadInput,
    testing::Values(
        BadCase{"Missing", [](const Setting& s) { return s.run({"scale.speed=" + s.path("no.csv")}); },
                "no.csv: can't be opened: No such file or directory"},
        BadCase{"Word", [](const Setting& s) { return s.with_log("time_s,speed_mps\n0,fast\n"); },
                "speed_mps: 'fast' is no number"},
        BadCase{"Track", [](const Setting& s) { return s.run({"scale.speed=" + s.write("track.gpx", "words")}); },
                "track.gpx:1: isn't XML"},
        BadCase{"OfAnotherTime",
                [](const Setting& s) { return s.run({"scale.speed=" + s.write("speed.csv", speeds(kTrueMps))}); },
                "the log doesn't overlap the drive: it goes from 100.0 to 107.0 s by the video's clock, the drive from "
                "0.0 to 5.9 s (scale.speed_offset_s, by how much the log's clock is ahead, is 0)"},
        BadCase{"WithoutNoise",
                [](const Setting& s) { return s.with_log(speeds(8), "part", {"scale.speed_sd_mps=0"}); },
                "scale.speed_sd_mps: 0 is out of range"},
        BadCase{"OffsetNotANumber", [](const Setting& s) { return s.run({"scale.speed_offset_s=nan"}); },
                "scale.speed_offset_s"},
        BadCase{"Height",
                [](const Setting& s) {
                  const std::string log = s.write("speed.csv", speeds(kTrueMps));
                  return run_program({"height", s.path("drive"), "--speed", log, "--set", "scale.speed=" + log,
                                      "--output", s.output()});
                },
                "the height is found from what the ground alone says; --set scale.speed= leaves it out"}),
    [](const auto& bad) { return std::string(bad.param.name); });

}  // namespace
}  // namespace groundscale
