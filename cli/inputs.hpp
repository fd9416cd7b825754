#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// Whether two paths lead to one file, there or not.
bool name_one_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// What `file` is to a scene: "it is the scene", "it is a mesh of the scene", "it is a file that a
/// mesh of the scene refers to"; empty: nothing.
std::string input_named(const std::filesystem::path& file, const Scene& scene);

/// Finds those files of a scene that an output would overwrite, also among a million outputs.
class InputsByName {
 public:
  explicit InputsByName(const Scene& scene);

  /// The input that `output` is, there or by a link; none: it is no input.
  std::optional<std::filesystem::path> find(const std::filesystem::path& output) const;

 private:
  std::multimap<std::string, std::filesystem::path> files_;  // by their names without a folder
};

}  // namespace pliant::cli
