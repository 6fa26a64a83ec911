// `height`: the camera's height from a speed log, a GPX track or a distance, end to end on a small drive made here; and
// the rows of docs/bad-input.md about it.

#include <cmath>
#include <filesystem>
#include <functional>
#include <numbers>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bad_input_docs.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kFrames = 64;
constexpr double kFrameS = 0.25;
constexpr double kLastS = kFrameS * (kFrames - 1);
constexpr double kClockAheadS = 3.0;

/// Between 2.2 and 4 m/s, twice up and down.
double speed_mps(double time_s) { return 3.1 + 0.9 * std::sin(0.8 * time_s); }
double travelled_m(double time_s) { return 3.1 * time_s - 0.9 / 0.8 * (std::cos(0.8 * time_s) - 1.0); }

std::string speeds(double factor = 1.0, double ahead_s = kClockAheadS) {
  std::string rows = "time_s,speed_mps\n";
  for (double t = 0.0; t <= kLastS; t += 0.5) rows += fmt::format("{},{}\n", t + ahead_s, factor * speed_mps(t));
  return rows;
}

/// The same way northwards at 49 degrees, where a degree is 111 209.7 m long.
std::string track() {
  std::string points;
  for (double t = 0.0; t <= kLastS; t += 0.5) {
    points += fmt::format("<trkpt lat=\"{:.9f}\" lon=\"8.4\"><time>2026-05-01T12:34:{:06.3f}Z</time></trkpt>\n",
                          49.0 + travelled_m(t) / 111209.7, t + 10.0);
  }
  return "<gpx version=\"1.1\"><trk><trkseg>\n" + points + "</trkseg></trk></gpx>\n";
}

/// A fresh place beside the drive, which is made once.
class Setting {
 public:
  std::string drive() const { return whole_drive(); }
  std::string output() const { return folder_ / "found.yaml"; }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string write(const std::string& name, const std::string& text) const { return folder_.file(name, text); }
  ProgramRun height(std::vector<std::string> more) const {
    std::vector<std::string> arguments = {"height", drive(), "--output", output(), "--quiet"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }
  ProgramRun with_speeds(const std::string& text, std::vector<std::string> more = {}) const {
    more.insert(more.end(), {"--speed", write("speed.csv", text)});
    return height(std::move(more));
  }
  ProgramRun with_track(const std::string& text) const { return height({"--gpx", write("track.gpx", text)}); }

 private:
  static std::string whole_drive() {
    static const TempFolder folder;
    static const bool written = [] {
      const SyntheticDrive drive;
      std::string times;
      fs::create_directories(folder / "drive/image_0");
      for (int k = 0; k < kFrames; ++k) {
        const auto done =
            write_image(folder / ("drive/image_0/" + drive.image_name(k)), drive.render(travelled_m(kFrameS * k)));
        GS_CHECK(done.has_value(), "the fixture can't be written");
        times += fmt::format("{}\n", kFrameS * k);
      }
      folder.file("drive/calib.txt", drive.calibration());
      folder.file("drive/times.txt", times);
      return true;
    }();
    GS_CHECK(written, "the fixture can't be written");
    return folder / "drive";
  }

  TempFolder folder_;
};

/// What the file says, which must name the drive's camera otherwise.
CameraSetup written(const Setting& s) {
  const SyntheticDrive drive;
  const auto setup = read_camera_file(s.output(), drive.width, drive.height);
  GS_CHECK(setup.has_value(), setup ? "" : "the file isn't there");
  EXPECT_EQ(setup->camera->focal_px(), drive.focal_px);
  EXPECT_TRUE(setup->height_sd_m);
  EXPECT_FALSE(setup->pitch_rad);
  return *setup;
}

// On this short drive of 48 m the odometry itself has a bias of up to 1.5 %.
constexpr double kToleranceM = 0.03;

TEST(Height, FromASpeedLogWithTheOdometryRunAgainAtTheHeightFound) {
  const Setting s;
  const ProgramRun run = s.with_speeds(speeds(), {"--camera-height", "1.3"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, testing::ContainsRegex("clock of the log +[23]\\.[0-9]+ s ahead"));
  EXPECT_THAT(run.out, HasSubstr("driven 2 times"));
  EXPECT_THAT(run.out, HasSubstr("verdict              the 1.3 m from --camera-height are off by"));
  EXPECT_NEAR(*written(s).height_m, 1.65, kToleranceM) << run.out;
  EXPECT_LT(*written(s).height_sd_m, 0.05);
  EXPECT_THAT(read_text(s.output()).value(), testing::StartsWith("# height_m found by groundscale "));
}

TEST(Height, FromAGpxTrackByItsOwnClock) {
  const Setting s;
  const ProgramRun run = s.with_track(track());
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("another clock"));
  EXPECT_THAT(run.out, HasSubstr("from KITTI's documented height"));
  EXPECT_NEAR(*written(s).height_m, 1.65, kToleranceM) << run.out;
}

TEST(Height, GapsOfTheLogAreNamed) {
  const Setting s;
  std::string rows = "time_s,speed_mps\n";
  for (double t = 0.0; t <= kLastS; t += 0.5) {
    if (t <= 6.0 || t >= 9.0) rows += fmt::format("{},{}\n", t + kClockAheadS, speed_mps(t));
  }
  const ProgramRun run = s.with_speeds(rows);
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(
      run.err,
      HasSubstr("warning: the log has gaps, the first of 1 from 9.0 to 12.0 s; nothing is taken for known inside"));
  EXPECT_NEAR(*written(s).height_m, 1.65, kToleranceM) << run.out;
}

TEST(Height, FromADistance) {
  const Setting s;
  const ProgramRun run = s.height({"--distance", fmt::format("{}", travelled_m(14.0) - travelled_m(2.0)), "--from", "2",
                                   "--to", "14", "--camera-height", "1.8"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("the 1.8 m from --camera-height are off by"));
  EXPECT_NEAR(*written(s).height_m, 1.65, kToleranceM) << run.out;
}

TEST(Height, NothingIsKnownOfTheHeight) {
  const Setting s;
  fs::create_directory(s.path("plain"));
  for (const auto& entry : fs::directory_iterator(s.drive() + "/image_0")) fs::copy(entry.path(), s.path("plain"));
  fs::copy(s.drive() + "/times.txt", s.path("plain"));
  fs::copy(s.drive() + "/calib.txt", s.path("plain"));
  const ProgramRun run = run_program({"height", s.path("plain"), "--speed", s.write("speed.csv", speeds()), "--offset",
                                      "3", "--output", s.path("plain/camera.yaml"), "--quiet"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("1.500 m    assumed, nothing says a height"));
  EXPECT_THAT(run.out, HasSubstr("3.00 s ahead of the video's as given"));
  // The drive's folder has its camera now, and `run` takes it.
  const ProgramRun again = run_program({"run", s.path("plain"), "--output", s.path("run"), "--frames", "8", "--quiet"});
  ASSERT_EQ(again.status, 0) << again.err;
  EXPECT_THAT(again.out, HasSubstr("plain/camera.yaml: 1 cm more makes"));
}

TEST(Height, KeepsWhatElseTheCameraFileSays) {
  const Setting s;
  const SyntheticDrive d;
  const std::string camera =
      s.write("mine.yaml", fmt::format("model: pinhole\nfx: {0}\nfy: {0}\ncx: {1}\ncy: {2}\nheight_m: "
                                       "1.6\nheight_sd_m: 0.2\npitch_deg: 0\nroll_deg: 0\n"
                                       "vehicle_mask: {{polygon: [[0, 238], [639, 238], [639, 239], [0, 239]]}}\n",
                                       d.focal_px, d.cx(), d.cy()));
  const ProgramRun run = s.with_speeds(speeds(), {"--camera", camera});
  ASSERT_EQ(run.status, 0) << run.err;
  const auto setup = read_camera_file(s.output(), d.width, d.height);
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->pitch_rad, 0.0);
  EXPECT_FALSE(setup->vehicle_mask.empty());
  EXPECT_LT(*setup->height_sd_m, 0.1);
}

/// A row of docs/bad-input.md.
struct Row {
  std::string name;
  int status;
  std::string message;  ///< A part of it that stands in the docs as well.
  std::function<ProgramRun(const Setting&)> run;
};

std::ostream& operator<<(std::ostream& stream, const Row& row) { return stream << row.name; }

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  GS_CHECK(at != std::string::npos, "the fixture has another text");
  return text.replace(at, from.size(), to);
}

Row csv_row(const std::string& name, const std::string& message, const std::string& text) {
  return {name, 2, message, [text](const Setting& s) { return s.with_speeds(text); }};
}

Row option_row(const std::string& name, const std::string& message, const std::vector<std::string>& options) {
  return {name, 2, message, [options](const Setting& s) { return s.height(options); }};
}

Row track_row(const std::string& name, const std::string& message, const std::string& text) {
  return {name, 2, message, [text](const Setting& s) { return s.with_track(text); }};
}

std::vector<Row> log_rows() {
  const std::string header = "time_s,speed_mps\n";
  std::string standing = header, sparse = header;
  for (int k = 0; k < 20; ++k) {
    standing += fmt::format("{},0.1\n", k);
    sparse += fmt::format("{},3\n", 10 * k);
  }
  return {
      option_row("speed log missing", "can't be opened: No such file or directory", {"--speed", "nowhere/speed.csv"}),
      csv_row("speed log without names of columns", "has no column time_s", "0,1\n1,1\n"),
      csv_row("speed log without speeds in m/s", "has no column speed_mps", "time_s,speed_kmh\n0,1\n"),
      csv_row("speed log with a word", "speed_mps: 'fast' is no number", header + "0,fast\n"),
      csv_row("speed log with NaN", "the speed is nan, it must be a finite number", header + "0,nan\n"),
      csv_row("negative speed", "m/s, it must not be negative", header + "0,-1\n"),
      csv_row("speed no vehicle has", "it must be at most 100 m/s: is it in km/h?", header + "0,130\n"),
      csv_row("times of the speed log don't rise", "the time doesn't rise: 1 s, then 1 s", header + "0,3\n1,3\n1,3\n"),
      csv_row("too few speeds", "the log has 3 speeds, at least 5 are needed", header + "0,3\n1,3\n2,3\n"),
      csv_row("speeds too far apart", "the speeds are 10 s apart", sparse),
      csv_row("speed log that stands still", "the log stands still or creeps throughout", standing),
      track_row("GPX that is no XML", "isn't XML: mismatched tag", "<gpx><trk></gpx>"),
      track_row("GPX without track", "holds no track point", "<gpx><wpt lat=\"1\" lon=\"1\"/></gpx>"),
      track_row("another document than GPX", "the document is 'kml', it must be a GPX track", "<kml/>"),
      track_row("track point without time", "trkpt has no time",
                "<gpx><trk><trkseg><trkpt lat=\"49\" lon=\"8\"/></trkseg></trk></gpx>"),
      track_row("track point with a latitude that can't be", "lat is '94.5', it must be from -90 to 90 degrees",
                replaced(track(), "lat=\"49.0", "lat=\"94.5\" x=\"")),
      track_row("track point with another time", "must be as 2026-05-01T12:34:56.7Z",
                replaced(track(), "12:34:10", "noon:10")),
      track_row("times of the track don't rise", "the time doesn't rise",
                replaced(track(), "12:34:10.5", "12:34:10.0")),
  };
}

std::vector<Row> drive_rows() {
  return {
      {"speed log of another time", 2, "the log doesn't overlap the video",
       [](const Setting& s) { return s.with_speeds(speeds(1.0, 500.0)); }},
      {"too little in common", 2, "log and video have 4 s in common",
       [](const Setting& s) {
         return s.with_speeds(speeds(), {"--offset", "14"});
       }},
      {"speeds in km/h", 2, "are they in km/h? Then it is 1.6",
       [](const Setting& s) { return s.with_speeds(speeds(3.6)); }},
      {"distance beyond the video", 2, "but the video goes from 0 to 15.75 s",
       [](const Setting& s) {
         return s.height({"--distance", "40", "--from", "2", "--to", "20"});
       }},
      {"distance in another unit", 2, "is the distance in metres, and that between these times?",
       [](const Setting& s) {
         return s.height({"--distance", "176"});
       }},
      {"speed log of another drive", 1, "isn't one number",
       [](const Setting& s) {
         std::string other = "time_s,speed_mps\n";
         for (int k = 0; k < 16; ++k) other += fmt::format("{},{}\n", k, k < 8 ? 2.5 : 6.0);
         return s.with_speeds(other, {"--offset", "0"});
       }},
  };
}

std::vector<Row> option_rows() {
  return {
      option_row("neither log nor distance", "one of --speed CSV, --gpx FILE and --distance M must be given", {}),
      option_row("log and distance", "one of --speed CSV, --gpx FILE and --distance M must be given",
                 {"--speed", "a.csv", "--distance", "40"}),
      option_row("times without distance", "--from, --to and --distance-sd belong to --distance",
                 {"--speed", "a.csv", "--from", "2"}),
      option_row("distance of zero", "--distance 0: must be a length above 0 m", {"--distance", "0"}),
      option_row("negative sd of the distance", "--distance-sd -1: must be at least 0 m",
                 {"--distance", "40", "--distance-sd", "-1"}),
      option_row("times of the distance fall", "--from 5 --to 4: the times must rise",
                 {"--distance", "40", "--from", "5", "--to", "4"}),
      option_row("offset with a distance", "--offset belongs to --speed and --gpx",
                 {"--distance", "40", "--offset", "3"}),
      option_row("offset that is no number", "must be a finite number", {"--speed", "a.csv", "--offset", "nan"}),
      option_row("range of offsets below zero", "--max-offset -1: must be from 0 to 86400 s",
                 {"--speed", "a.csv", "--max-offset", "-1"}),
      {"camera file that exists, without --force", 2, "exists; --force overwrites it",
       [](const Setting& s) {
         s.write("found.yaml", "kept");
         return s.with_speeds(speeds());
       }},
      {"output over the speed log", 2, "is read, another is needed",
       [](const Setting& s) {
         const std::string log = s.write("speed.csv", speeds());
         return run_program({"height", s.drive(), "--speed", log, "--output", log, "--force"});
       }},
      {"output over the camera file", 2, "is read, another is needed",
       [](const Setting& s) {
         const SyntheticDrive d;
         const std::string camera =
             s.write("found.yaml",
                     fmt::format("model: pinhole\nfx: {0}\nfy: {0}\ncx: {1}\ncy: {2}\n", d.focal_px, d.cx(), d.cy()));
         return s.with_speeds(speeds(), {"--camera", camera, "--force"});
       }},
      {"output into a folder that isn't there", 2, "there is no folder",
       [](const Setting& s) {
         const std::string log = s.write("speed.csv", speeds());
         return run_program({"height", s.drive(), "--speed", log, "--output", s.path("nowhere/camera.yaml")});
       }},
      {"output that is a folder", 2, "is a folder, a file is needed",
       [](const Setting& s) {
         fs::create_directory(s.output());
         return s.with_speeds(speeds());
       }},
  };
}

std::vector<Row> all_rows() {
  std::vector<Row> rows = log_rows();
  for (const auto& more : {drive_rows(), option_rows()}) rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

class HeightBadInput : public testing::TestWithParam<Row> {};

TEST_P(HeightBadInput, IsRefusedAndNothingIsWritten) {
  const Row& row = GetParam();
  const Setting s;
  const ProgramRun run = row.run(s);
  EXPECT_EQ(run.status, row.status) << run.err;
  EXPECT_THAT(run.err, HasSubstr("groundscale: "));
  EXPECT_THAT(run.err, HasSubstr(row.message));
  EXPECT_THAT(run.out, IsEmpty());
  if (row.name.find("output") == std::string::npos && row.name.find("exists") == std::string::npos) {
    EXPECT_FALSE(fs::exists(s.output()));
  }
}

TEST_P(HeightBadInput, IsInTheDocs) {
  expect_in_bad_input_docs(GetParam().name, GetParam().status, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(Rows, HeightBadInput, testing::ValuesIn(all_rows()),
                         [](const auto& row) { return test_name_of(row.param.name); });

}  // namespace
}  // namespace groundscale
