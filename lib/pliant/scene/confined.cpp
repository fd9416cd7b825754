#include "pliant/scene/confined.hpp"

#include <cerrno>
#include <cstring>

#include <fmt/format.h>
#include <sys/stat.h>

#include "pliant/mesh/file_reference.hpp"
#include "pliant/scene/check.hpp"

namespace pliant::xml {

Result<std::string> identify_file(const std::filesystem::path& file,
                                  const std::filesystem::path& root) {
  if (auto below = check_below(file, root); !below) return fail(below.error());
  if (auto readable = check_mesh_file(file); !readable) return fail(readable.error());
  struct stat status {};
  if (stat(file.c_str(), &status) != 0)
    return fail(ErrorCode::Unreadable, std::string("cannot read the file: ") + std::strerror(errno),
                file.string());
  return fmt::format("{}:{}", status.st_dev, status.st_ino);
}

}  // namespace pliant::xml
