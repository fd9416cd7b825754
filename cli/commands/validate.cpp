#include "cli/commands/validate.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/json.hpp"
#include "cli/terminal/report.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {
namespace {

// The results for all scenes, for `--json`.
struct Findings {
  Json scenes = Json::array();
  Json problems = Json::array();
};

std::string_view kind_of(ErrorCode code) {
  switch (code) {
    case ErrorCode::InvalidInput:
      return "invalid";
    case ErrorCode::Unreadable:
      return "unreadable";
    case ErrorCode::OutOfMemory:
      return "memory";
    case ErrorCode::Interrupted:
      return "interrupted";
    case ErrorCode::Unwritable:
    case ErrorCode::SolverFailed:
    case ErrorCode::NotFinite:
      break;
  }
  return "failed";
}

void add_problem(Findings& findings, const std::string& file, const TextSpan& span,
                 std::string_view kind, const std::string& message) {
  const auto known = [](int number) { return number > 0 ? Json(number) : Json(nullptr); };
  findings.problems.push_back({{"file", file},
                               {"line", known(span.line)},
                               {"column", known(span.column)},
                               {"endLine", known(span.end_line)},
                               {"endColumn", known(span.end_column)},
                               {"kind", kind},
                               {"severity", kind == "note"      ? "information"
                                            : kind == "warning" ? "warning"
                                                                : "error"},
                               {"message", message}});
}

// Reports an error of a scene on stderr, or adds it to the findings. Returns the exit code.
int tell(const Error& error, const std::string& file, Findings* findings) {
  if (!findings) return report(error);
  std::vector<Error> all = error.others;
  all.insert(all.begin(), error);
  for (const Error& one : all) {
    add_problem(*findings, one.file.empty() ? file : one.file, one.span(), kind_of(one.code),
                one.message);
  }
  return exit_code(error);
}

// `findings`: receives the results instead of the streams; null: prints them.
int validate(const std::string& file, const ValidateOptions& options, Findings* findings) {
  auto scene = read_scene(file, options.root);
  if (!scene) return tell(scene.error(), file, findings);
  auto checked = Simulation::check(*scene, simulation_options(options.resources));
  if (checked) scene->notes.insert(scene->notes.end(), checked->begin(), checked->end());
  if (!findings) print_notes(scene->notes);
  if (findings) {
    for (const SceneNote& note : scene->notes) {
      add_problem(*findings, note.file, note, "note", note.message);
    }
  }
  if (!checked) return tell(checked.error(), file, findings);
  std::vector<Warning> warnings = warnings_about(*scene);
  add_still_surfaces(warnings, *scene);
  if (!findings) print_warnings(warnings, scene->origin);
  if (findings) {
    for (const Warning& warning : warnings) {
      const ScenePlace place = place_of(warning, scene->origin);
      add_problem(*findings, place.file, place, "warning", place.told(warning.message()));
    }
  }
  if (!options.is_quiet && !findings) {
    print(stdout, fmt::format("{}: valid: {}, {}, frames {} to {}\n", printable(scene->origin.file),
                              counted(scene->surfaces.size(), "surface"),
                              counted(scene->forces.size(), "force"), scene->start, scene->end));
  }
  return exit_done;
}

}  // namespace

void add_validate(CLI::App& app, ValidateOptions& options) {
  CLI::App* validate = app.add_subcommand("validate", "Read and check scenes without running them");
  validate->add_option("SCENE", options.scenes, "Scene files")->required();
  validate->add_flag("--quiet", options.is_quiet, "Print nothing for valid scenes");
  add_root(*validate, options.root);
  validate->add_flag("--json", options.is_json,
                     "Print all problems as JSON; docs/info.md describes it");
  add_memory(*validate, options.resources);
}

int run_validate(const ValidateOptions& options) {
  catch_interrupts();
  int worst = exit_done;
  Findings findings;
  for (const std::string& file : options.scenes) {
    const int code = validate(file, options, options.is_json ? &findings : nullptr);
    worst = std::max(worst, code);
    if (was_interrupted()) {
      return code == exit_failed ? code : report({ErrorCode::Interrupted, "interrupted"});
    }
    findings.scenes.push_back({{"file", title_of_scene(file)}, {"valid", code == exit_done}});
  }
  if (options.is_json) {
    const Json json = {{"format", "pliant-validate-1"},
                       {"scenes", std::move(findings.scenes)},
                       {"problems", std::move(findings.problems)}};
    print(stdout, json.dump(2, ' ', true, Json::error_handler_t::replace) + '\n');
  }
  return worst;
}

}  // namespace pliant::cli
