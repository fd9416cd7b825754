#include "pliant/files/spool_file.hpp"

#include <cerrno>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "pliant/files/open_folder.hpp"
#include "pliant/files/output_place.hpp"

namespace pliant {
namespace {

// Opens a new file without a name in the folder; returns -1 and sets errno on failure.
int open_nameless(const OpenFolder& folder, const std::filesystem::path& file) {
  const int nameless = openat(folder.descriptor(), ".", O_RDWR | O_TMPFILE | O_CLOEXEC, 0600);
  if (nameless >= 0 || (errno != EOPNOTSUPP && errno != EISDIR && errno != EINVAL)) return nameless;
  // Fallback for other file systems: the file has a name for a moment, and remains if the program
  // is killed then.
  for (int attempt = 0; attempt < 1000; ++attempt) {
    const std::string name = hidden_name(file) + "." + std::to_string(getpid()) + "-" +
                             std::to_string(attempt) + ".part";
    const int descriptor =
        openat(folder.descriptor(), name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0600);
    if (descriptor >= 0) folder.remove(name);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

}  // namespace

SpoolFile::SpoolFile(std::filesystem::path file, Stream stream)
    : file_(std::move(file)), stream_(std::move(stream)) {}

Result<SpoolFile> SpoolFile::create(const std::filesystem::path& file) {
  const auto cannot_write = [&](int error_number) {
    return fail(ErrorCode::Unwritable,
                std::string("cannot write the file: ") + std::strerror(error_number),
                file.string());
  };
  const OpenFolder folder(file);
  if (folder.error() != 0) return cannot_write(folder.error());
  const int descriptor = open_nameless(folder, file);
  if (descriptor < 0) return cannot_write(errno);
  Stream stream(fdopen(descriptor, "w+b"));
  if (!stream) {
    const int error_number = errno;
    close(descriptor);
    return cannot_write(error_number);
  }
  return SpoolFile(file, std::move(stream));
}

Result<void> SpoolFile::write(std::string_view bytes) {
  if (std::fwrite(bytes.data(), 1, bytes.size(), stream_.get()) != bytes.size())
    return unwritable(errno);
  size_ += bytes.size();
  return {};
}

Result<void> SpoolFile::copy_to(AtomicFile& file, const StopRequest& should_stop) {
  if (std::fflush(stream_.get()) != 0) return unwritable(errno);
  if (fseeko(stream_.get(), 0, SEEK_SET) != 0) return unwritable(errno);
  std::vector<char> block(std::size_t{1} << 20);
  while (const std::size_t count = std::fread(block.data(), 1, block.size(), stream_.get())) {
    if (is_stopped(should_stop)) return interrupted();
    if (auto written = file.write({block.data(), count}); !written) return written;
  }
  if (std::ferror(stream_.get())) return unwritable(errno);
  return {};
}

tl::unexpected<Error> SpoolFile::unwritable(int error_number) const {
  return fail(ErrorCode::Unwritable,
              std::string("cannot write the file: ") + std::strerror(error_number), file_.string());
}

}  // namespace pliant
