#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <expat.h>
#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/iso_time_internal.hpp"
#include "groundscale/io/speed_file.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

using internal::bad_input;
using internal::quoted;

constexpr double kRadPerDeg = std::numbers::pi / 180.0;

struct TrackPoint {
  double latitude_rad = 0.0;
  double longitude_rad = 0.0;
  double time_s = 0.0;
  bool begins_segment = false;
};

/// Takes the points out of a GPX document as expat walks through it.
class TrackReader {
 public:
  explicit TrackReader(std::string path) : path_(std::move(path)) {
    GS_CHECK(parser_ != nullptr, "memory for the parser");
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(parser_.get(), &TrackReader::start, &TrackReader::end);
    XML_SetCharacterDataHandler(parser_.get(), &TrackReader::characters);
  }

  Result<std::vector<TrackPoint>> read(const std::string& text) {
    if (text.size() > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
      return bad_input(path_ + ": is too large for a track");
    }
    const XML_Status status = XML_Parse(parser_.get(), text.data(), static_cast<int>(text.size()), XML_TRUE);
    if (problem_) return *problem_;
    if (status != XML_STATUS_OK) {
      return bad_input(fmt::format("{}: isn't XML: {}", place(), XML_ErrorString(XML_GetErrorCode(parser_.get()))));
    }
    return std::move(points_);
  }

 private:
  std::string place() const { return fmt::format("{}:{}", path_, XML_GetCurrentLineNumber(parser_.get())); }

  void fail(const std::string& message) {
    if (problem_) return;
    problem_ = bad_input(fmt::format("{}: {}", place(), message));
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  static std::string_view local_name(const XML_Char* name) {
    const char* colon = std::strrchr(name, ':');
    return colon == nullptr ? name : colon + 1;
  }

  static void start(void* self, const XML_Char* name, const XML_Char** attributes) {
    static_cast<TrackReader*>(self)->begin_element(local_name(name), attributes);
  }
  static void end(void* self, const XML_Char* name) { static_cast<TrackReader*>(self)->end_element(local_name(name)); }
  static void characters(void* self, const XML_Char* text, int length) {
    TrackReader& reader = *static_cast<TrackReader*>(self);
    if (reader.in_time_) reader.time_.append(text, static_cast<std::size_t>(length));
  }

  void begin_element(std::string_view name, const XML_Char** attributes) {
    ++depth_;
    if (depth_ == 1 && name != "gpx") fail(fmt::format("the document is {}, it must be a GPX track", quoted(name)));
    if (name == "trkseg") begins_segment_ = true;
    if (name == "trkpt") begin_point(attributes);
    if (name == "time" && depth_ == point_depth_ + 1) {
      in_time_ = true;
      time_.clear();
    }
  }

  void begin_point(const XML_Char** attributes) {
    point_depth_ = depth_;
    has_time_ = false;
    point_ = TrackPoint{.begins_segment = std::exchange(begins_segment_, false)};
    struct Angle {
      const char* name;
      double bound_deg;
      double* target_rad;
    };
    for (const Angle& angle : {Angle{"lat", 90.0, &point_.latitude_rad}, Angle{"lon", 180.0, &point_.longitude_rad}}) {
      const XML_Char** at = attributes;
      while (*at != nullptr && std::strcmp(*at, angle.name) != 0) at += 2;
      if (*at == nullptr) return fail(fmt::format("trkpt has no {}", angle.name));
      const std::optional<double> degrees = internal::parse_number(at[1]);
      if (!degrees || !(std::abs(*degrees) <= angle.bound_deg)) {
        return fail(fmt::format("{} is {}, it must be from -{} to {} degrees", angle.name, quoted(at[1]),
                                angle.bound_deg, angle.bound_deg));
      }
      *angle.target_rad = *degrees * kRadPerDeg;
    }
  }

  void end_element(std::string_view name) {
    if (in_time_ && name == "time") {
      in_time_ = false;
      end_time();
    }
    if (depth_ == point_depth_) {
      point_depth_ = kNowhere;
      if (!has_time_) return fail("trkpt has no time: a track that was drawn, not driven, has no speed");
      points_.push_back(point_);
    }
    --depth_;
  }

  void end_time() {
    const std::string_view text = internal::trimmed(time_);
    const std::optional<double> time_s = internal::parse_iso_time(text);
    if (!time_s) return fail(fmt::format("time {} must be as 2026-05-01T12:34:56.7Z", quoted(text)));
    if (!points_.empty() && !(*time_s > points_.back().time_s)) {
      return fail(fmt::format("the time doesn't rise: {} is {} s before the point before or at its time", quoted(text),
                              points_.back().time_s - *time_s));
    }
    point_.time_s = *time_s;
    has_time_ = true;
  }

  static constexpr int kNowhere = -2;

  std::string path_;
  std::unique_ptr<std::remove_pointer_t<XML_Parser>, decltype(&XML_ParserFree)> parser_{XML_ParserCreate(nullptr),
                                                                                        &XML_ParserFree};
  std::optional<Error> problem_;
  int depth_ = 0;
  int point_depth_ = kNowhere;
  bool begins_segment_ = false, has_time_ = false, in_time_ = false;
  std::string time_;
  TrackPoint point_;
  std::vector<TrackPoint> points_;
};

/// From one point to a near one, in metres east and north on the WGS84 ellipsoid.
Eigen::Vector2d leg_of(const TrackPoint& from, const TrackPoint& to) {
  constexpr double kEquatorM = 6378137.0;
  constexpr double kEccentricity2 = 6.69437999014e-3;
  const double latitude = 0.5 * (from.latitude_rad + to.latitude_rad);
  const double w2 = 1.0 - kEccentricity2 * std::pow(std::sin(latitude), 2);
  const double across_m = kEquatorM / std::sqrt(w2);                                 // prime vertical
  const double along_m = kEquatorM * (1.0 - kEccentricity2) / (w2 * std::sqrt(w2));  // meridian
  const double longitude = std::remainder(to.longitude_rad - from.longitude_rad, 2.0 * std::numbers::pi);
  return {across_m * std::cos(latitude) * longitude, along_m * (to.latitude_rad - from.latitude_rad)};
}

/// Angle from one leg to the next; 0 where either is too short to have a direction.
double turn_of(const Eigen::Vector2d& a_m, const Eigen::Vector2d& b_m) {
  constexpr double kMinLegM = 2.0;
  if (a_m.norm() < kMinLegM || b_m.norm() < kMinLegM) return 0.0;
  return std::atan2(a_m.x() * b_m.y() - a_m.y() * b_m.x(), a_m.dot(b_m));
}

/// Chord to arc that spans an angle; sharper angles than a vehicle turns in a second are errors of position.
double arc_over_chord(double angle_rad) {
  constexpr double kMaxAngle = 1.0;
  const double half = 0.5 * std::abs(angle_rad);
  return half < 1e-6 || half > 0.5 * kMaxAngle ? 1.0 : half / std::sin(half);
}

std::vector<SpeedSample> speeds_of(const std::vector<TrackPoint>& points) {
  std::vector<Eigen::Vector2d> legs_m;  // leg k ends at point k + 1
  for (std::size_t k = 1; k < points.size(); ++k) legs_m.push_back(leg_of(points[k - 1], points[k]));
  const auto joined = [&points](std::size_t point) {
    return point > 0 && point + 1 < points.size() && !points[point].begins_segment && !points[point + 1].begins_segment;
  };
  std::vector<SpeedSample> speeds;
  bool after_gap = false;
  for (std::size_t k = 0; k < legs_m.size(); ++k) {
    double turn_rad = 0.0;
    int turns = 0;
    for (const std::size_t point : {k, k + 1}) {
      if (!joined(point)) continue;
      turn_rad += turn_of(legs_m[point - 1], legs_m[point]);
      ++turns;
    }
    const double interval_s = points[k + 1].time_s - points[k].time_s;
    const double length_m = legs_m[k].norm() * arc_over_chord(turns > 0 ? turn_rad / turns : 0.0);
    if (points[k + 1].begins_segment || length_m > kMaxSpeedMps * interval_s) {
      after_gap = true;
      continue;
    }
    speeds.push_back({0.5 * (points[k].time_s + points[k + 1].time_s), length_m / interval_s, after_gap});
    after_gap = false;
  }
  return speeds;
}

}  // namespace

Result<SpeedLog> read_gpx(const std::string& path) {
  const Result<std::string> text = read_text(path);
  if (!text) return text.error();
  const Result<std::vector<TrackPoint>> points = TrackReader(path).read(*text);
  if (!points) return points.error();
  if (points->empty()) return bad_input(path + ": holds no track point (trk, trkseg, trkpt)");
  Result<SpeedLog> log = SpeedLog::create(speeds_of(*points));
  return log ? std::move(log)
             : bad_input(fmt::format("{}: {} track points: {}", path, points->size(), log.error().message));
}

}  // namespace groundscale
