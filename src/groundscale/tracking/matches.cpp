#include "groundscale/tracking/matches.hpp"

namespace groundscale {

Matches match_by_id(const std::vector<TrackPoint>& points1, const std::vector<TrackPoint>& points2) {
  Matches matches;
  auto p2 = points2.begin();
  for (const TrackPoint& p1 : points1) {
    while (p2 != points2.end() && p2->id < p1.id) ++p2;
    if (p2 == points2.end()) break;
    if (p2->id == p1.id) matches.push_back({p1.id, p1.pixel, p2->pixel});
  }
  return matches;
}

}  // namespace groundscale
