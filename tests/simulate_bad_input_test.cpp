// docs/bad-input.md, what `simulate` refuses, and what a full disk or an end without warning leaves of a drive.
#include <spawn.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bad_input_docs.hpp"
#include "groundscale/io/file_size_limit_internal.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "program.hpp"

extern char** environ;

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::FileSizeLimit;
using internal::TempFolder;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr int kPoses = 80;
constexpr double kStepM = 0.9;

/// A KITTI row: a level camera at (x, 0, z) that looks `heading_rad` to the right of z; `stretch` 1 makes a rotation.
std::string pose_row(double x, double z, double heading_rad, double stretch = 1.0) {
  const double c = stretch * std::cos(heading_rad);
  const double s = stretch * std::sin(heading_rad);
  return fmt::format("{} 0 {} {} 0 {} 0 0 {} 0 {} {}", c, s, x, stretch, -s, c, z);
}

using Rows = std::vector<std::string>;

Rows straight_rows() {
  Rows rows;
  for (int k = 0; k < kPoses; ++k) rows.push_back(pose_row(0.0, kStepM * k, 0.0));
  return rows;
}

/// Straight on with one row replaced.
Rows straight_but(int k, const std::string& row) {
  Rows rows = straight_rows();
  rows[static_cast<std::size_t>(k)] = row;
  return rows;
}

Rows time_rows() {
  Rows rows;
  for (int k = 0; k < kPoses; ++k) rows.push_back(fmt::format("{:.1f}", 0.1 * k));
  return rows;
}

/// A folder with sound inputs, and a place for the drive.
class Setting {
 public:
  Setting() {
    write("poses.txt", straight_rows());
    camera("camera.yaml", 64, 32);
  }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string output() const { return path("drive"); }
  std::string write(const std::string& name, const Rows& rows) const {
    return folder_.file(name, fmt::format("{}\n", fmt::join(rows, "\n")));
  }
  /// Small images, so that a drive takes a second. No height and no angles: they are the preset's.
  std::string camera(const std::string& name, int width, int height) const {
    return folder_.file(
        name, fmt::format("model: pinhole\nimage_size: [{}, {}]\nfx: 40\nfy: 40\ncx: 31.5\ncy: 10\n", width, height));
  }
  std::vector<std::string> arguments(const std::vector<std::string>& more) const {
    std::vector<std::string> all = {"simulate", "--output", output(), "--no-cache"};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  ProgramRun run(const std::vector<std::string>& more) const { return run_program(arguments(more)); }
  /// A drive at the given poses, as small as can be.
  std::vector<std::string> along(const std::string& poses, const std::vector<std::string>& more = {}) const {
    std::vector<std::string> all = {"--camera", path("camera.yaml"), "--trajectory", poses};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  ProgramRun run_along(const Rows& poses) const { return run(along(write("poses.txt", poses))); }
  ProgramRun run_with_times(const Rows& times) const {
    return run(along(path("poses.txt"), {"--times", write("times.txt", times)}));
  }

 private:
  TempFolder folder_;
};

/// A row of docs/bad-input.md.
struct Row {
  std::string name;
  std::string message;  ///< A part of it that stands in the docs as well.
  std::function<ProgramRun(const Setting&)> run;
};

std::ostream& operator<<(std::ostream& stream, const Row& row) { return stream << row.name; }

/// There and back in one lane.
Rows reversing_rows() {
  Rows rows = straight_rows();
  for (int k = 1; k < kPoses; ++k) rows.push_back(pose_row(0.0, kStepM * (kPoses - 1 - k), 0.0));
  return rows;
}

/// A circle of 3 m, where half the road is 3.6 m wide.
Rows tight_rows() {
  constexpr double kRadiusM = 3.0;
  constexpr double kTurnRad = 0.25;
  Rows rows = straight_rows();
  const double start_m = kStepM * (kPoses - 1);
  for (int k = 1; k < kPoses; ++k) {
    const double a = kTurnRad * k;
    rows.push_back(pose_row(kRadiusM * (1.0 - std::cos(a)), start_m + kRadiusM * std::sin(a), a));
  }
  return rows;
}

std::vector<Row> pose_rows() {
  return {
      {"pose file missing", "can't be opened: No such file or directory",
       [](const Setting& s) { return s.run(s.along(s.path("nowhere.txt"))); }},
      {"pose file without poses", "holds no pose", [](const Setting& s) { return s.run_along({}); }},
      {"NaN in a pose", "is 'nan', it must be a finite number",
       [](const Setting& s) { return s.run_along(straight_but(5, "1 0 0 0 0 1 0 0 0 0 1 nan")); }},
      {"pose that is no rotation", "the 3x3 block isn't a rotation",
       [](const Setting& s) { return s.run_along(straight_but(5, pose_row(0.0, 5 * kStepM, 0.0, 1.1))); }},
      {"one pose", "there is one pose, a drive needs two at least",
       [](const Setting& s) { return s.run_along({pose_row(0.0, 0.0, 0.0)}); }},
      {"poses that jump", "from the one before; up to 10 m can be driven",
       [](const Setting& s) { return s.run_along(straight_but(20, pose_row(40.0, 20 * kStepM, 0.0))); }},
      {"poses that stand", "the poses go 0.00 m in all, a road needs 5 m",
       [](const Setting& s) { return s.run_along(Rows(kPoses, pose_row(0.0, 0.0, 0.0))); }},
      {"poses that reverse", "a road can only be laid under a vehicle that drives forwards",
       [](const Setting& s) { return s.run_along(reversing_rows()); }},
      {"camera that looks back along its way", "the vehicle points against its way",
       [](const Setting& s) {
         Rows rows = straight_rows();
         for (int k = 0; k < kPoses; ++k) rows[static_cast<std::size_t>(k)] = pose_row(0.0, -kStepM * k, 0.0);
         return s.run_along(rows);
       }},
      {"poses that turn too tightly for the road", "the path turns too tightly for the road: radius",
       [](const Setting& s) { return s.run_along(tight_rows()); }},
  };
}

std::vector<Row> time_file_rows() {
  return {
      {"times missing", "can't be opened: No such file or directory",
       [](const Setting& s) {
         return s.run(s.along(s.path("poses.txt"), {"--times", s.path("nowhere.txt")}));
       }},
      {"times of another number than poses", "it must have a row each",
       [](const Setting& s) {
         return s.run_with_times({"0", "0.1"});
       }},
      {"times of poses that fall", "time falls from 0.6 to 0.3 s",
       [](const Setting& s) {
         Rows times = time_rows();
         times[7] = "0.3";
         return s.run_with_times(times);
       }},
      {"times of two poses alike", "rows 7 and 8 both have the time 0.6 s",
       [](const Setting& s) {
         Rows times = time_rows();
         times[6] = times[7] = "0.6";
         return s.run_with_times(times);
       }},
      {"times closer together than the shutter is open", "is the least there may be between them",
       [](const Setting& s) {
         Rows times = time_rows();
         times[7] = "0.601";
         return s.run_with_times(times);
       }},
      {"a vehicle on its side", "the vehicle is tilted by 89 degrees against the mean of all",
       [](const Setting& s) {
         // Its right side is down.
         return s.run_along(straight_but(40, fmt::format("0 1 0 0 -1 0 0 0 0 0 1 {}", kStepM * 40)));
       }},
      {"poses in the folder that is written", "where the drive's own files would replace it",
       [](const Setting& s) {
         const std::string folder = fs::path(s.path("poses.txt")).parent_path().string();
         return run_program({"simulate", "--output", folder, "--no-cache", "--force", "--preset", "small",
                             "--trajectory", s.path("poses.txt")});
       }},
      {"output without a name", "--output: the folder's name is empty",
       [](const Setting&) {
         return run_program({"simulate", "--output", "", "--no-cache", "--preset", "small", "--frames", "1"});
       }},
      {"times that are no numbers", "must be one number, a time in seconds",
       [](const Setting& s) { return s.run_with_times(Rows(kPoses, "noon")); }},
      {"times without poses", "--times requires --trajectory",
       [](const Setting& s) {
         return s.run({"--times", s.write("times.txt", time_rows())});
       }},
  };
}

std::vector<Row> command_rows() {
  return {
      {"route and poses", "--route excludes --trajectory",
       [](const Setting& s) {
         return s.run(s.along(s.path("poses.txt"), {"--route", "city"}));
       }},
      {"more frames than poses", "has 80 frames",
       [](const Setting& s) {
         return s.run(s.along(s.path("poses.txt"), {"--frames", "81"}));
       }},
      {"more frames than the route has", "--frames 100000: route straight has 770 frames",
       [](const Setting& s) {
         return s.run({"--route", "straight", "--frames", "100000"});
       }},
      {"no frames", "--frames: Value 0 not in range 1 to",
       [](const Setting& s) {
         return s.run({"--frames", "0"});
       }},
      {"negative seed", "--seed: Value -1 not in range 0 to",
       [](const Setting& s) {
         return s.run({"--seed", "-1"});
       }},
      {"unknown route of simulate", "'circle' is no route, known: city, straight, hills, stop-and-go, motorway",
       [](const Setting& s) {
         return s.run({"--route", "circle"});
       }},
      {"unknown preset of simulate", "'large' is no preset, known: kitti, campus, small",
       [](const Setting& s) {
         return s.run({"--preset", "large"});
       }},
      {"drive's folder holds something, without --force", "exists and isn't empty; --force overwrites it",
       [](const Setting& s) {
         return run_program({"simulate", "--output", s.path("")});
       }},
      {"drive's folder is a file", "is a file, a folder is needed",
       [](const Setting& s) {
         return run_program({"simulate", "--output", s.path("poses.txt"), "--force"});
       }},
      {"drive's folder can't be made", "can't be made: Not a directory",
       [](const Setting& s) {
         return run_program({"simulate", "--output", s.path("poses.txt/drive"), "--no-cache", "--trajectory",
                             s.path("poses.txt"), "--camera", s.path("camera.yaml")});
       }},
  };
}

ProgramRun with_assignment(const Setting& s, const std::string& assignment) { return s.run({"--set", assignment}); }

std::vector<Row> option_rows() {
  return {
      {"images without width", "image_size: 0 must be a whole number from 1 to 65535",
       [](const Setting& s) {
         return s.run({"--camera", s.camera("zero.yaml", 0, 32)});
       }},
      {"images above 16384 px", "images of 17000 x 32 px; up to 16384 px a side and 64000000 in all are rendered",
       [](const Setting& s) {
         return s.run({"--camera", s.camera("wide.yaml", 17000, 32)});
       }},
      {"camera file of a drive missing", "can't be opened: No such file or directory",
       [](const Setting& s) {
         return s.run({"--camera", s.path("nowhere.yaml")});
       }},
      {"unknown key of the simulation", "unknown key, the nearest is 'world.road.crown'",
       [](const Setting& s) { return with_assignment(s, "world.rod.crown=0.01"); }},
      {"value of the simulation out of range", "7 is out of range, it must be from 0 to 0.1",
       [](const Setting& s) { return with_assignment(s, "world.road.crown=7"); }},
      {"three more rays at edges", "edge_rays is 3, it must be 0, 8 or 16",
       [](const Setting& s) { return with_assignment(s, "edge_rays=3"); }},
      {"lane beyond the road", "world.road.lane_offset_m is 5, it must be below world.road.half_width_m, 3.6",
       [](const Setting& s) { return with_assignment(s, "world.road.lane_offset_m=5"); }},
      {"front gardens with too much", "are above 1 together",
       [](const Setting& s) { return with_assignment(s, "world.hedges_share=0.9"); }},
      {"shutter longer than a frame", "shutter_ms is 200, frames come every 100 ms",
       [](const Setting& s) { return with_assignment(s, "shutter_ms=200"); }},
  };
}

std::vector<Row> all_rows() {
  std::vector<Row> all = pose_rows();
  for (const auto& rows : {time_file_rows(), command_rows(), option_rows()}) {
    all.insert(all.end(), rows.begin(), rows.end());
  }
  return all;
}

class SimulateRefuses : public testing::TestWithParam<Row> {};

TEST_P(SimulateRefuses, EndsWithTwoSaysWhyAndWritesNothing) {
  const Setting setting;
  const ProgramRun run = GetParam().run(setting);
  EXPECT_EQ(run.status, 2) << run.err;
  EXPECT_THAT(run.err, HasSubstr(GetParam().message));
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_FALSE(fs::exists(setting.output()));
  EXPECT_FALSE(fs::exists(setting.path("image_0")));
}

INSTANTIATE_TEST_SUITE_P(Rows, SimulateRefuses, testing::ValuesIn(all_rows()));

TEST(SimulateBadInput, ACameraFileWithoutHeightHasThePresets) {
  const Setting setting;
  ASSERT_EQ(setting.run(setting.along(setting.path("poses.txt"), {"--frames", "2"})).status, 0);
  EXPECT_THAT(*read_text(setting.output() + "/camera.yaml"), HasSubstr("height_m: 1.65\n"));
}

/// Lines, but for a header.
int count_rows(const std::string& path, int header = 0) {
  const std::string text = *read_text(path);
  EXPECT_TRUE(text.empty() || text.back() == '\n') << path;
  return static_cast<int>(std::count(text.begin(), text.end(), '\n')) - header;
}

/// Images that can be read, from 0 on; nothing else lies there.
int count_images(const std::string& folder) {
  int count = 0;
  for (; fs::exists(fmt::format("{}/{:06d}.png", folder, count)); ++count) {
    EXPECT_TRUE(read_image(fmt::format("{}/{:06d}.png", folder, count))) << folder << ", image " << count;
  }
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), count) << folder;
  return count;
}

/// As many rows as images everywhere. @return how many.
int whole_frames(const std::string& drive, const std::vector<std::string>& folders) {
  const int frames = count_images(drive + "/image_0");
  for (const std::string& name : folders) EXPECT_EQ(count_images(fmt::format("{}/{}", drive, name)), frames) << name;
  for (const char* name : {"poses.txt", "times.txt"}) EXPECT_EQ(count_rows(drive + "/" + name), frames) << name;
  EXPECT_EQ(count_rows(drive + "/truth.csv", 1), frames);
  return frames;
}

const std::vector<std::string> kMoreFolders = {"depth", "road_masks"};

/// Sizes of the files of a whole drive.
struct Sizes {
  rlim_t options = 0;
  rlim_t largest_image = 0;
  rlim_t largest_depth = 0;
  rlim_t truth = 0;
};

Sizes sizes_of(const std::string& drive) {
  Sizes sizes;
  for (const auto& entry : fs::directory_iterator(drive + "/image_0")) {
    sizes.largest_image = std::max<rlim_t>(sizes.largest_image, entry.file_size());
  }
  sizes.options = fs::file_size(drive + "/simulation.yaml");
  sizes.truth = fs::file_size(drive + "/truth.csv");
  for (const auto& entry : fs::directory_iterator(drive + "/depth")) {
    sizes.largest_depth = std::max<rlim_t>(sizes.largest_depth, entry.file_size());
  }
  return sizes;
}

/// How many frames a disk leaves on which no file may grow beyond `bytes`, after all that must hold then.
int frames_on_full_disk(const Setting& setting, rlim_t bytes, const std::string& name, bool more_images) {
  std::vector<std::string> arguments = setting.along(setting.path("poses.txt"), {"--force"});
  if (more_images) arguments.insert(arguments.end(), {"--depth", "--road-masks"});
  ProgramRun run;
  {
    const FileSizeLimit full(bytes);
    run = setting.run(arguments);
  }
  EXPECT_EQ(run.status, 1) << run.err;
  const int frames = whole_frames(setting.output(), more_images ? kMoreFolders : std::vector<std::string>());
  EXPECT_THAT(run.err, HasSubstr(name + ": can't be written: "));
  EXPECT_THAT(run.err, HasSubstr(fmt::format("({} of {} frames are written and whole)", frames, kPoses)));
  return frames;
}

TEST(SimulateBadInput, ADiskThatIsFullInTheMiddleLeavesAShorterDrive) {
  const Setting setting;
  ASSERT_EQ(setting.run(setting.along(setting.path("poses.txt"), {"--depth", "--road-masks"})).status, 0);
  ASSERT_EQ(whole_frames(setting.output(), kMoreFolders), kPoses);
  const Sizes sizes = sizes_of(setting.output());
  ASSERT_LT(std::max(sizes.options, sizes.largest_image), sizes.largest_depth)
      << "a drive of other images is needed here";
  ASSERT_LT(sizes.largest_depth, sizes.truth) << "a longer drive is needed here";

  // The row of the truth comes last: all of its frame that was written before must go again.
  const rlim_t between = (sizes.largest_depth + sizes.truth) / 2;
  for (const bool more_images : {true, false}) {
    const int frames = frames_on_full_disk(setting, between, "truth.csv", more_images);
    EXPECT_GT(frames, 2);
    EXPECT_LT(frames, kPoses);
    EXPECT_EQ(run_program({"run", setting.output(), "--output", setting.path("run"), "--force"}).status, 0);
  }
  // An image for which there is room, a depth image for which there is none.
  const rlim_t image_fits = (std::max(sizes.options, sizes.largest_image) + sizes.largest_depth) / 2;
  EXPECT_LT(frames_on_full_disk(setting, image_fits, ".png", true), kPoses);
}

TEST(SimulateBadInput, AnEndWithoutWarningLeavesAtMostOneImageMoreThanRows) {
  const Setting setting;
  std::vector<std::string> words = setting.arguments(setting.along(setting.path("poses.txt"), {"--quiet"}));
  words.insert(words.begin(), std::getenv("GROUNDSCALE_PROGRAM"));
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t child = 0;
  ASSERT_EQ(posix_spawn(&child, argv[0], nullptr, nullptr, argv.data(), environ), 0);
  // Half a minute in all, where a second is enough.
  constexpr int kTries = 3000;
  for (int k = 0; k < kTries && !fs::exists(setting.output() + "/image_0/000003.png"); ++k) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  kill(child, SIGKILL);
  int status = 0;
  waitpid(child, &status, 0);
  // What was being written has another ending, which no reader of images takes up.
  int images = 0;
  while (fs::exists(fmt::format("{}/image_0/{:06d}.png", setting.output(), images))) ++images;
  ASSERT_GE(images, 4);
  for (const char* name : {"poses.txt", "times.txt", "truth.csv"}) {
    const int rows = count_rows(setting.output() + "/" + name, name == std::string("truth.csv") ? 1 : 0);
    EXPECT_GE(rows, images - 1) << name;
    EXPECT_LE(rows, images) << name;
  }
}

TEST(SimulateBadInput, AnotherDriveWithForceLeavesNothingOfTheFirst) {
  const Setting setting;
  const std::string poses = setting.path("poses.txt");
  ASSERT_EQ(setting.run(setting.along(poses, {"--frames", "5", "--depth"})).status, 0);
  ASSERT_TRUE(fs::exists(setting.output() + "/depth/000004.png"));
  fs::copy_file(poses, setting.output() + "/config.yaml");  // as of the preset campus
  ASSERT_EQ(setting.run(setting.along(poses, {"--frames", "3", "--force"})).status, 0);
  EXPECT_EQ(whole_frames(setting.output(), {}), 3);
  EXPECT_FALSE(fs::exists(setting.output() + "/depth"));
  EXPECT_FALSE(fs::exists(setting.output() + "/config.yaml"));
}

TEST(SimulateBadInput, EveryRowStandsInTheDocs) {
  for (const Row& row : all_rows()) expect_in_bad_input_docs(row.name, 2, row.message);
}

}  // namespace
}  // namespace groundscale
