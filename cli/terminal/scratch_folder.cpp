#include "cli/terminal/scratch_folder.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/core/text.hpp"

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view name_begin = "pliant-view-";

// The file that is locked, in the folder.
std::string lock_of(const std::string& folder) { return folder + "/kept"; }

// Opens the file to be locked, and waits until it locks the folder; -1: it is gone. Some file
// systems have no locks.
int locked(const std::string& folder, int more_flags = 0) {
  const int lock =
      open(lock_of(folder).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | more_flags, 0600);
  struct stat facts = {};
  if (lock < 0) return -1;
  (void)flock(lock, LOCK_SH);
  if (fstat(lock, &facts) == 0 && facts.st_nlink > 0) return lock;
  close(lock);
  errno = ENOENT;
  return -1;
}

struct LockedFolder {
  std::string path;
  int lock;
};

// Null and errno if there can be none.
std::optional<LockedFolder> new_folder(const std::string& place) {
  constexpr int rounds = 10;  // another keeper may take it for one that is left over
  for (int round = 0; round < rounds; ++round) {
    std::string name = (fs::path(place) / name_begin).string() + "XXXXXX";
    if (mkdtemp(name.data()) == nullptr) return {};
    if (const int lock = locked(name, O_CREAT); lock >= 0) return LockedFolder{name, lock};
    if (errno != ENOENT) {
      const int error = errno;
      rmdir(name.c_str());
      errno = error;
      return {};
    }
  }
  return {};
}

void remove_whole(const std::string& folder) {
  constexpr int rounds = 50;  // a program that is about to end may still write
  constexpr useconds_t pause = 20'000;
  std::error_code error;
  for (int round = 0; round < rounds; ++round) {
    fs::remove_all(folder, error);
    if (!error) return;
    usleep(pause);
  }
}

// Removes what a keeper made that was killed: the folder is ours, has the file that keepers lock,
// and none has locked it.
void remove_left_over(const std::string& place) {
  std::error_code error;
  for (fs::directory_iterator entry(place, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string folder = entry->path().string();
    struct stat facts = {};
    if (!entry->path().filename().string().starts_with(name_begin) ||
        lstat(folder.c_str(), &facts) != 0 || !S_ISDIR(facts.st_mode) ||
        facts.st_uid != geteuid()) {
      continue;
    }
    const int lock = open(lock_of(folder).c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (lock < 0) continue;
    if (flock(lock, LOCK_EX | LOCK_NB) == 0) remove_whole(folder);
    close(lock);
  }
}

std::string read_all(int descriptor) {
  std::string text;
  std::array<char, 4096> piece;
  for (ssize_t count; (count = read(descriptor, piece.data(), piece.size())) != 0;) {
    if (count > 0) text.append(piece.data(), static_cast<std::size_t>(count));
    if (count < 0 && errno != EINTR) break;
  }
  return text;
}

}  // namespace

bool hold_folder(const std::string& folder) { return locked(folder) >= 0; }

int keep_folder(const std::string& place) {
  const auto folder = new_folder(place);
  if (!folder) return errno;
  // If this fails, the command has ended, and so has the lifeline.
  (void)!::write(STDOUT_FILENO, folder->path.data(), folder->path.size());
  release_streams();
  remove_left_over(place);
  read_all(ChildStreams::lifeline_end);
  // Programs in the folder have keepers, which hold it until they have ended them.
  (void)flock(folder->lock, LOCK_EX);
  remove_whole(folder->path);
  return 0;
}

Result<ScratchFolder> ScratchFolder::make() {
  const char* const named = std::getenv("TMPDIR");
  const bool is_named = named != nullptr && *named != '\0';
  const std::string place = is_named ? named : "/tmp";
  const auto cannot = [&](std::string_view reason) {
    return fail(ErrorCode::Unwritable,
                fmt::format("cannot make a folder for temporary files in {}{}: {}",
                            printable(place), is_named ? ", which TMPDIR names" : "", reason));
  };
  std::error_code error;
  const std::string whole = fs::absolute(place, error).string();
  if (error) return cannot(std::strerror(error.value()));
  Pipe answer;
  if (!answer.open()) return cannot(std::strerror(errno));
  auto keeper = Keeper::start({whole}, {.output = answer.writing.number()});
  answer.writing = OpenDescriptor();  // otherwise it would never end
  const std::string path = read_all(answer.reading.number());
  if (!keeper) return cannot(keeper.error().message);
  if (!path.empty()) return ScratchFolder(path, *std::move(keeper));
  keeper->end();
  const int reason = keeper->code().value_or(-1);
  return cannot(reason > 0 ? std::strerror(reason) : "its keeper ended");
}

ScratchFolder::ScratchFolder(ScratchFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), keeper_(std::move(other.keeper_)) {}

ScratchFolder::~ScratchFolder() {
  keeper_.end();
  if (!path_.empty()) remove_whole(path_);  // if the keeper was killed
}

}  // namespace pliant::cli
