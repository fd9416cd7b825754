#include "pliant/files/output_place.hpp"

#include <cerrno>
#include <climits>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/core/hash.hpp"

namespace pliant {
namespace {

// The kind of an existing file that may not be replaced; empty: it may be written.
std::string_view obstacle(const std::filesystem::path& file) {
  struct stat status = {};
  if (lstat(file.c_str(), &status) != 0) return {};  // no such file, or creating it fails too
  switch (status.st_mode & S_IFMT) {
    case S_IFREG:
      // The folder may allow to replace it all the same.
      if (faccessat(AT_FDCWD, file.c_str(), W_OK, AT_EACCESS) != 0 && errno == EACCES)
        return "it may not be written; change its permissions, or choose another name";
      return {};
    case S_IFDIR:
      return "it is a folder";
    case S_IFLNK:
      return "it is a symbolic link; name the file that it points to";
    case S_IFIFO:
      return "it is a pipe; a regular file is required";
    case S_IFSOCK:
      return "it is a socket; a regular file is required";
    default:
      return "it is a device; a regular file is required";
  }
}

// [bytes]
std::size_t longest_name_in(const std::filesystem::path& folder) {
  const long most = pathconf(folder.empty() ? "." : folder.c_str(), _PC_NAME_MAX);
  return most > 0 ? static_cast<std::size_t>(most) : NAME_MAX;
}

}  // namespace

Result<void> check_output_place(const std::filesystem::path& file) {
  const auto refuse = [&](std::string_view reason) {
    return fail(ErrorCode::InvalidInput, fmt::format("cannot write the file: {}", reason),
                file.string());
  };
  const std::string name = file.filename().string();
  constexpr std::size_t longest_path = PATH_MAX - 1;  // excludes the terminating zero
  if (file.native().size() > longest_path) {
    return refuse(fmt::format("its path has {} bytes; the system allows {}", file.native().size(),
                              longest_path));
  }
  if (file.empty()) return refuse("the name is empty");
  if (name.empty() || name == "." || name == "..") return refuse("it is a folder");
  // No file system has a shorter limit; the folder is queried only for longer names.
  constexpr std::size_t short_everywhere = 140;
  if (name.size() > short_everywhere) {
    if (const std::size_t most = longest_name_in(file.parent_path()); name.size() > most) {
      return refuse(fmt::format("its name has {} bytes; the folder allows {}", name.size(), most));
    }
  }
  if (const auto reason = obstacle(file); !reason.empty()) return refuse(reason);
  return {};
}

std::string hidden_name(const std::filesystem::path& file) {
  constexpr std::size_t longest = 64;
  std::string name = file.filename().string();
  if (name.size() > longest) {
    std::size_t end = longest / 2;
    // Do not cut within a character: some file systems accept only UTF-8.
    while (end > 0 && (static_cast<unsigned char>(name[end]) & 0xc0) == 0x80) --end;
    name = name.substr(0, end) + '-' + to_text(hash_of(name));
  }
  return '.' + name;
}

}  // namespace pliant
