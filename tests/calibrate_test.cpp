// `calibrate`: a camera's distortion and principal row from a simulated drive round a corner, end to end; and the rows
// of docs/bad-input.md about it.

#include <cstdlib>
#include <filesystem>
#include <functional>
#include <iterator>
#include <ostream>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bad_input_docs.hpp"
#include "groundscale/camera/parameters.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/file_size_limit_internal.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "program.hpp"
#include "synthetic_drive.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;
using internal::TempFolder;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::MatchesRegex;
using testing::Not;

/// The simulated camera (preset `small`), with errors of its row and its distortion.
std::string camera_text(double row_error_px = 0.0, double radial_error = 0.0) {
  return fmt::format(
      "model: pinhole\nimage_size: [480, 200]\nfx: 300\nfy: 300\ncx: 239.5\ncy: {}\n"
      "distortion: {{k1: {}, k2: 0, p1: 0, p2: 0, k3: 0}}\nheight_m: 1.65\n",
      60.0 + row_error_px, radial_error);
}

/// 50 m straight on, a right turn, 65 m of the next street; made once.
std::string city_drive() {
  static const TempFolder folder;
  static const bool made = [] {
    const ProgramRun run = run_program(
        {"simulate", "--output", folder / "city", "--preset", "small", "--frames", "170", "--no-cache", "--quiet"});
    GS_CHECK(run.status == 0, run.err);
    return true;
  }();
  GS_CHECK(made, "the drive can't be simulated");
  return folder / "city";
}

class Calibrate : public testing::Test {
 protected:
  std::string output() const { return folder_ / "found.yaml"; }
  std::string report() const { return folder_ / "found_report.html"; }
  std::string write(const std::string& name, const std::string& text) const { return folder_.file(name, text); }
  ProgramRun calibrate(std::vector<std::string> more) const {
    more.insert(more.begin(), {"calibrate", "--output", output(), "--quiet"});
    return run_program(more);
  }
  CameraSetup found() const {
    const auto setup = read_camera_file(output(), 480, 200);
    GS_CHECK(setup.has_value(), setup ? "" : setup.error().message);
    return *setup;
  }

  TempFolder folder_;
};

TEST_F(Calibrate, FindsDistortionAndRowAgainRoundACorner) {
  const std::string start = write("start.yaml", camera_text(5.0, 0.02));
  const ProgramRun run = calibrate({city_drive(), "--start", "30", "--camera", start});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, IsEmpty());
  EXPECT_THAT(run.out, HasSubstr("verdict              calibrated; at a camera height of 1.65 m (" + start +
                                 "), every length becomes "));
  EXPECT_THAT(run.out, HasSubstr("city, frames 30 to 169\n"));
  const CameraSetup setup = found();
  // One turn in small images tells the row to a pixel and k1 to 0.003, as the standard deviations say.
  EXPECT_NEAR(value_of(CameraParameter::kRow, *setup.camera), 60.0, 3.0) << run.out;
  EXPECT_NEAR(value_of(CameraParameter::kRadial, *setup.camera), 0.0, 0.008) << run.out;
  EXPECT_GT(setup.parameter_sds.at(CameraParameter::kRow), 0.5);
  EXPECT_LT(setup.parameter_sds.at(CameraParameter::kRow), 4.0);
  EXPECT_LT(setup.parameter_sds.at(CameraParameter::kRadial), 0.008);
  EXPECT_EQ(setup.camera->focal_px(), 300.0);
  EXPECT_EQ(setup.height_m, 1.65);
  ASSERT_TRUE(setup.pitch_rad && setup.roll_rad && setup.yaw_rad);
  // The camera looks straight ahead. A row that is 2 px off turns it by 0.4 degrees.
  for (const double angle : {*setup.pitch_rad, *setup.roll_rad, *setup.yaw_rad}) EXPECT_NEAR(angle, 0.0, 0.02);

  // What is printed stands in the file and in the report as well.
  const std::string text = read_text(output()).value();
  EXPECT_THAT(text, testing::StartsWith("# by groundscale calibrate "));
  EXPECT_THAT(text, HasSubstr("# verdict              calibrated; "));
  const std::string html = read_text(report()).value();
  for (const char* part : {"Residuals over the image", "Drift of the scale", "<svg", "frames 30 to 169", "calibrated; ",
                           "cy <span class=\"unit\">px</span>", "<mark>cy_sd: "}) {
    EXPECT_THAT(html, HasSubstr(part));
  }
}

TEST_F(Calibrate, RunFindsThemWhileDrivingAndRepeatsItself) {
  const std::string start = write("start.yaml", camera_text(5.0, 0.02));
  const ProgramRun first = run_program({"run", city_drive(), "--camera", start, "--set", "camera.refine=online",
                                        "--output", folder_ / "first", "--quiet"});
  ASSERT_EQ(first.status, 0) << first.err;
  EXPECT_THAT(first.out, HasSubstr("camera refined "));
  EXPECT_THAT(first.out, HasSubstr("drift against road "));
  const auto file = [this](const std::string& run, const char* name) {
    return read_text(folder_ / run + "/" + name).value();
  };
  const std::string summary = file("first", "summary.json");
  EXPECT_THAT(summary, HasSubstr("\"camera_changes\": [\n    {\n      \"frame\": "));
  EXPECT_THAT(summary, HasSubstr("\"percent_per_100m\": "));
  const ProgramRun again =
      run_program({"run", "--config", folder_ / "first/config.yaml", "--output", folder_ / "again", "--quiet"});
  ASSERT_EQ(again.status, 0) << again.err;
  for (const char* name : {"trajectory.kitti", "online.kitti", "frames.csv"}) {
    EXPECT_EQ(file("again", name), file("first", name)) << name;
  }
}

TEST_F(Calibrate, RefiningNeedsAMap) {
  const ProgramRun run = run_program({"run", city_drive(), "--frames", "10", "--set", "camera.refine=online", "--set",
                                      "odometry.mode=pairwise", "--output", folder_ / "run", "--quiet"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("camera.refine: online has no effect in pairwise mode"));
}

TEST_F(Calibrate, OnAStraightRoadNothingChanges) {
  const std::string start = write("start.yaml", camera_text(5.0, 0.02) + "k1_sd: 0.004\n");
  const ProgramRun run = calibrate({city_drive(), "--frames", "45", "--camera", start});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("verdict              the calibration stays as it is: 0 degrees of turning are too "
                                 "little, 30 are needed; lengths don't change\n"));
  EXPECT_THAT(run.out, HasSubstr("cy                   65, stays: 0 degrees"));
  std::string values;
  const std::string text = read_text(output()).value();
  for (std::size_t at = 0; at < text.size(); at = text.find('\n', at) + 1) {
    if (text[at] != '#') values += text.substr(at, text.find('\n', at) + 1 - at);
  }
  EXPECT_EQ(values,
            "model: pinhole\nimage_size: [480, 200]\nfx: 300\nfy: 300\ncx: 239.5\ncy: 65\n"
            "distortion: {k1: 0.02, k2: 0, p1: 0, p2: 0, k3: 0}\nk1_sd: 0.004\nheight_m: 1.65\n");
  EXPECT_THAT(read_text(report()).value(), HasSubstr("stays as it was: 0 degrees of turning"));
}

TEST_F(Calibrate, FromAFieldOfViewSaysHowWellTheFocalLengthIsKnown) {
  const ProgramRun run = calibrate({city_drive(), "--start", "30", "--frames", "110", "--fov", "74"});
  ASSERT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.out, HasSubstr("start                --fov 74\n"));
  EXPECT_THAT(run.out, testing::ContainsRegex("\nf +[0-9.]+ -> [0-9.]+ \\+- [0-9.]+\n"));
  const CameraSetup setup = found();
  const double sd_px = setup.parameter_sds.at(CameraParameter::kFocal);
  EXPECT_GT(sd_px, 1.0);
  EXPECT_LT(sd_px, 15.0);
  EXPECT_NEAR(setup.camera->focal_px(), 300.0, 15.0) << run.out;
}

TEST_F(Calibrate, AFullDiskLeavesWhatWasThere) {
  write("found.yaml", "old");
  write("found_report.html", "older");
  const internal::FileSizeLimit limit(1000);
  const ProgramRun run = calibrate({city_drive(), "--frames", "4", "--force"});
  EXPECT_EQ(run.status, 1);
  EXPECT_THAT(run.err, HasSubstr("can't be written"));
  EXPECT_EQ(read_text(output()).value(), "old");
  EXPECT_EQ(read_text(report()).value(), "older");
}

TEST_F(Calibrate, EndedByForceLeavesWhatWasThere) {
  write("found.yaml", "old");
  const std::string command =
      fmt::format("timeout -s KILL 1 '{}' calibrate '{}' --output '{}' --force --quiet > /dev/null 2>&1",
                  std::getenv("GROUNDSCALE_PROGRAM"), city_drive(), output());
  EXPECT_NE(std::system(command.c_str()), 0);
  EXPECT_EQ(read_text(output()).value(), "old");
  EXPECT_FALSE(fs::exists(report()));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_.path()), fs::directory_iterator()), 1);
}

TEST_F(Calibrate, AFrameThatCanNotBeReadIsBridgedWithAWarning) {
  const SyntheticDrive drive;
  drive.write_kitti(folder_ / "drive", 4);
  write("drive/image_0/" + drive.image_name(2), "no image");
  const ProgramRun run = calibrate({folder_ / "drive"});
  EXPECT_EQ(run.status, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("groundscale: warning: frame 2: "));
  EXPECT_THAT(run.err, HasSubstr("can't be decoded as an image"));
  EXPECT_THAT(run.out, HasSubstr("4 frames"));
}

/// A row of docs/bad-input.md.
struct Row {
  std::string name;
  int status;
  std::string message;  ///< A part of it that stands in the docs as well.
  std::function<std::vector<std::string>(const TempFolder&)> arguments;
};

std::ostream& operator<<(std::ostream& stream, const Row& row) { return stream << row.name; }

/// A drive of two frames, by name. The images are rendered once.
std::string small_drive(const TempFolder& folder, const std::string& name, const SyntheticDrive& drive = {}) {
  static const TempFolder rendered;
  const std::string kept = rendered / fmt::format("{}x{}", drive.width, drive.height);
  if (!fs::exists(kept)) drive.write_kitti(kept, 2);
  fs::copy(kept, folder / name, fs::copy_options::recursive);
  folder.file(name + "/calib.txt", drive.calibration());
  return folder / name;
}

Row camera_row(const std::string& name, const std::string& message, const std::string& line) {
  return {name, 2, message, [line](const TempFolder& folder) {
            return std::vector<std::string>{small_drive(folder, "drive"), "--camera",
                                            folder.file("camera.yaml",
                                                        "model: pinhole\nfx: 440\nfy: 440\ncx: "
                                                        "319.5\ncy: 110\n" +
                                                            line)};
          }};
}

Row fov_row(const std::string& name, const std::string& message, const std::vector<std::string>& options) {
  return {name, 2, message, [options](const TempFolder& folder) {
            std::vector<std::string> arguments = {small_drive(folder, "drive")};
            arguments.insert(arguments.end(), options.begin(), options.end());
            return arguments;
          }};
}

std::vector<Row> drive_rows() {
  using Arguments = std::vector<std::string>;
  return {
      {"calibrate without a drive", 2, "SOURCE is required", [](const TempFolder&) { return Arguments{}; }},
      {"calibrate from a folder that isn't there", 2, "no such folder or file",
       [](const TempFolder& f) { return Arguments{f / "nowhere"}; }},
      {"one drive named twice", 2, "is there twice: a drive must count once",
       [](const TempFolder& f) {
         return Arguments{small_drive(f, "drive"), f / "drive/"};
       }},
      {"drives of another image size", 2, "all drives must be of one camera",
       [](const TempFolder& f) {
         SyntheticDrive other;
         other.width = 600;
         return Arguments{small_drive(f, "drive"), small_drive(f, "other", other), "--camera", f / "drive/calib.txt"};
       }},
      {"drives of another calibration", 2, "all drives must be of one camera; --camera FILE names one for all of them",
       [](const TempFolder& f) {
         SyntheticDrive other;
         other.focal_px += 3.0;
         return Arguments{small_drive(f, "drive"), small_drive(f, "other", other)};
       }},
      {"first drive without calibration", 2, "--camera FILE names one for all drives",
       [](const TempFolder& f) {
         const std::string first = small_drive(f, "drive");
         fs::remove(first + "/calib.txt");
         return Arguments{first, small_drive(f, "other")};
       }},
      {"first image of a drive to calibrate from can't be read", 2, "can't be decoded as an image",
       [](const TempFolder& f) {
         const std::string drive = small_drive(f, "drive");
         f.file("drive/image_0/" + SyntheticDrive().image_name(0), "no image");
         return Arguments{drive};
       }},
      {"start beyond a drive to calibrate from", 2, "start is frame 9, it must be from 0 to 1",
       [](const TempFolder& f) {
         return Arguments{small_drive(f, "drive"), "--start", "9"};
       }},
  };
}

std::vector<Row> output_rows() {
  using Arguments = std::vector<std::string>;
  return {
      {"calibrated camera file that exists, without --force", 2, "exists; --force overwrites it",
       [](const TempFolder& f) {
         f.file("found.yaml", "kept");
         return Arguments{small_drive(f, "drive")};
       }},
      {"report that exists, without --force", 2, "found_report.html: exists; --force overwrites it",
       [](const TempFolder& f) {
         f.file("found_report.html", "kept");
         return Arguments{small_drive(f, "drive")};
       }},
      {"calibrated output over the camera file", 2, "is read, another is needed",
       [](const TempFolder& f) {
         const std::string camera = f.file("found.yaml", camera_text());
         SyntheticDrive drive;
         drive.width = 480;
         drive.height = 200;
         return Arguments{small_drive(f, "drive", drive), "--camera", camera, "--force"};
       }},
      {"calibrated output that is a folder", 2, "is a folder, a file is needed",
       [](const TempFolder& f) {
         fs::create_directory(f / "found.yaml");
         return Arguments{small_drive(f, "drive")};
       }},
  };
}

std::vector<Row> all_rows() {
  std::vector<Row> rows = {
      fov_row("field of view and camera file", "--fov and --camera: one of them says the focal length",
              {"--fov", "80", "--camera", "camera.yaml"}),
      fov_row("field of view that no pinhole has", "must be from 20 to 140 degrees", {"--fov", "180"}),
      fov_row("field of view that is no number", "must be from 20 to 140 degrees", {"--fov", "nan"}),
      fov_row("height of zero to calibrate with", "the camera height is 0 m, it must be above 0",
              {"--fov", "80", "--camera-height", "0"}),
      camera_row("sd of zero", "f_sd: 0 is out of range, it must be above 0", "f_sd: 0\n"),
      camera_row("negative sd", "cy_sd: -1 is out of range, it must be above 0", "cy_sd: -1\n"),
      camera_row("sd that is text", "k1_sd: 'much' must be a finite number", "k1_sd: much\n"),
      camera_row("sd of another model", "unknown key 'polynomial_2_sd'", "polynomial_2_sd: 1\n"),
  };
  for (const auto& more : {drive_rows(), output_rows()}) rows.insert(rows.end(), more.begin(), more.end());
  return rows;
}

class CalibrateBadInput : public testing::TestWithParam<Row> {};

TEST_P(CalibrateBadInput, IsRefusedAndNothingIsWritten) {
  const Row& row = GetParam();
  const TempFolder folder;
  std::vector<std::string> arguments = row.arguments(folder);
  const std::string output = folder / "found.yaml";
  const std::string report = folder / "found_report.html";
  const auto text_of = [](const std::string& path) { return fs::is_regular_file(path) ? read_text(path).value() : ""; };
  const std::string before = text_of(output) + text_of(report);
  arguments.insert(arguments.begin(), {"calibrate", "--output", output});
  const ProgramRun run = run_program(arguments);
  EXPECT_EQ(run.status, row.status) << run.err;
  EXPECT_THAT(run.err, HasSubstr(row.message));
  EXPECT_THAT(run.out, IsEmpty());
  EXPECT_EQ(text_of(output) + text_of(report), before);
}

TEST_P(CalibrateBadInput, IsInTheDocs) {
  expect_in_bad_input_docs(GetParam().name, GetParam().status, GetParam().message);
}

INSTANTIATE_TEST_SUITE_P(Rows, CalibrateBadInput, testing::ValuesIn(all_rows()),
                         [](const auto& row) { return test_name_of(row.param.name); });

}  // namespace
}  // namespace groundscale
