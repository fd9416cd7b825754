#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "pliant/replay/replay.hpp"

namespace pliant {

// What is known of a run besides its frames; not for other rooms.

/// A scene as it is written, and where its meshes are looked for.
struct WrittenScene {
  std::filesystem::path file;
  std::string text;
  std::filesystem::path root = {};  ///< as `load_scene` takes it
};

/// Errors: as `read_file`.
Result<WrittenScene> read_scene_text(const std::filesystem::path& file,
                                     const std::filesystem::path& root);

/// What a log of this scene says ahead of simulating it: all but its frames and surfaces. A file
/// that cannot be read is left out. Errors: as `parse_scene`.
Result<ReplayHeader> header_of_text(const WrittenScene& written,
                                    const std::filesystem::path& log_file, SolverChoice solver);

/// Adds frames and surfaces.
void complete(ReplayHeader& header, const Simulation& simulation, std::optional<int> last_frame);

/// Errors: as `parse_scene` and `Simulation::make`.
Result<Simulation> simulation_of(const WrittenScene& written, const SimulationOptions& options);

/// Whether a log may be written there. Errors: InvalidInput.
Result<void> check_log_place(const std::filesystem::path& log_file, const Scene& scene);

}  // namespace pliant
