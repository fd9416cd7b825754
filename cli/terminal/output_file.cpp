#include "cli/terminal/output_file.hpp"

#include <algorithm>
#include <system_error>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/text.hpp"
#include "pliant/files/output_place.hpp"

namespace pliant::cli {

Result<void> check_output_folder(std::string_view option, const std::filesystem::path& file) {
  const std::filesystem::path folder = file.parent_path();
  if (folder.empty()) return {};
  std::error_code unknown;  // if the status is unknown, the write will report it
  const auto status = std::filesystem::status(folder, unknown);
  const std::string name = printable(folder.string());
  const auto refuse = [&](std::string_view reason) {
    return fail(ErrorCode::Unwritable,
                fmt::format("{} {}: {}", option, printable(file.string()), reason));
  };
  if (status.type() == std::filesystem::file_type::not_found)
    return refuse(fmt::format("the folder {} does not exist", name));
  if (!unknown && !std::filesystem::is_directory(status))
    return refuse(fmt::format("{} is not a folder", name));
  return {};
}

Result<void> check_output_file(std::string_view option, const std::string& file,
                               std::span<const std::string_view> endings) {
  if (file == "-") {
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("{} -: cannot write this to the standard output; name a file, such as ./-",
                    option));
  }
  const std::string ending = ending_of(file);
  if (!endings.empty() && std::find(endings.begin(), endings.end(), ending) == endings.end()) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} {}: no format has the ending \"{}\"; allowed: {}", option,
                            printable(file), printable(ending), fmt::join(endings, ", ")));
  }
  if (auto there = check_output_folder(option, file); !there) return there;
  return check_output_place(file);
}

}  // namespace pliant::cli
