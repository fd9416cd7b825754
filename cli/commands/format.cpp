#include "cli/commands/format.hpp"

#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/inputs.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/resources.hpp"
#include "pliant/document/document.hpp"
#include "pliant/document/format_scene.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/scene/read.hpp"

namespace pliant::cli {
namespace {

Result<void> check_out(const FormatOptions& options, const Scene& scene) {
  const std::string input = input_named(options.out, scene);
  if (input.empty()) return {};
  const bool is_scene = name_one_file(options.out, options.scene);
  return fail(ErrorCode::InvalidInput,
              fmt::format("-o {}: {}; {}", printable(options.out), input,
                          is_scene ? "--in-place replaces it" : "choose another name"));
}

}  // namespace

void add_format(CLI::App& app, FormatOptions& options) {
  CLI::App* format =
      app.add_subcommand("format", "Write a scene in its canonical layout, comments kept");
  format->add_option("SCENE", options.scene, "Scene file")->required();
  CLI::Option* const out =
      format->add_option("-o,--out", options.out, "Output file; the standard output by default")
          ->check(file_name());
  format->add_flag("--in-place", options.is_in_place, "Replace the scene file")->excludes(out);
  add_root(*format, options.root);
}

int run_format(const FormatOptions& options) {
  catch_interrupts();
  if (options.is_in_place) {
    if (auto file = check_scene_is_file(options.scene, "--in-place replaces the file"); !file)
      return report(file.error());
  }
  const std::string& target = options.is_in_place ? options.scene : options.out;
  const char* const name = options.is_in_place ? "SCENE" : "-o";
  if (!target.empty()) {
    if (auto place = check_output_file(name, target); !place) return report(place.error());
  }
  const auto source = read_scene_text(options.scene);
  if (!source) return report(source.error());
  const auto scene = parse_source(*source, options.root);
  if (!scene) return report(scene.error());
  if (!options.is_in_place && !target.empty()) {
    if (auto free = check_out(options, *scene); !free) return report(free.error());
    auto place =
        check_scene_place(source->text, source->name, source->folder, target, &was_interrupted);
    if (!place) return report(place.error());
  }
  const auto text = format_scene(source->text, source->name, &was_interrupted);
  if (!text) return report(text.error());
  if (text->size() > source->text.size()) {
    // A longer text may be too large once it is expanded.
    const auto again = parse_source({*text, source->name, source->folder}, options.root);
    if (!again) return report(again.error());
  }
  if (target.empty()) {
    print_bytes(stdout, *text);
    return exit_done;
  }
  if (options.is_in_place && *text == source->text) return exit_done;
  auto written =
      options.is_in_place ? rewrite_file(target, source->text, *text) : write_file(target, *text);
  if (!written) return report(with_kept(written.error(), "nothing was written"));
  return exit_done;
}

}  // namespace pliant::cli
