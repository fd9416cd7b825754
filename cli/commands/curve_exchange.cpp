#include "cli/commands/curve_exchange.hpp"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string_view>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands/inputs.hpp"
#include "cli/commands/scene_input.hpp"
#include "cli/terminal/interrupt.hpp"
#include "cli/terminal/output_file.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/resources.hpp"
#include "cli/terminal/usage.hpp"
#include "pliant/core/text.hpp"
#include "pliant/exchange/scene_curves.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/pliant.hpp"

namespace pliant::cli {
namespace {

tl::unexpected<Error> bad_usage(std::string message) {
  return fail(ErrorCode::InvalidInput, std::move(message));
}

// Prints a line for each loss. Errors: with --strict, if one changes values: the first of them.
Result<void> tell_losses(const std::vector<CurveLoss>& losses, const std::string& file,
                         bool is_strict) {
  std::vector<Error> errors;
  for (const CurveLoss& loss : losses) {
    if (was_interrupted()) return interrupted();
    const std::string message = fmt::format("{}: {}", loss.curve, loss.message);
    if (is_strict && !loss.is_exact)
      errors.push_back(
          {ErrorCode::InvalidInput, message + ", which --strict does not allow", file});
    else
      print(stderr, fmt::format("{}: note: {}\n", printable(file), printable(message)));
  }
  if (errors.empty()) return {};
  return fail(as_one(std::move(errors), file));
}

std::string unit_name(CurveUnit unit) {
  if (unit == CurveUnit::Length) return ", a length";
  return unit == CurveUnit::Degrees ? ", in degrees" : "";
}

void print_curves(const CurveFile& file) {
  for (const FileCurve& curve : file.curves) {
    if (was_interrupted()) return;
    const auto& keys = curve.keys.keys;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const Key<1>& key : keys) {
      low = std::min(low, key.value[0]);
      high = std::max(high, key.value[0]);
    }
    print(stdout,
          fmt::format("{}: {}, frames {} to {}, values {} to {}{}\n", printable(curve.name),
                      counted(static_cast<std::int64_t>(keys.size()), "key"), keys.front().frame,
                      keys.back().frame, low, high, unit_name(curve.unit)));
  }
  if (file.curves.empty()) print(stdout, "no curves\n");
}

void print_channels(const Scene& scene) {
  print(stdout, fmt::format("\nchannels of {}:\n", printable(scene.origin.file)));
  for (const NamedChannel& channel : channels_of(scene)) {
    const bool is_vector = std::holds_alternative<const Channel<3>*>(channel.channel);
    print(stdout, fmt::format("  {}{}{}\n", channel.path, is_vector ? " .x .y .z" : "",
                              channel.is_animated() ? " (animated)" : ""));
  }
}

// The order of rotation of the surfaces whose `rotate` curves go to. Errors: several orders.
Result<RotateOrder> order_of(const std::vector<CurveMapping>& mappings, const Scene* scene) {
  if (!scene) return RotateOrder::Xyz;
  std::set<RotateOrder> orders;
  std::set<std::string_view> channels;
  for (const CurveMapping& mapping : mappings) channels.insert(mapping.channel);
  for (const Surface& surface : scene->surfaces)
    if (channels.contains(surface.name + ".rotate")) orders.insert(surface.transform.rotate_order);
  if (orders.size() > 1) {
    return bad_usage(
        "--map: surfaces with several orders of rotation cannot take curves at once; import them "
        "one "
        "after the other");
  }
  return orders.empty() ? RotateOrder::Xyz : *orders.begin();
}

struct Import {
  CurveFile file;
  std::vector<CurveMapping> mappings;
};

// The vector or the curve that a mapping takes.
std::string title_of_mapping(const CurveMapping& mapping, const CurveIndex& curves) {
  const auto found = curves.find(mapping.source);
  const bool is_one = !found.empty() && found.front()->name == mapping.source;
  return is_one && mapping.component >= 0 ? found.front()->group : mapping.source;
}

// Reads the file with the mappings, given or by name.
Result<Import> read_import(const CurveExchangeOptions& options, const Scene* scene,
                           const std::filesystem::path& root) {
  CurveReading reading;
  reading.tolerance = options.tolerance;
  reading.should_stop = &was_interrupted;
  if (scene) {
    reading.fps = scene->fps;
    reading.frame_at_zero = scene->start;
  }
  Import imported;
  for (const std::string& text : options.mappings) {
    auto mapping = parse_mapping(text);
    if (!mapping) return fail(mapping.error());
    imported.mappings.push_back(*std::move(mapping));
  }
  for (;;) {
    auto file = read_curves(options.file, reading, root);
    if (!file) return fail(file.error());
    imported.file = *std::move(file);
    if (options.mappings.empty() && scene)
      imported.mappings = mappings_by_name(imported.file, *scene);
    const auto order = order_of(imported.mappings, scene);
    if (!order) return fail(order.error());
    if (*order == reading.rotate_order) return imported;
    reading.rotate_order = *order;
  }
}

// Turns vectors to the axes of pliant, or tells that they are not turned.
void turn_vectors(Import& imported, const CurveExchangeOptions& options, const Scene* scene) {
  std::vector<CurveLoss>& losses = imported.file.losses;
  const bool is_z_up = options.up == "z";
  const bool is_doubtful =
      options.up.empty() && curve_format_of(options.file) == CurveFormat::Blender;
  std::set<std::string> told;
  std::map<std::string_view, const Surface*> surfaces;
  if (scene)
    for (const Surface& surface : scene->surfaces) surfaces.try_emplace(surface.name, &surface);
  const CurveIndex curves(imported.file);
  for (const CurveMapping& mapping : imported.mappings) {
    const std::string title = title_of_mapping(mapping, curves);
    if (!is_of_vector(mapping, curves) || !told.insert(title).second) continue;
    const std::string surface = mapping.channel.substr(0, mapping.channel.find('.'));
    const bool is_rotation = mapping.channel == surface + ".rotate";
    if (is_doubtful && title != mapping.channel) {
      losses.push_back(
          {title,
           fmt::format("x, y and z are taken as they are, but in Blender z is up: --up "
                       "z turns (x, y, z) to (x, z, {}y), and --up y ends this note",
                       mapping.channel == surface + ".scale" ? "" : "-"),
           true});
    }
    if (!is_z_up || !is_rotation || !scene) continue;
    const auto found = surfaces.find(surface);
    if (found == surfaces.end() || found->second->transform.rotate_order == RotateOrder::Xzy)
      continue;
    losses.push_back({title,
                      fmt::format("turned angles of the order xyz are those of the order xzy: give "
                                  "<transform> of {} rotateOrder=\"xzy\"",
                                  surface),
                      false});
  }
  if (is_z_up) imported.mappings = with_z_up(imported.mappings, imported.file);
}

// What was lost of the curves that are used.
std::vector<CurveLoss> losses_of(const Import& imported) {
  std::set<std::string> sources;
  for (const CurveMapping& mapping : imported.mappings) sources.insert(mapping.source);
  std::set<std::string> used = sources;
  for (const FileCurve& curve : imported.file.curves) {
    if (sources.contains(curve.name) || sources.contains(curve.group)) {
      used.insert(curve.name);
      used.insert(curve.group);
    }
  }
  std::vector<CurveLoss> losses;
  for (const CurveLoss& loss : imported.file.losses)
    if (used.count(loss.curve) > 0) losses.push_back(loss);
  return losses;
}

// Curves that no channel has the name of.
void note_left_out(const Import& imported, std::vector<CurveLoss>& losses) {
  std::set<std::string> used, used_groups;
  for (const CurveMapping& mapping : imported.mappings) used.insert(mapping.source);
  for (const FileCurve& curve : imported.file.curves)
    if (used.contains(curve.name)) used_groups.insert(curve.group);
  std::vector<std::string> names;
  for (const FileCurve& curve : imported.file.curves)
    if (!used_groups.contains(curve.group)) names.push_back(curve.name);
  if (names.empty()) return;
  constexpr std::size_t most = 8;
  const std::size_t others = names.size() - std::min(names.size(), most);
  names.resize(names.size() - others);
  losses.push_back(
      {names.front(),
       fmt::format("no channel has the name of {}{}; --map gives one", fmt::join(names, ", "),
                   others > 0 ? fmt::format(" and {} more", others) : ""),
       true});
}

Result<void> import_curves(const CurveExchangeOptions& options) {
  const auto root = folder_of(options.root);
  if (!root) return fail(root.error());
  const bool is_listing = options.out.empty();
  const bool is_printing = options.out == "-";
  std::optional<Scene> scene;
  std::string text;  // of the scene
  const std::string folder = std::filesystem::path(options.out).parent_path().string();
  if (!is_listing && !is_printing) {
    if (auto place = check_output_file("-o", options.out); !place) return place;
    std::error_code ignored;
    if (!std::filesystem::exists(options.out, ignored)) {
      return bad_usage(
          fmt::format("-o {}: the scene does not exist; -o - prints the elements for a new one",
                      printable(options.out)));
    }
    auto read = read_file(options.out, largest_scene_file, &was_interrupted);
    if (!read) return fail(read.error());
    text = *std::move(read);
    auto parsed = parse_scene(text, options.out, folder, root->string(), &was_interrupted);
    if (!parsed) return fail(parsed.error());
    scene = *std::move(parsed);
  }
  auto imported = read_import(options, scene ? &*scene : nullptr, *root);
  if (!imported) return fail(imported.error());
  if (is_listing) {
    if (!options.mappings.empty()) return bad_usage("--map: needs -o, the scene for the curves");
    print_curves(imported->file);
    if (was_interrupted()) return interrupted();
    return tell_losses(imported->file.losses, options.file, options.is_strict);
  }
  if (imported->mappings.empty()) {
    if (!options.is_quiet) {
      print_curves(imported->file);
      if (scene) print_channels(*scene);
    }
    return bad_usage(
        is_printing ? "--map: is needed with -o -, to name the channels"
                    : "no curve of the file has the name of a channel of the scene; name them with "
                      "--map SOURCE=CHANNEL");
  }
  turn_vectors(*imported, options, scene ? &*scene : nullptr);
  auto placed = place_curves(imported->file, imported->mappings, scene ? &*scene : nullptr,
                             options.offset, options.tolerance, &was_interrupted);
  if (!placed) {
    Error error = placed.error();
    // Nobody typed what was mapped by name.
    if (options.mappings.empty() && error.message.starts_with("--map ")) {
      error.message.erase(0, std::string_view("--map ").size());
      error.file = options.file;
    }
    return fail(std::move(error));
  }
  std::vector<CurveLoss> losses = losses_of(*imported);
  if (options.mappings.empty()) note_left_out(*imported, losses);
  losses.insert(losses.end(), placed->losses.begin(), placed->losses.end());
  const auto fps = imported->file.fps;
  if (scene && fps && std::abs(*fps - scene->fps) > 1e-9 * scene->fps) {
    losses.push_back({"fps",
                      fmt::format("the file has {} frames/s, the scene {}: frames stay frames",
                                  *fps, scene->fps),
                      true});
  }
  if (auto told = tell_losses(losses, options.file, options.is_strict); !told) return told;
  if (is_printing) {
    const std::string elements = animate_elements(*placed, &was_interrupted);
    if (was_interrupted()) return interrupted();
    print(stdout, elements);
    return {};
  }
  const auto changed =
      with_curves(text, options.out, folder, root->string(), *placed, &was_interrupted);
  if (!changed) return fail(changed.error());
  if (auto written = rewrite_file(options.out, text, *changed); !written) return written;
  if (!options.is_quiet) {
    std::vector<std::string> names;
    for (const PlacedCurve& curve : placed->curves) names.push_back(curve.channel);
    print(stdout, fmt::format("{}: {}: {}\n", printable(options.out),
                              counted(static_cast<std::int64_t>(names.size()), "channel"),
                              fmt::join(names, ", ")));
  }
  return {};
}

Result<void> export_curves(const CurveExchangeOptions& options) {
  if (auto place = check_output_file("-o", options.out); !place) return place;
  const auto format = curve_format_of(options.out);
  if (!format) {
    return bad_usage(fmt::format(
        "{}: no format of curves has the ending \"{}\"; allowed: .json, .gltf, .glb, .anim",
        printable(options.out), ending_of(options.out)));
  }
  const auto scene = read_scene(options.scene, options.root);
  if (!scene) return fail(scene.error());
  if (auto free = check_no_input("-o", options.out, *scene); !free) return free;
  const auto curves = curves_of(*scene, options.channels);
  if (!curves) return fail(curves.error());
  if (curves->empty()) return bad_usage("the scene has no animated channel, so there are no keys");
  CurveWriting writing;
  writing.fps = scene->fps;
  writing.first = scene->start;
  writing.last = scene->end;
  writing.tolerance = options.tolerance;
  writing.should_stop = &was_interrupted;
  writing.is_binary = ending_of(options.out) == ".glb";
  const auto text = write_curves(*curves, *format, writing);
  if (!text) return fail(text.error());
  if (auto told = tell_losses(text->losses, options.out, options.is_strict); !told) return told;
  if (auto written = write_file(options.out, text->bytes); !written) return written;
  if (!options.is_quiet) {
    print(stdout, fmt::format("{}: {}\n", printable(options.out),
                              counted(static_cast<std::int64_t>(curves->size()), "channel")));
  }
  return {};
}

CLI::App* add_pair(CLI::App& app, const char* name, const char* does, const char* curves_do) {
  CLI::App* parent = app.add_subcommand(name, does);
  parent->require_subcommand(1);
  return parent->add_subcommand("curves", curves_do);
}

void add_shared(CLI::App& command, CurveExchangeOptions& options) {
  command
      .add_option("--tolerance", options.tolerance,
                  "Largest change where a curve must be converted, as a share of its range")
      ->check(number_from(1e-9))
      ->capture_default_str();
  command.add_flag("--strict", options.is_strict,
                   "Refuse to write a curve whose values would change");
  command.add_flag("--quiet", options.is_quiet, "Print no summary");
  add_root(command, options.root);
}

}  // namespace

void add_import(CLI::App& app, CurveExchangeOptions& options) {
  CLI::App* command = add_pair(app, "import", "Read from files of other programs",
                               "Read keys of Blender, Maya or a glTF into a scene");
  command->add_option("FILE", options.file, "File of the other program: .json, .gltf, .glb, .anim")
      ->required();
  command
      ->add_option("-o,--out", options.out,
                   "Scene that gets the keys; \"-\": print them as elements; by default the "
                   "curves of the file are listed")
      ->check(file_name());
  command->add_option("--map", options.mappings,
                      "SOURCE=CHANNEL[.x|.y|.z][*FACTOR]: a curve of the file for a channel; by "
                      "default those whose names are the same");
  command
      ->add_option("--up", options.up,
                   "The axis that is up in the file, z in Blender: z turns vectors that are mapped "
                   "as a whole, (x, y, z) to (x, z, -y)")
      ->check(one_of({"y", "z"}));
  command->add_option("--offset", options.offset, "Frames that are added to those of the file");
  add_shared(*command, options);
}

void add_export(CLI::App& app, CurveExchangeOptions& options) {
  CLI::App* into = add_pair(app, "export", "Write files for other programs",
                            "Write keys of a scene for Blender, Maya or as glTF");
  into->add_option("SCENE", options.scene, "Scene file")->required();
  into->add_option("-o,--out", options.out, "Output file: .json, .gltf, .glb or .anim")->required();
  into->add_option("--channel", options.channels,
                   "Channels, as NAME.attribute; all animated channels by default");
  add_shared(*into, options);
}

int run_import(const CurveExchangeOptions& options) {
  catch_interrupts();
  if (auto done = import_curves(options); !done) return report(done.error());
  return exit_done;
}

int run_export(const CurveExchangeOptions& options) {
  catch_interrupts();
  if (auto done = export_curves(options); !done) return report(done.error());
  return exit_done;
}

}  // namespace pliant::cli
