#include "cli/commands/suggest.hpp"

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/scene_input.hpp"
#include "cli/commands/suggest_formats.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "editor/motion.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/output_place.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {
namespace {

// A number greater than 0, and the unit behind it.
std::optional<std::pair<double, std::string_view>> to_quantity(std::string_view text) {
  text = trim(text, ascii_blanks);
  const std::size_t end = text.find_last_of("0123456789.");
  if (end == std::string_view::npos) return {};
  const auto number = to_number(text.substr(0, end + 1));
  if (!number || !(*number > 0)) return {};
  return std::pair(*number, trim(text.substr(end + 1), ascii_blanks));
}

template <class Parse>
CLI::Validator accepted_by(const Parse& parse, const std::string& type, const std::string& rule) {
  return CLI::Validator(
      [=](std::string& text) -> std::string {
        return parse(text) ? "" : fmt::format("{}: must be {}", text, rule);
      },
      type);
}

// The scene's file, which will be changed.
Result<SceneDocument> open_document(const SuggestOptions& options) {
  if (auto is_file = check_scene_is_file(options.scene, "--write changes the scene"); !is_file)
    return fail(is_file.error());
  const auto folder = folder_of(options.root);
  if (!folder) return fail(folder.error());
  if (auto place = check_output_place(options.scene); !place) return fail(place.error());
  return SceneDocument::open(options.scene,
                             {.root = folder->string(), .should_stop = &was_interrupted});
}

// Writes the suggested values into the scene's file, and notes what that does beside. Returns
// whether it changes the file.
Result<bool> write(SceneDocument& document, Suggestion& suggestion) {
  const auto changed =
      document.apply(editor::operations_for(suggestion, document.scene()), "suggest");
  if (!changed) return fail(changed.error());
  for (const TextEdit& edit : changed->edits) {
    if (edit.removed.find('$') == std::string::npos) continue;
    suggestion.notes.push_back(
        fmt::format("{} takes the place of {}; what else uses the definition keeps its value",
                    printable(edit.inserted), printable(edit.removed)));
  }
  if (document.is_saved()) return false;
  if (auto saved = document.save(); !saved) return fail(saved.error());
  return true;
}

MotionGoals goals_of(const SuggestOptions& options, double fps) {
  MotionGoals goals{.surface = options.surface, .force = options.force};
  if (!options.peak.empty()) goals.peak = to_number(options.peak);
  if (!options.settle.empty()) goals.settling = to_duration(options.settle)->seconds(fps);
  if (!options.ring.empty()) goals.frequency = to_frequency(options.ring);
  return goals;
}

// Without a document nothing is written.
int suggest(const SuggestOptions& options, Scene scene, SceneDocument* document) {
  print_notes(scene.notes);
  SimulationOptions run = simulation_options(options.resources);
  Shelf shelf(part_for_shelf(run));
  run.shelf = &shelf;
  WorkLine line(options.is_quiet);
  run.progressed = line.report();
  auto simulation = Simulation::make(std::move(scene), run);
  if (!simulation) return report(simulation.error());
  const double fps = simulation->scene().fps;
  auto suggestion = suggest_material(*simulation, goals_of(options, fps), run);
  line.erase();
  if (!suggestion) return report(suggestion.error());
  SuggestFacts facts{.file = title_of_scene(options.scene),
                     .surface = simulation->scene().surfaces[suggestion->after.surface].name,
                     .force = options.force,
                     .fps = fps,
                     .suggestion = *std::move(suggestion)};
  Result<bool> written = false;
  if (document) written = write(*document, facts.suggestion);
  facts.is_written = written && *written;
  print(stdout, options.is_json ? suggest_json(facts) : suggest_text(facts));
  if (!written) return report(written.error());
  return facts.suggestion.meets_goals() ? exit_done : exit_failed;
}

}  // namespace

std::optional<Duration> to_duration(std::string_view text) {
  const auto quantity = to_quantity(text);
  if (!quantity) return {};
  const auto& [number, unit] = *quantity;
  if (unit == "s") return Duration{number, false};
  if (unit == "ms") return Duration{number / 1000, false};
  if (unit == "f" || unit == "frame" || unit == "frames") return Duration{number, true};
  return {};
}

std::optional<double> to_frequency(std::string_view text) {
  const auto quantity = to_quantity(text);
  if (!quantity) return {};
  const auto& [number, unit] = *quantity;
  return unit.empty() || unit == "Hz" || unit == "hz" ? std::optional(number) : std::nullopt;
}

void add_suggest(CLI::App& app, SuggestOptions& options) {
  CLI::App* suggest = app.add_subcommand(
      "suggest", "Find magnitude, damping and density for the motion that is wanted");
  suggest->add_option("SCENE", options.scene, "Scene file")->required();
  suggest
      ->add_option(
          "--peak", options.peak,
          "Largest displacement in the animation, in lengths of the scene: by the magnitudes")
      ->check(accepted_by(
          [](std::string_view text) {
            const auto number = to_number(text);
            return number && *number > 0;
          },
          "LENGTH", "a number greater than 0"));
  suggest
      ->add_option(
          "--settle", options.settle,
          "Time after which it stays within 5 % of where it comes to rest, such as 1s, 500ms "
          "or 24f (frames): by the damping")
      ->check(accepted_by(to_duration, "TIME", "a time greater than 0 with its unit: s, ms or f"));
  suggest
      ->add_option("--ring", options.ring,
                   "Frequency with which it rings in the animation, such as 2Hz: by the density")
      ->check(accepted_by(to_frequency, "FREQUENCY", "a frequency greater than 0, such as 2Hz"));
  suggest->add_option("--force", options.force,
                      "A force, or a group, that acts alone; all forces together by default");
  suggest->add_option("--surface", options.surface, "The surface, if forces act on several");
  suggest->add_flag("--write", options.writes, "Write the numbers into the scene");
  suggest->add_flag("--quiet", options.is_quiet, "No progress");
  suggest->add_flag("--json", options.is_json, "Print JSON instead; docs/info.md describes it");
  add_root(*suggest, options.root);
  add_memory(*suggest, options.resources);
}

int run_suggest(const SuggestOptions& options) {
  catch_interrupts();
  if (options.peak.empty() && options.settle.empty() && options.ring.empty()) {
    return report({ErrorCode::InvalidInput,
                   "no goal is given: at least one of --peak, --settle and --ring is required"});
  }
  if (!options.writes) {
    auto scene = read_scene(options.scene, options.root);
    return scene ? suggest(options, *std::move(scene), nullptr) : report(scene.error());
  }
  auto document = open_document(options);
  return document ? suggest(options, document->scene(), &*document) : report(document.error());
}

}  // namespace pliant::cli
