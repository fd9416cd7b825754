#include "suggest.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>
#include <utility>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "interrupt.hpp"
#include "pliant/core/read_file.hpp"
#include "pliant/core/text.hpp"
#include "pliant/output/atomic_file.hpp"
#include "pliant/output/output_place.hpp"
#include "pliant/pliant.hpp"
#include "report.hpp"
#include "scene_input.hpp"
#include "suggest_formats.hpp"

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

// The text of the scene as it is in its file.
struct SceneText {
  std::string text;
  Scene scene;
};

Result<SceneText> read_text(const SuggestOptions& options) {
  if (auto is_file = check_scene_is_file(options.scene, "--write changes the scene"); !is_file)
    return fail(is_file.error());
  const auto folder = folder_of(options.root);
  if (!folder) return fail(folder.error());
  if (auto place = check_output_place(options.scene); !place) return fail(place.error());
  auto text = read_file(options.scene);
  if (!text) return fail(text.error());
  auto scene = parse_scene(*text, options.scene,
                           std::filesystem::path(options.scene).parent_path().string(), *folder);
  if (!scene) return fail(scene.error());
  return SceneText{*std::move(text), *std::move(scene)};
}

// Writes the suggested values into the scene's file. Returns whether that changes it.
Result<bool> write(const SuggestOptions& options, const std::string& text,
                   const Suggestion& suggestion) {
  std::vector<std::string> paths;
  for (const SuggestedValue& value : suggestion.values) paths.push_back(value.path);
  const auto folder = folder_of(options.root);
  if (!folder) return fail(folder.error());
  auto changed = changed_text(text, suggestion.scene, paths, options.scene,
                              std::filesystem::path(options.scene).parent_path().string(), *folder);
  if (!changed) return fail(changed.error());
  if (*changed == text) return false;
  const auto present = read_file(options.scene);
  if (!present) return fail(present.error());
  if (*present != text) {
    return fail(ErrorCode::Unwritable,
                "the file was changed meanwhile by another program; nothing is written",
                options.scene);
  }
  auto file = AtomicFile::create(options.scene);
  if (!file) return fail(file.error());
  if (auto kept = file->keep_permissions(); !kept) return fail(kept.error());
  if (auto written = file->write(*changed); !written) return fail(written.error());
  if (auto committed = file->commit(); !committed) return fail(committed.error());
  return true;
}

MotionGoals goals_of(const SuggestOptions& options, double fps) {
  MotionGoals goals{.surface = options.surface, .force = options.force};
  if (!options.peak.empty()) goals.peak = to_number(options.peak);
  if (!options.settle.empty()) goals.settling = to_duration(options.settle)->seconds(fps);
  if (!options.ring.empty()) goals.frequency = to_frequency(options.ring);
  return goals;
}

int suggest(const SuggestOptions& options, Scene scene, const std::string& text) {
  print_notes(scene);
  const std::size_t note_count = scene.notes.size();
  const SimulationOptions run = simulation_options(options.resources);
  auto simulation = Simulation::make(std::move(scene), run);
  if (!simulation) return report(simulation.error());
  print_notes(simulation->scene(), note_count);
  const double fps = simulation->scene().fps;
  auto suggestion = suggest_material(*simulation, goals_of(options, fps), run);
  if (!suggestion) return report(suggestion.error());
  SuggestFacts facts{.file = options.scene,
                     .surface = simulation->scene().surfaces[suggestion->after.surface].name,
                     .force = options.force,
                     .fps = fps,
                     .suggestion = *std::move(suggestion)};
  if (options.writes) {
    const auto written = write(options, text, facts.suggestion);
    if (!written) return report(written.error());
    facts.is_written = *written;
  }
  print(stdout, options.is_json ? suggest_json(facts) : suggest_text(facts));
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
    return scene ? suggest(options, *std::move(scene), "") : report(scene.error());
  }
  auto read = read_text(options);
  return read ? suggest(options, std::move(read->scene), read->text) : report(read.error());
}

}  // namespace pliant::cli
