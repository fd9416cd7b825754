// A sandboxed program for tests: behaves like a reader that a hostile file has taken over. The
// arguments for the sandbox are followed, as for the real reader, by an ending, the behaviour, and
// a number.

#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/ptrace.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/files/boxed/mesh_message.hpp"
#include "pliant/files/boxed/program/enter_box.hpp"
#include "pliant/files/boxed/run_boxed.hpp"

extern char** environ;

namespace {

using namespace pliant;

void answer(std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = write(boxed_answer, bytes.data(), bytes.size());
    if (count <= 0) _exit(9);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
}

template <class T>
std::string packed(T number) {
  return {reinterpret_cast<const char*>(&number), sizeof number};
}

// Answers with a text, as the reason of a refusal.
void confess(const std::string& text) {
  answer(packed(message_begin) + packed(static_cast<std::uint32_t>(MessageKind::Refused)) +
         packed(static_cast<std::uint32_t>(text.size())) + text + packed(message_end));
}

// Recurses deeper and deeper: `depth` keeps the compiler from making it a loop.
int recurse(volatile char* above, int depth) {
  volatile char here[4096];
  here[0] = static_cast<char>(depth);
  return depth < 0 ? above[0] : recurse(here, depth + 1) + here[0];
}

std::string echoed() {
  std::string bytes;
  char chunk[4096];
  while (const ssize_t count =
             pread(boxed_input, chunk, sizeof chunk, static_cast<off_t>(bytes.size()))) {
    if (count < 0) _exit(9);
    bytes.append(chunk, static_cast<std::size_t>(count));
  }
  return bytes;
}

// One letter for each forbidden action that succeeded.
std::string escapes() {
  std::string done;
  const auto note = [&](const char* what, bool was_done) {
    if (was_done) done += what;
  };
  note("reads files, ", open("/etc/passwd", O_RDONLY) >= 0);
  note("writes files, ", open("/tmp/pliant-escaped", O_WRONLY | O_CREAT, 0600) >= 0);
  note("writes its input, ", write(boxed_input, "x", 1) == 1);
  note("has a socket, ", socket(AF_INET, SOCK_STREAM, 0) >= 0);
  note("has a pipe, ", dup(boxed_answer) >= 0);
  note("signals its parent, ", kill(getppid(), 0) == 0);
  note("is traced, ", ptrace(PTRACE_TRACEME, 0, nullptr, nullptr) == 0);
  note("has code in fresh memory, ", mmap(nullptr, 4096, PROT_READ | PROT_WRITE | PROT_EXEC,
                                          MAP_PRIVATE | MAP_ANONYMOUS, -1, 0) != MAP_FAILED);
  note("has an environment, ", environ && environ[0]);
  struct stat status {};
  for (int descriptor = boxed_program; descriptor < 64; ++descriptor)
    note("has other open files, ", fstat(descriptor, &status) == 0);
  char* no_arguments[] = {nullptr};
  const pid_t process = fork();
  if (process == 0) _exit(0);
  note("has children, ", process > 0);
  execve("/bin/true", no_arguments, no_arguments);
  return "it " + done + "stays in";
}

void act(std::string_view what) {
  if (what == "crash") std::raise(SIGSEGV);
  if (what == "abort") std::abort();
  if (what == "recurse") _exit(recurse(nullptr, 0));
  if (what == "spin")
    for (;;) getpid();
  if (what == "allocate") {
    std::vector<char*> taken;
    try {
      for (;;) std::memset(taken.emplace_back(new char[1 << 20]), 1, 1 << 20);
    } catch (const std::bad_alloc&) {
      _exit(boxed_out_of_memory);
    }
  }
  if (what == "flood")
    for (const std::string chunk(1 << 16, 'x');;) answer(chunk);
  if (what == "rubbish") answer("rubbish");
  if (what == "give up") _exit(3);
  if (what == "echo") answer(echoed());
  if (what == "uninitialised") {
    const auto* fresh = static_cast<volatile char*>(std::malloc(1000));
    answer(std::string(1, fresh[500]));
  }
  if (what == "escape") confess(escapes());
  if (what == "tell lies") confess("\x1b[2Jgo\nand \"run\" this" + std::string(5000, 'x'));
}

}  // namespace

int main(int count, char** arguments) {
  if (count != box_arguments + 3 || !enter_box(count, arguments)) return 1;
  act(arguments[box_arguments + 1]);
  return boxed_done;
}
