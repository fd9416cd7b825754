#include "cli/commands/regions_file.hpp"

#include <string>
#include <utility>

#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/json.hpp"

namespace pliant::cli {

Result<RegionsFile> RegionsFile::create(const std::filesystem::path& file, const Scene& scene) {
  auto atomic = AtomicFile::create(file);
  if (!atomic) return fail(atomic.error());
  RegionsFile regions(*std::move(atomic));
  const Json fps = scene.fps;
  const std::string head = "{\"version\": 1, \"fps\": " + fps.dump() + ", \"frames\": [";
  if (auto written = regions.file_.write(head); !written) return fail(written.error());
  return regions;
}

Result<void> RegionsFile::write(const FrameReport& report, const Simulation& simulation) {
  const auto frame = to_json(report, simulation, &was_interrupted);
  if (!frame) return fail(frame.error());
  const char* const before = std::exchange(is_first_, false) ? "\n" : ",\n";
  return file_.write(before + *frame);
}

Result<void> RegionsFile::finish(const SolverCounts& counts) {
  const Json solver = {{"analyses", counts.analyses},
                       {"factorizations", counts.factorizations},
                       {"solves", counts.solves}};
  if (auto written = file_.write("\n], \"solver\": " + solver.dump() + "}\n"); !written) {
    return written;
  }
  return file_.commit();
}

}  // namespace pliant::cli
