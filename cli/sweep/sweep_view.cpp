#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "cli/commands/inputs.hpp"
#include "cli/commands/look.hpp"
#include "cli/sweep/sweep.hpp"
#include "cli/sweep/sweep_memory.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/progress.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/shell_word.hpp"
#include "cli/view/view_picture.hpp"
#include "pliant/files/atomic_file.hpp"
#include "viewer/page.hpp"
#include "viewer/sweep_bake.hpp"
#include "viewer/sweep_page.hpp"

namespace pliant::cli {
namespace {

namespace fs = std::filesystem;

// Whether a file may be written, ahead of all work: it is no part of the sweep and no input of it.
Result<void> check_view_output(std::string_view option, const std::string& file,
                               const SweepFolder& folder) {
  if (auto no_part = check_no_part(option, file, folder); !no_part) return no_part;
  return folder.sweep().for_each_variant(
      [&](const Scene& scene) { return check_no_input(option, file, scene); }, &was_interrupted);
}

Result<void> check_view_places(const SweepViewOptions& options) {
  if (!options.out && !options.png)
    return fail(ErrorCode::InvalidInput, "-o F.html or --png F is missing: what to write");
  if (options.out && options.png && name_one_file(*options.out, *options.png))
    return refuse_output("--png", *options.png, "it is that of -o");
  if (options.out) {
    if (auto place = check_output_file("-o", *options.out, page_endings); !place) return place;
  }
  if (options.png) {
    if (auto place = check_output_file("--png", *options.png, picture_endings); !place)
      return place;
    return check_look(options.look);
  }
  return {};
}

// A picture of all takes in rows, each with its number and values below it, the colours' scale at
// the bottom.
struct SheetPicture {
  viewer::PictureSize tile;
  int columns = 1;
  int text = 0;   // size of the letters [px]
  int line = 0;   // height of a line of text [px]
  int label = 0;  // height of the text below each take [px]
  int strip = 0;  // height of the colours' scale [px]
  viewer::PictureSize whole = {};
};

Result<SheetPicture> sheet_picture(const SweepViewOptions& options, const SweepFolder& folder,
                                   std::size_t takes) {
  const auto tile = parse_size(options.size);
  if (!tile) return fail(tile.error());
  if (takes == 0)
    return fail(ErrorCode::Unwritable, fmt::format("{}: no take is done that a picture could show",
                                                   printable(folder.folder())));
  constexpr std::size_t most_lines = 3;
  const std::size_t varied =
      folder.sweep().takes().paths().size() + (folder.request().scenes.size() > 1 ? 1 : 0);
  SheetPicture picture{.tile = *tile};
  const int count = static_cast<int>(takes);
  // As wide as high, or a little wider.
  const double shape = static_cast<double>(tile->height) / tile->width;
  picture.columns =
      std::clamp(static_cast<int>(std::ceil(std::sqrt(1.3 * count * shape))), 1, count);
  picture.text = std::clamp((tile->width + 12) / 25, 11, 48);
  picture.line = (13 * picture.text + 5) / 10;
  picture.label = 2 * picture.text + picture.line * static_cast<int>(std::min(varied, most_lines));
  picture.strip = 6 * picture.text;
  const int rows = (count + picture.columns - 1) / picture.columns;
  // The scale of the colours is 15 letters wide, and has margins.
  picture.whole = {std::max(picture.columns * tile->width, 18 * picture.text),
                   rows * (tile->height + picture.label) + picture.strip};
  if (std::max(picture.whole.width, picture.whole.height) <= longest_side) return picture;
  return fail(ErrorCode::InvalidInput,
              fmt::format("--size {}: {} make a picture of {}x{}, and the most is {}x{}",
                          options.size, counted(count, "take"), picture.whole.width,
                          picture.whole.height, longest_side, longest_side));
}

Result<std::string> take_sheet(PictureTaker& taker, const SheetPicture& picture,
                               const std::string& look, std::string packed) {
  taker.publish(std::move(packed));
  auto ordered = taker.order({{"width", picture.tile.width},
                              {"height", picture.tile.height},
                              {"columns", picture.columns},
                              {"whole", {picture.whole.width, picture.whole.height}},
                              {"text", picture.text},
                              {"line", picture.line},
                              {"label", picture.label},
                              {"look", look}},
                             picture.whole);
  if (!ordered) return fail(ordered.error());
  return taker.take();
}

Result<AtomicFile> written_file(const std::string& name, std::string_view content) {
  auto file = AtomicFile::create(name);
  if (!file) return file;
  if (auto written = file->write(content, &was_interrupted); !written) return fail(written.error());
  return file;
}

// Both files appear at the end, or none of them.
Result<void> write_view(const SweepViewOptions& options, const std::optional<std::string>& made,
                        const std::optional<std::string>& picture) {
  std::vector<AtomicFile> files;
  const auto add = [&](const std::optional<std::string>& name,
                       const std::optional<std::string>& content) -> Result<void> {
    if (!name || !content) return {};
    auto file = written_file(*name, *content);
    if (!file) return fail(file.error());
    files.push_back(*std::move(file));
    return {};
  };
  if (auto added = add(options.out, made); !added) return added;
  if (auto added = add(options.png, picture); !added) return added;
  if (was_interrupted()) return interrupted();
  for (AtomicFile& file : files) {
    if (auto committed = file.commit(); !committed) return committed;
  }
  return {};
}

// What bakes a take, without its number.
std::string bake_command(const std::string& folder) {
  // A name that begins with - would be an option.
  const std::string name = (folder.starts_with('-') ? "./" : "") + folder;
  const std::string words[] = {"pliant", "sweep", "bake", name};
  return shell_line(words);
}

}  // namespace

Result<void> check_no_part(std::string_view option, const std::string& file,
                           const SweepFolder& folder) {
  const fs::path root(folder.folder());
  for (const char* part : {"sweep.json", "takes.csv"}) {
    if (name_one_file(file, root / part)) return refuse_output(option, file, "it is the sweep's");
  }
  const fs::path parent = fs::path(file).parent_path();
  for (const char* part : {"log", "takes", "slurm"}) {
    const bool is_there =
        parent.empty() ? name_one_file(".", root / part) : name_one_file(parent, root / part);
    if (is_there) return refuse_output(option, file, "its folder is the sweep's");
  }
  return {};
}

void add_sweep_view(CLI::App& sweep, SweepViewOptions& options) {
  CLI::App* view = sweep.add_subcommand(
      "view", "Make a web page of a sweep: pictures of takes, plots of measures, the table");
  view->add_option("DIR", options.folder, "Folder of a sweep")->required();
  view->add_option("-o,--out", options.out, "The page, one file that needs no network");
  auto* png = view->add_option("--png", options.png,
                               "Also, or only, a picture of takes side by side; needs Chromium");
  view->add_option("--frame", options.frame,
                   "Frame of all pictures; by default that of each take's peak");
  view->add_option("--size", options.size, "Size in pixels of each take in the picture")
      ->capture_default_str()
      ->needs(png);
  view->add_option("--look", options.look,
                   "Look of the picture, written as in the page's address: "
                   "\"turn=30&tilt=20&peak=2&theme=dark\"")
      ->needs(png);
  add_root(*view, options.root);
  add_threads(*view, options.resources);
  add_memory(*view, options.resources);
  view->add_flag("--quiet", options.is_quiet, "No progress and no summary");
}

int run_sweep_view(const SweepViewOptions& options) {
  catch_interrupts();
  const auto begin = std::chrono::steady_clock::now();
  if (auto places = check_view_places(options); !places) return report(places.error());
  const auto page = viewer::sweep_page_template();
  if (!page) return report(page.error());
  const auto folder = open_sweep(options.folder, options.root);
  if (!folder) return report(folder.error());
  for (const auto& [option, file] :
       {std::pair("-o", options.out), std::pair("--png", options.png)}) {
    if (!file) continue;
    if (auto place = check_view_output(option, *file, *folder); !place)
      return report(place.error());
  }
  const auto status = folder->status(&was_interrupted);
  if (!status) return report(status.error());
  const auto plan = viewer::plan_sweep_view(*folder, *status, options.frame);
  if (!plan) return report(plan.error());
  std::optional<SheetPicture> picture;
  std::optional<PictureTaker> taker;
  if (options.png) {
    const auto sheet = sheet_picture(options, *folder, plan->takes.size());
    if (!sheet) return report(sheet.error());
    picture = *sheet;
    if (auto browser = check_browser("--png"); !browser) return report(browser.error());
    auto started = PictureTaker::start(*page);
    if (!started) return report(started.error());
    taker.emplace(*std::move(started));
  }

  const SimulationOptions resources =
      simulation_options(options.resources, memory_of_records(folder->sweep()));
  std::optional<Progress> progress;
  if (!plan->takes.empty())
    progress.emplace(static_cast<int>(plan->takes.size()), options.is_quiet, "takes");
  auto bake = viewer::bake_sweep(*folder, *status, *plan,
                                 {.threads = resources.threads,
                                  .max_memory = resources.max_memory,
                                  .should_stop = resources.should_stop,
                                  .command = bake_command(folder->folder()),
                                  .take_done = [&] { progress->advance(); }});
  progress.reset();
  if (!bake) return report(with_kept(bake.error(), "nothing was written"));
  print_conflicts(*status);
  for (const auto& [take, reason] : bake->failed)
    print(stderr, fmt::format("{}: {}\n", title_of(folder->sweep(), folder->request().scenes, take),
                              printable(reason)));

  std::optional<std::string> made, drawn;
  if (options.out) {
    auto whole = viewer::page_with(*page, viewer::name_of_folder(options.folder), bake->packed,
                                   &was_interrupted);
    if (!whole) return report(with_kept(whole.error(), "nothing was written"));
    made = *std::move(whole);
  }
  if (picture && bake->pictured == 0)
    print(stderr,
          fmt::format("{}: not written, since no take has a picture\n", printable(*options.png)));
  if (picture && bake->pictured > 0) {
    auto taken = take_sheet(*taker, *picture, options.look, std::move(bake->packed));
    if (!taken) return report(with_kept(taken.error(), "nothing was written"));
    drawn = *std::move(taken);
  }
  if (auto written = write_view(options, made, drawn); !written)
    return report(with_kept(written.error(), "nothing was written"));
  if (!options.is_quiet) {
    const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - begin;
    const auto summary = [&](const std::string& file, std::size_t size) {
      print(stdout,
            fmt::format("{}: {} of {} shown, {}, {:.2f} s\n", printable(file), bake->pictured,
                        counted(static_cast<std::int64_t>(status->takes.size()), "take"),
                        bytes_text(size), elapsed.count()));
    };
    if (made) summary(*options.out, made->size());
    if (drawn) summary(*options.png, drawn->size());
  }
  return bake->failed.empty() && status->conflicts.empty() ? exit_done : exit_failed;
}

}  // namespace pliant::cli
