#include "cli/view/view.hpp"

#include <chrono>
#include <filesystem>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/inputs.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/report.hpp"
#include "cli/view/view_picture.hpp"
#include "cli/view/view_scene.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "viewer/page.hpp"

namespace pliant::cli {
namespace {

std::string page_file(const ViewOptions& options) { return options.out.value_or("view.html"); }

// Whether the scene can be served, or the result can be written to its place.
Result<void> check_places(const ViewOptions& options) {
  if (options.port) {
    return check_scene_is_file(options.scene, "--serve reads the scene again after every save");
  }
  if (options.png) return check_output_file("--png", *options.png, picture_endings);
  if (options.movie) return check_output_file("--movie", *options.movie);
  return check_output_file("-o", page_file(options), page_endings);
}

int page_view(const ViewOptions& options, std::string_view page) {
  const auto begin = std::chrono::steady_clock::now();
  const std::string out = page_file(options);
  auto scene = read_scene(options.scene, options.root, options.changes);
  if (!scene) return report(scene.error());
  if (auto free = check_no_input("-o", out, *scene); !free) return report(free.error());
  const auto baked = bake_scene(*std::move(scene), options, &was_interrupted);
  if (!baked) return report(with_kept(baked.error(), "no page was written"));
  const auto made =
      viewer::page_of(page, baked->scene, baked->bake, view_limits(options, &was_interrupted));
  const auto written = made ? write_file(out, *made, &was_interrupted) : fail(made.error());
  if (!written) return report(with_kept(written.error(), "no page was written"));
  if (options.is_quiet) return exit_done;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
  print(stdout, fmt::format("{}: {}, {}, {}, {:.2f} s, {}\n", printable(out),
                            counted(baked->frames.count(), "frame"),
                            counted(baked->bake.vertex_count, "vertex", "vertices"),
                            bytes_text(made->size()), elapsed.count(),
                            peak_text(baked->bake.peak_displacement, baked->frames, baked->scene)));
  return exit_done;
}

// A value that is not a port is most likely the scene, given after --serve.
CLI::Validator port_number() {
  return CLI::Validator(
      [](std::string& text) -> std::string {
        const auto port = to_integer(text);
        if (port && *port >= 0 && *port <= 65535) return "";
        return text + ": must be a port from 0 to 65535; write SCENE before --serve";
      },
      "PORT");
}

}  // namespace

void add_view(CLI::App& app, ViewOptions& options) {
  CLI::App* view = app.add_subcommand("view", "Make a web page that plays a scene");
  view->add_option("SCENE", options.scene, "Scene file")->required();
  auto* out = view->add_option("-o,--out", options.out,
                               "The page, one file that needs no network; view.html by default");
  view->add_option("--frames", options.frames, "Frames to show, A:B or one frame; all by default");
  auto* serve = view->add_option("--serve", options.port,
                                 "Serve the page on this machine, and bake again on every save; "
                                 "any free port by default")
                    ->expected(0, 1)
                    ->default_str("0")
                    ->check(port_number())
                    ->excludes(out);
  auto* png = view->add_option("--png", options.png, "Write a picture instead of the page")
                  ->excludes(out)
                  ->excludes(serve);
  auto* movie =
      view->add_option("--movie", options.movie,
                       "Write a movie instead of the page: .mp4, .gif or .webm; needs ffmpeg")
          ->excludes(out)
          ->excludes(serve)
          ->excludes(png);
  auto* frame =
      view->add_option("--frame", options.frame, "Frame of the picture; the first by default")
          ->needs(png);
  view->add_flag("--contact-sheet", options.is_sheet, "Twelve frames in one picture")
      ->needs(png)
      ->excludes(frame);
  auto* size =
      view->add_option("--size", options.size,
                       "Size in pixels of the picture, of each frame in a sheet (480x300 by "
                       "default), or of the movie")
          ->capture_default_str();
  auto* look = view->add_option("--look", options.look,
                                "Look of the picture or movie, written as in the page's address: "
                                "\"turn=30&tilt=20&colour=velocity&theme=dark\"");
  view->callback([=, &options] {
    // Words have the same size in all pictures, and twelve of them are seen at once.
    if (options.is_sheet && size->count() == 0) options.size = "480x300";
    const CLI::Option* given = size->count() > 0 ? size : look;
    if (given->count() > 0 && png->count() == 0 && movie->count() == 0) {
      throw CLI::RequiresError(given->get_name(), "--png or --movie");
    }
  });
  add_root(*view, options.root);
  add_changes(*view, options.changes);
  add_threads(*view, options.resources);
  add_memory(*view, options.resources);
  view->add_flag("--quiet", options.is_quiet, "No progress and no summary");
}

int run_view(const ViewOptions& options) {
  catch_interrupts();
  if (auto places = check_places(options); !places) return report(places.error());
  const auto page = viewer::page_template();
  if (!page) return report(page.error());
  if (options.port) return serve_view(options, *page);
  if (options.png) return picture_view(options, *page);
  if (options.movie) return movie_view(options, *page);
  return page_view(options, *page);
}

}  // namespace pliant::cli
