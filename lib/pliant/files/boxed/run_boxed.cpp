#include "pliant/files/boxed/run_boxed.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <thread>
#include <utility>

#include <dlfcn.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pliant/files/open_file.hpp"

namespace pliant {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr Seconds tick{0.05};

tl::unexpected<Error> not_started(const char* what, int error) {
  return fail(ErrorCode::Unreadable, fmt::format("cannot start a process to read the file: {}: {}",
                                                 what, std::strerror(error)));
}

// The same file under a number that is none of a sandboxed program's.
OpenDescriptor lifted(OpenDescriptor file) {
  if (!file.is_open() || file.number() > boxed_program) return file;
  return OpenDescriptor(fcntl(file.number(), F_DUPFD_CLOEXEC, boxed_program + 1));
}

// A process that the destructor kills and reaps, so that no zombie remains.
class Child {
 public:
  explicit Child(pid_t process) : process_(process) {}
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() { kill(); }

  // Its status, if it has ended. A process that something else has waited for counts as exited with
  // 0; its answer shows whether it succeeded.
  std::optional<int> ended() {
    if (process_ < 0) return status_;
    int status = 0;
    const pid_t waited = waitpid(process_, &status, WNOHANG);
    if (waited == 0 || (waited < 0 && errno == EINTR)) return {};
    process_ = -1;
    status_ = waited < 0 ? 0 : status;
    return status_;
  }

  void kill() {
    if (process_ < 0) return;
    ::kill(process_, SIGKILL);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) continue;
    process_ = -1;
  }

 private:
  pid_t process_;
  int status_ = 0;
};

// The program as an in-memory file.
OpenDescriptor program_file(std::string_view program) {
  OpenDescriptor file = lifted(OpenDescriptor(memfd_create("pliant", MFD_CLOEXEC)));
  while (file.is_open() && !program.empty()) {
    const ssize_t count = write(file.number(), program.data(), program.size());
    if (count > 0) {
      program.remove_prefix(static_cast<std::size_t>(count));
    } else if (errno != EINTR) {
      file = OpenDescriptor();
    }
  }
  return file;
}

// Arguments of posix_spawn, freed by the destructor.
class SpawnSettings {
 public:
  SpawnSettings() {
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
  }
  SpawnSettings(const SpawnSettings&) = delete;
  SpawnSettings& operator=(const SpawnSettings&) = delete;
  ~SpawnSettings() {
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
  }

  // In the program, no signal is ignored or blocked as it may be here, and the program is in its
  // own process group: Ctrl-C goes to this process, which then kills the program.
  int set(int program, int input, int answer) {
    sigset_t all, none;
    sigfillset(&all);
    sigemptyset(&none);
    posix_spawnattr_setsigdefault(&attributes, &all);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(
        &attributes, POSIX_SPAWN_SETSIGDEF | POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETPGROUP);
    int error = posix_spawn_file_actions_adddup2(&actions, input, boxed_input);
    for (const int output : {STDOUT_FILENO, STDERR_FILENO}) {
      if (error == 0)
        error = posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
    }
    if (error == 0) error = posix_spawn_file_actions_adddup2(&actions, answer, boxed_answer);
    if (error == 0) error = posix_spawn_file_actions_adddup2(&actions, program, boxed_program);
    if (error == 0) error = posix_spawn_file_actions_addclosefrom_np(&actions, boxed_program + 1);
    return error;
  }

  posix_spawn_file_actions_t actions;
  posix_spawnattr_t attributes;
};

// Arguments for `enter_box` are first.
std::vector<std::string> all_arguments(const std::vector<std::string>& arguments,
                                       const BoxLimits& limits) {
  std::vector<std::string> all = {
      "pliant-boxed", std::to_string(getpid()), std::to_string(limits.memory),
      fmt::format("{:.0f}", limits.seconds + 1), std::to_string(limits.freed)};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return all;
}

// Shared libraries that come with the file that this code is in, as in the Python wheel, are for
// the program too: its whole environment, empty if there are none. Not if the file's name is
// relative: what is in the present folder is not ours.
std::string library_path() {
  Dl_info info;
  if (dladdr(reinterpret_cast<const void*>(&run_boxed), &info) == 0) return {};
  const std::string folder = std::filesystem::path(info.dli_fname).parent_path() / "libs";
  std::error_code error;
  if (folder.front() != '/' || folder.find_first_of(":;") != std::string::npos ||
      !std::filesystem::is_directory(folder, error))
    return {};
  return "LD_LIBRARY_PATH=" + folder;
}

Result<pid_t> spawn(const OpenDescriptor& program, const std::vector<std::string>& arguments,
                    int input, const OpenDescriptor& answer) {
  std::vector<std::string> owned = arguments;
  std::vector<char*> pointers;
  for (std::string& argument : owned) pointers.push_back(argument.data());
  pointers.push_back(nullptr);
  std::string path_of_libraries = library_path();
  char* environment[] = {path_of_libraries.empty() ? nullptr : path_of_libraries.data(), nullptr};
  SpawnSettings settings;
  int error = settings.set(program.number(), input, answer.number());
  const std::string path = fmt::format("/proc/self/fd/{}", boxed_program);
  pid_t process = -1;
  if (error == 0) {
    error = posix_spawn(&process, path.c_str(), &settings.actions, &settings.attributes,
                        pointers.data(), environment);
  }
  if (error != 0) return not_started("posix_spawn", error);
  return process;
}

// Time during which this process runs: a time when it is stopped does not count.
class Patience {
 public:
  explicit Patience(double seconds) : left_(seconds) {}

  bool is_over() {
    const auto now = Clock::now();
    left_ -= std::min<Seconds>(now - last_, Seconds(1));
    last_ = now;
    return left_ <= Seconds(0);
  }

 private:
  Seconds left_;
  Clock::time_point last_ = Clock::now();
};

// Appends the bytes in the pipe, waiting for a tick at most. False at its end.
bool read_some(const OpenDescriptor& pipe, std::string& answer) {
  pollfd waiting{pipe.number(), POLLIN, 0};
  if (poll(&waiting, 1, static_cast<int>(tick.count() * 1000)) <= 0) return true;
  char chunk[1 << 16];
  const ssize_t count = read(pipe.number(), chunk, sizeof chunk);
  if (count > 0) answer.append(chunk, static_cast<std::size_t>(count));
  return count > 0 || (count < 0 && (errno == EINTR || errno == EAGAIN));
}

BoxedEnd end_of(int status, std::string answer) {
  if (!WIFSIGNALED(status)) return {BoxedEnd::How::Exited, WEXITSTATUS(status), std::move(answer)};
  const int signal = WTERMSIG(status);
  return {signal == SIGXCPU ? BoxedEnd::How::TimedOut : BoxedEnd::How::Killed, signal,
          std::move(answer)};
}

Result<BoxedEnd> wait_for(Child& child, const OpenDescriptor& pipe, const BoxLimits& limits,
                          const StopRequest& should_stop) {
  Patience patience(limits.seconds);
  std::string answer;
  bool is_answering = true;
  std::chrono::microseconds pause{50};
  for (;;) {
    if (pliant::is_stopped(should_stop)) return interrupted();
    if (patience.is_over()) return BoxedEnd{BoxedEnd::How::TimedOut, 0, std::move(answer)};
    if (is_answering) {
      is_answering = read_some(pipe, answer);
      if (answer.size() > limits.answer_bytes)
        return BoxedEnd{BoxedEnd::How::TooLong, 0, std::move(answer)};
    } else if (const auto status = child.ended()) {
      return end_of(*status, std::move(answer));
    } else {
      std::this_thread::sleep_for(pause);
      pause = std::min(2 * pause, std::chrono::microseconds{20000});
    }
  }
}

}  // namespace

Result<BoxedEnd> run_boxed(std::string_view program, const std::vector<std::string>& arguments,
                           int input, const BoxLimits& limits, const StopRequest& should_stop) {
  const OpenDescriptor file = program_file(program);
  if (!file.is_open()) return not_started("memfd_create", errno);
  const OpenDescriptor lifted_input(fcntl(input, F_DUPFD_CLOEXEC, boxed_program + 1));
  int ends[2];
  if (!lifted_input.is_open() || pipe2(ends, O_CLOEXEC) != 0) return not_started("pipe", errno);
  const OpenDescriptor from_child = lifted(OpenDescriptor(ends[0]));
  OpenDescriptor to_parent = lifted(OpenDescriptor(ends[1]));
  if (!from_child.is_open() || !to_parent.is_open()) return not_started("pipe", errno);
  const auto process =
      spawn(file, all_arguments(arguments, limits), lifted_input.number(), to_parent);
  if (!process) return fail(process.error());
  Child child(*process);
  to_parent = OpenDescriptor();  // otherwise the pipe would never end
  return wait_for(child, from_child, limits, should_stop);
}

}  // namespace pliant
