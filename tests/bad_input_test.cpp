// docs/bad-input.md as tests: every row runs the program on a small drive made here, spoilt in one way.

#include <filesystem>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/videoio.hpp>

#include "bad_input_docs.hpp"
#include "groundscale/io/file_size_limit_internal.hpp"
#include "groundscale/io/files.hpp"
#include "groundscale/io/image_file.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::FileSizeLimit;
using internal::TempFolder;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

constexpr int kFrames = 12;

/// A fresh copy of the sound drive, and a place for the output.
class Setting {
 public:
  Setting() { fs::copy(sound_drive(), drive(), fs::copy_options::recursive); }

  std::string drive() const { return folder_ / "drive"; }
  std::string output() const { return folder_ / "output"; }
  std::string path(const std::string& name) const { return folder_ / name; }
  std::string image(int frame) const { return folder_ / ("drive/image_0/" + SyntheticDrive().image_name(frame)); }

  /// Writes a file of the setting ("drive/calib.txt"). @return its path.
  std::string write(const std::string& name, const std::string& text) const { return folder_.file(name, text); }
  /// A camera.yaml in the drive, used before its calib.txt.
  void write_camera(const std::string& more) const {
    const SyntheticDrive d;
    write("drive/camera.yaml",
          fmt::format("model: pinhole\nfx: {0}\nfy: {0}\ncx: {1}\ncy: {2}\n{3}", d.focal_px, d.cx(), d.cy(), more));
  }
  /// The drive's images as a video, lossy.
  std::string write_video() const {
    const SyntheticDrive d;
    const std::string video = path("drive/drive.avi");
    cv::VideoWriter writer(video, cv::CAP_FFMPEG, cv::VideoWriter::fourcc('M', 'J', 'P', 'G'), 10.0,
                           cv::Size(d.width, d.height));
    GS_CHECK(writer.isOpened(), "the fixture can't be written");
    for (int k = 0; k < kFrames; ++k) {
      const Image grey = *read_image(image(k));
      cv::Mat colour;
      cv::cvtColor(cv::Mat(d.height, d.width, CV_8U, const_cast<std::uint8_t*>(grey.data())), colour,
                   cv::COLOR_GRAY2BGR);
      writer.write(colour);
    }
    write_camera("");
    return video;
  }

  ProgramRun run(std::vector<std::string> more = {}) const { return run_source(drive(), std::move(more)); }
  ProgramRun run_source(const std::string& source, std::vector<std::string> more = {}) const {
    std::vector<std::string> arguments = {"run", source, "--output", output()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_program(arguments);
  }

 private:
  static std::string sound_drive() {
    static const TempFolder folder;
    static const bool written = [] {
      SyntheticDrive().write_kitti(folder / "drive", kFrames);
      return true;
    }();
    GS_CHECK(written, "the fixture can't be written");
    return folder / "drive";
  }

  TempFolder folder_;
};

/// A row of docs/bad-input.md.
struct Row {
  std::string name;
  int status;
  std::string message;  ///< A part of it that stands in the docs as well.
  std::function<ProgramRun(const Setting&)> run;
};

std::ostream& operator<<(std::ostream& stream, const Row& row) { return stream << row.name; }

std::string calibration_with(const std::string& from, const std::string& to) {
  std::string text = SyntheticDrive().calibration();
  const std::size_t at = text.find(from);
  GS_CHECK(at != std::string::npos, "the fixture's calibration has another text");
  return text.replace(at, from.size(), to);
}

/// Into an image folder without calibration or KITTI's layout.
std::string plain_folder(const Setting& s) { return s.path("drive/image_0"); }

void write_mask(const Setting& s, int frame, const Image& mask) {
  const auto written = write_image(s.path("masks/" + SyntheticDrive().image_name(frame)), mask);
  GS_CHECK(written.has_value(), "the fixture can't be written");
}

Image all_road() {
  Image mask(640, 240);
  std::fill_n(mask.data(), mask.width() * mask.height(), std::uint8_t{255});
  return mask;
}

/// What is wrong with the images.
std::vector<Row> source_rows() {
  return {
      {"missing folder", 2, "no such folder or file", [](const Setting& s) { return s.run_source(s.path("nowhere")); }},
      {"empty folder", 2, "holds no images",
       [](const Setting& s) {
         fs::create_directory(s.path("empty"));
         return s.run_source(s.path("empty"));
       }},
      {"a file that is no video", 2, "can't be opened as a video",
       [](const Setting& s) { return s.run_source(s.write("words.txt", "words")); }},
      {"first image can't be read", 2, "the first image gives the size, it must be readable",
       [](const Setting& s) {
         s.write("drive/image_0/000000.png", "words");
         return s.run();
       }},
  };
}

/// What is wrong with the camera.
std::vector<Row> camera_rows() {
  return {
      {"no calibration", 2, "no calibration",
       [](const Setting& s) {
         fs::remove(s.path("drive/calib.txt"));
         return s.run();
       }},
      {"camera file missing", 2, "can't be opened: No such file or directory",
       [](const Setting& s) {
         return s.run({"--camera", s.path("nowhere.yaml")});
       }},
      {"calibration without the image's row", 2, "has no row 'P0:' with 12 numbers",
       [](const Setting& s) {
         s.write("drive/calib.txt", "P5: 1\n");
         return s.run();
       }},
      {"calibration with a wrong number of values", 2, "13 values, it must have 12",
       [](const Setting& s) {
         s.write("drive/calib.txt", calibration_with("0 0 1 0", "0 0 1 0 7"));
         return s.run();
       }},
      {"NaN in the calibration", 2, "is 'nan', it must be a finite number",
       [](const Setting& s) {
         s.write("drive/calib.txt", calibration_with("P0: 440", "P0: nan"));
         return s.run();
       }},
      {"calibration with a row that is there twice", 2, "is there a second time",
       [](const Setting& s) {
         const std::string row = SyntheticDrive().calibration();
         s.write("drive/calib.txt", row + row);
         return s.run();
       }},
      {"negative focal length", 2, "a focal length must be above 0",
       [](const Setting& s) {
         s.write("drive/calib.txt", calibration_with("P0: 440", "P0: -440"));
         return s.run();
       }},
      {"calibration of other images: size", 2, "this is the calibration of other images",
       [](const Setting& s) {
         s.write_camera("image_size: [1241, 376]\n");
         return s.run();
       }},
      {"calibration of other images: principal point", 2, "lies outside the images",
       [](const Setting& s) {
         s.write("drive/calib.txt", calibration_with("319.5", "1607.2"));
         return s.run();
       }},
      {"unknown key in the camera file", 2, "unknown key 'heigth_m', the nearest is 'height_m'",
       [](const Setting& s) {
         s.write_camera("heigth_m: 1.65\n");
         return s.run();
       }},
      {"unknown camera model", 2, "is no camera model, known: pinhole, kannala_brandt, ocam",
       [](const Setting& s) {
         s.write("drive/camera.yaml", "model: mei\n");
         return s.run();
       }},
  };
}

/// What is wrong with the camera's height, or with how it looks.
std::vector<Row> mounting_rows() {
  return {
      {"no camera height", 2, "the camera height is missing",
       [](const Setting& s) {
         fs::copy_file(s.path("drive/calib.txt"), plain_folder(s) + "/calib.txt");
         return s.run_source(plain_folder(s));
       }},
      {"camera height of zero", 2, "the camera height is 0 m, it must be above 0",
       [](const Setting& s) {
         return s.run({"--camera-height", "0"});
       }},
      {"negative camera height", 2, "the camera height is -1.65 m, it must be above 0",
       [](const Setting& s) {
         return s.run({"--camera-height", "-1.65"});
       }},
      {"camera height in the camera file not above zero", 2, "is out of range, it must be above 0 m",
       [](const Setting& s) {
         s.write_camera("height_m: 0\n");
         return s.run();
       }},
      {"no road in view", 2, "no road is in view",
       [](const Setting& s) {
         s.write_camera("pitch_deg: -60\nroll_deg: 0\nyaw_deg: 0\n");
         return s.run();
       }},
      {"no road in view, with a vehicle mask", 2, "no road is in view",
       [](const Setting& s) {
         s.write_camera(
             "pitch_deg: -60\nroll_deg: 0\nyaw_deg: 0\n"
             "vehicle_mask: {polygon: [[0, 220], [639, 220], [639, 239], [0, 239]]}\n");
         return s.run();
       }},
  };
}

/// What is wrong with times, truth or road masks.
std::vector<Row> frame_rows() {
  return {
      {"fewer than two frames", 2, "at least 2 are needed",
       [](const Setting& s) {
         return s.run({"--frames", "1"});
       }},
      {"start beyond the last frame", 2, "it must be from 0 to 11",
       [](const Setting& s) {
         return s.run({"--start", "12"});
       }},
      {"times with another number of rows than there are images", 2, "it must have a row each",
       [](const Setting& s) {
         s.write("drive/times.txt", "0\n0.1\n");
         return s.run();
       }},
      {"times that never rise", 2, "they must rise",
       [](const Setting& s) {
         std::string times;
         for (int k = 0; k < kFrames; ++k) times += "0.5\n";
         s.write("drive/times.txt", times);
         return s.run();
       }},
      {"times that fall", 2, "time falls from",
       [](const Setting& s) {
         s.write("drive/times.txt", "0\n0.2\n0.1\n");
         return s.run();
       }},
      {"truth with fewer rows than frames", 2, "5 rows",
       [](const Setting& s) {
         const std::string truth = s.write("truth.txt", SyntheticDrive().truth(5));
         return run_program({"evaluate", s.write("estimate.txt", SyntheticDrive().truth(kFrames)), "--truth", truth});
       }},
      {"truth with fewer rows than frames, given to run", 2, "5 rows, but the last frame is 11",
       [](const Setting& s) {
         return s.run({"--truth", s.write("truth.txt", SyntheticDrive().truth(5))});
       }},
      {"truth that is missing, given to run", 2, "can't be opened: No such file or directory",
       [](const Setting& s) {
         return s.run({"--truth", s.path("nowhere.txt")});
       }},
      {"folder of road masks missing", 2, "no such folder",
       [](const Setting& s) {
         return s.run({"--road-masks", s.path("nowhere")});
       }},
      {"folder of road masks empty", 2, "holds no images",
       [](const Setting& s) {
         fs::create_directory(s.path("masks"));
         return s.run({"--road-masks", s.path("masks")});
       }},
      {"road masks of another size", 2, "is 600x240, the images are 640x240",
       [](const Setting& s) {
         fs::create_directory(s.path("masks"));
         for (int k = 0; k < kFrames; ++k) write_mask(s, k, Image(600, 240));
         return s.run({"--road-masks", s.path("masks")});
       }},
  };
}

/// What is wrong with the command, the configuration or the output.
std::vector<Row> command_rows() {
  return {
      {"no source", 2, "SOURCE is missing",
       [](const Setting& s) {
         return run_program({"run", "--output", s.output()});
       }},
      {"output that exists, without --force", 2, "--force overwrites it",
       [](const Setting& s) {
         s.write("output/keep.txt", "kept");
         return s.run();
       }},
      {"output that can't be written", 2, "can't be made",
       [](const Setting& s) {
         s.write("file", "");
         return run_program({"run", s.drive(), "--output", s.path("file/output")});
       }},
      {"unknown configuration key", 2, "unknown key, the nearest is 'ground.method'",
       [](const Setting& s) {
         return s.run({"--set", "ground.metod=sparse"});
       }},
      {"method that can't be fused", 2, "ground.plane.fused.methods: \"dence\" can't be fused; known: ",
       [](const Setting& s) {
         return s.run({"--set", "ground.plane.fused.methods=sparse,dence"});
       }},
      {"section where a key is expected", 2, "is a section, a key of it is",
       [](const Setting& s) {
         return s.run({"--set", "ground=3"});
       }},
      {"configuration value out of range", 2, "is out of range, it must be",
       [](const Setting& s) {
         return s.run({"--config", s.write("my.yaml", "road:\n  region:\n    near_m: -3\n")});
       }},
      {"configuration that is no YAML", 2, "isn't YAML",
       [](const Setting& s) {
         return s.run({"--config", s.write("my.yaml", "road: [\n")});
       }},
      {"overlay folder that holds something, without --force", 2, "exists and isn't empty; --force overwrites it",
       [](const Setting& s) {
         s.write("pictures/keep.txt", "kept");
         return s.run({"--overlay", s.path("pictures")});
       }},
      {"overlay folder that holds the input", 2, "holds the input, another is needed",
       [](const Setting& s) {
         return s.run({"--overlay", s.path("drive/image_0"), "--force"});
       }},
      {"unknown option or command", 2, "Run with --help for more information",
       [](const Setting& s) { return s.run({"--no-such-option"}); }},
  };
}

std::vector<Row> refused_rows() {
  std::vector<Row> all = source_rows();
  for (const auto& rows : {camera_rows(), mounting_rows(), frame_rows(), command_rows()})
    all.insert(all.end(), rows.begin(), rows.end());
  return all;
}

class Refused : public testing::TestWithParam<Row> {};

TEST_P(Refused, EndsWithTwoSaysWhyAndWritesNothing) {
  const Setting setting;
  const ProgramRun run = GetParam().run(setting);
  EXPECT_EQ(run.status, GetParam().status) << run.err;
  EXPECT_THAT(run.err, HasSubstr(GetParam().message));
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_FALSE(fs::exists(setting.output() + "/online.kitti"));
  if (GetParam().message == "--force overwrites it") {
    EXPECT_EQ(*read_text(setting.output() + "/keep.txt"), "kept");
  } else {
    EXPECT_FALSE(fs::exists(setting.output()));
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, Refused, testing::ValuesIn(refused_rows()));

/// Every file of a finished run is there and sound: a row a frame, no NaN or infinity anywhere.
void expect_whole_run(const std::string& output, int frames) {
  for (const char* name : {"trajectory.kitti", "trajectory.tum", "online.kitti", "online.tum"}) {
    const auto trajectory = read_trajectory(output + "/" + name);  // refuses NaN
    ASSERT_TRUE(trajectory) << trajectory.error().message;
    EXPECT_EQ(trajectory->size(), frames) << name;
  }
  for (const char* name : {"frames.csv", "summary.json", "config.yaml"}) {
    const auto text = read_text(output + "/" + name);
    ASSERT_TRUE(text) << text.error().message;
    EXPECT_THAT(*text, Not(testing::ContainsRegex("[^a-z]-?(nan|inf)[^a-z]"))) << name;
  }
}

using CsvRow = std::map<std::string, std::string>;

std::vector<std::string> split(const std::string& line, char at) {
  std::vector<std::string> parts;
  std::istringstream stream(line + at);
  for (std::string part; std::getline(stream, part, at);) parts.push_back(part);
  return parts;
}

std::vector<CsvRow> read_frames(const std::string& output) {
  std::istringstream stream(*read_text(output + "/frames.csv"));
  std::string line;
  std::getline(stream, line);
  const std::vector<std::string> names = split(line, ',');
  std::vector<CsvRow> rows;
  while (std::getline(stream, line)) {
    const std::vector<std::string> values = split(line, ',');
    CsvRow& row = rows.emplace_back();
    for (std::size_t k = 0; k < names.size() && k < values.size(); ++k) row[names[k]] = values[k];
  }
  return rows;
}

std::vector<Row> passed_rows() {
  return {{"camera height over 20 m", 0, "is it given in metres?",
           [](const Setting& s) {
             return s.run({"--camera-height", "165"});
           }},
          {"one road mask missing", 0, "goes without road mask",
           [](const Setting& s) {
             fs::create_directory(s.path("masks"));
             for (int k = 0; k < kFrames; ++k) {
               if (k != 5) write_mask(s, k, all_road());
             }
             return s.run({"--road-masks", s.path("masks")});
           }},
          {"truncated image in the middle", 0, "truncated: the PNG's end is missing",
           [](const Setting& s) {
             const std::string whole = *read_text(s.image(5));
             s.write("drive/image_0/000005.png", whole.substr(0, whole.size() / 2));
             return s.run();
           }},
          {"corrupt image in the middle", 0, "can't be decoded as an image",
           [](const Setting& s) {
             s.write("drive/image_0/000005.png", "words");
             return s.run();
           }},
          {"image of another size in the middle", 0, "the first image is 640x240", [](const Setting& s) {
             const auto written = write_image(s.image(5), Image(600, 240));
             GS_CHECK(written.has_value(), "the fixture can't be written");
             return s.run();
           }}};
}

class Passed : public testing::TestWithParam<Row> {};

TEST_P(Passed, EndsWithZeroAWarningAndARowForEveryFrame) {
  const Setting setting;
  const ProgramRun run = GetParam().run(setting);
  EXPECT_EQ(run.status, GetParam().status) << run.err;
  EXPECT_THAT(run.err, HasSubstr("warning: "));
  EXPECT_THAT(run.err, HasSubstr(GetParam().message));
  ASSERT_NO_FATAL_FAILURE(expect_whole_run(setting.output(), kFrames));
  EXPECT_THAT(*read_text(setting.output() + "/summary.json"), HasSubstr(GetParam().message));
  if (GetParam().name.find("in the middle") == std::string::npos) return;
  const std::vector<CsvRow> frames = read_frames(setting.output());
  ASSERT_EQ(frames.size(), std::size_t{kFrames});
  EXPECT_EQ(frames[5].at("state"), "bridged");
  EXPECT_THAT(frames[5].at("reason"), Not(IsEmpty()));
  for (const int k : {4, 6, 11}) EXPECT_EQ(frames[k].at("state"), "moving") << k;
}

INSTANTIATE_TEST_SUITE_P(Rows, Passed, testing::ValuesIn(passed_rows()));

TEST(BadInput, TheSoundDriveRunsWithoutAWarning) {
  const Setting setting;
  const ProgramRun run = setting.run();
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  ASSERT_NO_FATAL_FAILURE(expect_whole_run(setting.output(), kFrames));
  const auto trajectory = read_trajectory(setting.output() + "/trajectory.kitti");
  // Only that it is the drive that was made: accuracy is tested elsewhere.
  EXPECT_NEAR(trajectory->world_from_cam.back().translation.z(), SyntheticDrive().step_m * (kFrames - 1), 0.9);
}

/// All images the same, in one grey or as the first.
class NothingMoves : public testing::TestWithParam<std::pair<const char*, int>> {};

TEST_P(NothingMoves, IsStillWithoutMotionScaleOrNaN) {
  const Setting setting;
  Image image = *read_image(setting.image(0));
  if (const int grey = GetParam().second; grey >= 0) {
    std::fill_n(image.data(), image.width() * image.height(), static_cast<std::uint8_t>(grey));
  }
  for (int k = 0; k < kFrames; ++k) ASSERT_TRUE(write_image(setting.image(k), image));
  const ProgramRun run = setting.run();
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("warning: no measurement of the road was accepted"));
  ASSERT_NO_FATAL_FAILURE(expect_whole_run(setting.output(), kFrames));
  const auto trajectory = read_trajectory(setting.output() + "/trajectory.kitti");
  for (const RigidTransform& pose : trajectory->world_from_cam) {
    EXPECT_EQ(pose.translation.norm(), 0.0);
    EXPECT_LT((pose.rotation - Eigen::Matrix3d::Identity()).norm(), 1e-9);
  }
  for (const CsvRow& frame : read_frames(setting.output())) {
    EXPECT_EQ(frame.at("state"), "still") << "frame " << frame.at("frame");
    EXPECT_EQ(frame.at("step_m"), "");
    EXPECT_EQ(frame.at("raw_step_m"), "");
  }
}

INSTANTIATE_TEST_SUITE_P(Images, NothingMoves,
                         testing::Values(std::pair("all-black images", 0), std::pair("all-white images", 255),
                                         std::pair("identical images", -1)));

/// Bytes of the n-th frame of an MJPG/AVI file: begin and end.
std::pair<std::size_t, std::size_t> avi_frame(const std::string& bytes, int n) {
  std::size_t at = bytes.find("movi");
  for (int k = 0; k <= n; ++k) at = bytes.find("00dc", at + 4);
  GS_CHECK(at != std::string::npos, "the video has fewer frames");
  return {at + 8, std::min(bytes.find("00dc", at + 8), bytes.find("idx1", at + 8))};
}

TEST(BadInput, AVideoThatEndsEarlyIsReadToItsEndWithAWarning) {
  const Setting setting;
  const std::string video = setting.write_video();
  const std::string whole = *read_text(video);
  setting.write("drive/drive.avi", whole.substr(0, avi_frame(whole, 9).first + 20));
  const ProgramRun run = setting.run_source(video, {"--camera-height", "1.65"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err,
              testing::ContainsRegex("warning: .*declares 12 frames, [0-9]+ were decoded: the video ends early"));
  expect_whole_run(setting.output(), read_trajectory(setting.output() + "/trajectory.kitti")->size());
}

TEST(BadInput, AVideoWhoseFirstFrameCanNotBeDecodedEndsWithOne) {
  const Setting setting;
  const std::string video = setting.write_video();
  std::string bytes = *read_text(video);
  for (int k = 0; k < kFrames; ++k) {
    const auto [begin, end] = avi_frame(bytes, k);
    std::fill(bytes.begin() + static_cast<std::ptrdiff_t>(begin), bytes.begin() + static_cast<std::ptrdiff_t>(end),
              '\0');
  }
  setting.write("drive/drive.avi", bytes);
  const ProgramRun run = setting.run_source(video, {"--camera-height", "1.65"});
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("the first asked for, can't be decoded"));
  EXPECT_FALSE(fs::exists(setting.output()));
}

TEST(BadInput, ADiskThatIsFullInTheMiddleEndsWithOneAndLeavesWholeRows) {
  const Setting setting;
  ProgramRun run;
  {
    const FileSizeLimit limit(1500);  // about half of the rows
    run = setting.run();
  }
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("online.kitti: can't be written: "));
  const auto online = read_trajectory(setting.output() + "/online.kitti");
  ASSERT_TRUE(online) << online.error().message;
  EXPECT_GE(online->size(), 2);
  EXPECT_LT(online->size(), kFrames);
  EXPECT_EQ(read_text(setting.output() + "/online.kitti")->back(), '\n');
  for (const auto& entry : fs::directory_iterator(setting.output())) {
    EXPECT_NE(entry.path().extension(), ".part") << "a file that isn't whole is left behind";
  }
}

TEST(BadInput, AFailureAtTheEndLeavesWhatWasWrittenBefore) {
  const Setting setting;
  fs::create_directories(setting.output() + "/frames.csv.part");  // where the table is to be written
  const ProgramRun run = setting.run({"--force"});
  EXPECT_EQ(run.status, 1) << run.err;
  EXPECT_THAT(run.err, HasSubstr("frames.csv: can't be written: Is a directory"));
  EXPECT_EQ(read_trajectory(setting.output() + "/online.kitti")->size(), kFrames);
  EXPECT_EQ(read_trajectory(setting.output() + "/trajectory.kitti")->size(), kFrames);
}

TEST(BadInput, EveryRowStandsInTheDocs) {
  std::vector<Row> rows = refused_rows();
  for (const Row& row : passed_rows()) rows.push_back(row);
  for (const char* name : {"all-black images", "all-white images", "identical images"}) {
    rows.push_back({name, 0, "no measurement of the road was accepted", nullptr});
  }
  rows.push_back({"video that ends early", 0, "the video ends early", nullptr});
  rows.push_back({"video whose first frame can't be decoded", 1, "the first asked for, can't be decoded", nullptr});
  rows.push_back({"truth that stands still, given to run", 1, "is whole, but can't be evaluated", nullptr});
  rows.push_back({"disk full in the middle", 1, "can't be written", nullptr});
  for (const Row& row : rows) expect_in_bad_input_docs(row.name, row.status, row.message);
}

}  // namespace
}  // namespace groundscale
