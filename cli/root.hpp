#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::cli {

/// `--root DIR` of every command that reads scenes; none: each scene's own folder.
using Root = std::optional<std::string>;

void add_root(CLI::App& command, Root& root);

/// The folder that was named; empty: none. Errors: it is no folder.
Result<std::filesystem::path> folder_of(const Root& root);

/// Errors: as `folder_of` and `load_scene`.
Result<Scene> load_scene(const std::string& file, const Root& root);

}  // namespace pliant::cli
