#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <string_view>

#include "groundscale/core/result.hpp"

namespace groundscale {

/// The whole file. @return kBadInput where there is no such file, it is a folder or can't be opened; kIo where reading
/// fails on the way; both with path and the system's reason.
Result<std::string> read_text(const std::string& path);

/// Writes beside and renames, so that the file is whole or as it was. @return kIo with path and the system's reason.
Result<void> write_text(const std::string& path, std::string_view text);

/// Whether results may be written into a folder: it isn't there, is empty, or `force` is set.
/// @param option  The command line's name of it, for messages: "--output".
/// @return kBadInput "option folder: why".
Result<void> check_output_folder(const std::string& option, const std::string& folder, bool force);
/// Makes a folder with all above it. @return kBadInput, as above.
Result<void> make_output_folder(const std::string& option, const std::string& folder);

/// A file that grows line by line and stays valid: each `write` reports a full disk at once and leaves no part of its
/// line behind.
class LineWriter {
 public:
  static Result<LineWriter> create(const std::string& path);
  Result<void> write(std::string_view line);  ///< Adds the line's end and flushes.
  /// Removes the last line that was written, once. Nothing may be written afterwards.
  void take_back();

 private:
  explicit LineWriter(std::string path) : path_(std::move(path)) {}
  std::string path_;
  std::ofstream stream_;
  std::uintmax_t whole_bytes_ = 0;   ///< Up to the end of the last line that was written,
  std::uintmax_t bytes_before_ = 0;  ///< and of the one before.
};

}  // namespace groundscale
