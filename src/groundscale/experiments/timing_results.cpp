#include <algorithm>
#include <filesystem>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "groundscale/estimation/robust.hpp"
#include "groundscale/experiments/timing_results_internal.hpp"
#include "groundscale/io/files.hpp"

namespace groundscale::internal {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFile = "/times.json";
constexpr const char* kBefore[] = {"tracking", "motion", "road matching"};
constexpr const char* kSparseKind[] = {"triangulation", "decomposition", "sparse"};
constexpr double kMsPerS = 1e3;

/// Medians of the three, with something added; nothing where one isn't measured.
std::optional<std::pair<double, double>> range_of_sparse_kind(const Timings& timings, double plus_ms) {
  double low = std::numeric_limits<double>::infinity(), high = 0.0;
  for (const char* name : kSparseKind) {
    const TimedRow* row = timings.find(name);
    if (row == nullptr || row->ms.empty()) return std::nullopt;
    low = std::min(low, row->median_ms() + plus_ms);
    high = std::max(high, row->median_ms() + plus_ms);
  }
  return std::pair(low, high);
}

void add_findings(const Timings& timings, double plus_ms, const std::string& what,
                  std::vector<PaperFinding>& findings) {
  constexpr double kFar = 3.0, kAlike = 2.0;
  const auto range = range_of_sparse_kind(timings, plus_ms);
  const TimedRow* dense = timings.find("dense");
  PaperFinding slowest{fmt::format("dense is slowest by far ({})", what), {}, "a method that it names is not measured"};
  PaperFinding alike{
      fmt::format("triangulation, decomposition and sparse take alike ({})", what), {}, slowest.measured};
  if (range && dense != nullptr && !dense->ms.empty()) {
    const double ratio = (dense->median_ms() + plus_ms) / range->second;
    slowest.reproduced = ratio >= kFar;
    slowest.measured = fmt::format("{:.2f} times the slowest of the others, at least {:g} is far", ratio, kFar);
  }
  if (range) {
    const double ratio = range->second / range->first;
    alike.reproduced = ratio <= kAlike;
    alike.measured = fmt::format("slowest {:.2f} times the fastest, at most {:g} is alike", ratio, kAlike);
  }
  findings.push_back(std::move(slowest));
  findings.push_back(std::move(alike));
}

}  // namespace

double TimedRow::median_ms() const { return median(ms); }

double TimedRow::p95_ms() const {
  constexpr double kHigh = 0.95;
  return quantile(ms, kHigh);
}

const TimedRow* Timings::find(const std::string& name) const {
  const auto found = std::find_if(rows.begin(), rows.end(), [&name](const TimedRow& row) { return row.name == name; });
  return found == rows.end() ? nullptr : &*found;
}

double Timings::before_ms() const {
  double sum = 0.0;
  for (const TimedRow& row : rows) sum += row.method || row.ms.empty() ? 0.0 : row.median_ms();
  return sum;
}

Result<void> add_timings(const RenderedDrive& drive, const std::vector<PlaneMethod>& methods,
                         const OdometryOptions& options, Timings& timings) {
  auto walk = PairWalk::open(drive, {.odometry = options});
  if (!walk) return walk.error();
  timings.rows.clear();
  for (const char* name : kBefore) timings.rows.push_back({.name = name, .ms = {}});
  const std::size_t first = timings.rows.size();
  std::vector<EstimatePlane> estimates;
  std::vector<Rng> rngs;
  for (const PlaneMethod& method : methods) {
    timings.rows.push_back({.name = std::string(method.name), .method = true, .ms = {}});
    estimates.push_back(method.make(options.ground.plane));
    rngs.emplace_back(static_cast<std::uint64_t>(options.seed));
  }
  while (walk->next()) {
    const RegionOptions& region = options.road.region;
    const RoadObservations observations = walk->observe(walk->region(region), region);
    const PairTimes& times = walk->times();
    std::size_t k = 0;
    for (const double seconds : {times.tracking_s, times.motion_s, times.road_s}) {
      timings.rows[k++].ms.push_back(kMsPerS * seconds);
    }
    for (std::size_t m = 0; m < methods.size(); ++m) {
      const double start_s = thread_cpu_s();
      const auto plane = estimates[m](observations, rngs[m]);
      timings.rows[first + m].ms.push_back(kMsPerS * (thread_cpu_s() - start_s));
      if (!plane) ++timings.rows[first + m].refused;
    }
  }
  return {};
}

Result<void> write_timings(const Timings& timings, const std::string& folder) {
  Json json = Json::array();
  for (const TimedRow& row : timings.rows) {
    json.push_back({{"name", row.name}, {"method", row.method}, {"refused", row.refused}, {"ms", row.ms}});
  }
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  return write_text(folder + kFile, json.dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

Result<Timings> read_timings(const std::string& folder) {
  const auto text = read_text(folder + kFile);
  if (!text) return Error{ErrorCode::kIo, text.error().message};
  try {
    Timings timings;
    for (const Json& row : Json::parse(*text)) {
      timings.rows.push_back({row.at("name").get<std::string>(), row.at("method").get<bool>(),
                              row.at("ms").get<std::vector<double>>(), row.at("refused").get<int>()});
    }
    return timings;
  } catch (const Json::exception& error) {
    return Error{ErrorCode::kIo, fmt::format("{}: a result in it can't be read: {}", folder, error.what())};
  }
}

void append(const Timings& more, Timings& timings) {
  if (timings.rows.empty()) {
    timings = more;
    return;
  }
  for (std::size_t k = 0; k < timings.rows.size(); ++k) {
    timings.rows[k].ms.insert(timings.rows[k].ms.end(), more.rows[k].ms.begin(), more.rows[k].ms.end());
    timings.rows[k].refused += more.rows[k].refused;
  }
}

Table timing_table(const Timings& timings) {
  Table table({{.name = "part", .title = "part", .text = true},
               {.name = "kind", .title = "", .text = true},
               {.name = "frames", .title = "frames", .decimals = 0, .averaged = false},
               {.name = "refused", .title = "refused", .decimals = 0, .averaged = false},
               {.name = "median_ms", .title = "median ms", .averaged = false},
               {.name = "p95_ms", .title = "95 % below ms", .averaged = false},
               {.name = "times_sparse", .title = "times sparse", .averaged = false},
               {.name = "frame_ms", .title = "with all before ms", .averaged = false}});
  const TimedRow* sparse = timings.find("sparse");
  for (const TimedRow& row : timings.rows) {
    std::optional<double> ratio, whole, refused;
    if (row.method) {
      refused = row.refused;
      whole = timings.before_ms() + row.median_ms();
      if (sparse != nullptr) ratio = row.median_ms() / sparse->median_ms();
    }
    table.add_row({row.name, std::string(row.method ? "method" : "before"),
                   std::optional(static_cast<double>(row.ms.size())), refused, std::optional(row.median_ms()),
                   std::optional(row.p95_ms()), ratio, whole});
  }
  return table;
}

std::string timing_overview(const Table& table) {
  return table.markdown({"part", "kind", "frames", "refused", "median_ms", "p95_ms", "times_sparse", "frame_ms"});
}

Plot timing_plot(const Timings& timings) {
  Plot plot{.name = "time",
            .title = "Time a frame, one core: median (bar) and 95th percentile (point)",
            .x_label = "",
            .y_label = "ms",
            .columns = {"row", "before_ms", "method_ms", "p95_ms"},
            .rows = {},
            .curves = {{.title = "before any method", .y = 1, .style = CurveStyle::kBars, .colour = 6},
                       {.title = "method", .y = 2, .style = CurveStyle::kBars, .colour = 1},
                       {.title = "95 % below", .y = 3, .style = CurveStyle::kPoints, .colour = 0}},
            .settings = {"set boxwidth 0.7", "set logscale y", "set yrange [0.01:*]"}};
  std::string names;
  for (std::size_t k = 0; k < timings.rows.size(); ++k) {
    const TimedRow& row = timings.rows[k];
    const std::optional<double> median = row.median_ms();
    plot.rows.push_back(
        {static_cast<double>(k), row.method ? std::nullopt : median, row.method ? median : std::nullopt, row.p95_ms()});
    names += fmt::format("{}'{}' {}", names.empty() ? "" : ", ", row.name, k);
  }
  plot.settings.push_back(fmt::format("set xtics ({}) rotate by 30 right", names));
  plot.settings.push_back(fmt::format("set xrange [-0.7:{}.7]", timings.rows.size() - 1));
  plot.settings.emplace_back("set bmargin 9");
  return plot;
}

std::vector<PaperFinding> timing_findings(const Timings& timings) {
  std::vector<PaperFinding> findings;
  add_findings(timings, 0.0, "the method alone", findings);
  add_findings(timings, timings.before_ms(), "with tracking, motion and road matching", findings);
  return findings;
}

std::vector<Aim> timing_aims(const Timings& timings) {
  constexpr double kSparseMs = 3.0, kDenseMs = 25.0;
  std::vector<Aim> aims;
  for (const auto& [name, limit_ms] : {std::pair("sparse", kSparseMs), std::pair("triangulation", kSparseMs),
                                       std::pair("decomposition", kSparseMs), std::pair("dense", kDenseMs)}) {
    Aim aim{fmt::format("{} takes at most {:g} ms a frame (median, KITTI's size)", name, limit_ms), {}, "not measured"};
    const TimedRow* row = timings.find(name);
    if (row != nullptr && !row->ms.empty()) {
      aim.met = row->median_ms() <= limit_ms;
      aim.measured = fmt::format("{:.2f} ms", row->median_ms());
    }
    aims.push_back(std::move(aim));
  }
  return aims;
}

}  // namespace groundscale::internal
