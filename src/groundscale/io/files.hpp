#pragma once

#include <fstream>
#include <string>
#include <string_view>

#include "groundscale/core/result.hpp"

namespace groundscale {

Result<std::string> read_text(const std::string& path);

/// Writes beside and renames, so that the file is whole or as it was. @return kIo with path and the system's reason.
Result<void> write_text(const std::string& path, std::string_view text);

/// A file that grows line by line and stays valid: each `write` reports a full disk at once.
class LineWriter {
 public:
  static Result<LineWriter> create(const std::string& path);
  Result<void> write(std::string_view line);  ///< Adds the line's end and flushes.

 private:
  explicit LineWriter(std::string path) : path_(std::move(path)) {}
  std::string path_;
  std::ofstream stream_;
};

}  // namespace groundscale
