#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "groundscale/experiments/contamination.hpp"
#include "groundscale/experiments/pair_walk.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/experiments/rendered_drive.hpp"
#include "groundscale/experiments/table.hpp"
#include "groundscale/plane/methods.hpp"

namespace groundscale::internal {

/// What is looked at: a fixed strip with obstacles in it, all of it; its road alone, as a perfect detector sees it; the
/// strip along the path.
inline constexpr std::string_view kWholeRegion = "whole", kRoadMask = "mask", kPathRegion = "path";

/// One method on one pair of frames.
struct ContaminationRecord {
  std::string drive;
  int frame = 0;
  std::string region;
  double wanted_share = 0.0;  ///< Of the fixed strip's pixels that aren't road.
  double share = 0.0;         ///< Of those of the region that is looked at.
  std::string method;
  std::optional<double> error;  ///< Step over the true one, less 1; nothing where the method refuses.
};

/// A strip of the road as it is laid out in an image.
struct PlacedStrip {
  RegionOptions options;  ///< Its polygon.
  Image mask;
  double share = 0.0;  ///< Of its pixels that aren't road.
};

/// Straight ahead, shifted to the right by `shift_m`.
PlacedStrip place_strip(const PairWalk& walk, const RegionOptions& strip, double shift_m);

/// For each share the shift that comes nearest, the smallest of equals; nothing where it stays more than 0.025 away.
std::vector<std::optional<PlacedStrip>> strips_of_shares(const PairWalk& walk, const RegionOptions& strip,
                                                         const std::vector<double>& shares);

/// All pairs of a drive. @return errors of PairWalk::open; kBadInput where the drive has no road masks.
Result<std::vector<ContaminationRecord>> measure_contamination(const RenderedDrive& drive,
                                                               const std::vector<PlaneMethod>& methods,
                                                               const std::vector<double>& shares,
                                                               const PairWalkOptions& options);

/// Kept results. @return kIo.
Result<void> write_records(const std::vector<ContaminationRecord>& records, const std::string& folder);
Result<std::vector<ContaminationRecord>> read_records(const std::string& folder);

/// A row a record.
Table records_table(const std::vector<ContaminationRecord>& records);
/// A row a region, share and method: pairs, how many are measured, bias, median and 95th percentile of |error|.
Table contamination_table(const std::vector<ContaminationRecord>& records);
/// Of a region: a row a share, a column a method with the median of |error| in percent.
std::string contamination_overview(const std::vector<ContaminationRecord>& records, std::string_view region);
/// A figure a region: the median over the share, a curve a method.
std::vector<Plot> contamination_plots(const std::vector<ContaminationRecord>& records);

}  // namespace groundscale::internal
