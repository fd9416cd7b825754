#include "pliant/states/folder_store.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstdint>
#include <ctime>
#include <filesystem>
#include <mutex>
#include <system_error>
#include <tuple>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/files/atomic_file.hpp"
#include "pliant/files/open_file.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view ending = ".state";
constexpr std::size_t key_digits = 32;
constexpr std::int64_t second = 1'000'000'000;  // [ns]

// A part of a file that has not been written to for so long was left by a killed process.
constexpr std::int64_t abandoned_after = 600 * second;

std::int64_t now() {
  timespec time = {};
  clock_gettime(CLOCK_REALTIME, &time);
  return std::int64_t{time.tv_sec} * second + time.tv_nsec;
}

// The key in the name of a file of this store.
std::optional<Hash> key_in(std::string_view name) {
  if (name.size() != key_digits + ending.size() || !name.ends_with(ending)) return {};
  return to_hash(name.substr(0, key_digits));
}

// Whether it is the name of an unfinished file of this store, as made by `AtomicFile`:
// .KEY.N-N.part
bool is_part(std::string_view name) {
  constexpr std::string_view end = ".part";
  const std::size_t size = key_digits + ending.size();
  if (!name.starts_with('.') || !name.ends_with(end) || name.size() < 1 + size + end.size() ||
      !key_in(name.substr(1, size)))
    return false;
  name.remove_prefix(1 + size);
  name.remove_suffix(end.size());
  return name.starts_with('.') && name.find('-') != std::string_view::npos &&
         name.find_first_not_of("0123456789-", 1) == std::string_view::npos;
}

// The space of a file of that many bytes on a disk that allocates pages.
std::size_t on_disk(std::size_t bytes) {
  constexpr std::size_t page = 4096;
  return (bytes + page - 1) / page * page;
}

bool read_all(int descriptor, std::string& bytes) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::read(descriptor, bytes.data() + done, bytes.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    done += static_cast<std::size_t>(count);
  }
  return true;
}

}  // namespace

/// What the store does, safe from several threads; its public members are the store's own.
class FolderStateStore::Folder {
 public:
  Folder(fs::path folder, std::size_t byte_budget)
      : folder_(std::move(folder)), byte_budget_(byte_budget), opened_(now()) {}

  bool holds(const Hash& key) const;
  std::optional<std::string> read(const Hash& key, std::size_t most) const;
  void write(const Hash& key, std::string_view bytes);
  void discard(const Hash& key);
  std::string trouble() const;
  int damaged_count() const;

 private:
  struct Entry {
    fs::path file;
    std::size_t bytes = 0;  // on the disk
    std::int64_t used = 0;  // [ns] since 1970
    int rank = 0;           // lower ranks are removed first
  };

  fs::path file_of(const Hash& key) const;
  bool take_room(std::size_t bytes);
  std::vector<Entry> entries() const;
  void make_room(std::size_t bytes);

  fs::path folder_;
  std::size_t byte_budget_;
  std::int64_t opened_;  // [ns] since 1970

  mutable std::mutex mutex_;       // guards the members below
  bool is_counted_ = false;        // whether `bytes_` is known
  std::size_t bytes_ = 0;          // on the disk at the last count, plus those written since
  std::size_t bytes_written_ = 0;  // since the last count
  std::string trouble_;
  int damaged_count_ = 0;
};

FolderStateStore::FolderStateStore(std::unique_ptr<Folder> folder) : folder_(std::move(folder)) {}
FolderStateStore::~FolderStateStore() = default;

bool FolderStateStore::holds(const Hash& key) { return folder_->holds(key); }

std::optional<std::string> FolderStateStore::read(const Hash& key, std::size_t most) {
  return folder_->read(key, most);
}

void FolderStateStore::write(const Hash& key, std::string_view bytes) {
  folder_->write(key, bytes);
}

void FolderStateStore::discard(const Hash& key) { folder_->discard(key); }

std::string FolderStateStore::trouble() const { return folder_->trouble(); }

int FolderStateStore::damaged_count() const { return folder_->damaged_count(); }

Result<std::unique_ptr<FolderStateStore>> FolderStateStore::open(const std::string& folder,
                                                                 std::size_t byte_budget) {
  std::error_code error;
  fs::create_directories(folder, error);
  std::error_code unknown;
  if (fs::exists(folder, unknown) && !fs::is_directory(folder, unknown)) {
    return fail(ErrorCode::InvalidInput, "is not a folder", folder);
  }
  if (!fs::is_directory(folder, unknown)) {
    return fail(ErrorCode::Unwritable, "cannot create the folder: " + error.message(), folder);
  }
  return std::unique_ptr<FolderStateStore>(
      new FolderStateStore(std::make_unique<Folder>(folder, byte_budget)));
}

fs::path FolderStateStore::Folder::file_of(const Hash& key) const {
  return folder_ / (to_text(key) += ending);
}

bool FolderStateStore::Folder::holds(const Hash& key) const {
  struct stat status = {};
  return lstat(file_of(key).c_str(), &status) == 0 && S_ISREG(status.st_mode);
}

std::optional<std::string> FolderStateStore::Folder::read(const Hash& key, std::size_t most) const {
  // A link or a pipe of that name is not a file of this store, and must not block.
  const OpenDescriptor file(
      ::open(file_of(key).c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  struct stat status = {};
  if (file.number() < 0 || fstat(file.number(), &status) != 0 || !S_ISREG(status.st_mode)) {
    return {};
  }
  const auto size = static_cast<std::uint64_t>(status.st_size);
  // A file that cannot be complete is returned as far as it can be read; the caller detects it.
  std::string bytes(static_cast<std::size_t>(std::min<std::uint64_t>(size, most)), '\0');
  if (!read_all(file.number(), bytes)) return {};
  futimens(file.number(), nullptr);  // marks it as used; without permission, it is removed sooner
  return bytes;
}

void FolderStateStore::Folder::write(const Hash& key, std::string_view bytes) {
  if (!take_room(on_disk(bytes.size()))) return;
  auto file = AtomicFile::create(file_of(key), Flush::Nothing);
  Result<void> written;
  if (file) written = file->write(bytes);
  if (file && written) written = file->commit();
  if (file && written) return;
  const Error& error = file ? written.error() : file.error();
  const std::lock_guard lock(mutex_);
  if (trouble_.empty()) trouble_ = error.message;
}

void FolderStateStore::Folder::discard(const Hash& key) {
  std::error_code ignored;
  const bool is_gone = fs::remove(file_of(key), ignored);
  const std::lock_guard lock(mutex_);
  if (is_gone) ++damaged_count_;
}

std::string FolderStateStore::Folder::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

int FolderStateStore::Folder::damaged_count() const {
  const std::lock_guard lock(mutex_);
  return damaged_count_;
}

// Whether that many more bytes may be written to the disk.
bool FolderStateStore::Folder::take_room(std::size_t bytes) {
  const std::lock_guard lock(mutex_);
  if (!trouble_.empty() || bytes > byte_budget_) return false;
  // Other processes write too: count again now and then.
  if (!is_counted_ || bytes_ + bytes > byte_budget_ || bytes_written_ > byte_budget_ / 16) {
    make_room(bytes);
  }
  if (bytes_ + bytes > byte_budget_) return false;
  bytes_ += bytes;
  bytes_written_ += bytes;
  return true;
}

auto FolderStateStore::Folder::entries() const -> std::vector<Entry> {
  std::vector<Entry> entries;
  std::error_code error;
  for (fs::directory_iterator place(folder_, error), end; !error && place != end;
       place.increment(error)) {
    const std::string name = place->path().filename().string();
    const auto key = key_in(name);
    struct stat status = {};
    if ((!key && !is_part(name)) || lstat(place->path().c_str(), &status) != 0) continue;
    if (!S_ISREG(status.st_mode)) continue;
    const std::int64_t used = std::int64_t{status.st_mtim.tv_sec} * second + status.st_mtim.tv_nsec;
    if (!key && now() - used < abandoned_after) continue;
    // Of this run's own files each rank has half as many as the one before: the bits of a key are
    // as good as random, and the same for every process.
    const bool is_ours = key && used >= opened_;
    entries.push_back({place->path(), on_disk(static_cast<std::size_t>(status.st_size)), used,
                       is_ours ? 1 + std::countr_zero(key->low)
                       : key   ? 0
                               : -1});
  }
  return entries;
}

// Counts the files, and removes some if they use too much space.
void FolderStateStore::Folder::make_room(std::size_t bytes) {
  std::vector<Entry> there = entries();
  std::sort(there.begin(), there.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.rank, a.used, a.file) < std::tie(b.rank, b.used, b.file);
  });
  bytes_ = bytes_written_ = 0;
  for (const Entry& entry : there) bytes_ += entry.bytes;
  is_counted_ = true;
  const bool is_full = bytes_ + bytes > byte_budget_;
  // Leaves some spare space, so that this need not be done for each file.
  const std::size_t spare = byte_budget_ / 16;
  for (const Entry& entry : there) {
    if (entry.rank >= 0 && (!is_full || bytes_ + bytes + spare <= byte_budget_)) break;
    std::error_code ignored;
    if (fs::remove(entry.file, ignored) && !ignored) bytes_ -= entry.bytes;
  }
}

}  // namespace pliant
