#include "output_files.hpp"

#include <filesystem>
#include <system_error>

#include <fmt/format.h>

namespace groundscale {
namespace {

namespace fs = std::filesystem;

Error bad_output(const std::string& path, const std::string& why) {
  return {ErrorCode::kBadInput, fmt::format("--output {}: {}", path, why)};
}

bool same_file(const std::string& a, const std::string& b) {
  std::error_code ignored;
  return !a.empty() && !b.empty() && fs::equivalent(a, b, ignored);
}

}  // namespace

Result<void> check_output_files(const std::vector<std::string>& outputs, const std::vector<std::string>& inputs,
                                bool force) {
  for (const std::string& output : outputs) {
    std::error_code ignored;
    for (const std::string& input : inputs) {
      if (same_file(output, input)) return bad_output(output, "is read, another is needed");
    }
    if (fs::is_directory(output, ignored)) return bad_output(output, "is a folder, a file is needed");
    if (fs::exists(output, ignored) && !force) return bad_output(output, "exists; --force overwrites it");
    const fs::path folder = fs::path(output).parent_path();
    if (!folder.empty() && !fs::is_directory(folder, ignored)) {
      return bad_output(output, "there is no folder " + folder.string());
    }
  }
  return {};
}

}  // namespace groundscale
