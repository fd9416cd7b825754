#include "cli/terminal/keeper.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/wait.h>
#include <unistd.h>

#include "cli/terminal/scratch_folder.hpp"
#include "cli/terminal/supervised_program.hpp"

namespace pliant::cli {

Result<Keeper> Keeper::start(std::vector<std::string> words, const ChildStreams& streams) {
  Pipe lifeline;
  if (!lifeline.open())
    return fail(ErrorCode::Unwritable, fmt::format("cannot make a pipe: {}", std::strerror(errno)));
  words.insert(words.begin(), {"/proc/self/exe", std::string(keeper_request)});
  ChildStreams its = streams;
  its.lifeline = lifeline.reading.number();
  const auto process = start_child(std::move(words), its);
  if (!process) return fail(process.error());
  return Keeper(*process, std::move(lifeline.writing));
}

Keeper::Keeper(Keeper&& other) noexcept
    : process_(std::exchange(other.process_, 0)),
      lifeline_(std::move(other.lifeline_)),
      code_(other.code_) {}

void Keeper::end() {
  lifeline_ = OpenDescriptor();
  if (process_ != 0) kill(process_, SIGCONT);  // if somebody has stopped it
  reap(0);
}

std::optional<int> Keeper::code() {
  reap(WNOHANG);
  return process_ == 0 ? std::optional(code_) : std::nullopt;
}

void Keeper::reap(int options) {
  int status = 0;
  pid_t ended = 0;
  while (process_ != 0 && (ended = waitpid(process_, &status, options)) < 0 && errno == EINTR)
    continue;
  if (process_ == 0 || ended == 0) return;
  process_ = 0;
  code_ = ended > 0 && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int run_keeper(std::span<char*> words) {
  sigset_t before, all;
  sigfillset(&all);
  sigprocmask(SIG_BLOCK, &all, &before);
  fcntl(ChildStreams::lifeline_end, F_SETFD, FD_CLOEXEC);
  if (words.size() < 2) return EINVAL;
  return words.size() == 2 ? keep_folder(words[0]) : keep_program(words[0], &words[1], before);
}

void release_streams() {
  const int nothing = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, stream);
  close(nothing);
}

}  // namespace pliant::cli
