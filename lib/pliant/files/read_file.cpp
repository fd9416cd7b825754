#include "pliant/files/read_file.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <memory>

#include <unistd.h>

#include "pliant/core/hash_stream.hpp"
#include "pliant/files/open_file.hpp"

namespace pliant {

namespace {

tl::unexpected<Error> cannot_read(const std::filesystem::path& file, const std::string& reason) {
  return fail(ErrorCode::Unreadable, "cannot read the file: " + reason, file.string());
}

tl::unexpected<Error> too_large(const std::filesystem::path& file, std::size_t max_bytes) {
  return cannot_read(file, "it is larger than " + std::to_string(max_bytes >> 20) + " MiB");
}

}  // namespace

Result<void> check_readable(const std::filesystem::path& file) {
  std::error_code status_error;
  if (std::filesystem::is_directory(file, status_error)) return cannot_read(file, "it is a folder");
  if (access(file.c_str(), R_OK) != 0) return cannot_read(file, std::strerror(errno));
  return {};
}

Result<void> read_pieces(const std::filesystem::path& file,
                         const std::function<bool(std::string_view)>& take) {
  if (auto readable = check_readable(file); !readable) return readable;

  errno = 0;
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(std::fopen(file.c_str(), "rb"),
                                                               &std::fclose);
  if (!stream) return cannot_read(file, std::strerror(errno));
  // Reads to the end instead of querying the size first: pipes have no size.
  std::string chunk(std::size_t{1} << 20, '\0');
  while (const std::size_t count = std::fread(chunk.data(), 1, chunk.size(), stream.get())) {
    if (!take(std::string_view(chunk).substr(0, count))) return {};
  }
  if (std::ferror(stream.get())) return cannot_read(file, std::strerror(errno));
  return {};
}

Result<void> read_pieces(const OpenFile& file, const std::function<bool(std::string_view)>& take) {
  std::string chunk(std::size_t{1} << 20, '\0');
  off_t offset = 0;
  while (true) {
    const ssize_t count = pread(file.descriptor(), chunk.data(), chunk.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return cannot_read(file.name(), std::strerror(errno));
    if (count == 0) return {};
    if (!take(std::string_view(chunk).substr(0, static_cast<std::size_t>(count)))) return {};
    offset += count;
  }
}

namespace {

template <class File>
Result<std::string> read_all(const File& file, const std::filesystem::path& name,
                             std::uintmax_t size, std::size_t max_bytes,
                             const StopRequest& should_stop) {
  std::string bytes;
  bool is_stopped = false;
  if (size > max_bytes) return too_large(name, max_bytes);  // any file may grow meanwhile
  bytes.reserve(static_cast<std::size_t>(size));
  const auto read = read_pieces(file, [&](std::string_view piece) {
    bytes += piece;
    is_stopped = pliant::is_stopped(should_stop);
    return bytes.size() <= max_bytes && !is_stopped;
  });
  if (!read) return fail(read.error());
  if (is_stopped) return interrupted();
  if (bytes.size() > max_bytes) return too_large(name, max_bytes);
  return bytes;
}

}  // namespace

Result<std::string> read_file(const std::filesystem::path& file, std::size_t max_bytes,
                              const StopRequest& should_stop) {
  std::error_code no_size;  // a pipe has none
  const std::uintmax_t size = std::filesystem::file_size(file, no_size);
  return read_all(file, file, no_size ? 0 : size, max_bytes, should_stop);
}

Result<std::string> read_file(const OpenFile& file, std::size_t max_bytes,
                              const StopRequest& should_stop) {
  return read_all(file, file.name(), file.size(), max_bytes, should_stop);
}

Result<Hash> hash_of_file(const OpenFile& file, const StopRequest& should_stop) {
  HashStream stream;
  bool is_stopped = pliant::is_stopped(should_stop);
  const auto read = read_pieces(file, [&](std::string_view piece) {
    stream.add(piece);
    is_stopped = is_stopped || pliant::is_stopped(should_stop);
    return !is_stopped;
  });
  if (is_stopped) return interrupted();
  if (!read) return fail(read.error());
  return stream.hash();
}

}  // namespace pliant
