// Intercepts system calls of the command (LD_PRELOAD). It logs flushes of files and folders, and
// renames, in order to PLIANT_SHIM_LOG. PLIANT_SHIM_FAIL makes flushes fail: "file 5" or "folder
// 22" is the errno of every fsync of that kind; EINTR only of every second one. "exchange 22" is
// that of every exchange of two names, "process 3" that of reading what process 1 is.
// PLIANT_SHIM_KILL=N ends the program, like SIGKILL, before the Nth event. PLIANT_SHIM_SAVE="flush
// PATH" saves another text at PATH, as an editor does, ahead of the first flush of a file;
// "exchange PATH" ahead of the first exchange of two names.

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

namespace {

std::string path_of(int descriptor) {
  char path[4096] = {};
  const std::string link = "/proc/self/fd/" + std::to_string(descriptor);
  return readlink(link.c_str(), path, sizeof(path) - 1) > 0 ? path : "?";
}

void log(const std::string& line) {
  static int events = 0;
  const char* const last = std::getenv("PLIANT_SHIM_KILL");
  if (last != nullptr && ++events == std::atoi(last)) raise(SIGKILL);
  const char* const file = std::getenv("PLIANT_SHIM_LOG");
  if (file == nullptr) return;
  const int descriptor = open(file, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  const std::string text = line + '\n';
  if (write(descriptor, text.data(), text.size()) < 0) std::abort();
  close(descriptor);
}

void save_ahead_of(const std::string& event) {
  static bool is_saved = false;
  const char* const wish = std::getenv("PLIANT_SHIM_SAVE");
  if (wish == nullptr || is_saved || !std::string(wish).starts_with(event + ' ')) return;
  is_saved = true;
  const std::string path = std::string(wish).substr(event.size() + 1), fresh = path + "~";
  const int descriptor = open(fresh.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (write(descriptor, "saved", 5) != 5 || std::rename(fresh.c_str(), path.c_str()) != 0)
    std::abort();
  close(descriptor);
}

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" int fsync(int descriptor) {
  struct stat status = {};
  fstat(descriptor, &status);
  const std::string kind = S_ISDIR(status.st_mode) ? "folder" : "file";
  if (kind == "file") save_ahead_of("flush");
  if (const char* const wish = std::getenv("PLIANT_SHIM_FAIL")) {
    static int calls = 0;
    const std::string text = wish;
    const int error = std::atoi(text.substr(text.find(' ') + 1).c_str());
    if (text.starts_with(kind + ' ') && (error != EINTR || ++calls % 2 == 1)) {
      errno = error;
      return -1;
    }
  }
  log("flush " + kind + ' ' + path_of(descriptor));
  return next<int (*)(int)>("fsync")(descriptor);
}

extern "C" ssize_t read(int descriptor, void* bytes, size_t count) {
  const char* const wish = std::getenv("PLIANT_SHIM_FAIL");
  if (wish != nullptr && std::string(wish).starts_with("process ") &&
      path_of(descriptor) == "/proc/1/stat") {
    errno = std::atoi(wish + 8);
    return -1;
  }
  return next<ssize_t (*)(int, void*, size_t)>("read")(descriptor, bytes, count);
}

extern "C" int renameat(int from_folder, const char* from, int to_folder, const char* to) noexcept {
  log("rename " + path_of(from_folder) + '/' + from + " to " + path_of(to_folder) + '/' + to);
  return next<int (*)(int, const char*, int, const char*)>("renameat")(from_folder, from, to_folder,
                                                                       to);
}

extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to,
                         unsigned flags) noexcept {
  save_ahead_of("exchange");
  const char* const wish = std::getenv("PLIANT_SHIM_FAIL");
  if (wish != nullptr && std::string(wish).starts_with("exchange ")) {
    errno = std::atoi(wish + 9);
    return -1;
  }
  log("exchange " + path_of(from_folder) + '/' + from + " and " + path_of(to_folder) + '/' + to);
  return next<int (*)(int, const char*, int, const char*, unsigned)>("renameat2")(
      from_folder, from, to_folder, to, flags);
}
