#include "groundscale/evaluation/pairing.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"
#include "groundscale/io/trajectory_file.hpp"

namespace groundscale {
namespace {

using internal::bad_input;

constexpr double kMaxTimeDifferenceS = 0.02;  // as in the TUM benchmark's own tools

std::string beside(const std::string& folder, const char* name) {
  return (std::filesystem::path(folder) / name).string();
}

bool exists(const std::string& path) {
  std::error_code ignored;
  return std::filesystem::exists(path, ignored);
}

/// The estimate's side before it meets the truth.
struct Estimate {
  Trajectory trajectory;
  std::optional<Trajectory> online;
  std::vector<FrameRow> frames;
  std::string times_from;
};

Result<Estimate> read_run_folder(const std::string& folder) {
  const std::string trajectory_path = beside(folder, "trajectory.kitti");
  const std::string table_path = beside(folder, "frames.csv");
  const std::string online_path = beside(folder, "online.kitti");
  for (const std::string& path : {trajectory_path, table_path}) {
    if (exists(path)) continue;
    return bad_input(fmt::format("{}: not there, so {} isn't the folder of a run that ended{}", path, folder,
                                 exists(online_path) ? " (online.kitti can be evaluated by itself)" : ""));
  }
  Result<Trajectory> trajectory = read_trajectory(trajectory_path);
  if (!trajectory) return trajectory.error();
  Result<std::vector<FrameRow>> frames = read_frame_table(table_path);
  if (!frames) return frames.error();
  Estimate estimate{std::move(*trajectory), std::nullopt, std::move(*frames), ""};
  if (static_cast<std::size_t>(estimate.trajectory.size()) != estimate.frames.size()) {
    return bad_input(fmt::format("{} has {} rows, {} has {}: they are not of one run", trajectory_path,
                                 estimate.trajectory.size(), table_path, estimate.frames.size()));
  }
  if (exists(online_path)) {
    Result<Trajectory> online = read_trajectory(online_path);
    if (!online) return online.error();
    if (online->size() != estimate.trajectory.size()) {
      return bad_input(fmt::format("{} has {} rows, {} has {}: they are not of one run", trajectory_path,
                                   estimate.trajectory.size(), online_path, online->size()));
    }
    estimate.online = std::move(*online);
  }
  if (estimate.frames.front().time_s) {
    estimate.times_from = table_path;
    estimate.trajectory.times_s.clear();
    for (const FrameRow& row : estimate.frames) estimate.trajectory.times_s.push_back(*row.time_s);
  }
  return estimate;
}

Result<Estimate> read_estimate(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return read_run_folder(path);
  Result<Trajectory> trajectory = read_trajectory(path);
  if (!trajectory) return trajectory.error();
  Estimate estimate;
  estimate.trajectory = std::move(*trajectory);
  if (estimate.trajectory.has_times()) estimate.times_from = path;
  return estimate;
}

/// Leaves out the first rows.
Result<void> skip_rows(int skip, const std::string& path, Estimate& estimate) {
  const int rows = estimate.trajectory.size();
  if (skip < 0) return bad_input(fmt::format("--skip {}: it must be from 0 on", skip));
  if (rows - skip < 2) {
    return bad_input(fmt::format("{}: {} rows, of which {} are skipped; at least 2 must be left", path, rows, skip));
  }
  const auto cut = [skip](auto& values) {
    if (!values.empty()) values.erase(values.begin(), values.begin() + skip);
  };
  cut(estimate.trajectory.world_from_cam);
  cut(estimate.trajectory.times_s);
  cut(estimate.frames);
  if (estimate.online) cut(estimate.online->world_from_cam);
  return {};
}

/// Times of a KITTI truth, from `times.txt` beside it.
Result<std::vector<double>> read_times_beside(const std::string& truth_path, int rows) {
  const std::string path = (std::filesystem::path(truth_path).parent_path() / "times.txt").string();
  if (!exists(path)) {
    return bad_input(
        fmt::format("the estimate's rows have times and those of {} have none: {} isn't there either; give a "
                    "truth with TUM rows, or an estimate with KITTI rows",
                    truth_path, path));
  }
  const Result<std::string> text = read_text(path);
  if (!text) return text.error();
  std::vector<double> times_s;
  for (const internal::Line& line : internal::split_lines(*text)) {
    const std::string_view word = internal::trimmed(line.text);
    if (word.empty()) continue;
    const std::optional<double> time_s = internal::parse_number(word);
    if (!time_s || !std::isfinite(*time_s) || (!times_s.empty() && *time_s < times_s.back())) {
      return bad_input(fmt::format("{}:{}: {} must be a time in seconds, not before the one above", path, line.number,
                                   internal::quoted(word)));
    }
    times_s.push_back(*time_s);
  }
  if (times_s.size() != static_cast<std::size_t>(rows)) {
    return bad_input(fmt::format("{} has {} times, {} has {} rows", path, times_s.size(), truth_path, rows));
  }
  return times_s;
}

/// Row of the truth for every row of the estimate, by number.
Result<std::vector<int>> rows_by_number(const Estimate& estimate, const PairingRequest& request, int rows_of_truth) {
  std::vector<int> rows;
  rows.reserve(static_cast<std::size_t>(estimate.trajectory.size()));
  for (int k = 0; k < estimate.trajectory.size(); ++k) {
    rows.push_back((estimate.frames.empty() ? request.skip + k : estimate.frames[k].frame) + request.truth_offset);
  }
  if (rows.front() >= 0 && rows.back() < rows_of_truth) return rows;
  return bad_input(fmt::format("{} needs rows {} to {} of the truth, {} has {} rows (0 to {}); {}", request.estimate,
                               rows.front(), rows.back(), request.truth, rows_of_truth, rows_of_truth - 1,
                               request.advice));
}

/// The same by time. Both times never fall.
Result<std::vector<int>> rows_by_time(const std::vector<double>& times_s, const std::vector<double>& truth_times_s,
                                      const PairingRequest& request) {
  if (request.truth_offset != 0) {
    return bad_input(
        fmt::format("--truth-offset {}: rows of {} are matched by time", request.truth_offset, request.estimate));
  }
  std::vector<int> rows;
  for (std::size_t k = 0; k < times_s.size(); ++k) {
    const auto after = std::lower_bound(truth_times_s.begin(), truth_times_s.end(), times_s[k]);
    auto nearest = after;
    if (after == truth_times_s.end() ||
        (after != truth_times_s.begin() && times_s[k] - after[-1] < *after - times_s[k])) {
      --nearest;
    }
    const std::size_t number = static_cast<std::size_t>(request.skip) + k + 1;
    if (std::abs(*nearest - times_s[k]) > kMaxTimeDifferenceS) {
      return bad_input(
          fmt::format("{}: pose {} is at {} s, the nearest of the truth ({}) at {} s: at most {} s apart is "
                      "allowed",
                      request.estimate, number, times_s[k], request.truth, *nearest, kMaxTimeDifferenceS));
    }
    rows.push_back(static_cast<int>(nearest - truth_times_s.begin()));
    if (k > 0 && rows[k] <= rows[k - 1]) {
      return bad_input(
          fmt::format("{}: poses {} and {}, at {} and {} s, have the same nearest pose of the truth at {} s",
                      request.estimate, number - 1, number, times_s[k - 1], times_s[k], *nearest));
    }
  }
  return rows;
}

}  // namespace

Result<PairedDrive> pair_drive(const PairingRequest& request) {
  Result<Estimate> estimate = read_estimate(request.estimate);
  if (!estimate) return estimate.error();
  Result<Trajectory> truth = read_trajectory(request.truth);
  if (!truth) return truth.error();
  if (const auto skipped = skip_rows(request.skip, request.estimate, *estimate); !skipped) return skipped.error();

  PairedDrive drive;
  drive.rows_of_truth = truth->size();
  const bool by_time = estimate->frames.empty() && estimate->trajectory.has_times();
  if (truth->has_times()) {
    drive.times_from = request.truth;
  } else if (by_time) {
    Result<std::vector<double>> times_s = read_times_beside(request.truth, truth->size());
    if (!times_s) return times_s.error();
    truth->times_s = std::move(*times_s);
    drive.times_from = (std::filesystem::path(request.truth).parent_path() / "times.txt").string();
  }
  Result<std::vector<int>> rows = by_time ? rows_by_time(estimate->trajectory.times_s, truth->times_s, request)
                                          : rows_by_number(*estimate, request, truth->size());
  if (!rows) return rows.error();
  drive.truth_rows = std::move(*rows);
  for (const int row : drive.truth_rows) {
    drive.truth.world_from_cam.push_back(truth->world_from_cam[row]);
    if (truth->has_times()) drive.truth.times_s.push_back(truth->times_s[row]);
  }
  if (by_time) {
    drive.max_time_difference_s = 0.0;
    for (int k = 0; k < drive.truth.size(); ++k) {
      const double difference_s = std::abs(drive.truth.times_s[k] - estimate->trajectory.times_s[k]);
      drive.max_time_difference_s = std::max(*drive.max_time_difference_s, difference_s);
    }
  } else if (!truth->has_times() && estimate->trajectory.has_times()) {
    drive.truth.times_s = estimate->trajectory.times_s;
    drive.times_from = estimate->times_from;
  }
  drive.estimate = std::move(estimate->trajectory);
  drive.online = std::move(estimate->online);
  drive.frames = std::move(estimate->frames);
  return drive;
}

}  // namespace groundscale
