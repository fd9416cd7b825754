#include "runs.hpp"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/stl.h>

#include "parts.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/output_place.hpp"
#include "pliant/replay/replay.hpp"
#include "pliant/scene/inputs.hpp"
#include "pliant/simulation/animation_bake.hpp"
#include "pliant/viewer/view_page.hpp"
#include "simulations.hpp"

namespace pliant::python {
namespace {

namespace fs = std::filesystem;

// -- Bakes
// -----------------------------------------------------------------------------------------

/// The files that a bake has written, also those whose names depend on their content.
std::vector<std::string> files_written(const AnimationPlan& plan) {
  std::vector<std::string> files = files_of(plan);
  const fs::path folder = fs::path(plan.file).parent_path();
  std::vector<std::string> others;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(folder.empty() ? "." : folder, ignored))
    if (const fs::path name = entry.path().filename(); is_named_at_the_end(plan, name.string()))
      others.push_back((folder / name).string());
  std::ranges::sort(others);
  files.insert(files.end(), others.begin(), others.end());
  return files;
}

Result<void> bake_frames(Simulation& simulation, AnimationBake& output, const Telling& telling,
                         const StopRequest& should_stop) {
  if (auto free = output.check_inputs(); !free) return free;
  if (auto begun = output.begin(); !begun) return begun;
  const AnimationPlan& plan = output.plan();
  const int start = simulation.scene().start;
  const std::int64_t total = std::int64_t{plan.last_frame} - start + 1;
  Frame frame;
  // Always from the scene's start, whichever frames are written.
  for (std::int64_t number = start; number <= plan.last_frame; ++number) {
    if (should_stop()) return interrupted();
    auto reached = simulation.at(static_cast<int>(number), std::move(frame));
    if (!reached) return fail(reached.error());
    frame = *std::move(reached);
    if (number >= plan.first_frame)
      if (auto written = output.write(frame); !written) return written;
    telling.tell(number - start + 1, total);
  }
  return output.finish();
}

py::object bake(const py::object& scene, const std::string& out, const py::object& frames,
                const py::object& surface, const std::string& space, int threads,
                const std::string& solver, const py::object& max_memory, const py::object& store,
                bool resume, const py::object& progress) {
  const auto begin = std::chrono::steady_clock::now();
  Asking asking;
  taken(check_ending(out));
  AnimationOptions options{.file = out, .is_world = is_world(space), .resume = resume};
  const SimulationOptions run = options_of(threads, solver, asking, max_memory, store);
  options.max_memory = run.max_memory;
  options.should_stop = run.should_stop;
  Scene native = scene_of(scene, &asking);
  options.frames = frames_within(frames, native);
  if (!surface.is_none()) options.surfaces.push_back(surface_index(native, surface));
  const Telling telling(progress, &asking);
  Turn turn(asking);
  std::optional<Simulation> simulation;
  std::optional<AnimationBake> output;
  std::vector<std::string> files;
  turn.run([&]() -> Result<void> {
    auto made = Simulation::make(std::move(native), run);
    if (!made) return fail(made.error());
    simulation.emplace(*std::move(made));
    auto planned = AnimationBake::make(*simulation, options);
    if (!planned) return fail(planned.error());
    output.emplace(*std::move(planned));
    auto done = bake_frames(*simulation, *output, telling, options.should_stop);
    if (done) files = files_written(output->plan());
    return done;
  });
  py::list names;
  for (const std::string& file : files) names.append(name_text(file));
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  return class_named("BakeSummary")(py::tuple(names), output->frame_count(), output->vertex_count(),
                                    elapsed.count(), output->peak_displacement(),
                                    py::tuple(warning_list(simulation->warnings())));
}

// -- Pages
// -----------------------------------------------------------------------------------------

/// Calls `work(simulation, should_stop)` with a simulation, or with one of a scene.
template <class Work>
auto with_simulation(const py::object& what, Work&& work) {
  if (py::isinstance<OwnSimulation>(what)) {
    auto& own = what.cast<OwnSimulation&>();
    Turn turn(*own.asking);
    return turn.run([&] { return work(*own.working, own.asking->request()); });
  }
  Asking asking;
  const SimulationOptions run = options_of(1, "auto", asking, py::none(), py::none());
  Scene native = scene_of(what, &asking);
  Turn turn(asking);
  return turn.run([&]() -> decltype(work(std::declval<Simulation&>(), asking.request())) {
    auto simulation = Simulation::make(std::move(native), run);
    if (!simulation) return fail(simulation.error());
    return work(*simulation, run.should_stop);
  });
}

ViewPageOptions page_options(const std::optional<FrameSpan>& frames,
                             const StopRequest& should_stop) {
  return {.frames = frames, .should_stop = should_stop};
}

/// Checks, before any work, that a page may be written.
Result<void> check_page(const std::string& out, const Scene& scene,
                        const StopRequest& should_stop) {
  const std::string ending = ending_of(out);
  const auto refused = [&](const std::string& reason) {
    return fail(ErrorCode::InvalidInput, fmt::format("{}: {}", printable(out), reason));
  };
  if (ending != ".html" && ending != ".htm")
    return refused(
        fmt::format("no format has the ending \"{}\"; allowed: .html, .htm", printable(ending)));
  if (auto place = check_output_place(out); !place) return place;
  if (InputFinder(scene, should_stop).find(out))
    return refused("it is an input of the scene; choose another name");
  return {};
}

void view(const py::object& what, const std::string& out, const py::object& frames) {
  std::optional<FrameSpan> span;
  if (!frames.is_none()) span = frame_span(frames);
  with_simulation(what,
                  [&](Simulation& simulation, const StopRequest& should_stop) -> Result<void> {
                    if (auto free = check_page(out, simulation.scene(), should_stop); !free)
                      return free;
                    return write_view_page(simulation, out, page_options(span, should_stop));
                  });
}

std::string page_of(const py::object& simulation) {
  return with_simulation(simulation, [&](Simulation& own, const StopRequest& should_stop) {
    return view_page(own, page_options({}, should_stop));
  });
}

// -- Replays
// ---------------------------------------------------------------------------------------

ReplayOptions replay_options(int threads, bool keep_going, const StopRequest& should_stop) {
  ReplayOptions options;
  options.simulation.threads = threads;
  options.simulation.should_stop = should_stop;
  options.keeps_going = keep_going;
  return options;
}

/// Calls `work(simulation or file, should_stop)` with whatever is given.
template <class Work>
auto with_run(const py::object& what, Work&& work) {
  if (py::isinstance<OwnSimulation>(what)) {
    auto& own = what.cast<OwnSimulation&>();
    Turn turn(*own.asking);
    return turn.run([&] { return work(*own.working, own.asking->request()); });
  }
  const auto file = what.cast<std::string>();
  return run_once([&](const StopRequest& should_stop) { return work(file, should_stop); });
}

void record(const py::object& what, const std::string& log, const std::optional<int>& last_frame,
            int states_every, int threads) {
  check_threads(threads);
  if (states_every < 0) throw py::value_error("states_every must not be negative");
  with_run(what, [&](auto& own, const StopRequest& should_stop) -> Result<ReplayHeader> {
    ReplayOptions options = replay_options(threads, false, should_stop);
    options.last_frame = last_frame;
    options.states_every = states_every;
    return record_replay(own, log, options);
  });
}

template <class T>
py::object object_or_none(const std::optional<T>& value) {
  return value ? py::object(py::cast(*value)) : py::object(py::none());
}

py::tuple lines_of(const std::vector<std::string>& lines) {
  py::list list;
  for (const std::string& line : lines) list.append(name_text(line));
  return py::tuple(list);
}

py::object verdict_object(const ReplayVerdict& verdict) {
  py::list differences;
  const py::object type = class_named("ReplayDifference");
  const auto pair_of = [](const auto& pair) -> py::object {
    return pair ? py::object(py::make_tuple((*pair)[0], (*pair)[1])) : py::object(py::none());
  };
  for (const ReplayDifference& each : verdict.differences)
    differences.append(type(each.frame, each.surface, each.field, pair_of(each.node), each.size,
                            pair_of(each.peaks), each.message()));
  return class_named("ReplayVerdict")(verdict.holds(), verdict.frame_count, py::tuple(differences),
                                      lines_of(verdict.mismatches), lines_of(verdict.causes));
}

py::object verify(const std::string& log, const py::object& what, bool keep_going, int threads) {
  check_threads(threads);
  if (what.is_none())
    return verdict_object(run_once([&](const StopRequest& should_stop) {
      return verify_replay(log, std::nullopt, replay_options(threads, keep_going, should_stop));
    }));
  return verdict_object(with_run(what, [&](auto& own, const StopRequest& should_stop) {
    return verify_replay(log, own, replay_options(threads, keep_going, should_stop));
  }));
}

py::object compare(const std::string& a, const std::string& b, bool keep_going) {
  return verdict_object(run_once([&](const StopRequest& should_stop) {
    return compare_replays(a, b, replay_options(1, keep_going, should_stop));
  }));
}

}  // namespace

FrameSpan frame_span(const py::object& frames) {
  std::vector<int> both;
  try {
    both = frames.cast<std::vector<int>>();
  } catch (const py::cast_error&) {
    throw py::type_error("frames must be (first, last), not " + std::string(py::repr(frames)));
  }
  if (both.size() != 2) throw py::value_error("frames must be two numbers, (first, last)");
  if (both[0] > both[1])
    refuse(fmt::format("frames ({}, {}): the first is behind the last", both[0], both[1]));
  return {both[0], both[1]};
}

FrameSpan frames_within(const py::object& frames, const Scene& scene) {
  if (frames.is_none()) return {scene.start, scene.end};
  const FrameSpan span = frame_span(frames);
  if (span.first < scene.start || span.last > scene.end)
    refuse(fmt::format("frames ({}, {}): the scene has frames {} to {}", span.first, span.last,
                       scene.start, scene.end));
  return span;
}

void add_runs(Module& module) {
  module.def("bake", &bake);
  module.def("view", &view);
  module.def("page", &page_of);
  module.def("record_replay", &record);
  module.def("verify_replay", &verify);
  module.def("compare_replays", &compare);
}

}  // namespace pliant::python
