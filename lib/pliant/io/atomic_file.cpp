#include "pliant/io/atomic_file.hpp"

#include <bit>
#include <cerrno>
#include <cstring>
#include <string>
#include <utility>

#include <fcntl.h>
#include <unistd.h>

#include "pliant/core/expects.hpp"
#include "pliant/io/raw_bytes.hpp"

namespace pliant {
namespace {

static_assert(std::endian::native == std::endian::little,
              "the formats written here are little endian");

tl::unexpected<Error> cannot_write(const std::filesystem::path& file, const std::string& reason) {
  return fail(ErrorCode::Unwritable, "cannot write the file: " + reason, file.string());
}

// Opens a new file beside `file`, under a name that nobody else uses; -1 with errno otherwise.
int open_part(const std::filesystem::path& file, std::filesystem::path& part) {
  for (int attempt = 0; attempt < 1000; ++attempt) {
    // In the same folder, because a rename is atomic only within one file system.
    part = file.parent_path() / ("." + file.filename().string() + "." + std::to_string(getpid()) +
                                 "-" + std::to_string(attempt) + ".part");
    const int descriptor = open(part.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path file, std::filesystem::path part, Stream stream)
    : file_(std::move(file)), part_(std::move(part)), stream_(std::move(stream)) {}

AtomicFile::~AtomicFile() {
  if (!stream_) return;
  stream_.reset();
  std::error_code ignored;  // nothing to do about a part that cannot be removed
  std::filesystem::remove(part_, ignored);
}

Result<AtomicFile> AtomicFile::create(const std::filesystem::path& file) {
  std::error_code status_error;
  if (std::filesystem::is_directory(file, status_error))
    return cannot_write(file, "it is a folder");
  std::filesystem::path part;
  const int descriptor = open_part(file, part);
  if (descriptor < 0) return cannot_write(file, std::strerror(errno));
  Stream stream(fdopen(descriptor, "wb"));
  if (!stream) {
    const int error_number = errno;
    close(descriptor);
    unlink(part.c_str());
    return cannot_write(file, std::strerror(error_number));
  }
  return AtomicFile(file, part, std::move(stream));
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

Result<void> AtomicFile::commit() {
  PLIANT_EXPECTS(stream_);
  // Closing is the last chance of a network file system to say that the disk is full.
  std::FILE* const stream = stream_.release();
  const bool is_flushed = std::fflush(stream) == 0;
  const int flush_error = errno;
  const bool is_closed = std::fclose(stream) == 0;
  const int error_number = is_flushed ? errno : flush_error;
  if (is_flushed && is_closed && std::rename(part_.c_str(), file_.c_str()) == 0) return {};
  const auto failure = unwritable(is_flushed && is_closed ? errno : error_number);
  unlink(part_.c_str());
  return failure;
}

tl::unexpected<Error> AtomicFile::unwritable(int error_number) const {
  return cannot_write(file_, std::strerror(error_number));
}

}  // namespace pliant
