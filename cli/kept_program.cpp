#include "kept_program.hpp"

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/signalfd.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pliant/core/text.hpp"

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;

constexpr int no_such_program = 127, ended_by_signal = 128;  // exit codes, as of shells

int code_from(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : ended_by_signal + WTERMSIG(status);
}

// The parent of a process; 0: it has ended.
pid_t parent_of(const std::string& process) {
  std::ifstream file("/proc/" + process + "/stat");
  std::string line;
  std::getline(file, line);
  // The name before it, in parentheses, may contain anything.
  const std::size_t end = line.rfind(") ");
  return end == std::string::npos || line.size() < end + 4 ? 0 : std::atoi(line.c_str() + end + 4);
}

void kill_children() {
  std::error_code error;
  for (fs::directory_iterator entry("/proc", error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (name.find_first_not_of("0123456789") == std::string::npos && parent_of(name) == getpid())
      kill(std::atoi(name.c_str()), SIGKILL);
  }
}

// Kills all children. Theirs become ours in turn, and are killed too.
void end_everything() {
  constexpr int patience = 500;  // rounds; nobody waits longer for one that cannot be killed
  constexpr useconds_t pause = 10'000;
  for (int round = 0; round < patience; ++round) {
    kill_children();
    pid_t ended = 0;
    while ((ended = waitpid(-1, nullptr, WNOHANG)) > 0) continue;
    if (ended < 0 && errno == ECHILD) return;
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

// Leaves the streams to the program: a pipe must end with it.
void release_streams() {
  const int nothing = open("/dev/null", O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nothing, stream);
  close(nothing);
}

}  // namespace

int run_keeper(std::span<char*> words) {
  if (words.size() < 3) return no_such_program;
  const char* const folder = words[0];
  sigset_t before, ends;
  sigemptyset(&ends);
  sigaddset(&ends, SIGCHLD);
  sigprocmask(SIG_BLOCK, &ends, &before);
  const int news = signalfd(-1, &ends, SFD_CLOEXEC | SFD_NONBLOCK);
  fcntl(ChildStreams::lifeline_end, F_SETFD, FD_CLOEXEC);
  prctl(PR_SET_CHILD_SUBREAPER, 1);
  // "." is short: the name of a socket has 107 bytes at most.
  if (news < 0 || chdir(folder) != 0 || setenv("TMPDIR", ".", 1) != 0) return no_such_program;
  const pid_t keeper = getpid();
  const pid_t program = fork();
  if (program == 0) become(words.data() + 1, keeper, before);
  if (program < 0) return no_such_program;
  release_streams();
  const auto code = await_end(program, news);
  end_everything();
  if (code) return *code;
  std::error_code ignored;
  fs::remove_all(folder, ignored);
  return ended_by_signal + SIGKILL;
}

Result<ScratchFolder> ScratchFolder::make() {
  const char* const named = std::getenv("TMPDIR");
  const bool is_named = named != nullptr && *named != '\0';
  const std::string place = is_named ? named : "/tmp";
  std::error_code error;
  std::string name = (fs::absolute(place, error) / "pliant-view-XXXXXX").string();
  if (!error && mkdtemp(name.data()) != nullptr) return ScratchFolder(name);
  const int reason = error ? error.value() : errno;
  return fail(ErrorCode::Unwritable,
              fmt::format("cannot make a folder for temporary files in {}{}: {}", printable(place),
                          is_named ? ", which TMPDIR names" : "", std::strerror(reason)));
}

ScratchFolder::ScratchFolder(ScratchFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})) {}

ScratchFolder::~ScratchFolder() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
}

Result<KeptProgram> KeptProgram::start(std::vector<std::string> words, const ChildStreams& streams,
                                       const ScratchFolder& folder) {
  const auto cannot = [&](int error) {
    return fail(ErrorCode::Unwritable,
                fmt::format("cannot start {}: {}", words.front(), std::strerror(error)));
  };
  if (!is_on_path(words.front())) return cannot(ENOENT);
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return cannot(errno);
  std::vector<std::string> all = {"/proc/self/exe", std::string(keeper_request), folder.path()};
  all.insert(all.end(), words.begin(), words.end());
  ChildStreams its = streams;
  its.lifeline = ends[0];
  const auto keeper = start_child(std::move(all), its);
  close(ends[0]);
  if (keeper) return KeptProgram(*keeper, ends[1]);
  close(ends[1]);
  return fail(keeper.error());
}

KeptProgram::KeptProgram(KeptProgram&& other) noexcept
    : keeper_(std::exchange(other.keeper_, 0)),
      lifeline_(std::exchange(other.lifeline_, -1)),
      code_(other.code_) {}

KeptProgram::~KeptProgram() {
  if (lifeline_ >= 0) close(lifeline_);
  while (keeper_ != 0 && waitpid(keeper_, nullptr, 0) < 0 && errno == EINTR) continue;
}

std::optional<int> KeptProgram::code() {
  if (keeper_ == 0) return code_;
  int status = 0;
  const pid_t ended = waitpid(keeper_, &status, WNOHANG);
  if (ended == 0 || (ended < 0 && errno == EINTR)) return {};
  keeper_ = 0;
  const int code = ended > 0 ? code_from(status) : -1;
  code_ = code >= ended_by_signal ? -1 : code;
  return code_;
}

}  // namespace pliant::cli
