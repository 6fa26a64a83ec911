#include "groundscale/io/trajectory_file.hpp"

#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "groundscale/io/files.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

using internal::bad_input;

constexpr int kKittiNumbers = 12;
constexpr int kTumNumbers = 8;
constexpr double kRotationTolerance = 1e-3;

Result<std::vector<double>> numbers_of(const std::vector<std::string_view>& words, const std::string& place) {
  std::vector<double> numbers;
  for (std::size_t k = 0; k < words.size(); ++k) {
    const std::optional<double> number = internal::parse_number(words[k]);
    if (!number || !std::isfinite(*number)) {
      return bad_input(
          fmt::format("{}: value {} is {}, it must be a finite number", place, k + 1, internal::quoted(words[k])));
    }
    numbers.push_back(*number);
  }
  return numbers;
}

Result<RigidTransform> pose_of_kitti(const std::vector<double>& v, const std::string& place) {
  RigidTransform pose;
  pose.rotation << v[0], v[1], v[2], v[4], v[5], v[6], v[8], v[9], v[10];
  pose.translation << v[3], v[7], v[11];
  const double off = (pose.rotation.transpose() * pose.rotation - Eigen::Matrix3d::Identity()).norm();
  if (!(off <= kRotationTolerance) || pose.rotation.determinant() < 0.0) {
    return bad_input(fmt::format("{}: the 3x3 block isn't a rotation (R^T R differs from 1 by {:.3g}, det R = {:.3g})",
                                 place, off, pose.rotation.determinant()));
  }
  return pose;
}

Result<RigidTransform> pose_of_tum(const std::vector<double>& v, const std::string& place) {
  const Eigen::Quaterniond rotation(v[7], v[4], v[5], v[6]);
  if (!(std::abs(rotation.norm() - 1.0) <= kRotationTolerance)) {
    return bad_input(fmt::format("{}: the quaternion's norm is {:.6g}, it must be 1", place, rotation.norm()));
  }
  return RigidTransform{rotation.normalized().toRotationMatrix(), {v[1], v[2], v[3]}};
}

Result<void> write_rows(const std::string& path, const std::vector<std::string>& rows) {
  return write_text(path, rows.empty() ? "" : fmt::format("{}\n", fmt::join(rows, "\n")));
}

}  // namespace

Result<Trajectory> read_trajectory(const std::string& path) {
  const Result<std::string> text = read_text(path);
  if (!text) return text.error();
  Trajectory trajectory;
  int numbers_a_row = 0;
  for (const internal::Line& line : internal::split_lines(*text)) {
    const std::vector<std::string_view> words = internal::split_words(line.text);
    if (words.empty() || words.front().front() == '#') continue;
    const std::string place = fmt::format("{}:{}", path, line.number);
    const int count = static_cast<int>(words.size());
    if (numbers_a_row == 0 && (count == kKittiNumbers || count == kTumNumbers)) numbers_a_row = count;
    if (count != numbers_a_row) {
      return bad_input(fmt::format("{}: {} values, a row must have {}", place, count,
                                   numbers_a_row == 0 ? "12 (KITTI: world_from_cam, row by row) or 8 (TUM: time tx ty "
                                                        "tz qx qy qz qw)"
                                                      : fmt::format("{} as the rows before", numbers_a_row)));
    }
    const Result<std::vector<double>> numbers = numbers_of(words, place);
    if (!numbers) return numbers.error();
    Result<RigidTransform> pose = count == kTumNumbers ? pose_of_tum(*numbers, place) : pose_of_kitti(*numbers, place);
    if (!pose) return pose.error();
    trajectory.world_from_cam.push_back(*pose);
    if (count != kTumNumbers) continue;
    const double time_s = numbers->front();
    if (trajectory.has_times() && time_s < trajectory.times_s.back()) {
      return bad_input(fmt::format("{}: time falls from {} to {} s", place, trajectory.times_s.back(), time_s));
    }
    trajectory.times_s.push_back(time_s);
  }
  if (trajectory.size() == 0) return bad_input(path + ": holds no pose");
  return trajectory;
}

std::string kitti_row(const RigidTransform& world_from_cam) {
  Eigen::Matrix<double, 3, 4, Eigen::RowMajor> rows;
  rows << world_from_cam.rotation, world_from_cam.translation;
  return fmt::format("{}", fmt::join(rows.data(), rows.data() + rows.size(), " "));
}

std::string tum_row(double time_s, const RigidTransform& world_from_cam) {
  Eigen::Quaterniond q = Eigen::Quaterniond(world_from_cam.rotation).normalized();
  if (q.w() < 0.0) q.coeffs() *= -1.0;
  const Eigen::Vector3d& t = world_from_cam.translation;
  const double numbers[] = {time_s, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
  return fmt::format("{}", fmt::join(numbers, " "));
}

Result<void> write_kitti(const std::string& path, const Trajectory& trajectory) {
  std::vector<std::string> rows;
  for (const RigidTransform& pose : trajectory.world_from_cam) rows.push_back(kitti_row(pose));
  return write_rows(path, rows);
}

Result<void> write_tum(const std::string& path, const Trajectory& trajectory) {
  GS_CHECK(trajectory.times_s.size() == trajectory.world_from_cam.size(), "TUM rows need a time a pose");
  std::vector<std::string> rows;
  for (std::size_t k = 0; k < trajectory.times_s.size(); ++k) {
    rows.push_back(tum_row(trajectory.times_s[k], trajectory.world_from_cam[k]));
  }
  return write_rows(path, rows);
}

}  // namespace groundscale
