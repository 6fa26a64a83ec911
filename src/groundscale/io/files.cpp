#include "groundscale/io/files.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>

#include "groundscale/io/bytes_internal.hpp"
#include "groundscale/io/text_internal.hpp"

namespace groundscale {
namespace {

std::string system_reason() { return errno == 0 ? "unknown reason" : std::strerror(errno); }

Error io_error(std::string_view what, const std::string& path) {
  return Error{ErrorCode::kIo, fmt::format("{}: {}: {}", path, what, system_reason())};
}

}  // namespace

Result<std::string> read_text(const std::string& path) {
  std::string text;
  if (Result<void> read = internal::read_bytes(path, &text); !read) return read.error();
  return text;
}

Result<void> internal::read_bytes(const std::string& path, std::string* bytes) {
  constexpr std::size_t kMaxBytes = std::size_t{1} << 30;
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) return internal::bad_input(path + ": is a folder, not a file");
  errno = 0;
  std::ifstream stream;
  stream.rdbuf()->pubsetbuf(nullptr, 0);  // straight into `bytes`
  stream.open(path, std::ios::binary);
  if (!stream) return internal::bad_input(fmt::format("{}: can't be opened: {}", path, system_reason()));
  // As long as the file says, then what more there is: not every file knows its length.
  const std::uintmax_t expected = std::filesystem::file_size(path, ignored);
  std::size_t filled = 0;
  for (std::size_t block = ignored || expected > kMaxBytes ? kBlock : expected + 1;; block = kBlock) {
    if (bytes->size() < filled + block) bytes->resize(filled + block);
    stream.read(bytes->data() + filled, static_cast<std::streamsize>(bytes->size() - filled));
    filled += static_cast<std::size_t>(stream.gcount());
    if (!stream) break;
    if (filled > kMaxBytes) return internal::bad_input(path + ": more than 1 GiB, this is no text file");
  }
  if (stream.bad()) return io_error("can't be read", path);
  bytes->resize(filled);
  return {};
}

Result<void> write_text(const std::string& path, std::string_view text) {
  const std::string beside = path + ".part";
  errno = 0;
  std::ofstream stream(beside, std::ios::binary | std::ios::trunc);
  stream.write(text.data(), static_cast<std::streamsize>(text.size()));
  stream.close();
  if (stream && std::rename(beside.c_str(), path.c_str()) == 0) return {};
  Error error = io_error("can't be written", path);
  std::error_code ignored;
  std::filesystem::remove(beside, ignored);
  return error;
}

Result<LineWriter> LineWriter::create(const std::string& path) {
  LineWriter writer(path);
  errno = 0;
  writer.stream_.open(path, std::ios::binary | std::ios::trunc);
  if (!writer.stream_) return io_error("can't be written", path);
  return writer;
}

Result<void> LineWriter::write(std::string_view line) {
  errno = 0;
  stream_.write(line.data(), static_cast<std::streamsize>(line.size()));
  stream_.put('\n');
  stream_.flush();
  if (stream_) {
    bytes_before_ = whole_bytes_;
    whole_bytes_ += line.size() + 1;
    return {};
  }
  Error error = io_error("can't be written", path_);
  stream_.close();
  std::error_code ignored;
  std::filesystem::resize_file(path_, whole_bytes_, ignored);
  return error;
}

void LineWriter::take_back() {
  stream_.close();
  std::error_code ignored;
  std::filesystem::resize_file(path_, bytes_before_, ignored);
  whole_bytes_ = bytes_before_;
}

Result<void> check_output_folder(const std::string& option, const std::string& folder, bool force) {
  if (folder.empty()) return internal::bad_input(fmt::format("{}: the folder's name is empty", option));
  std::error_code ignored;
  if (!std::filesystem::exists(folder, ignored)) return {};
  if (!std::filesystem::is_directory(folder, ignored)) {
    return internal::bad_input(fmt::format("{} {}: is a file, a folder is needed", option, folder));
  }
  if (!std::filesystem::is_empty(folder, ignored) && !force) {
    return internal::bad_input(fmt::format("{} {}: exists and isn't empty; --force overwrites it", option, folder));
  }
  return {};
}

Result<void> make_output_folder(const std::string& option, const std::string& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (!error) return {};
  return internal::bad_input(fmt::format("{} {}: can't be made: {}", option, folder, error.message()));
}

}  // namespace groundscale
