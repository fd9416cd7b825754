#include "pliant/replay/replay.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/shortened.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/files/open_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/replay/log_file.hpp"
#include "pliant/replay/run_header.hpp"
#include "pliant/scene/read.hpp"

namespace pliant {
namespace {

// The input of the solve at a frame, as in docs/replay.md: a line `region solved i0 i1 j0 j1` for
// each part of each region, or a hash of what is cut out of triangles; then, for a body that
// recovers, a byte for each node; then, for one that yields, a hash of its plastic curvatures;
// then, for one that remembers what pushed, a byte for each node, and hashes of loads and tangents.
std::string region_text(const SurfaceReport& report, const BodyState& state) {
  std::string text;
  for (std::size_t k = 0; k < report.regions.size(); ++k) {
    for (const Box& part : report.regions[k].parts) {
      text += fmt::format("{} {} {} {} {} {}\n", k, report.regions[k].is_solved() ? 1 : 0, part.i0,
                          part.i1, part.j0, part.j1);
    }
  }
  if (report.cut) text += fmt::format("{}\n", to_text(*report.cut));
  text.append(state.unsettled.begin(), state.unsettled.end());
  if (const auto count = static_cast<std::size_t>(state.plastic.size()); count > 0) {
    text += fmt::format("{}\n", to_text(hash_of(std::span(state.plastic.data(), count))));
  }
  const auto& [loads, unknowns, tangents] = state.last;
  if (unknowns.empty()) return text;
  text.append(unknowns.begin(), unknowns.end());
  text += fmt::format("{}\n", to_text(hash_of(loads)));
  Field slopes(4, 3);
  const Vector3d* const sides[] = {&tangents.su0, &tangents.su1, &tangents.sv0, &tangents.sv1};
  for (int side = 0; side < 4; ++side) slopes.row(side) = sides[side]->transpose();
  text += fmt::format("{}\n", to_text(hash_of(slopes)));
  return text;
}

double peak_displacement(const Field& positions, const Field& rest) {
  double largest = 0;
  for (Eigen::Index row = 0; row < rest.rows(); ++row) {
    const double x = positions(row, 0) - rest(row, 0);
    const double y = positions(row, 1) - rest(row, 1);
    const double z = positions(row, 2) - rest(row, 2);
    largest = std::max(largest, x * x + y * y + z * z);
  }
  return std::sqrt(largest);
}

// The log's frame for the state that `simulation` computes; `threads` hash the surfaces. Errors:
// those of `Simulation::report`.
Result<ReplayFrame> digest(Simulation& simulation, int frame, ThreadPool& threads,
                           bool with_states) {
  const auto report = simulation.report(frame);
  if (!report) return fail(report.error());
  const std::size_t count = report->surfaces.size();
  ReplayFrame digests{.number = frame, .surfaces = std::vector<SurfaceDigest>(count)};
  if (with_states) digests.states.resize(count);
  threads.for_each(count, [&](std::size_t k) {
    const BodyState& state = simulation.state(k);
    const RestShape& shape = simulation.rest_shapes()[k];
    // The state of an animated shape holds displacements.
    const Field none = Field::Zero(shape.animation ? shape.rest.rows() : 0, 3);
    const Field& rest = shape.animation ? none : shape.rest;
    digests.surfaces[k] = {hash_of(state.positions), hash_of(state.velocities),
                           hash_of(region_text(report->surfaces[k], state)),
                           peak_displacement(state.positions, rest)};
    if (with_states) digests.states[k] = {state.positions, state.velocities};
  });
  return digests;
}

constexpr std::size_t longest_name = 200;  // of a log, in messages [bytes]

Result<void> write_frames(Simulation& simulation, const ReplayHeader& header, ReplayLogWriter& log,
                          const ReplayOptions& options) {
  ThreadPool threads(options.simulation.threads);
  for (int number = header.start; number <= header.end; ++number) {
    const bool has_states =
        options.states_every > 0 && (number - header.start) % options.states_every == 0;
    const auto frame = digest(simulation, number, threads, has_states);
    if (!frame) return fail(frame.error());
    if (auto written = log.write(*frame); !written) return written;
    if (options.frame_done) options.frame_done(header.frame_count());
  }
  return log.finish();
}

// The scene of a log, and a remark if it is not the one that the caller may expect.
struct FoundScene {
  WrittenScene written;
  std::optional<std::string> remark = {};
};

Result<FoundScene> find_scene(const std::filesystem::path& log_file, const ReplayHeader& header,
                              const std::optional<std::string>& given,
                              const ReplayOptions& options) {
  const std::string& root = options.root;
  const std::filesystem::path folder = log_file.parent_path();
  if (!given && header.scene_file.empty()) {
    if (!header.scene_text.empty()) {
      return FoundScene{{.text = header.scene_text, .folder = folder, .root = root}};
    }
    return fail(ErrorCode::InvalidInput,
                "a program recorded it, with a scene that no file can contain: only the program "
                "can verify it",
                log_file.string(), 1);
  }
  const std::filesystem::path file =
      given ? std::filesystem::path(*given) : folder / header.scene_file;
  if (given) {
    auto written = read_scene_text(file, root, options.simulation.should_stop);
    if (!written) return fail(written.error());
    return FoundScene{*std::move(written)};
  }
  // The log may be a stranger's, whose scene tells nothing of what is outside.
  const auto opened = OpenFile::open(file, root);
  std::error_code ignored;
  if (!opened && opened.error().code == ErrorCode::Unreadable &&
      !std::filesystem::exists(file, ignored)) {
    return FoundScene{
        {.file = file, .text = header.scene_text, .root = root},
        fmt::format("the scene {} does not exist; its text in the log is simulated instead",
                    shortened(printable(header.scene_file), longest_name))};
  }
  if (!opened) return fail(opened.error());
  auto text = read_file(*opened, largest_scene_file, options.simulation.should_stop);
  if (!text) return fail(text.error());
  return FoundScene{{.file = file, .text = *std::move(text), .root = root}};
}

// A recorded run, open at its first frame.
struct RecordedRun {
  ReplayLogReader log;
  SolverChoice solver;
};

Result<RecordedRun> open_run(const std::string& log_file, const StopRequest& should_stop) {
  auto log = ReplayLogReader::open(log_file, should_stop);
  if (!log) return fail(log.error());
  const std::string& name = log->header().solver;
  const auto solver = solver_choice(name);
  if (!solver || !is_available(*solver)) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("recorded with the solver {}, which this build does not have",
                            shortened(printable(name), longest_name)),
                log_file, 1);
  }
  return RecordedRun{*std::move(log), *solver};
}

// The error for a scene that fails now but did not when it was recorded, with the causes.
tl::unexpected<Error> fail_because(Error error, const std::vector<std::string>& causes,
                                   const std::filesystem::path& log_file) {
  const bool is_input =
      error.code == ErrorCode::InvalidInput || error.code == ErrorCode::Unreadable;
  for (const std::string& cause : causes) {
    if (is_input) error.others.push_back({error.code, cause, log_file.string()});
  }
  return fail(std::move(error));
}

// Compares the frames of a log with those of `next`, up to `last`. The remaining frames are read
// only to check their seals.
template <class Next>
Result<void> compare_frames(ReplayLogReader& log, long last, const ReplayOptions& options,
                            ReplayVerdict& verdict, const Next& next) {
  while (true) {
    const auto a = log.next(options.simulation.should_stop);
    if (!a) return fail(a.error());
    if (!*a) return {};
    const bool is_decided = !verdict.holds() && !options.keeps_going;
    if (is_decided || (*a)->number > last) continue;
    const Result<ReplayFrame> b = next(**a);
    if (!b) return fail(b.error());
    for (ReplayDifference& difference : differences_in(log.header(), **a, *b)) {
      verdict.differences.push_back(std::move(difference));
      if (!options.keeps_going) break;
    }
    ++verdict.frame_count;
    if (options.frame_done) options.frame_done(log.header().frame_count());
  }
}

Result<void> read_on(ReplayLogReader& log, const StopRequest& should_stop) {
  while (true) {
    const auto frame = log.next(should_stop);
    if (!frame) return fail(frame.error());
    if (!*frame) return {};
  }
}

// Plays a simulation into a log, with a header that lacks frames and surfaces.
Result<ReplayHeader> record(Simulation& simulation, ReplayHeader header,
                            const std::string& log_file, const ReplayOptions& options) {
  const Scene& scene = simulation.scene();
  if (options.last_frame &&
      (*options.last_frame < scene.start || *options.last_frame > scene.end)) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("the last frame to record is {}; the scene has frames {} to {}",
                            *options.last_frame, scene.start, scene.end),
                scene.origin.file);
  }
  if (auto free = check_log_place(log_file, scene); !free) return fail(free.error());
  complete(header, simulation, options.last_frame);
  auto log = ReplayLogWriter::create(log_file, header);
  if (!log) return fail(log.error());
  if (auto done = write_frames(simulation, header, *log, options); !done) {
    return fail(done.error());
  }
  return header;
}

// Compares a log with a simulation whose header, complete, is `now`.
Result<void> compare(ReplayLogReader& log, const ReplayHeader& now, Simulation& simulation,
                     const ReplayOptions& options, ReplayVerdict& verdict) {
  verdict.mismatches = mismatches_in(log.header(), now);
  ThreadPool threads(options.simulation.threads);
  const auto compute = [&](const ReplayFrame& recorded) {
    return digest(simulation, recorded.number, threads, !recorded.states.empty());
  };
  return compare_frames(log, last_comparable_frame(log.header(), now), options, verdict, compute);
}

}  // namespace

Result<ReplayHeader> record_replay(const std::string& scene_file, const std::string& log_file,
                                   const ReplayOptions& options) {
  auto written = read_scene_text(scene_file, options.root, options.simulation.should_stop);
  if (!written) return fail(written.error());
  written->changes = options.changes;
  auto simulation = simulation_of(*written, options.simulation);
  if (!simulation) return fail(simulation.error());
  auto header = header_of(simulation->scene(), *written, log_file, options.simulation.solver,
                          options.simulation.should_stop);
  if (!header) return header;
  return record(*simulation, *std::move(header), log_file, options);
}

Result<ReplayHeader> record_replay(Simulation& simulation, const std::string& log_file,
                                   const ReplayOptions& options) {
  const Scene& scene = simulation.scene();
  const std::filesystem::path folder = std::filesystem::path(log_file).parent_path();
  auto header = header_of(scene, written_by_program(scene, folder), log_file, simulation.solver(),
                          options.simulation.should_stop);
  if (!header) return header;
  return record(simulation, *std::move(header), log_file, options);
}

Result<ReplayVerdict> verify_replay(const std::string& log_file,
                                    const std::optional<std::string>& scene_file,
                                    const ReplayOptions& options) {
  auto recorded = open_run(log_file, options.simulation.should_stop);
  if (!recorded) return fail(recorded.error());
  auto& [log, solver] = *recorded;
  const ReplayHeader& then = log.header();
  auto found = find_scene(log_file, then, scene_file, options);
  if (!found) return fail(found.error());
  found->written.changes = then.changes;
  ReplayVerdict verdict;
  if (found->remark) verdict.causes.push_back(*found->remark);

  auto now = header_of_text(found->written, log_file, solver, options.simulation.should_stop);
  if (!now) return fail(now.error());
  for (std::string& cause : causes_in(then, *now)) verdict.causes.push_back(std::move(cause));
  SimulationOptions run = options.simulation;
  run.solver = solver;
  auto simulation = simulation_of(found->written, run);
  if (!simulation) return fail_because(simulation.error(), verdict.causes, log_file);
  complete(*now, *simulation, then.end);
  if (auto compared = compare(log, *now, *simulation, options, verdict); !compared) {
    return fail(compared.error());
  }
  return verdict;
}

Result<ReplayVerdict> verify_replay(const std::string& log_file, Simulation& simulation,
                                    const ReplayOptions& options) {
  auto recorded = open_run(log_file, options.simulation.should_stop);
  if (!recorded) return fail(recorded.error());
  auto& [log, solver] = *recorded;
  const ReplayHeader& then = log.header();
  if (solver != simulation.solver()) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("recorded with the solver {}, but the simulation uses {}",
                            name_of(solver), name_of(simulation.solver())),
                log_file, 1);
  }
  const Scene& scene = simulation.scene();
  // Files are named relative to the scene, if it is in a file.
  const std::filesystem::path folder =
      (std::filesystem::path(log_file).parent_path() / then.scene_file).parent_path();
  auto made = header_of(scene, written_by_program(scene, folder), log_file, solver,
                        options.simulation.should_stop);
  if (!made) return fail(made.error());
  ReplayHeader& now = *made;
  complete(now, simulation, then.end);
  ReplayVerdict verdict;
  // The text of a scene file may say the same in other words.
  if (!then.scene_file.empty()) now.scene_text = then.scene_text;
  now.changes = then.changes;
  verdict.causes = causes_in(then, now);
  if (auto compared = compare(log, now, simulation, options, verdict); !compared) {
    return fail(compared.error());
  }
  return verdict;
}

Result<ReplayVerdict> compare_replays(const std::string& log_file,
                                      const std::string& other_log_file,
                                      const ReplayOptions& options) {
  const StopRequest& should_stop = options.simulation.should_stop;
  auto log = ReplayLogReader::open(log_file, should_stop);
  if (!log) return fail(log.error());
  auto other = ReplayLogReader::open(other_log_file, should_stop);
  if (!other) return fail(other.error());
  ReplayVerdict verdict;
  verdict.causes = causes_in(log->header(), other->header());
  verdict.mismatches = mismatches_in(log->header(), other->header());
  const long last = last_comparable_frame(log->header(), other->header());
  const auto read = [&](const ReplayFrame&) -> Result<ReplayFrame> {
    auto frame = other->next(should_stop);
    if (!frame) return fail(frame.error());
    return **std::move(frame);  // never null: `last` is a frame of both
  };
  if (auto compared = compare_frames(*log, last, options, verdict, read); !compared) {
    return fail(compared.error());
  }
  if (auto sound = read_on(*other, should_stop); !sound) return fail(sound.error());
  return verdict;
}

}  // namespace pliant
