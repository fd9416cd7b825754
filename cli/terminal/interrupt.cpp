#include "cli/terminal/interrupt.hpp"

#include <atomic>
#include <csignal>
#include <initializer_list>

#include <fcntl.h>
#include <sys/resource.h>
#include <unistd.h>

namespace pliant::cli {
namespace {

std::atomic<bool> was_signalled = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler must not wait");

void note_interrupt(int) { was_signalled = true; }

}  // namespace

void catch_interrupts() {
  struct sigaction action = {};
  action.sa_handler = &note_interrupt;
  // Without SA_RESTART, so that a read that waits for a pipe ends too. SA_RESETHAND: the second
  // signal ends the program.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  for (const int signal : {SIGINT, SIGTERM}) sigaction(signal, &action, nullptr);
  struct sigaction present = {};  // nohup lets it be ignored
  if (sigaction(SIGHUP, nullptr, &present) == 0 && present.sa_handler != SIG_IGN)
    sigaction(SIGHUP, &action, nullptr);
  std::signal(SIGXFSZ, SIG_IGN);
}

void own_standard_streams() {
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
    // `open` returns the lowest free descriptor, which is this one. stdout is opened for reading,
    // so every write fails, which is reported.
    if (fcntl(stream, F_GETFD) < 0)
      open("/dev/null", stream == STDERR_FILENO ? O_WRONLY : O_RDONLY);
  }
  std::signal(SIGPIPE, SIG_IGN);
}

void raise_file_limit() {
  rlimit limit = {};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

bool was_interrupted() { return was_signalled; }

Error with_kept(Error error, std::string_view kept) {
  if (error.code == ErrorCode::Interrupted) error.message.append("; ").append(kept);
  return error;
}

}  // namespace pliant::cli
