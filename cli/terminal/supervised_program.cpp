#include "cli/terminal/supervised_program.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;

constexpr int no_such_program = 127, ended_by_signal = 128;  // exit codes, as of shells

int code_from(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : ended_by_signal + WTERMSIG(status);
}

// The parent of a process; 0: it has ended, before the file was opened or before it was read.
pid_t parent_of(const std::string& process) {
  const OpenDescriptor file(
      open(fmt::format("/proc/{}/stat", process).c_str(), O_RDONLY | O_CLOEXEC));
  std::array<char, 256> bytes;  // more than are before it
  const ssize_t count = read(file.number(), bytes.data(), bytes.size());
  const std::string text(bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  // The name before it, in parentheses, may contain anything, also a line's end.
  const std::size_t end = text.rfind(") ");
  return end == std::string::npos || text.size() < end + 4 ? 0 : std::atoi(text.c_str() + end + 4);
}

std::vector<pid_t> children() {
  std::vector<pid_t> found;
  std::error_code error;
  for (fs::directory_iterator entry("/proc", error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos && parent_of(name) == getpid())
      found.push_back(std::atoi(name.c_str()));
  }
  return found;
}

// Whether a process is the command, or a keeper.
bool is_pliant(pid_t process) {
  std::error_code error;
  const fs::path file = fs::read_symlink(fmt::format("/proc/{}/exe", process), error);
  return !error && file == fs::read_symlink("/proc/self/exe", error);
}

// Kills all children but those. Theirs become ours in turn, and are killed too.
void end_children_except(bool (*is_spared)(pid_t)) {
  constexpr int patience = 500;  // rounds; nobody waits longer for one that cannot be killed
  constexpr useconds_t pause = 10'000;
  for (int round = 0; round < patience; ++round) {
    bool has_any = false;
    for (const pid_t child : children()) {
      if (is_spared(child)) continue;
      has_any = true;
      kill(child, SIGKILL);
      waitpid(child, nullptr, WNOHANG);
    }
    if (!has_any) return;
    usleep(pause);
  }
}

[[noreturn]] void become(char** words, pid_t keeper, const sigset_t& signals) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);  // if the keeper itself is killed
  setpgid(0, 0);
  sigprocmask(SIG_SETMASK, &signals, nullptr);
  if (getppid() == keeper) execvp(words[0], words);
  _exit(no_such_program);
}

// Waits until the program or the lifeline has ended. The program's exit code, or null.
std::optional<int> await_end(pid_t program, int news) {
  for (;;) {
    std::array<pollfd, 2> ready = {{{news, POLLIN, 0}, {ChildStreams::lifeline_end, POLLIN, 0}}};
    if (poll(ready.data(), ready.size(), -1) < 0) continue;
    signalfd_siginfo ignored;
    if (ready[0].revents != 0 && read(news, &ignored, sizeof ignored) < 0) continue;
    int status = 0;
    for (pid_t ended; (ended = waitpid(-1, &status, WNOHANG)) > 0;) {
      if (ended == program) return code_from(status);
    }
    if (ready[1].revents != 0) return {};
  }
}

}  // namespace

int keep_program(const std::string& folder, char** words, const sigset_t& signals) {
  sigset_t ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGCHLD);
  const int news = signalfd(-1, &ends, SFD_CLOEXEC | SFD_NONBLOCK);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  // "." is short: the name of a socket has 107 bytes at most.
  if (news < 0 || !hold_folder(folder) || chdir(folder.c_str()) != 0 ||
      setenv("TMPDIR", ".", 1) != 0) {
    return no_such_program;
  }
  const pid_t keeper = getpid();
  const pid_t program = fork();
  if (program == 0) become(words, keeper, signals);
  if (program < 0) return no_such_program;
  release_streams();
  const auto code = await_end(program, news);
  end_children_except([](pid_t) { return false; });
  return code.value_or(ended_by_signal + SIGKILL);
}

Result<SupervisedProgram> SupervisedProgram::start(std::vector<std::string> words,
                                                   const ChildStreams& streams,
                                                   const ScratchFolder& folder) {
  const auto cannot = [&](std::string_view reason) {
    return fail(ErrorCode::Unwritable, fmt::format("cannot start {}: {}", words.front(), reason));
  };
  // Absolute, since the PATH may name folders from ours, and the program has another.
  const auto program = program_on_path(words.front());
  if (!program) return cannot(std::strerror(ENOENT));
  std::vector<std::string> all = {folder.path(), *program};
  all.insert(all.end(), words.begin() + 1, words.end());
  prctl(PR_SET_CHILD_SUBREAPER, 1);  // see `end_orphans`
  auto keeper = Keeper::start(std::move(all), streams);
  if (!keeper) return cannot(keeper.error().message);
  return SupervisedProgram(*std::move(keeper));
}

SupervisedProgram::~SupervisedProgram() {
  keeper_.end();
  end_orphans();
}

std::optional<int> SupervisedProgram::code() {
  const auto code = keeper_.code();
  end_orphans();
  return code && *code >= ended_by_signal ? -1 : code;
}

// What the program of a killed keeper has started is ours then.
void SupervisedProgram::end_orphans() {
  if (keeper_.code() == -1) end_children_except(&is_pliant);
}

}  // namespace pliant::cli
