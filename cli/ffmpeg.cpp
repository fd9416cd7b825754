#include "ffmpeg.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <fstream>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "child.hpp"
#include "interrupt.hpp"

namespace pliant::cli {
namespace {

using namespace std::chrono_literals;

constexpr const char* program = "ffmpeg";
constexpr auto poll_pause = 20ms;

tl::unexpected<Error> missing(const std::string& reason) {
  return fail(
      ErrorCode::Unwritable,
      fmt::format("--movie needs ffmpeg to write the movie (Debian package ffmpeg): {}", reason));
}

}  // namespace

Result<Ffmpeg> Ffmpeg::start(const std::vector<std::string>& words, const std::string& log) {
  std::vector<std::string> all = {program, "-hide_banner", "-nostdin", "-loglevel", "error", "-y"};
  all.insert(all.end(), words.begin(), words.end());
  const int messages = open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  int ends[2];
  if (messages < 0 || pipe2(ends, O_CLOEXEC) != 0) {
    const int error = errno;
    if (messages >= 0) close(messages);
    return missing(std::strerror(error));
  }
  const auto id = start_child(std::move(all), {.input = ends[0], .errors = messages});
  close(messages);
  close(ends[0]);
  if (!id) {
    close(ends[1]);
    return missing(id.error().message);
  }
  fcntl(ends[1], F_SETFL, fcntl(ends[1], F_GETFL) | O_NONBLOCK);
  return Ffmpeg(*id, ends[1], log);
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
