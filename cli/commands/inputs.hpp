#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// Whether two paths lead to the same file, existing or not.
bool name_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// The role of `file` as an input of a scene: "it is the scene", "it is a mesh of the scene", "it
/// is a file that a mesh of the scene refers to"; empty: not an input.
std::string input_named(const std::filesystem::path& file, const Scene& scene);

/// `-o FILE: REASON; choose another name`.
tl::unexpected<Error> refuse_output(std::string_view option, const std::filesystem::path& file,
                                    std::string_view reason);

/// Checks that a file, named by an option, is not an input of a scene. Errors: `refuse_output`.
Result<void> check_no_input(std::string_view option, const std::filesystem::path& file,
                            const Scene& scene);

/// Finds the files of a scene that an output would overwrite; fast enough for a million outputs.
class InputFinder {
 public:
  explicit InputFinder(const Scene& scene);

  /// The input that `output` is, directly or by a link of either kind; null: it is not an input.
  std::optional<std::filesystem::path> find(const std::filesystem::path& output) const;

 private:
  // By their device and number there, whatever their names are.
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::filesystem::path> there_;
  // Those that are not there, by their file names without folders.
  std::multimap<std::string, std::filesystem::path> missing_;
};

}  // namespace pliant::cli
