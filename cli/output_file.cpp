#include "output_file.hpp"

#include <system_error>

#include <fmt/format.h>

#include "pliant/io/output_place.hpp"

namespace pliant::cli {

Result<void> check_output_folder(std::string_view option, const std::filesystem::path& file) {
  const std::filesystem::path folder = file.parent_path();
  if (folder.empty()) return {};
  std::error_code unknown;  // if the status is unknown, the write will report it
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

Result<void> check_output_file(std::string_view option, const std::string& file) {
  if (file == "-") {
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} -: this cannot go to the standard output; name a file (./- is one)",
                            option));
  }
  if (auto there = check_output_folder(option, file); !there) return there;
  return check_output_place(file);
}

}  // namespace pliant::cli
