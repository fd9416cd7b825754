#include "cli/sweep/sweep_memory.hpp"

#include <algorithm>
#include <chrono>
#include <optional>
#include <set>
#include <utility>

#include "cli/terminal/memory_limit.hpp"

namespace pliant::cli {
namespace {

constexpr std::size_t of_a_record = 512;  // what a sweep and its log cost for each take

Result<Simulation> simulation_of(const Sweep& sweep, std::size_t take,
                                 const SimulationOptions& options) {
  auto scene = sweep.scene_of(take);
  if (!scene) return fail(scene.error());
  return Simulation::make(*std::move(scene), options);
}

// What it reserves while it is played, until it is stopped.
std::size_t most_reserved(Simulation& simulation) {
  std::size_t most = simulation.reserved_memory();
  Frame frame;
  for (const int number : simulation.frames()) {
    auto reached = simulation.at(number, std::move(frame));
    most = std::max(most, simulation.reserved_memory());
    if (!reached) break;
    frame = *std::move(reached);
  }
  return most;
}

// The first takes of all scenes and others, spread evenly.
std::set<std::size_t> chosen_takes(std::size_t count, std::size_t scenes) {
  constexpr std::size_t most_scenes = 16, spread = 4;
  std::set<std::size_t> takes;
  for (std::size_t scene = 0; scene < std::min(scenes, most_scenes); ++scene)
    takes.insert(scene * (count / scenes));
  for (std::size_t k = 0; k <= spread; ++k) takes.insert((count - 1) * k / spread);
  return takes;
}

}  // namespace

std::size_t memory_of_records(const Sweep& sweep) { return of_a_record * sweep.takes().count(); }

Result<std::size_t> memory_of_part(const Sweep& sweep, int threads,
                                   const SimulationOptions& options) {
  constexpr auto patience = std::chrono::seconds(2);
  auto deadline = std::chrono::steady_clock::time_point::max();
  const auto is_interrupted = [&] { return options.should_stop && options.should_stop(); };
  SimulationOptions run = options;
  run.threads = 1;
  run.should_stop = [&] { return is_interrupted() || std::chrono::steady_clock::now() > deadline; };
  run.solver = sweep.settings().solver;
  const std::size_t count = sweep.takes().count();
  std::optional<Simulation> largest;
  bool is_short = false;  // of memory for some take, even alone
  const auto is_larger = [&](const Simulation& other) {
    return !largest || other.surface_memory() > largest->surface_memory();
  };
  for (const std::size_t take : chosen_takes(count, sweep.scenes().size())) {
    auto simulation = simulation_of(sweep, take, run);
    if (is_interrupted()) return interrupted();
    is_short |= !simulation && simulation.error().code == ErrorCode::OutOfMemory;
    if (simulation && is_larger(*simulation)) largest = *std::move(simulation);
  }
  deadline = std::chrono::steady_clock::now() + patience;
  const std::size_t of_take = largest ? most_reserved(*largest) : 0;
  if (is_interrupted()) return interrupted();
  const std::size_t of_takes =
      is_short ? options.max_memory
               : std::min(options.max_memory,
                          memory_of_takes(static_cast<std::size_t>(threads), of_take));
  return memory_of_program + memory_of_records(sweep) + of_takes;
}

}  // namespace pliant::cli
