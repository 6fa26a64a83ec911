#include "groundscale/io/speed_file.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "groundscale/io/temp_folder_internal.hpp"

namespace groundscale {
namespace {

using testing::HasSubstr;

Result<SpeedLog> csv(const std::string& text) {
  const internal::TempFolder folder;
  return read_speed_csv(folder.file("speed.csv", text));
}

Result<SpeedLog> gpx(const std::string& text) {
  const internal::TempFolder folder;
  return read_gpx(folder.file("track.gpx", text));
}

std::string refusal(const Result<SpeedLog>& log) { return log ? "" : log.error().message; }

TEST(SpeedCsv, ReadsItsTwoColumnsWhereverTheyAre) {
  const auto log = csv("# a comment\r\nspeed_mps , yaw, time_s\n\n1.5,0,10\n2,0,11\n2.5,x,12\n3,,13\n3.5,0,14\n");
  ASSERT_TRUE(log) << log.error().message;
  ASSERT_EQ(log->samples().size(), 5U);
  EXPECT_EQ(log->first_s(), 10.0);
  EXPECT_EQ(log->samples()[2].speed_mps, 2.5);
}

TEST(SpeedCsv, NamesWhatIsWrong) {
  const std::string header = "time_s,speed_mps\n";
  EXPECT_THAT(refusal(csv("")), HasSubstr("is empty"));
  EXPECT_THAT(refusal(csv("0,1\n1,1\n")), HasSubstr("csv:1: has no column time_s"));
  EXPECT_THAT(refusal(csv("time_s,speed_kmh\n1,1\n")), HasSubstr("has no column speed_mps"));
  EXPECT_THAT(refusal(csv("time_s,speed_mps,time_s\n")), HasSubstr("column time_s is there twice"));
  EXPECT_THAT(refusal(csv(header + "0,1\n1\n")), HasSubstr("csv:3: 1 values, but the first line names 2 columns"));
  EXPECT_THAT(refusal(csv(header + "0,fast\n")), HasSubstr("csv:2: speed_mps: 'fast' is no number"));
  EXPECT_THAT(refusal(csv(header + "0,nan\n")), HasSubstr("csv:2: the speed is nan"));
  EXPECT_THAT(refusal(csv(header + "0,1\n0,1\n")), HasSubstr("csv:3: the time doesn't rise"));
  EXPECT_THAT(refusal(csv(header + "0,-1\n")), HasSubstr("must not be negative"));
  EXPECT_THAT(refusal(csv(header + "0,1\n1,1\n")), HasSubstr("2 speeds, at least 5"));
}

/// A degree of latitude and of longitude at 49 deg north, by differences of earth-fixed positions on WGS84.
constexpr double kNorthM = 111209.738;
constexpr double kEastM = 73171.793;

std::string point(double latitude_deg, double longitude_deg, double second) {
  return fmt::format(
      "<trkpt lat=\"{:.9f}\" lon=\"{:.9f}\"><ele>100</ele><time>2026-05-01T12:{:02d}:{:06.3f}Z</time></trkpt>\n",
      latitude_deg, longitude_deg, static_cast<int>(second) / 60, std::fmod(second, 60.0));
}

std::string document(const std::string& points) {
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<gpx xmlns:x=\"urn:x\">"
         "<metadata><time>2026-05-01T11:00:00Z</time></metadata><wpt lat=\"1\" lon=\"2\"/><trk><trkseg>\n" +
         points + "</trkseg></trk></gpx>\n";
}

TEST(Gpx, SpeedIsTheWayOnTheEllipsoidOverTime) {
  std::string north, east;
  for (int k = 0; k < 8; ++k) {
    north += point(49.0 + k * 10.0 / kNorthM, 8.4, k);
    east += point(49.0, 8.4 + k * 10.0 / kEastM, k);
  }
  for (const std::string& track : {north, east}) {
    const auto log = gpx(document(track));
    ASSERT_TRUE(log) << log.error().message;
    ASSERT_EQ(log->samples().size(), 7U);
    EXPECT_EQ(log->first_s(), 1777636800.5);
    for (const SpeedSample& sample : log->samples()) EXPECT_NEAR(sample.speed_mps, 10.0, 2e-4);
    EXPECT_TRUE(log->gaps().empty());
  }
}

TEST(Gpx, ATurnIsAnArcNotItsChords) {
  // A circle of 15 m at 8 m/s, a point a second: chords are 1.2 % short.
  std::string circle;
  for (int k = 0; k < 12; ++k) {
    const double angle = k * 8.0 / 15.0;
    circle += point(49.0 + 15.0 * std::sin(angle) / kNorthM, 8.4 + 15.0 * std::cos(angle) / kEastM, k);
  }
  const auto log = gpx(document(circle));
  ASSERT_TRUE(log) << log.error().message;
  for (const SpeedSample& sample : log->samples()) EXPECT_NEAR(sample.speed_mps, 8.0, 0.003);
}

TEST(Gpx, SegmentsAndJumpsAreGaps) {
  std::string points;
  for (int k = 0; k < 20; ++k) {
    const double jump = k == 12 ? 0.01 : 0.0;  // a kilometre, there and back
    if (k == 6) points += "</trkseg><trkseg>\n";
    points += point(49.0 + k * 10.0 / kNorthM + jump, 8.4, k);
  }
  const auto log = gpx(document(points));
  ASSERT_TRUE(log) << log.error().message;
  ASSERT_EQ(log->gaps().size(), 2U);
  EXPECT_EQ(log->gaps()[0].from_s - log->first_s(), 4.0);  // the last whole second before the segment's end
  EXPECT_EQ(log->gaps()[1].from_s - log->first_s(), 10.0);
  for (const SpeedSample& sample : log->samples()) EXPECT_NEAR(sample.speed_mps, 10.0, 2e-4);
}

TEST(Gpx, NamesWhatIsWrong) {
  EXPECT_THAT(refusal(gpx("")), HasSubstr("isn't XML"));
  EXPECT_THAT(refusal(gpx("words")), HasSubstr("gpx:1: isn't XML"));
  EXPECT_THAT(refusal(gpx(document("<trkpt>"))), HasSubstr("trkpt has no lat"));
  EXPECT_THAT(refusal(gpx("<gpx>\n<trk>\n</gpx>")), HasSubstr("gpx:3: isn't XML: mismatched tag"));
  EXPECT_THAT(refusal(gpx("<gpx><trk>")), HasSubstr("isn't XML"));
  EXPECT_THAT(refusal(gpx("<kml/>")), HasSubstr("the document is 'kml', it must be a GPX track"));
  EXPECT_THAT(refusal(gpx(document(""))), HasSubstr("holds no track point"));
  EXPECT_THAT(refusal(gpx(document("<trkpt lat=\"91\" lon=\"0\"/>"))),
              HasSubstr("lat is '91', it must be from -90 to 90"));
  EXPECT_THAT(refusal(gpx(document("<trkpt lat=\"nan\" lon=\"0\"/>"))), HasSubstr("lat is 'nan'"));
  EXPECT_THAT(refusal(gpx(document("<trkpt lat=\"49\" lon=\"8\"/>"))), HasSubstr("trkpt has no time"));
  EXPECT_THAT(refusal(gpx(document("<trkpt lat=\"49\" lon=\"8\"><time>noon</time></trkpt>"))),
              HasSubstr("time 'noon' must be"));
  EXPECT_THAT(refusal(gpx(document(point(49, 8, 1) + point(49, 8, 1)))), HasSubstr("the time doesn't rise"));
  EXPECT_THAT(refusal(gpx(document(point(49, 8, 1) + point(49, 8, 2)))),
              HasSubstr("2 track points: the log has 1 speeds"));
}

TEST(SpeedFile, TheEndingTellsATrackFromATable) {
  const internal::TempFolder folder;
  const auto reads = [&folder](const std::string& name, const std::string& text) {
    return read_speed_log(folder.file(name, text)).has_value();
  };
  std::string rows = "time_s,speed_mps\n";
  for (int k = 0; k < 6; ++k) rows += fmt::format("{},8\n", k);
  std::string points;
  for (int k = 0; k < 7; ++k) points += point(49.0 + 1e-4 * k, 8, k);
  EXPECT_TRUE(reads("log.csv", rows));
  EXPECT_TRUE(reads("log", rows));
  EXPECT_TRUE(reads("track.GPX", document(points)));
  EXPECT_FALSE(reads("rows.gpx", rows));
  EXPECT_FALSE(reads("track.csv", document(points)));
}

TEST(Gpx, EntitiesThatExpandWithoutEndAreRefused) {
  std::string bomb = "<?xml version=\"1.0\"?><!DOCTYPE gpx [<!ENTITY a0 \"aaaaaaaaaa\">";
  for (int k = 1; k < 12; ++k) {
    bomb += fmt::format("<!ENTITY a{} \"", k);
    for (int n = 0; n < 10; ++n) bomb += fmt::format("&a{};", k - 1);
    bomb += "\">";
  }
  EXPECT_THAT(refusal(gpx(bomb + "]><gpx>&a11;</gpx>")), HasSubstr("isn't XML"));
}

}  // namespace
}  // namespace groundscale
