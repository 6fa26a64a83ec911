#include "groundscale/experiments/work_unit.hpp"

#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

#include <fmt/format.h>

#include "groundscale/core/hash.hpp"
#include "groundscale/io/files.hpp"

namespace groundscale {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBegun = "begun\n";
constexpr std::string_view kDone = "done\n";

}  // namespace

WorkUnit::WorkUnit(std::string folder, std::string key) : folder_(std::move(folder)), key_(std::move(key)) {}

bool WorkUnit::done() const {
  std::error_code ignored;
  if (!fs::is_directory(folder_, ignored)) return false;
  const auto mark = read_text(key_file());
  return mark && *mark == std::string(kDone) + key_;
}

/// Empties what a unit left; never anything else.
Result<void> WorkUnit::clear() const {
  std::error_code error;
  const auto mark = read_text(key_file());
  const bool ours = mark && (mark->starts_with(kBegun) || mark->starts_with(kDone));
  if (!ours && fs::exists(folder_, error)) {
    return Error{ErrorCode::kBadInput,
                 fmt::format("{}: isn't from an experiment (it has no {}); it must go first", folder_, key_file())};
  }
  fs::create_directories(fs::path(folder_).parent_path(), error);
  if (const auto written = write_text(key_file(), std::string(kBegun) + key_); !written) return written;
  fs::remove_all(folder_, error);
  if (!error) return {};
  return Error{ErrorCode::kIo, fmt::format("{}: can't be removed: {}", folder_, error.message())};
}

Result<void> WorkUnit::complete(bool anew, const std::function<Result<void>()>& work) const {
  if (!anew && done()) return {};
  if (const auto cleared = clear(); !cleared) return cleared;
  if (const auto worked = work(); !worked) return worked;
  return write_text(key_file(), std::string(kDone) + key_);
}

Result<std::string> file_digest(const std::string& path) {
  const auto bytes = read_text(path);
  if (!bytes) return bytes.error();
  Fnv1a hash;
  hash.add(*bytes);
  return hash.text();
}

}  // namespace groundscale
