#include "output_folder.hpp"

#include <system_error>

#include <fmt/format.h>

namespace pliant::cli {

Result<void> check_output_folder(std::string_view option, const std::filesystem::path& file) {
  const std::filesystem::path folder = file.parent_path();
  if (folder.empty()) return {};
  std::error_code unknown;  // what cannot be looked at, writing will tell of
  const auto status = std::filesystem::status(folder, unknown);
  const auto refuse = [&](std::string_view reason) {
    return fail(ErrorCode::Unwritable,
                fmt::format("{} {}: the folder {} {}", option, printable(file.string()),
                            printable(folder.string()), reason));
  };
  if (status.type() == std::filesystem::file_type::not_found) return refuse("does not exist");
  if (!unknown && !std::filesystem::is_directory(status)) return refuse("is no folder");
  return {};
}

}  // namespace pliant::cli
