#include "ffmpeg.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "interrupt.hpp"

namespace pliant::cli {
namespace {

using namespace std::chrono_literals;

constexpr const char* program = "ffmpeg";
constexpr auto poll_pause = 20ms;

tl::unexpected<Error> missing(const std::string& reason) {
  return fail(
      ErrorCode::Unwritable,
      fmt::format(
          "--movie: cannot start ffmpeg, which writes the movie (Debian package ffmpeg): {}",
          reason));
}

// Starts it in its own process group, so that Ctrl-C reaches only us.
int spawn(std::vector<std::string> words, int input, const std::string& log, pid_t& id) {
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_adddup2(&files, input, STDIN_FILENO);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDERR_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC,
                                   0600);
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigemptyset(&signals);
  sigaddset(&signals, SIGPIPE);  // we ignore it, see `own_standard_streams`
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  const int failed =
      posix_spawnp(&id, arguments.front(), &files, &attributes, arguments.data(), environ);
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  return failed;
}

}  // namespace

bool is_on_path(std::string_view name) {
  const char* const path = std::getenv("PATH");
  std::string_view folders = path == nullptr ? "" : path;
  while (!folders.empty()) {
    const std::size_t end = std::min(folders.find(':'), folders.size());
    const auto file = std::filesystem::path(folders.substr(0, end)) / name;
    std::error_code ignored;
    if (access(file.c_str(), X_OK) == 0 && !std::filesystem::is_directory(file, ignored)) {
      return true;
    }
    folders.remove_prefix(std::min(end + 1, folders.size()));
  }
  return false;
}

Result<Ffmpeg> Ffmpeg::start(const std::vector<std::string>& words, const std::string& log) {
  std::vector<std::string> all = {program, "-hide_banner", "-nostdin", "-loglevel", "error", "-y"};
  all.insert(all.end(), words.begin(), words.end());
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return missing(std::strerror(errno));
  pid_t id = 0;
  const int failed = spawn(std::move(all), ends[0], log, id);
  close(ends[0]);
  if (failed != 0) {
    close(ends[1]);
    return missing(std::strerror(failed));
  }
  fcntl(ends[1], F_SETFL, fcntl(ends[1], F_GETFL) | O_NONBLOCK);
  return Ffmpeg(id, ends[1], log);
}

Ffmpeg::Ffmpeg(Ffmpeg&& other) noexcept
    : id_(std::exchange(other.id_, 0)),
      input_(std::exchange(other.input_, -1)),
      log_(std::move(other.log_)) {}

Ffmpeg::~Ffmpeg() {
  close_input();
  if (id_ == 0) return;
  kill(-id_, SIGKILL);  // its incomplete output is useless
  waitpid(id_, nullptr, 0);
}

void Ffmpeg::close_input() {
  if (input_ >= 0) close(input_);
  input_ = -1;
}

Result<void> Ffmpeg::write(std::string_view bytes) {
  while (!bytes.empty()) {
    if (was_interrupted()) return fail(ErrorCode::Interrupted, "interrupted");
    pollfd ready = {input_, POLLOUT, 0};
    if (poll(&ready, 1, static_cast<int>(std::chrono::milliseconds(100).count())) <= 0) continue;
    const ssize_t written = ::write(input_, bytes.data(), bytes.size());
    if (written > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EAGAIN && errno != EINTR) {
      return failure();
    }
  }
  return {};
}

Result<void> Ffmpeg::finish() {
  close_input();
  for (;;) {
    int status = 0;
    const pid_t ended = waitpid(id_, &status, WNOHANG);
    if (ended == id_) {
      id_ = 0;
      if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return {};
      return failure();
    }
    if (was_interrupted()) return fail(ErrorCode::Interrupted, "interrupted");
    std::this_thread::sleep_for(poll_pause);
  }
}

// The first line of its log: later ones are consequences.
tl::unexpected<Error> Ffmpeg::failure() const {
  std::ifstream file(log_);
  std::string line;
  std::getline(file, line);
  constexpr std::size_t longest = 300;
  return fail(ErrorCode::Unwritable,
              fmt::format("ffmpeg could not write the movie: {}",
                          line.empty() ? "it gave no reason" : printable(line.substr(0, longest))));
}

}  // namespace pliant::cli
