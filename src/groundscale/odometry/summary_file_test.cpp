#include "groundscale/odometry/summary_file.hpp"

#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using internal::TempFolder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Pair;

const std::string kSummary = R"({"version": "0.1.0", "source": "drive", "truth": "poses.txt", "first_frame": 5,
"frames": 12, "seed": 3, "camera": "c.yaml", "camera_height_m": 1.5, "camera_height_from": "--camera-height",
"times_from_source": false, "mounting": {"pitch_deg": 90, "roll_deg": -0.5, "yaw_deg": 2}, "length_m": 11.5,
"states": {"moving": 7, "still": 1, "rotating": 2, "bridged": 1, "lost": 1}, "accepted_measurements": 6,
"matching": {"track_length_frames": 7.5, "matches": 200, "inlier_ratio": 0.9, "rms_px": 0.3, "road_matches": 60,
"road_inlier_ratio": 0.8, "road_rms_px": 0.4, "pitch_sd_deg": 0.2}, "first_scaled_frame": 6,
"scale_corrections": [{"frame": 8, "lambda": 1.1, "drift_before": 1.09, "drift_after": null},
{"frame": 9, "lambda": 0.9, "drift_before": 0.91, "drift_after": 1.01}],
"camera_changes": [{"frame": 9, "k1": {"value": 0.01, "sd": 0.002}}],
"scale_slope": {"percent_per_100m": 4.0, "sd_percent_per_100m": 0.5, "length_m": 39, "measurements": 38, "verdict": "x"},
"speed_log": {"file": "s.csv", "frames_scaled": 4, "ratio_to_ground": null},
"warnings": ["one", "two"], "time": {"wall_s": 1.5, "median_ms_a_frame": 20.5, "p95_ms_a_frame": 33,
"mean_ms_a_frame": {"z first": 1.25, "a second": 12}, "road_network": {"runs": 3, "mean_ms_a_run": 8.5}}}
)";

std::string error_of(const std::string& text) {
  const TempFolder folder;
  const auto summary = read_run_summary(folder.file("summary.json", text));
  if (summary) return "no error";
  EXPECT_EQ(summary.error().code, ErrorCode::kBadInput);
  return summary.error().message;
}

TEST(RunSummaryFile, IsReadAsItIsDocumented) {
  const TempFolder folder;
  const auto s = read_run_summary(folder.file("summary.json", kSummary));
  ASSERT_TRUE(s) << s.error().message;
  EXPECT_EQ(s->source, "drive");
  EXPECT_EQ(s->truth, "poses.txt");
  EXPECT_EQ(s->first_frame, 5);
  EXPECT_EQ(s->frames, 12);
  EXPECT_FALSE(s->has_times);
  EXPECT_DOUBLE_EQ(s->mounting.pitch_rad, 0.5 * std::numbers::pi);
  EXPECT_THAT((std::vector{s->moving, s->still, s->rotating, s->bridged, s->lost}), ElementsAre(7, 1, 2, 1, 1));
  EXPECT_EQ(s->accepted, 6);
  EXPECT_EQ(s->matching.pitch_sd_deg, 0.2);
  EXPECT_EQ(s->first_scaled_frame, 6);
  ASSERT_EQ(s->corrections.size(), 2U);
  EXPECT_FALSE(s->corrections[0].drift_after);
  EXPECT_EQ(s->corrections[1].drift_after, 1.01);
  ASSERT_EQ(s->camera_changes.size(), 1U);
  EXPECT_EQ(s->camera_changes[0].values.at("k1").sd, 0.002);
  EXPECT_DOUBLE_EQ(s->slope.value().per_100m, 0.04);
  ASSERT_TRUE(s->speed_log);
  EXPECT_FALSE(s->speed_log->ratio);
  EXPECT_THAT(s->warnings, ElementsAre("one", "two"));
  EXPECT_THAT(s->stage_ms, ElementsAre(Pair("z first", 1.25), Pair("a second", 12.0)));
  EXPECT_EQ(s->network_runs, 3);
}

TEST(RunSummaryFile, MayLackWhatOlderVersionsDidNotWrite) {
  const TempFolder folder;
  const auto s = read_run_summary(folder.file("summary.json", R"({"source": "drive", "frames": 2, "truth": null})"));
  ASSERT_TRUE(s) << s.error().message;
  EXPECT_EQ(s->truth, "");
  EXPECT_FALSE(s->slope);
  EXPECT_FALSE(s->first_scaled_frame);
}

TEST(RunSummaryFile, IsRefusedWhereItIsNone) {
  EXPECT_THAT(error_of("{"), HasSubstr("summary.json: isn't JSON"));
  EXPECT_THAT(error_of("[1]"), HasSubstr("summary.json: isn't JSON with the figures of a run"));
  EXPECT_THAT(error_of("{}"), HasSubstr("isn't the summary of a run"));
  EXPECT_THAT(error_of(R"({"source": "drive", "frames": "many"})"), HasSubstr("isn't the summary of a run"));
  EXPECT_THAT(error_of(R"({"source": "drive", "frames": 2, "warnings": [1]})"),
              HasSubstr("isn't the summary of a run"));
}

}  // namespace
}  // namespace groundscale
