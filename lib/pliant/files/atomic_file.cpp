#include "pliant/files/atomic_file.hpp"

#include <algorithm>
#include <bit>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/xattr.h>
#include <unistd.h>

#include "pliant/core/expects.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/open_folder.hpp"
#include "pliant/files/output_place.hpp"
#include "pliant/files/raw_bytes.hpp"

namespace pliant {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the formats written here are little endian");

tl::unexpected<Error> cannot_write(const std::filesystem::path& file, int error_number) {
  return fail(ErrorCode::Unwritable,
              std::string("cannot write the file: ") + std::strerror(error_number), file.string());
}

// Opens a new file in the folder under an unused name; returns -1 and sets errno on failure.
int open_part(const OpenFolder& folder, const std::filesystem::path& file, mode_t mode,
              std::string& part) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    // In the same folder, because a rename is atomic only within one file system.
    part = hidden_name(file) + "." + std::to_string(getpid()) + "-" + std::to_string(attempt) +
           ".part";
    const int descriptor =
        openat(folder.descriptor(), part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

constexpr std::string_view access_list = "system.posix_acl_access";

// Copies what users and programs have attached to a file. Whether its access list is the same.
bool copy_attributes(const std::filesystem::path& from, int to) {
  std::string names(std::size_t{64} << 10, '\0'), value(names.size(), '\0');
  const ssize_t size = llistxattr(from.c_str(), names.data(), names.size());
  names.resize(static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
  fremovexattr(to, access_list.data());  // one that the folder gives to new files
  bool is_same = true;
  for (std::size_t begin = 0; begin < names.size(); begin += std::strlen(&names[begin]) + 1) {
    const std::string_view name = &names[begin];
    if (name != access_list && !name.starts_with("user.")) continue;
    const ssize_t bytes = lgetxattr(from.c_str(), name.data(), value.data(), value.size());
    const bool is_copied = bytes >= 0 && fsetxattr(to, name.data(), value.data(),
                                                   static_cast<std::size_t>(bytes), 0) == 0;
    if (!is_copied && name == access_list) is_same = false;
  }
  return is_same;
}

// Makes the new file one of the same user and group, with the same access. Whether it is.
bool become(const std::filesystem::path& file, const struct stat& old, int descriptor) {
  struct stat status = {};
  if (fstat(descriptor, &status) != 0) return false;
  bool is_same = true;
  if (status.st_gid != old.st_gid)
    is_same = fchown(descriptor, static_cast<uid_t>(-1), old.st_gid) == 0;
  if (status.st_uid != old.st_uid)
    is_same = fchown(descriptor, old.st_uid, static_cast<gid_t>(-1)) == 0 && is_same;
  is_same = copy_attributes(file, descriptor) && is_same;
  // A file system without permissions may refuse this, and needs none.
  (void)fchmod(descriptor, old.st_mode & 0777U);
  return is_same;
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path file, std::string part, Stream stream, Flush flush,
                       bool is_as_old)
    : file_(std::move(file)),
      part_(std::move(part)),
      stream_(std::move(stream)),
      flush_(flush),
      is_as_old_(is_as_old) {}

AtomicFile::~AtomicFile() {
  if (!stream_) return;
  stream_.reset();
  // If a part cannot be removed, there is nothing to do about it.
  if (const OpenFolder folder(file_); folder.error() == 0) folder.remove(part_);
}

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& file, Flush flush) {
  if (auto place = check_output_place(file); !place) return fail(place.error());
  const OpenFolder folder(file);
  if (folder.error() != 0) return cannot_write(file, folder.error());
  struct stat old = {};
  const bool is_old =
      fstatat(folder.descriptor(), file.filename().c_str(), &old, AT_SYMLINK_NOFOLLOW) == 0;
  std::string part;
  // Until it has the older file's owner, group and permissions, nobody else may open it.
  const int descriptor = open_part(folder, file, is_old ? 0600 : 0666, part);
  if (descriptor < 0) return cannot_write(file, errno);
  Stream stream(fdopen(descriptor, "wb"));
  if (!stream) {
    const int error_number = errno;
    close(descriptor);
    folder.remove(part);
    return cannot_write(file, error_number);
  }
  const bool is_as_old = !is_old || become(file, old, descriptor);
  return AtomicFile(file, part, std::move(stream), flush, is_as_old);
}

Result<void> AtomicFile::write(std::string_view bytes, const StopRequest& should_stop) {
  PLIANT_EXPECTS(stream_);
  constexpr std::size_t most = std::size_t{1} << 22U;  // between two asks
  while (!bytes.empty()) {
    if (is_stopped(should_stop)) return interrupted();
    const std::string_view piece = bytes.substr(0, most);
    if (std::fwrite(piece.data(), 1, piece.size(), stream_.get()) != piece.size()) {
      return unwritable(errno);
    }
    bytes.remove_prefix(piece.size());
  }
  return {};
}

Result<void> AtomicFile::write(std::span<const double> numbers) { return write(bytes_of(numbers)); }

Result<void> AtomicFile::write(std::span<const float> numbers) { return write(bytes_of(numbers)); }

Result<void> AtomicFile::commit() { return commit_as(file_); }

Result<void> AtomicFile::commit_over(std::string_view old_bytes) {
  PLIANT_EXPECTS(stream_);
  const OpenFolder folder(file_);
  Result<void> done;
  if (folder.error() != 0) done = unwritable(folder.error());
  if (done && !is_as_old_) {
    done = fail(ErrorCode::Unwritable,
                "cannot write the file: it belongs to another user or group, or has an access "
                "list, and the new one would not",
                file_.string());
  }
  // Open until it has its name, to know it again.
  const OpenDescriptor own(dup(fileno(stream_.get())));
  if (auto finished = finish_bytes(); done) done = std::move(finished);
  if (done) done = replace(folder, own.number(), old_bytes);
  if (folder.error() == 0 && folder.is(part_, own.number())) folder.remove(part_);
  if (!done || flush_ != Flush::All) return done;
  if (const int error = folder.flush(); error != 0) return unwritable(error);
  return {};
}

// Requires: all bytes are written. The part has its name still if it could not be placed.
Result<void> AtomicFile::replace(const OpenFolder& folder, int own, std::string_view old_bytes) {
  const std::string name = file_.filename().string();
  const auto has_changed = [&] {
    return fail(ErrorCode::Unwritable, "cannot write the file: it has changed since it was read",
                file_.string());
  };
  struct stat old = {};
  if (fstatat(folder.descriptor(), name.c_str(), &old, AT_SYMLINK_NOFOLLOW) != 0 &&
      errno == ENOENT) {
    const int error = folder.rename_new(part_, name);
    if (error == EEXIST) return has_changed();
    return error == 0 ? Result<void>() : unwritable(error);
  }
  if (!folder.has(name, old_bytes)) return has_changed();
  const int error = folder.exchange(part_, name);
  if (error == ENOENT) return has_changed();
  if (error != 0) {  // the file system cannot
    const int renamed = folder.rename(part_, name);
    return renamed == 0 ? Result<void>() : unwritable(renamed);
  }
  // What was saved in this very moment is the part now. It gets its name back, and what was saved
  // even later keeps it.
  if (folder.has(part_, old_bytes)) {
    folder.remove(part_);
    return {};
  }
  folder.exchange(part_, name);
  if (!folder.is(part_, own)) folder.exchange(part_, name);
  return has_changed();
}

Result<void> AtomicFile::commit_as(const std::filesystem::path& file) {
  return place(file, false).map([](bool) {});
}

Result<bool> AtomicFile::commit_new() { return place(file_, true); }

// Gives it a name, with `only_new` unless another file has it. Whether it has it.
Result<bool> AtomicFile::place(const std::filesystem::path& file, bool only_new) {
  PLIANT_EXPECTS(stream_);
  PLIANT_EXPECTS(file.parent_path() == file_.parent_path());
  const OpenFolder folder(file_);
  Result<void> done;
  if (file != file_) done = check_output_place(file);
  if (auto finished = finish_bytes(); done) done = std::move(finished);
  if (done && folder.error() != 0) done = unwritable(folder.error());
  bool is_taken = false;
  if (done) {
    const std::string name = file.filename().string();
    const int error = only_new ? folder.rename_new(part_, name) : folder.rename(part_, name);
    is_taken = only_new && error == EEXIST;
    if (error != 0 && !is_taken) done = unwritable(error);
  }
  if (!done || is_taken) {
    if (folder.error() == 0) folder.remove(part_);
    return done.map([] { return false; });
  }
  if (flush_ != Flush::All) return true;
  if (const int error = folder.flush(); error != 0) return unwritable(error);
  return true;
}

// Requires: all bytes are written.
Result<AtomicFile::Placed> AtomicFile::exchange(const OpenFolder& folder) const {
  if (auto free = check_output_place(file_); !free) return fail(free.error());
  const std::string name = file_.filename().string();
  int error = folder.exchange(part_, name);
  if (error == 0) return Placed::Exchanged;
  const bool is_new = error == ENOENT;
  error = folder.rename(part_, name);
  if (error != 0) return unwritable(error);
  return is_new ? Placed::New : Placed::Replaced;
}

Result<void> commit_all(std::vector<AtomicFile> files) {
  using Placed = AtomicFile::Placed;
  PLIANT_EXPECTS(!files.empty());
  const OpenFolder folder(files.front().file_);
  Result<void> done;
  if (folder.error() != 0) done = files.front().unwritable(folder.error());
  for (AtomicFile& file : files) {
    PLIANT_EXPECTS(file.stream_ && file.file_.parent_path() == files.front().file_.parent_path());
    if (auto finished = file.finish_bytes(); done) done = std::move(finished);
  }
  if (folder.error() != 0) return done;
  const auto flush = [&]() -> Result<void> {
    const int error = files.front().flush_ == Flush::All ? folder.flush() : 0;
    return error == 0 ? Result<void>() : files.front().unwritable(error);
  };
  std::vector<Placed> placed;
  while (done && placed.size() < files.size()) {
    if (placed.size() + 1 == files.size()) done = flush();
    if (!done) break;
    const auto now = files[placed.size()].exchange(folder);
    if (now) placed.push_back(*now);
    if (!now) done = fail(now.error());
  }
  if (done) done = flush();
  for (std::size_t k = done ? 0 : placed.size(); k-- > 0;) {
    const std::string name = files[k].file_.filename().string();
    if (placed[k] == Placed::Exchanged) folder.exchange(files[k].part_, name);
    if (placed[k] == Placed::New) folder.remove(name);
  }
  for (const AtomicFile& file : files) folder.remove(file.part_);
  return done;
}

// Writes all remaining bytes, and closes.
Result<void> AtomicFile::finish_bytes() {
  std::FILE* const stream = stream_.release();
  int error = std::fflush(stream) == 0 ? 0 : errno;
  if (error == 0 && flush_ != Flush::Nothing) error = flush_descriptor(fileno(stream));
  // Only close may report that the disk of a network file system is full.
  const bool is_closed = std::fclose(stream) == 0;
  if (error == 0 && !is_closed) error = errno;
  if (error != 0) return unwritable(error);
  return {};
}

tl::unexpected<Error> AtomicFile::unwritable(int error_number) const {
  return cannot_write(file_, error_number);
}

Result<void> write_file(const std::filesystem::path& file, std::string_view bytes,
                        const StopRequest& should_stop) {
  auto output = AtomicFile::create(file);
  if (!output) return fail(output.error());
  if (auto written = output->write(bytes, should_stop); !written) return written;
  if (is_stopped(should_stop)) return interrupted();
  return output->commit();
}

Result<void> rewrite_file(const std::filesystem::path& file, std::string_view old_bytes,
                          std::string_view bytes) {
  auto output = AtomicFile::create(file);
  if (!output) return fail(output.error());
  if (auto written = output->write(bytes); !written) return written;
  return output->commit_over(old_bytes);
}

Result<void> flush_folder(const std::filesystem::path& file) {
  const OpenFolder folder(file);
  const int error = folder.error() != 0 ? folder.error() : folder.flush();
  if (error != 0) return cannot_write(file, error);
  return {};
}

}  // namespace pliant
