// Every text that a person can hand to the program, broken in many ways: each parser gives a value or a kBadInput that
// names the file, and nothing else (no crash, no exception, no hang, no NaN).

#include <cmath>
#include <filesystem>
#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/camera/pinhole.hpp"
#include "groundscale/core/rng.hpp"
#include "groundscale/io/camera_file.hpp"
#include "groundscale/io/config.hpp"
#include "groundscale/io/image_folder_internal.hpp"
#include "groundscale/io/temp_folder_internal.hpp"
#include "groundscale/io/times_file.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {

struct SomeOptions {
  bool on = true;
  int count = 3;
  double ratio = 0.5;
  std::string name;
  std::vector<double> list;
};

void visit_fields(SomeOptions& options, FieldVisitor& v) {
  v.field({.key = "on", .unit = "", .help = ""}, options.on);
  v.field({.key = "count", .unit = "", .help = "", .min = 0.0, .max = 100.0}, options.count);
  v.field({.key = "ratio", .unit = "", .help = "", .min = 0.0, .max = 1.0}, options.ratio);
  v.field({.key = "name", .unit = "", .help = ""}, options.name);
  v.field({.key = "list", .unit = "", .help = ""}, options.list);
}

struct TopOptions {
  SomeOptions some;
};
void visit_fields(TopOptions& options, FieldVisitor& v) { v.group("some", options.some); }

namespace {

using internal::TempFolder;
using testing::HasSubstr;

/// A parser under test: a sound text, and a call that says "" for a sound value, "!..." for an unsound one, else the
/// message of the error.
struct Parser {
  std::string name;
  std::string sound;
  std::function<std::string(const std::string& text)> parse;
};

std::ostream& operator<<(std::ostream& stream, const Parser& parser) { return stream << parser.name; }

std::string message_of(const Error& error) {
  if (error.code != ErrorCode::kBadInput) return "!not kBadInput: " + error.message;
  return error.message.empty() ? "!no message" : error.message;
}

std::string input_file(const std::string& text) {
  static const TempFolder folder;
  std::filesystem::remove(folder / "input.txt");  // some file systems flush one that is written over, which takes long
  return folder.file("input.txt", text);
}

std::string parse_trajectory(const std::string& text) {
  const Result<Trajectory> read = read_trajectory(input_file(text));
  if (!read) return message_of(read.error());
  for (const RigidTransform& pose : read->world_from_cam) {
    if (!pose.rotation.allFinite() || !pose.translation.allFinite()) return "!not finite";
  }
  return "";
}

std::string parse_calibration(const std::string& text) {
  const Result<CameraSetup> read = read_kitti_calibration(input_file(text), 0, 1241, 376);
  return read ? "" : message_of(read.error());
}

std::string parse_camera(const std::string& text) {
  const Result<CameraSetup> read = read_camera_file(input_file(text), 640, 480);
  if (!read) return message_of(read.error());
  return !read->height_m || *read->height_m > 0.0 ? "" : "!height";
}

std::string parse_times(const std::string& text) {
  const Result<std::vector<double>> read = read_times(input_file(text), 3, "image");
  return read ? "" : message_of(read.error());
}

std::string parse_config(const std::string& text) {
  TopOptions options;
  const Result<void> read = apply_yaml(text, "input.txt", [&](FieldVisitor& v) { visit_fields(options, v); });
  if (!read) return message_of(read.error());
  return check_ranges(options) ? "" : "!out of range";
}

std::vector<Parser> parsers() {
  return {
      {"trajectory_kitti", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1e-3 0 1 0 -2.5 0 0 1 3\n", parse_trajectory},
      {"trajectory_tum", "0.1 0 0 0 0 0 0 1\n0.2 1 2 3 0 0 0 1\n", parse_trajectory},
      {"calibration", "P0: 718.8 0 607.1 0 0 718.8 185.2 0 0 0 1 0\nTr: 1 2 3\n", parse_calibration},
      {"camera",
       "model: pinhole\nimage_size: [640, 480]\nfx: 700\nfy: 700\ncx: 320\ncy: 240\n"
       "distortion: {k1: -0.1, k2: 0.01}\nheight_m: 1.5\npitch_deg: 2\n"
       "vehicle_mask:\n  polygon: [[0, 470], [639, 470], [639, 479]]\n",
       parse_camera},
      {"times", "0\n0.1\n0.25\n", parse_times},
      {"config", "some:\n  on: false\n  count: 7\n  ratio: 0.25\n  name: \"a b\"\n  list: [1, 2.5]\n", parse_config}};
}

class Parsers : public testing::TestWithParam<Parser> {
 protected:
  void check(const std::string& text) {
    const std::string message = GetParam().parse(text);
    ASSERT_FALSE(message.starts_with("!")) << message << "\nfor:\n" << text.substr(0, 500);
    if (!message.empty()) {
      ASSERT_THAT(message, HasSubstr("input.txt"));
    }
    for (const char c : message) ASSERT_TRUE(c >= ' ' && c <= '~') << "an unprintable byte in: " << message;
  }
};

TEST_P(Parsers, ReadTheSoundTextAlsoWithWindowsLineEndsAndAByteOrderMark) {
  const std::string sound = GetParam().sound;
  EXPECT_EQ(GetParam().parse(sound), "");
  std::string windows = "\xEF\xBB\xBF";
  for (const char c : sound) windows += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(GetParam().parse(windows), "");
  EXPECT_EQ(GetParam().parse(sound.substr(0, sound.size() - 1)), "") << "without the last line's end";
}

TEST_P(Parsers, SurviveTruncationAtEveryByte) {
  for (std::size_t length = 0; length <= GetParam().sound.size(); ++length) check(GetParam().sound.substr(0, length));
}

TEST_P(Parsers, SurviveRandomBytesInASoundText) {
  Rng rng(11);
  for (int round = 0; round < 500; ++round) {
    std::string text = GetParam().sound;
    for (int change = rng.index(4); change >= 0; --change) {
      text[rng.index(static_cast<int>(text.size()))] = static_cast<char>(rng.index(256));
    }
    check(text);
  }
}

TEST_P(Parsers, SurviveBinaryGarbage) {
  Rng rng(12);
  for (int round = 0; round < 300; ++round) {
    std::string text(static_cast<std::size_t>(rng.index(400)), '\0');
    for (char& c : text) c = static_cast<char>(rng.index(256));
    check(text);
  }
}

TEST_P(Parsers, SurviveOddNumbersInPlaceOfEveryNumber) {
  const std::string digits = "0123456789.-";
  const std::string sound = GetParam().sound;
  for (const std::string odd : {"1e308", "-1e308", "1e999", "nan", "-inf", "1e-320", "0x10",
                                "1_000", "1,5",    "--1",   "+-1", "",     "9e99",   "123456789012345678901234567890",
                                "-0",    "1e",     "1.2.3", "\0",  "[",    "]",      "{",
                                "&a",    "*a",     "!!int", "%",   "\t"}) {
    for (std::size_t at = 0; at < sound.size(); ++at) {
      if (digits.find(sound[at]) == std::string::npos) continue;
      std::size_t end = at;
      while (end < sound.size() && digits.find(sound[end]) != std::string::npos) ++end;
      check(sound.substr(0, at) + odd + sound.substr(end));
      at = end;
    }
  }
}

TEST_P(Parsers, SurviveDeepNestingAndLongLines) {
  constexpr int kMany = 100'000;
  check(std::string(kMany, '['));
  check(std::string(kMany, '{'));
  check("some: " + std::string(kMany, '['));
  check("model: " + std::string(kMany, '-'));
  check(std::string(kMany, ' '));
  check(std::string(kMany, '\n'));
  check(std::string(kMany, '1'));
  std::string blocks;
  for (int k = 0; k < 2000; ++k) blocks += std::string(static_cast<std::size_t>(k), ' ') + "a:\n";
  check(blocks);
  std::string dashes;
  for (int k = 0; k < kMany; ++k) dashes += "- ";
  check(dashes);
}

INSTANTIATE_TEST_SUITE_P(All, Parsers, testing::ValuesIn(parsers()),
                         [](const testing::TestParamInfo<Parser>& parser) { return parser.param.name; });

TEST(Assignments, SurviveRandomBytes) {
  Rng rng(13);
  for (int round = 0; round < 5000; ++round) {
    std::string text = "some.list=[1, 2]";
    for (int change = rng.index(4); change >= 0; --change) {
      text[rng.index(static_cast<int>(text.size()))] = static_cast<char>(rng.index(256));
    }
    TopOptions options;
    const Result<void> set = apply_assignment(text, [&](FieldVisitor& v) { visit_fields(options, v); });
    if (!set) {
      ASSERT_EQ(set.error().code, ErrorCode::kBadInput);
    }
    ASSERT_TRUE(check_ranges(options));
  }
}

}  // namespace
}  // namespace groundscale
