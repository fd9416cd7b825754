#include "pliant/output/atomic_file.hpp"

#include <bit>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/core/expects.hpp"
#include "pliant/output/open_folder.hpp"
#include "pliant/output/output_place.hpp"
#include "pliant/output/raw_bytes.hpp"

namespace pliant {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the formats written here are little endian");

tl::unexpected<Error> cannot_write(const std::filesystem::path& file, int error_number) {
  return fail(ErrorCode::Unwritable,
              std::string("cannot write the file: ") + std::strerror(error_number), file.string());
}

// Opens a new file in the folder under an unused name; returns -1 and sets errno on failure.
int open_part(const OpenFolder& folder, const std::filesystem::path& file, std::string& part) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    // In the same folder, because a rename is atomic only within one file system.
    part = hidden_name(file) + "." + std::to_string(getpid()) + "-" + std::to_string(attempt) +
           ".part";
    const int descriptor =
        openat(folder.descriptor(), part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path file, std::string part, Stream stream, Flush flush)
    : file_(std::move(file)), part_(std::move(part)), stream_(std::move(stream)), flush_(flush) {}

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
  std::string part;
  const int descriptor = open_part(folder, file, part);
  if (descriptor < 0) return cannot_write(file, errno);
  Stream stream(fdopen(descriptor, "wb"));
  if (!stream) {
    const int error_number = errno;
    close(descriptor);
    folder.remove(part);
    return cannot_write(file, error_number);
  }
  struct stat old = {};
  if (lstat(file.c_str(), &old) == 0) {
    // A file system without permissions may refuse this, and needs none.
    (void)fchmod(descriptor, old.st_mode & 0777U);
  }
  return AtomicFile(file, part, std::move(stream), flush);
}

Result<void> AtomicFile::write(std::string_view bytes) {
  PLIANT_EXPECTS(stream_);
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size()) {
    return unwritable(errno);
  }
  return {};
}

Result<void> AtomicFile::write(std::span<const double> numbers) { return write(bytes_of(numbers)); }

Result<void> AtomicFile::write(std::span<const float> numbers) { return write(bytes_of(numbers)); }

Result<void> AtomicFile::commit() { return commit_as(file_); }

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

Result<void> write_file(const std::filesystem::path& file, std::string_view bytes) {
  auto output = AtomicFile::create(file);
  if (!output) return fail(output.error());
  if (auto written = output->write(bytes); !written) return written;
  return output->commit();
}

Result<void> flush_folder(const std::filesystem::path& file) {
  const OpenFolder folder(file);
  const int error = folder.error() != 0 ? folder.error() : folder.flush();
  if (error != 0) return cannot_write(file, error);
  return {};
}

}  // namespace pliant
