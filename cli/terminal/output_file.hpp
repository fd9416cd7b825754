#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "pliant/core/result.hpp"

namespace pliant::cli {

/// Checks, before any work, that the folder of `file`, given with an option, exists. Errors:
/// Unwritable, naming the option and the folder.
Result<void> check_output_folder(std::string_view option, const std::filesystem::path& file);

/// The endings of the files that `check_output_file` checks, if they have one format only.
inline constexpr std::string_view page_endings[] = {".html", ".htm"};
inline constexpr std::string_view picture_endings[] = {".png"};

/// Checks, before any work, that the file named by an option may be written, and that it has one of
/// the endings, if any are given. For every file that a command writes except those of an
/// animation, which `make_writer` checks. Errors: those of `check_output_folder` and
/// `check_output_place`; InvalidInput for "-", which other programs read as the standard output,
/// and for another ending.
Result<void> check_output_file(std::string_view option, const std::string& file,
                               std::span<const std::string_view> endings = {});

}  // namespace pliant::cli
