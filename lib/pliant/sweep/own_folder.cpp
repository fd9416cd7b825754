#include "pliant/sweep/own_folder.hpp"

#include <system_error>

namespace pliant {

namespace fs = std::filesystem;

Result<void> make_own_folder(const fs::path& folder) {
  std::error_code error;
  if (fs::is_symlink(folder, error))
    return fail(
        ErrorCode::InvalidInput,
        "is a symbolic link, but a sweep writes only to its own folder; put a folder in its "
        "place, or make the sweep where the link leads",
        folder.string());
  fs::create_directory(folder, error);
  if (error)
    return fail(ErrorCode::Unwritable, "cannot make the folder: " + error.message(),
                folder.string());
  return {};
}

}  // namespace pliant
