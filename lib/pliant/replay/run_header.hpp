#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "pliant/replay/replay.hpp"

namespace pliant {

// The description of a run without its frames. Internal to replay.

/// The text of a scene, and the folders for its meshes.
struct WrittenScene {
  std::filesystem::path file = {};  ///< empty: made by a program
  std::string text = {};            ///< empty: of a program, and no file can contain it
  std::filesystem::path folder = file.parent_path();  ///< of the meshes' relative names
  std::filesystem::path root = {};                    ///< as in `load_scene`
  std::vector<std::string> changes = {};              ///< as in `ReplayOptions`
};

/// Errors: as `read_file`.
Result<WrittenScene> read_scene_text(const std::filesystem::path& file,
                                     const std::filesystem::path& root,
                                     const StopRequest& should_stop);

/// The scene of a program, as text if a file can contain it; its meshes are named relative to
/// `folder`.
WrittenScene written_by_program(const Scene& scene, const std::filesystem::path& folder);

/// The part of a log's header that is known before the simulation: all but frames and surfaces.
/// Files that cannot be read are omitted. Errors: Interrupted.
Result<ReplayHeader> header_of(const Scene& scene, const WrittenScene& written,
                               const std::filesystem::path& log_file, SolverChoice solver,
                               const StopRequest& should_stop);

/// The same for a text. Errors: as `parse_scene`; Interrupted.
Result<ReplayHeader> header_of_text(const WrittenScene& written,
                                    const std::filesystem::path& log_file, SolverChoice solver,
                                    const StopRequest& should_stop);

/// Adds frames and surfaces.
void complete(ReplayHeader& header, const Simulation& simulation, std::optional<int> last_frame);

/// Errors: as `parse_scene` and `Simulation::make`.
Result<Simulation> simulation_of(const WrittenScene& written, const SimulationOptions& options);

/// Whether a log may be written there. Errors: InvalidInput.
Result<void> check_log_place(const std::filesystem::path& log_file, const Scene& scene);

}  // namespace pliant
