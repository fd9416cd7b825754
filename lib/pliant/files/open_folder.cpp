#include "pliant/files/open_folder.hpp"

#include <cerrno>
#include <chrono>
#include <cstdio>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/files/open_file.hpp"
namespace pliant {

OpenFolder::OpenFolder(const std::filesystem::path& file) {
  const std::filesystem::path parent = file.parent_path();
  const char* const name = parent.empty() ? "." : parent.c_str();
  descriptor_ = OpenDescriptor(open(name, O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  is_readable_ = descriptor_.is_open();
  // A folder that is writable but not readable suffices for everything except a flush.
  if (!is_readable_ && errno == EACCES)
    descriptor_ = OpenDescriptor(open(name, O_PATH | O_DIRECTORY | O_CLOEXEC));
  if (!descriptor_.is_open()) error_ = errno;
}

int OpenFolder::rename(const std::string& from, const std::string& to) const {
  return renameat(descriptor(), from.c_str(), descriptor(), to.c_str()) == 0 ? 0 : errno;
}

int OpenFolder::rename_new(const std::string& from, const std::string& to) const {
  // By a link, which network file systems have too; others have no links.
  if (linkat(descriptor(), from.c_str(), descriptor(), to.c_str(), 0) == 0) {
    remove(from);
    return 0;
  }
  if (errno == EEXIST) return EEXIST;
  return renameat2(descriptor(), from.c_str(), descriptor(), to.c_str(), RENAME_NOREPLACE) == 0
             ? 0
             : errno;
}

int OpenFolder::exchange(const std::string& one, const std::string& other) const {
  const int done =
      renameat2(descriptor(), one.c_str(), descriptor(), other.c_str(), RENAME_EXCHANGE);
  return done == 0 ? 0 : errno;
}

bool OpenFolder::has(const std::string& name, std::string_view bytes) const {
  const OpenDescriptor file(
      openat(descriptor(), name.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status = {};
  if (!file.is_open() || fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode))
    return false;
  std::vector<char> piece(std::size_t{1} << 20);
  while (true) {
    const ssize_t count = read(file.number(), piece.data(), piece.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return count == 0 && bytes.empty();
    const std::string_view there(piece.data(), static_cast<std::size_t>(count));
    if (!bytes.starts_with(there)) return false;
    bytes.remove_prefix(there.size());
  }
}

bool OpenFolder::is(const std::string& name, int descriptor) const {
  struct stat named = {}, open = {};
  return fstatat(descriptor_.number(), name.c_str(), &named, AT_SYMLINK_NOFOLLOW) == 0 &&
         fstat(descriptor, &open) == 0 && named.st_dev == open.st_dev &&
         named.st_ino == open.st_ino;
}

void OpenFolder::remove(const std::string& name) const { unlinkat(descriptor(), name.c_str(), 0); }

int OpenFolder::flush() const { return is_readable_ ? flush_descriptor(descriptor()) : 0; }

void OpenFolder::lock() const {
  using namespace std::chrono_literals;
  // Limited, since the process with the lock may hang.
  for (auto waited = 0ms; waited < 10s; waited += 10ms) {
    if (!is_readable_ || flock(descriptor(), LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK)
      return;
    std::this_thread::sleep_for(10ms);
  }
}

int flush_descriptor(int descriptor) {
  while (fsync(descriptor) != 0) {
    if (errno == EINTR) continue;
    const bool is_unknown = errno == EINVAL || errno == EOPNOTSUPP || errno == ENOSYS;
    return is_unknown ? 0 : errno;
  }
  return 0;
}

}  // namespace pliant
