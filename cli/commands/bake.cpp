#include "cli/commands/bake.hpp"

#include <chrono>
#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>
#ifdef __GLIBC__
#include <malloc.h>
#endif

#include "cli/commands/dt_check.hpp"
#include "cli/commands/frame_range.hpp"
#include "cli/commands/inputs.hpp"
#include "cli/commands/regions_file.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/commands/solver_option.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/rounded.hpp"
#include "cli/terminal/usage.hpp"
#include "pliant/core/text.hpp"
#include "pliant/pliant.hpp"
#include "pliant/simulation/animation_bake.hpp"

namespace pliant::cli {
namespace {

bool is_world(const BakeOptions& options) { return options.space == "world"; }

// The surfaces to write, by their index in the scene.
Result<std::vector<std::size_t>> chosen_surfaces(const Simulation& simulation,
                                                 const BakeOptions& options) {
  std::vector<std::size_t> chosen;
  std::vector<std::string> names;
  for (std::size_t k = 0; k < simulation.rest_shapes().size(); ++k) {
    names.push_back(simulation.rest_shapes()[k].name);
    if (!options.surface || *options.surface == names.back()) chosen.push_back(k);
  }
  if (!chosen.empty()) return chosen;
  return fail(ErrorCode::InvalidInput,
              fmt::format("--surface {}: the scene has no such surface; it has {}",
                          *options.surface, fmt::join(names, ", ")));
}

// Warns of surfaces so far from the origin that the format tears them.
void warn_of_precision(const Scene& scene, const AnimationBake& bake) {
  const AnimationPlan& plan = bake.plan();
  for (const PrecisionLoss& loss : precision_losses(plan)) {
    const std::string& name = plan.surfaces[loss.surface].name;
    const Surface& surface = scene.surfaces[bake.surfaces()[loss.surface]];
    const Vector3d there = plan.is_placed
                               ? Vector3d(0, 0, 0)
                               : surface.transform.placement_at(plan.first_frame).translate;
    print_warning(scene.origin.place_of(name),
                  precision_text(fmt::format("\"{}\"", name), ending_of(plan.file), loss, there) +
                      (plan.is_placed ? "; with --space world" : ""));
  }
}

// Checks that the file for the regions is not one that the bake reads or writes.
Result<void> check_regions_file(const BakeOptions& options, const Scene& scene,
                                const AnimationPlan& plan) {
  if (!options.regions) return {};
  const std::filesystem::path regions = *options.regions;
  if (auto place = check_output_file("--regions", *options.regions); !place) return place;
  const auto refuse = [&](std::string_view reason) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("--regions {}: {}", printable(regions.string()), reason));
  };
  if (const auto input = input_named(regions, scene); !input.empty()) return refuse(input);
  if (is_named_at_the_end(plan, regions.filename().string()))
    return refuse("it has the name of a file that -o may write");
  for (const std::filesystem::path file : files_of(plan)) {
    // Compares names first: querying the disk for each of a million frames would be slow.
    if (file.filename() == regions.filename() && name_one_file(regions, file)) {
      return refuse("it is a file that -o writes");
    }
  }
  return {};
}

// `-o FILE: REASON`.
Result<void> of_out(const Result<void>& checked) {
  if (checked) return {};
  Error error = checked.error();
  error.message = "-o " + error.message;
  return fail(std::move(error));
}

Result<AnimationBake> open_output(const Simulation& simulation, const BakeOptions& options,
                                  const FrameSpan& frames, std::size_t max_memory) {
  const auto chosen = chosen_surfaces(simulation, options);
  if (!chosen) return fail(chosen.error());
  auto bake = AnimationBake::make(simulation, {.file = options.out,
                                               .frames = frames,
                                               .surfaces = *chosen,
                                               .is_world = is_world(options),
                                               .omits_colliders = options.omits_colliders,
                                               .resume = options.resume,
                                               .max_memory = max_memory,
                                               .should_stop = &was_interrupted});
  if (!bake) return fail(bake.error());
  const Scene& scene = simulation.scene();
  if (auto checked = of_out(bake->check_inputs()); !checked) return fail(checked.error());
  if (auto free = check_regions_file(options, scene, bake->plan()); !free)
    return fail(free.error());
  if (auto begun = bake->begin(); !begun) return fail(begun.error());
  warn_of_precision(scene, *bake);
  return bake;
}

// ", 15 files kept, 25 written" for a resumed bake.
std::string resume_summary(const FileCounts& files) {
  return fmt::format(", {} kept, {} written", counted(files.kept, "file"), files.written);
}

Result<void> write_regions(Simulation& simulation, int frame, RegionsFile& regions) {
  const auto report = simulation.report(frame);
  if (!report) return fail(report.error());
  return regions.write(*report, simulation);
}

Result<void> write_frames(Simulation& simulation, const BakeOptions& options,
                          const FrameSpan& frames, AnimationBake& output,
                          std::optional<RegionsFile>& regions, std::optional<DtCheck>& check,
                          const BakeSource& source) {
  std::optional<Measurer> measurer;
  if (source.hash) measurer.emplace(simulation);
  Progress progress(frames.last - simulation.scene().start + 1, options.is_quiet);
  Frame frame;
  const auto bake_frame = [&](int number) -> Result<void> {
    if (was_interrupted()) return interrupted();
    auto reached = simulation.at(number, std::move(frame));
    if (!reached) return fail(reached.error());
    frame = *std::move(reached);
    if (check) {
      if (auto advanced = check->advance(frame); !advanced) return advanced;
    }
    if (number < frames.first) return {};
    if (check) check->compare(frame, output.surfaces());
    if (measurer) measurer->add(frame);
    if (auto written = output.write(frame); !written) return written;
    return regions ? write_regions(simulation, number, *regions) : Result<void>();
  };
  // Always from the scene's start, whichever frames are written.
  for (int number = simulation.scene().start; number <= frames.last; ++number) {
    if (auto baked = bake_frame(number); !baked) return fail(with_frame(baked.error(), number));
    progress.advance();
  }
  if (measurer) {
    const auto measures = measurer->measures();
    if (!measures) return fail(measures.error());
    if (measures->hash != *source.hash)
      return fail(ErrorCode::SolverFailed, source.title + ": hash differs");
  }
  if (auto finished = output.finish(); !finished) return finished;
  return regions ? regions->finish(simulation.solver_counts()) : Result<void>();
}

// Describes the files that an interrupted run leaves for the next one.
std::string kept_text(const BakeOptions& options) {
  const std::string ending = ending_of(options.out);
  const bool is_sequence = ending == ".obj" || ending == ".ply";
  const std::string files =
      is_sequence ? "the files written so far are kept, and --resume continues with them"
                  : "no file was written";
  return files + (options.cache.folder
                      ? "; the solved frames are in the --cache folder, and the next run reads them"
                      : "; --cache DIR would keep the solved frames for the next run");
}

// Prints the time of each stage, and the rest: reading the scene, finding grids, progress, files
// other than the animation.
void print_profile(const Profile& profile, double elapsed) {
  const auto row = [&](std::string_view stage, double seconds) {
    print(stderr, fmt::format("{:<12} {:>10.3f} {:>8.1f}\n", stage, seconds,
                              elapsed > 0 ? 100 * seconds / elapsed : 0));
  };
  print(stderr, fmt::format("{:<12} {:>10} {:>8}\n", "stage", "seconds", "share, %"));
  for (std::size_t k = 0; k < stage_count; ++k) {
    row(name_of(static_cast<Stage>(k)), profile.seconds[k]);
  }
  // Below 0 if surfaces were solved in parallel.
  row("the rest", elapsed - profile.total());
  row("run", elapsed);
}

// Frames take and give back the same memory. What is free stays for the next one; it would go to
// the system and come back page by page.
void keep_free_memory() {
#ifdef __GLIBC__
  mallopt(M_MMAP_THRESHOLD, 1 << 25);  // the most there is
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
#endif
}

}  // namespace

void add_bake_options(CLI::App& command, BakeOptions& options) {
  command
      .add_option("-o,--out", options.out,
                  fmt::format("Output file; its ending selects the format: {}; a run of # in it "
                              "is the frame",
                              fmt::join(known_endings(), ", ")))
      ->required();
  command.add_option("--frames", options.frames,
                     "Frames to write, A:B or one frame; all by default");
  command.add_option("--surface", options.surface, "Write this surface only");
  command.add_option("--space", options.space, "Space of the positions")
      ->check(one_of({"world", "object"}))
      ->capture_default_str();
  command.add_flag("--no-colliders", options.omits_colliders,
                   "Leave colliders out of .glb, .gltf and .usda");
  command.add_flag(
      "--resume", options.resume,
      "Keep the files of an .obj or .ply sequence that are already identical to the result");
  add_cache(command, options.cache);
  add_threads(command, options.resources);
  add_memory(command, options.resources);
  command.add_option("--regions", options.regions,
                     "Write the regions that each frame solves, and their forces, to this JSON "
                     "file");
  command.add_flag(
      "--check-dt", options.checks_dt,
      "Simulate again with half the time step, and print the largest difference over the "
      "peak displacement");
  command.add_flag("--profile", options.is_profiled,
                   "Print a table on stderr at the end: the time spent in each stage of the run");
  command.add_flag("--quiet", options.is_quiet, "No progress and no summary");
}

void add_bake(CLI::App& app, BakeOptions& options) {
  CLI::App* bake = app.add_subcommand("bake", "Simulate a scene and write the animation");
  bake->add_option("SCENE", options.scene, "Scene file")->required();
  add_bake_options(*bake, options);
  add_solver(*bake, options.solver);
  add_root(*bake, options.root);
  add_changes(*bake, options.changes);
}

int run_bake(const BakeOptions& options) {
  return run_bake(
      options, {.read = [&] { return read_scene(options.scene, options.root, options.changes); }});
}

int run_bake(const BakeOptions& options, const BakeSource& source) {
  keep_free_memory();
  const auto begin = std::chrono::steady_clock::now();
  catch_interrupts();

  const auto solver = parse_solver(options.solver);
  if (!solver) return report(solver.error());
  if (auto known = check_ending(options.out); !known) return report(known.error());
  if (auto there = check_output_folder("-o", options.out); !there) return report(there.error());
  if (options.regions) {
    auto place = check_output_file("--regions", *options.regions);
    if (!place) return report(place.error());
  }
  auto scene = source.read();
  if (!scene) return report(scene.error());
  const auto frames = parse_frames(options.frames, *scene);
  if (!frames) return report(frames.error());

  const auto store = open_cache(options.cache);
  if (!store) return report(store.error());
  SimulationOptions run = simulation_options(options.resources);
  run.solver = *solver;
  run.profile = options.is_profiled;
  run.store = store->get();
  run.round_done = round_line(options.is_quiet);
  if (options.checks_dt) run.max_memory /= 2;  // for each of the two runs
  auto simulation = Simulation::make(*std::move(scene), run);
  if (!simulation) return report(with_kept(simulation.error(), "no file was written"));
  auto output = open_output(*simulation, options, *frames, run.max_memory);
  if (!output) return report(with_kept(output.error(), "no file was written"));

  std::optional<DtCheck> check;
  if (options.checks_dt) {
    auto made = DtCheck::make(simulation->scene(), run);
    if (!made) return report(with_kept(made.error(), "no file was written"));
    check.emplace(*std::move(made));
  }
  std::optional<RegionsFile> regions;
  if (options.regions) {
    auto created = RegionsFile::create(*options.regions, simulation->scene());
    if (!created) return report(created.error());
    regions.emplace(*std::move(created));
  }

  const auto written = write_frames(*simulation, options, *frames, *output, regions, check, source);
  print_warnings(*simulation);
  print_cache_notes(store->get(), options.cache);
  if (!written) return report(with_kept(written.error(), kept_text(options)));

  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  if (!options.is_quiet) {
    print(stdout,
          fmt::format("{}: {}, {}, {:.2f} s, {}{}{}\n", printable(options.out),
                      counted(output->frame_count(), "frame"),
                      counted(output->vertex_count(), "vertex", "vertices"), elapsed.count(),
                      peak_text(output->peak_displacement(), *frames, simulation->scene()),
                      options.resume ? resume_summary(output->file_counts()) : "",
                      *store ? cache_summary(simulation->frame_counts()) : ""));
  }
  if (check) {
    print(stdout, fmt::format("{}: {}\n", printable(options.out),
                              check->to_text(output->peak_displacement())));
  }
  if (options.is_profiled) {
    Profile profile = simulation->profile();
    profile.add(output->profile());
    print_profile(profile, elapsed.count());
  }
  return exit_done;
}

}  // namespace pliant::cli
