#include "calibrate_plan.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "groundscale/calibration/focal_search.hpp"
#include "groundscale/camera/pinhole.hpp"
#include "groundscale/io/camera_file.hpp"

namespace groundscale {
namespace {

Error bad_input(std::string message) { return {ErrorCode::kBadInput, std::move(message)}; }

/// Notes what is wrong with a drive's frames while they are read.
class NotingSequence : public Sequence {
 public:
  NotingSequence(std::unique_ptr<Sequence> sequence, std::shared_ptr<std::set<std::string>> warnings)
      : sequence_(std::move(sequence)), warnings_(std::move(warnings)) {}

  std::optional<Frame> next() override {
    auto frame = sequence_->next();
    if (frame && frame->image.empty()) warnings_->insert(fmt::format("frame {}: {}", frame->index, frame->problem));
    if (!frame) {
      for (const std::string& warning : sequence_->warnings()) warnings_->insert(warning);
    }
    return frame;
  }
  int first_frame() const override { return sequence_->first_frame(); }
  int frame_count() const override { return sequence_->frame_count(); }
  int width() const override { return sequence_->width(); }
  int height() const override { return sequence_->height(); }
  std::vector<std::string> image_names() const override { return sequence_->image_names(); }
  std::string calibration_path() const override { return sequence_->calibration_path(); }
  std::optional<int> kitti_image() const override { return sequence_->kitti_image(); }
  std::vector<std::string> warnings() const override { return sequence_->warnings(); }
  bool has_times() const override { return sequence_->has_times(); }

 private:
  std::unique_ptr<Sequence> sequence_;
  std::shared_ptr<std::set<std::string>> warnings_;
};

/// The camera of --camera or the one that lies with the images; of --fov; or none: its focal length is searched for.
Result<void> choose_start(const CalibrateArguments& a, const SourceArguments& own, const Sequence& sequence,
                          CalibrationPlan& plan) {
  const bool named = !plan.config.run.camera.empty();
  if (!a.fov_deg && (named || !sequence.calibration_path().empty())) {
    auto camera = choose_camera(own, plan.config.run, sequence);
    if (!camera) return camera.error();
    plan.camera = std::move(*camera);
    return {};
  }
  if (named) return bad_input("--fov and --camera: one of them says the focal length");
  plan.focal_known = false;
  plan.focal_searched = !a.fov_deg.has_value();
  constexpr double kAnyFovDeg = 80.0;
  const double focal_px = focal_of_view(a.fov_deg.value_or(kAnyFovDeg), sequence.width());
  auto camera = plain_pinhole(focal_px, sequence.width(), sequence.height());
  if (!camera) return camera.error();
  plan.camera.setup.camera = *camera;
  plan.camera.camera_from = a.fov_deg ? fmt::format("--fov {:g}", *a.fov_deg) : "nothing";
  return choose_height(own, plan.config.run, sequence, plan.camera);
}

/// How far apart the pixels of one ray lie, at most, over the image.
double apart_px(const Camera& a, const Camera& b) {
  constexpr int kSteps = 8;
  double apart = 0.0;
  for (int row = 0; row <= kSteps; ++row) {
    for (int column = 0; column <= kSteps; ++column) {
      const Eigen::Vector2d pixel((a.width() - 1.0) * column / kSteps, (a.height() - 1.0) * row / kSteps);
      const auto ray = a.ray(pixel);
      if (!ray) continue;
      const auto other = b.project(*ray);
      if (!other) return HUGE_VAL;
      apart = std::max(apart, (*other - pixel).norm());
    }
  }
  return apart;
}

/// Where nothing else says the camera, another drive's own calibration must be that of the first.
Result<void> check_calibration(const SourceArguments& own, const RunConfig& config, const Sequence& sequence,
                               const CalibrationPlan& plan) {
  if (sequence.calibration_path().empty()) return {};
  const std::string& first = plan.drives.front().source;
  if (plan.focal_searched) {
    return bad_input(fmt::format("{} has a calibration, {} has none: --camera FILE names one for all drives",
                                 config.run.source, first));
  }
  const auto camera = choose_camera(own, config.run, sequence);
  if (!camera) return camera.error();
  constexpr double kRoundingPx = 0.05;
  const double apart = apart_px(*plan.camera.setup.camera, *camera->setup.camera);
  if (apart <= kRoundingPx) return {};
  const std::string by = std::isfinite(apart) ? fmt::format("by up to {:.1f} px", apart) : "altogether";
  return bad_input(
      fmt::format("{}: differs from {} {}: all drives must be of one camera; --camera FILE names one for "
                  "all of them",
                  camera->camera_from, plan.camera.camera_from, by));
}

Result<void> add_drive(const CalibrateArguments& a, const std::string& source, CalibrationPlan& plan) {
  SourceArguments own = a.source;
  own.source = source;
  auto config = read_config(own);
  if (!config) return config.error();
  for (const CalibrationPlan::Drive& other : plan.drives) {
    std::error_code ignored;
    if (other.source == source || std::filesystem::equivalent(other.source, source, ignored)) {
      return bad_input(fmt::format("{} is there twice: a drive must count once", source));
    }
  }
  auto sequence = open_drive(config->run);
  if (!sequence) return sequence.error();
  if (plan.drives.empty()) {
    plan.config = *config;
    if (const auto chosen = choose_start(a, own, **sequence, plan); !chosen) return chosen;
  }
  const Camera& camera = *plan.camera.setup.camera;
  if ((*sequence)->width() != camera.width() || (*sequence)->height() != camera.height()) {
    return bad_input(fmt::format("{}: images of {} x {} px, the camera has {} x {}: all drives must be of one camera",
                                 source, (*sequence)->width(), (*sequence)->height(), camera.width(), camera.height()));
  }
  if (!plan.drives.empty() && !a.fov_deg && config->run.camera.empty()) {
    if (const auto fine = check_calibration(own, *config, **sequence, plan); !fine) return fine;
  }
  plan.drives.push_back(
      {source, (*sequence)->first_frame(), (*sequence)->frame_count(), (*sequence)->calibration_path()});
  plan.readers.push_back({source, [run = config->run, warnings = plan.warnings]() -> Result<std::unique_ptr<Sequence>> {
                            auto opened = open_drive(run);
                            if (!opened) return opened;
                            return std::unique_ptr<Sequence>(
                                std::make_unique<NotingSequence>(std::move(*opened), warnings));
                          }});
  return {};
}

}  // namespace

int CalibrationPlan::frames() const {
  int sum = 0;
  for (const Drive& drive : drives) sum += drive.frames;
  return sum;
}

Result<CameraPtr> plain_pinhole(double focal_px, int width, int height) {
  return PinholeCamera::create({.fx = focal_px, .fy = focal_px, .cx = 0.5 * (width - 1), .cy = 0.5 * (height - 1)},
                               width, height);
}

Result<CalibrationPlan> make_calibration_plan(const CalibrateArguments& arguments) {
  if (arguments.fov_deg && !(*arguments.fov_deg >= 20.0 && *arguments.fov_deg <= 140.0)) {
    return bad_input(fmt::format("--fov {}: must be from 20 to 140 degrees, from left to right", *arguments.fov_deg));
  }
  CalibrationPlan plan;
  plan.warnings = std::make_shared<std::set<std::string>>();
  for (const std::string& source : arguments.sources) {
    if (const auto added = add_drive(arguments, source, plan); !added) return added.error();
  }
  return plan;
}

}  // namespace groundscale
