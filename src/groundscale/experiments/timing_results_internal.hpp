#pragma once

#include <string>
#include <vector>

#include "groundscale/experiments/aims.hpp"
#include "groundscale/experiments/pair_walk.hpp"
#include "groundscale/experiments/paper_finding.hpp"
#include "groundscale/experiments/plot.hpp"
#include "groundscale/experiments/table.hpp"
#include "groundscale/plane/methods.hpp"

namespace groundscale::internal {

/// CPU time of one thread in milliseconds, a number a frame.
struct TimedRow {
  std::string name;
  bool method = false;  ///< Else what comes before any method.
  std::vector<double> ms;
  int refused = 0;  ///< Frames without a result: they count.

  double median_ms() const;
  double p95_ms() const;
};

/// Rows of what comes before, in their order, then the methods.
struct Timings {
  std::vector<TimedRow> rows;

  const TimedRow* find(const std::string& name) const;
  /// Sum of the medians of what comes before any method.
  double before_ms() const;
};

/// Adds the frames of a drive. Every method is handed the same observations. @return errors of PairWalk::open.
Result<void> add_timings(const RenderedDrive& drive, const std::vector<PlaneMethod>& methods,
                         const OdometryOptions& options, Timings& timings);

/// Kept results. @return kIo.
Result<void> write_timings(const Timings& timings, const std::string& folder);
Result<Timings> read_timings(const std::string& folder);
/// The frames of both, row by row.
void append(const Timings& more, Timings& timings);

Table timing_table(const Timings& timings);
std::string timing_overview(const Table& table);
/// A bar a row up to the median, a point at the 95th percentile. The axis is logarithmic.
Plot timing_plot(const Timings& timings);

/// By medians, of the method alone and with all that comes before it:
/// - dense is slowest by far: at least 3 times the slowest of triangulation, decomposition and sparse;
/// - these three are alike: the slowest takes at most twice as long as the fastest.
std::vector<PaperFinding> timing_findings(const Timings& timings);
/// At KITTI's size: sparse, triangulation and decomposition at most 3 ms, dense at most 25 ms (medians).
std::vector<Aim> timing_aims(const Timings& timings);

}  // namespace groundscale::internal
