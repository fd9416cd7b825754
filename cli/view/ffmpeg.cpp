#include "cli/view/ffmpeg.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <fstream>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include "cli/terminal/interrupt.hpp"

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

Result<Ffmpeg> Ffmpeg::start(const std::vector<std::string>& words, const ScratchFolder& folder) {
  std::vector<std::string> all = {program, "-hide_banner", "-nostdin", "-loglevel", "error", "-y"};
  all.insert(all.end(), words.begin(), words.end());
  const std::string log = folder.path() + "/log";
  const OpenDescriptor messages(open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  Pipe pixels;
  if (!messages.is_open() || !pixels.open()) return missing(std::strerror(errno));
  auto kept = KeptProgram::start(
      std::move(all), {.input = pixels.reading.number(), .errors = messages.number()}, folder);
  if (!kept) return missing(kept.error().message);
  const int input = pixels.writing.number();
  fcntl(input, F_SETFL, fcntl(input, F_GETFL) | O_NONBLOCK);
  return Ffmpeg(*std::move(kept), std::move(pixels.writing), log);
}

Result<void> Ffmpeg::write(std::string_view bytes) {
  while (!bytes.empty()) {
    if (was_interrupted()) return interrupted();
    pollfd ready = {input_.number(), POLLOUT, 0};
    if (poll(&ready, 1, static_cast<int>(std::chrono::milliseconds(100).count())) <= 0) continue;
    const ssize_t written = ::write(input_.number(), bytes.data(), bytes.size());
    if (written > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(written));
    } else if (errno != EAGAIN && errno != EINTR) {
      return failure();
    }
  }
  return {};
}

Result<void> Ffmpeg::finish() {
  input_ = OpenDescriptor();
  for (;;) {
    if (const auto code = program_.code()) return *code == 0 ? Result<void>() : failure();
    if (was_interrupted()) return interrupted();
    std::this_thread::sleep_for(poll_pause);
  }
}

// The first line of its log, or the beginning of it: later ones are consequences.
tl::unexpected<Error> Ffmpeg::failure() const {
  std::ifstream file(log_);
  constexpr std::size_t longest = 300;
  std::array<char, longest + 1> bytes = {};
  file.getline(bytes.data(), bytes.size());
  const std::string_view line = bytes.data();
  return fail(ErrorCode::Unwritable,
              fmt::format("ffmpeg could not write the movie: {}",
                          line.empty() ? "it gave no reason" : printable(line)));
}

}  // namespace pliant::cli
