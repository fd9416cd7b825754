#pragma once

#include <memory>

#include "cli/terminal/resources.hpp"
#include "editor/edit_server.hpp"

namespace pliant::cli {

/// Exports by commands of pliant itself: `bake`, and by the file's ending `view --movie` or `replay
/// record`. They write what they write in a terminal, and end when this one does, but go on if it
/// is killed.
std::shared_ptr<editor::Exporter> make_exporter(const ResourceOptions& resources);

}  // namespace pliant::cli
