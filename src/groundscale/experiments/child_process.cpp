#include "groundscale/experiments/child_process.hpp"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>

#include <fmt/format.h>

#include "groundscale/io/files.hpp"

namespace groundscale {
namespace {

/// A file descriptor that is closed with the object, and in every program that is started meanwhile.
class Descriptor {
 public:
  explicit Descriptor(int number) : number_(number) {}
  ~Descriptor() { close_now(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int number() const { return number_; }
  void close_now() {
    if (number_ >= 0) close(number_);
    number_ = -1;
  }

 private:
  int number_;
};

Error failure(const std::string& what) {
  return Error{ErrorCode::kIo, fmt::format("{}: {}", what, std::strerror(errno))};
}

/// In the child, between fork and exec: only what is allowed there, nothing that allocates.
[[noreturn]] void become(char* const* words, const char* folder, int output, int failed, pid_t caller) {
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  const int nothing = open("/dev/null", O_RDONLY | O_CLOEXEC);
  if (getppid() == caller && nothing >= 0 && dup2(nothing, STDIN_FILENO) >= 0 && dup2(output, STDOUT_FILENO) >= 0 &&
      (folder[0] == '\0' || chdir(folder) == 0)) {
    execvp(words[0], words);
  }
  const int why = errno;
  [[maybe_unused]] const ssize_t written = write(failed, &why, sizeof(why));
  constexpr int kNotStarted = 127;
  _exit(kNotStarted);
}

/// Why the child couldn't start; 0 where it could: then exec has closed the pipe's other end.
int why_not_started(int pipe_end) {
  int why = 0;
  ssize_t bytes = 0;
  do {
    bytes = read(pipe_end, &why, sizeof(why));
  } while (bytes < 0 && errno == EINTR);
  return bytes == static_cast<ssize_t>(sizeof(why)) ? why : 0;
}

double seconds_of(const timeval& time) {
  constexpr double kMicrosecond = 1e-6;
  return static_cast<double>(time.tv_sec) + kMicrosecond * static_cast<double>(time.tv_usec);
}

}  // namespace

Result<ChildResult> run_child(const ChildCommand& command) {
  std::vector<std::string> texts = {command.program};
  texts.insert(texts.end(), command.arguments.begin(), command.arguments.end());
  std::vector<char*> words;
  for (std::string& text : texts) words.push_back(text.data());
  words.push_back(nullptr);

  constexpr mode_t kMode = 0666;
  const Descriptor output(open(command.output.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, kMode));
  if (output.number() < 0) return failure(command.output + ": can't be written");
  int ends[2] = {-1, -1};
  if (pipe2(ends, O_CLOEXEC) != 0) return failure(command.program + ": can't be started");
  const Descriptor reading(ends[0]);
  Descriptor writing(ends[1]);

  const auto start = std::chrono::steady_clock::now();
  const pid_t caller = getpid();
  const pid_t child = fork();
  if (child < 0) return failure(command.program + ": can't be started");
  if (child == 0) become(words.data(), command.folder.c_str(), output.number(), writing.number(), caller);
  writing.close_now();
  const int why = why_not_started(reading.number());
  int status = 0;
  rusage usage{};
  while (wait4(child, &status, 0, &usage) < 0) {
    if (errno != EINTR) return failure(command.program + ": can't be waited for");
  }
  errno = why;
  if (why != 0) return failure(command.program + ": can't be started");

  constexpr int kSignalled = 128;
  constexpr double kKilobytesInMb = 1024.0;
  ChildResult result;
  result.status = WIFEXITED(status) ? WEXITSTATUS(status) : kSignalled + WTERMSIG(status);
  result.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  result.cpu_s = seconds_of(usage.ru_utime) + seconds_of(usage.ru_stime);
  result.peak_memory_mb = static_cast<double>(usage.ru_maxrss) / kKilobytesInMb;
  return result;
}

std::string shell_line(const std::vector<std::string>& words) {
  constexpr std::string_view kPlain = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=.,:/@%";
  std::string line;
  for (const std::string& word : words) {
    if (!line.empty()) line += ' ';
    if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) {
      line += word;
      continue;
    }
    line += '\'';
    for (const char c : word) line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    line += '\'';
  }
  return line;
}

std::string command_of_this_process() {
  std::vector<std::string> words = {"groundscale"};
  const auto text = read_text("/proc/self/cmdline");
  if (!text) return words.front();
  std::size_t begin = text->find('\0');
  while (begin != std::string::npos && begin + 1 < text->size()) {
    const std::size_t end = text->find('\0', begin + 1);
    words.push_back(text->substr(begin + 1, end - begin - 1));
    begin = end;
  }
  return shell_line(words);
}

}  // namespace groundscale
