#include "pliant/replay/run_header.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "pliant/files/open_file.hpp"
#include "pliant/files/output_place.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/scene/inputs.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/write.hpp"

namespace pliant {
namespace {

namespace fs = std::filesystem;

// The path from a folder to a file, so that both can be moved together. An empty folder is the
// current one.
std::string name_from(const fs::path& folder, const fs::path& file) {
  std::error_code ignored;
  const fs::path base = folder.empty() ? fs::current_path(ignored) : fs::absolute(folder, ignored);
  return fs::absolute(file, ignored)
      .lexically_normal()
      .lexically_proximate(base.lexically_normal())
      .generic_string();
}

// Relative to the scene's folder; relative to its canonical path if the file is given by one.
std::string name_of(const SceneInput& input, const WrittenScene& written) {
  std::error_code unknown;
  const fs::path real = fs::canonical(written.folder.empty() ? "." : written.folder, unknown);
  const bool is_real = !unknown && fs::weakly_canonical(input.file, unknown) == input.file;
  return name_from(is_real ? real : written.folder, input.file);
}

bool is_one_file(const fs::path& a, const fs::path& b) {
  std::error_code ignored;
  return fs::equivalent(a, b, ignored);
}

Result<Scene> scene_of(const WrittenScene& written, const StopRequest& should_stop = {}) {
  auto scene =
      parse_scene(written.text, written.file.string(), written.folder, written.root, should_stop);
  if (!scene || written.changes.empty()) return scene;
  if (auto changed = change_scene(*scene, written.changes, written.root.string()); !changed)
    return fail(changed.error());
  return scene;
}

}  // namespace

Result<WrittenScene> read_scene_text(const fs::path& file, const fs::path& root,
                                     const StopRequest& should_stop) {
  auto text = read_file(file, largest_scene_file, should_stop);
  if (!text) return fail(text.error());
  return WrittenScene{.file = file, .text = *std::move(text), .root = root};
}

WrittenScene written_by_program(const Scene& scene, const fs::path& folder) {
  auto text = to_xml(scene, folder.string());
  return {.file = {}, .text = text ? *std::move(text) : std::string(), .folder = folder};
}

Result<ReplayHeader> header_of(const Scene& scene, const WrittenScene& written,
                               const fs::path& log_file, SolverChoice solver,
                               const StopRequest& should_stop) {
  ReplayHeader header;
  header.version = PLIANT_VERSION;
  if (!written.file.empty()) header.scene_file = name_from(log_file.parent_path(), written.file);
  header.scene_text = written.text;
  header.changes = written.changes;
  for (const SceneInput& input : inputs_of(scene, should_stop)) {
    if (input.file == scene.origin.file) continue;  // the scene is stored as text
    const auto opened = OpenFile::open(input.file, input.root);
    if (!opened) continue;
    const auto hash = hash_of_file(*opened, should_stop);
    if (!hash && hash.error().code == ErrorCode::Interrupted) return fail(hash.error());
    if (hash) header.files.push_back({name_of(input, written), *hash});
  }
  header.solver = name_of(solver);
  header.factors = name_of(available_solvers().front());
  return header;
}

Result<ReplayHeader> header_of_text(const WrittenScene& written, const fs::path& log_file,
                                    SolverChoice solver, const StopRequest& should_stop) {
  const auto scene = scene_of(written);
  if (!scene) return fail(scene.error());
  return header_of(*scene, written, log_file, solver, should_stop);
}

void complete(ReplayHeader& header, const Simulation& simulation, std::optional<int> last_frame) {
  const Scene& scene = simulation.scene();
  header.start = scene.start;
  header.end = std::min(scene.end, last_frame.value_or(scene.end));
  for (const RestShape& shape : simulation.rest_shapes()) {
    ReplaySurface& surface = header.surfaces.emplace_back();
    surface.name = shape.name;
    if (shape.grid) {
      surface.columns = shape.grid->columns;
      surface.rows = shape.grid->rows;
    } else {
      surface.nodes = static_cast<int>(shape.rest.rows());
    }
  }
}

Result<Simulation> simulation_of(const WrittenScene& written, const SimulationOptions& options) {
  auto scene = scene_of(written, options.should_stop);
  if (!scene) return fail(scene.error());
  return Simulation::make(*std::move(scene), options);
}

Result<void> check_log_place(const fs::path& log_file, const Scene& scene) {
  const auto refuse = [&](std::string_view reason) {
    return fail(ErrorCode::InvalidInput, fmt::format("the log would overwrite {}", reason),
                log_file.string());
  };
  if (auto place = check_output_place(log_file); !place) return place;
  for (const SceneInput& input : inputs_of(scene)) {
    if (is_one_file(log_file, input.file)) return refuse(input.role);
  }
  return {};
}

}  // namespace pliant
