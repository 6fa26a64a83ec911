#include "groundscale/mapping/drive_recorder.hpp"

#include "groundscale/estimation/robust.hpp"

namespace groundscale {

void visit_fields(DriveRecorderOptions& options, FieldVisitor& visitor) {
  visitor.field({.key = "view_px",
                 .unit = "px",
                 .help = "median motion of the tracks after which a frame becomes the next view",
                 .min = 0.5,
                 .max = 1000},
                options.view_px);
  visitor.field({.key = "view_share",
                 .unit = "",
                 .help = "share of the view's tracks still followed, below a frame becomes the next view",
                 .min = 0,
                 .max = 1},
                options.view_share);
}

void DriveRecorder::add(int index, int frame, const std::vector<TrackPoint>& tracks) {
  if (!indices_.empty()) {
    const Matches shared = match_by_id(last_, tracks);
    std::vector<double> motions;
    for (const Match& match : shared) motions.push_back((match.pixel2 - match.pixel1).norm());
    const bool thinned = static_cast<double>(shared.size()) < options_.view_share * static_cast<double>(last_.size());
    if (!thinned && !(median(std::move(motions)) >= options_.view_px)) return;
  }
  const int view = static_cast<int>(indices_.size());
  for (const TrackPoint& point : tracks) tracks_[point.id].push_back({view, point.pixel});
  indices_.push_back(index);
  frames_.push_back(frame);
  last_ = tracks;
}

DriveTracks DriveRecorder::drive(const std::vector<RigidTransform>& world_from_cam) const {
  DriveTracks drive;
  for (std::size_t view = 0; view < indices_.size(); ++view) {
    drive.views.push_back({frames_[view], world_from_cam[static_cast<std::size_t>(indices_[view])].inverse()});
  }
  for (const auto& [id, sights] : tracks_) {
    if (sights.size() >= 2) drive.tracks.push_back({id, sights});
  }
  return drive;
}

}  // namespace groundscale
