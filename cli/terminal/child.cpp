#include "cli/terminal/child.hpp"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

namespace pliant::cli {
namespace {

constexpr std::size_t most_kept = std::size_t{1} << 16U;     // of a line, and of messages [bytes]
constexpr std::size_t most_written = std::size_t{1} << 28U;  // by a program [bytes]
constexpr int tick = 100, shortest_tick = 2;                 // [ms]

tl::unexpected<Error> cannot_start(const std::string& program, int error) {
  return fail(ErrorCode::Unwritable,
              fmt::format("cannot start {}: {}", program, std::strerror(error)));
}

std::vector<char*> pointers_to(std::vector<std::string>& words) {
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  return pointers;
}

std::vector<char*> environment_with(std::vector<std::string>& added,
                                    std::span<const std::string_view> dropped) {
  std::vector<char*> variables;
  for (std::string& variable : added) variables.push_back(variable.data());
  for (char** variable = environ; *variable != nullptr; ++variable) {
    const auto begins = [&](std::string_view text) {
      return std::string_view(*variable).starts_with(text);
    };
    if (std::ranges::none_of(dropped, begins)) variables.push_back(*variable);
  }
  variables.push_back(nullptr);
  return variables;
}

// Cuts bytes into lines.
class Lines {
 public:
  explicit Lines(const std::function<void(std::string_view)>& take) : take_(take) {}

  void add(std::string_view bytes) {
    if (!take_) return;
    for (std::size_t end; (end = bytes.find('\n')) != std::string_view::npos;
         bytes.remove_prefix(end + 1)) {
      keep(bytes.substr(0, end));
      take_(line_);
      line_.clear();
    }
    keep(bytes);
  }

  void finish() {
    if (take_ && !line_.empty()) take_(line_);
  }

 private:
  void keep(std::string_view bytes) { line_ += bytes.substr(0, most_kept - line_.size()); }

  const std::function<void(std::string_view)>& take_;
  std::string line_;
};

// The code of a process that has ended; null: it has not.
std::optional<int> code_of(pid_t id, int options = WNOHANG) {
  int status = 0;
  const pid_t ended = waitpid(id, &status, options);
  if (ended == id) return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  return ended < 0 && errno != EINTR ? std::optional(-1) : std::nullopt;
}

// Reads what is there, and closes a pipe at its end.
void read_some(OpenDescriptor& end, const std::function<void(std::string_view)>& take) {
  char bytes[1 << 14];
  const ssize_t count = read(end.number(), bytes, sizeof bytes);
  if (count > 0) take({bytes, static_cast<std::size_t>(count)});
  if (count == 0 || (count < 0 && errno != EINTR)) end = OpenDescriptor();
}

}  // namespace

std::optional<std::string> program_on_path(std::string_view name) {
  const char* const path = std::getenv("PATH");
  std::string_view folders = path == nullptr ? "" : path;
  while (!folders.empty()) {
    const std::size_t end = std::min(folders.find(':'), folders.size());
    const auto file = std::filesystem::path(folders.substr(0, end)) / name;
    std::error_code ignored;
    if (access(file.c_str(), X_OK) == 0 && !std::filesystem::is_directory(file, ignored)) {
      return std::filesystem::absolute(file, ignored).string();
    }
    folders.remove_prefix(std::min(end + 1, folders.size()));
  }
  return {};
}

bool Pipe::open() {
  int ends[2];
  if (pipe2(ends, O_CLOEXEC) != 0) return false;
  reading = OpenDescriptor(ends[0]);
  writing = OpenDescriptor(ends[1]);
  return true;
}

Result<pid_t> start_child(std::vector<std::string> words, const ChildStreams& streams,
                          std::span<const std::string_view> dropped,
                          std::span<const std::string> added) {
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  const auto connect = [&](int ours, int its, int access) {
    if (ours < 0) {
      posix_spawn_file_actions_addopen(&files, its, "/dev/null", access, 0);
    } else {
      posix_spawn_file_actions_adddup2(&files, ours, its);
    }
  };
  connect(streams.input, STDIN_FILENO, O_RDONLY);
  connect(streams.output, STDOUT_FILENO, O_WRONLY);
  connect(streams.errors, STDERR_FILENO, O_WRONLY);
  if (streams.lifeline >= 0)  // the last, since it may replace one that was connected
    posix_spawn_file_actions_adddup2(&files, streams.lifeline, ChildStreams::lifeline_end);
  // It gets nothing else: the sockets of our server would be open as long as it.
  const int others = streams.lifeline >= 0 ? ChildStreams::lifeline_end + 1 : STDERR_FILENO + 1;
  posix_spawn_file_actions_addclosefrom_np(&files, others);
  if (!streams.folder.empty()) posix_spawn_file_actions_addchdir_np(&files, streams.folder.c_str());
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t signals;
  sigfillset(&signals);  // we ignore some, see interrupt.hpp
  posix_spawnattr_setsigdefault(&attributes, &signals);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP | POSIX_SPAWN_SETSIGDEF);
  std::vector<char*> arguments = pointers_to(words);
  std::vector<std::string> own(added.begin(), added.end());
  std::vector<char*> variables = environment_with(own, dropped);
  pid_t id = 0;
  const int failed =
      posix_spawnp(&id, arguments.front(), &files, &attributes, arguments.data(), variables.data());
  posix_spawn_file_actions_destroy(&files);
  posix_spawnattr_destroy(&attributes);
  if (failed != 0) return cannot_start(words.front(), failed);
  return id;
}

void await_child(pid_t child) {
  while (!code_of(child, 0)) continue;
}

Result<ProgramEnd> run_program(const std::vector<std::string>& words, const ProgramRun& run) {
  Pipe output, errors;
  if (!output.open() || !errors.open()) return cannot_start(words.front(), errno);
  const auto id = start_child(words,
                              {.input = run.input,
                               .output = output.writing.number(),
                               .errors = errors.writing.number(),
                               .folder = run.folder},
                              run.dropped, run.added);
  if (!id) return fail(id.error());
  const auto begin = std::chrono::steady_clock::now();
  output.writing = OpenDescriptor();  // otherwise the pipes would never end
  errors.writing = OpenDescriptor();
  ProgramEnd end;
  std::size_t written = 0;
  Lines lines(run.take_line), messages(run.take_message);
  const auto take_output = [&](std::string_view bytes) {
    written += bytes.size();
    lines.add(bytes);
  };
  const auto take_errors = [&](std::string_view bytes) {
    written += bytes.size();
    messages.add(bytes);
    if (!run.take_message) end.errors += bytes.substr(0, most_kept - end.errors.size());
  };
  const auto kill_it = [&] {
    if (run.ends_gently) {
      kill(-*id, SIGINT);
      constexpr int most_ticks = 100;
      for (int k = 0; k < most_ticks; ++k) {
        if (code_of(*id)) return;
        std::this_thread::sleep_for(std::chrono::milliseconds(tick));
      }
    }
    kill(-*id, SIGKILL);
    while (!code_of(*id, 0)) continue;
  };
  const auto refuse = [&](const std::string& reason) {
    kill_it();
    return fail(ErrorCode::Unwritable, fmt::format("{} {}", words.front(), reason));
  };
  for (std::optional<int> code; !code;) {
    if (run.should_stop && run.should_stop()) {
      kill_it();
      return interrupted();
    }
    if (std::chrono::steady_clock::now() - begin > run.patience)
      return refuse(fmt::format("gives no answer within {} s", run.patience.count()));
    if (written > most_written)
      return refuse(fmt::format("writes more than {} MiB", most_written >> 20U));
    // poll passes over descriptors that are closed.
    pollfd ready[] = {{output.reading.number(), POLLIN, 0}, {errors.reading.number(), POLLIN, 0}};
    const bool are_closed = ready[0].fd < 0 && ready[1].fd < 0;
    const bool has_ended = (code = code_of(*id)).has_value();
    // What it has left in the pipes is read, but not what its children go on to write.
    const auto last = std::chrono::steady_clock::now() + std::chrono::milliseconds(tick);
    do {
      if (poll(ready, 2, has_ended ? 0 : are_closed ? shortest_tick : tick) <= 0) break;
      if (ready[0].revents != 0) read_some(output.reading, take_output);
      if (ready[1].revents != 0) read_some(errors.reading, take_errors);
      ready[0].fd = output.reading.number();
      ready[1].fd = errors.reading.number();
    } while (has_ended && std::chrono::steady_clock::now() < last);
    if (has_ended) end.code = *code;
  }
  lines.finish();
  messages.finish();
  return end;
}

}  // namespace pliant::cli
