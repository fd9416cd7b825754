#include "info.hpp"

#include <algorithm>
#include <iterator>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "interrupt.hpp"
#include "pliant/pliant.hpp"
#include "report.hpp"
#include "scene_input.hpp"

namespace pliant::cli {
namespace {

// `palm (point in hand)`.
std::string title(const Force& force) {
  return fmt::format("{} ({}{})", force.name, kind_of(force),
                     force.group.empty() ? "" : " in " + force.group);
}

std::string shape_text(const SurfaceShape& shape) {
  if (const auto* file = std::get_if<MeshFile>(&shape)) return "mesh " + file->path.string();
  return std::holds_alternative<GridSheet>(shape) ? "sheet" : "mesh";
}

void print_surface(const Surface& surface, const RestShape& shape) {
  const Grid& grid = shape.mapping.grid;
  print(stdout,
        fmt::format("  {}  {}, grid {} x {}, {} vertices{}\n", surface.name,
                    shape_text(surface.shape), grid.columns, grid.rows, shape.mesh.vertex_count(),
                    surface.enabled ? "" : "; disabled: written at rest"));
}

// What the force would do, in as many lines as there is something to say.
void print_preview(const ForcePreview& preview, const Simulation& simulation) {
  const Scene& scene = simulation.scene();
  const Force& force = scene.forces[preview.force];
  std::string text =
      fmt::format("  {} on {}: ", title(force), scene.surfaces[preview.surface].name);
  if (!preview.frame) {
    text += fmt::format("selects nothing at rest; its largest magnitude is {:g} (frame {})\n",
                        preview.magnitude, preview.magnitude_frame);
  } else {
    const Box& box = preview.region;
    text += fmt::format("from frame {} it selects {} x {} nodes, columns {} to {}, rows {} to {}\n",
                        *preview.frame, box.columns(), box.rows(), box.i0, box.i1, box.j0, box.j1);
    if (!preview.is_solvable) text += "    fewer than 3 x 3 nodes: too few to solve\n";
  }
  if (preview.is_solvable && !preview.is_solved) {
    text += "    too many to preview the static peak and the natural frequency\n";
  }
  if (preview.is_solved) {
    text += fmt::format("    static peak displacement {:.4g} at magnitude {:g} (frame {})\n",
                        preview.static_peak, preview.magnitude, preview.magnitude_frame);
    text += preview.frequency > 0
                ? fmt::format("    first natural frequency {:.4g} Hz, damping ratio {:.3g}: {}\n",
                              preview.frequency, preview.damping_ratio,
                              preview.damping_ratio < 1 ? "it rings" : "it creeps back")
                : "    first natural frequency: none, the density is 0\n";
  }
  print(stdout, text);
}

// A force without a preview, and why it has none.
std::string idle_text(const Force& force, const Scene& scene) {
  const auto group = std::find_if(scene.groups.begin(), scene.groups.end(),
                                  [&](const Group& one) { return one.name == force.group; });
  bool is_enabled = false;
  for (int frame = scene.start; frame <= scene.end && !is_enabled; ++frame) {
    is_enabled =
        force.enabled.at(frame) && (group == scene.groups.end() || group->enabled.at(frame));
  }
  return fmt::format(
      "  {}: {}\n", title(force),
      is_enabled ? "no surface that is solved while it is enabled" : "never enabled");
}

template <int D>
std::string value_text(const Value<D>& value) {
  return fmt::format("{:g}", fmt::join(value, " "));
}

template <int D>
std::string keys_text(const Channel<D>& channel, bool is_switch = false) {
  const auto& keys = channel.curve().keys().keys;
  std::string text = fmt::format("{} key{}:", keys.size(), keys.size() == 1 ? "" : "s");
  // The ends of a long curve say enough.
  constexpr std::size_t most = 12, at_each_end = 5;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (keys.size() > most && k == at_each_end) {
      text += " …";
      k = keys.size() - at_each_end;
    }
    const std::string value =
        is_switch ? (keys[k].value[0] != 0 ? "true" : "false") : value_text<D>(keys[k].value);
    text += fmt::format("{} {:g} = {}", k > 0 ? "," : "", keys[k].frame, value);
  }
  return text;
}

struct KeysText {
  std::string operator()(const Channel<1>* channel) const { return keys_text(*channel); }
  std::string operator()(const Channel<3>* channel) const { return keys_text(*channel); }
  std::string operator()(const Switch* channel) const {
    return keys_text(channel->channel(), true);
  }
};

void print_channels(const Scene& scene) {
  std::string text;
  for (const NamedChannel& channel : channels_of(scene)) {
    if (!channel.is_animated()) continue;
    text += fmt::format("  {}  {}\n", channel.path, std::visit(KeysText{}, channel.channel));
  }
  print(stdout, "channels with keys\n" + (text.empty() ? "  none\n" : text));
}

}  // namespace

void add_info(CLI::App& app, InfoOptions& options) {
  CLI::App* info = app.add_subcommand("info", "Tell what is in a scene, to choose numbers by");
  info->add_option("SCENE", options.scene, "Scene file")->required();
  add_root(*info, options.root);
  add_memory(*info, options.resources);
}

int run_info(const InfoOptions& options) {
  catch_interrupts();
  auto scene = read_scene(options.scene, options.root);
  if (!scene) return report(scene.error());
  print_notes(*scene);
  const SimulationOptions run = simulation_options(options.resources);
  if (scene->surfaces.empty()) {
    if (const auto checked = Simulation::check(*scene, run); !checked) {
      return report(checked.error());
    }
    print(stdout, fmt::format("{}\nframes {} to {} at {:g} frames/s\nno surface\n", options.scene,
                              scene->start, scene->end, scene->fps));
    print_channels(*scene);
    return exit_done;
  }
  const auto simulation = Simulation::make(*std::move(scene), run);
  if (!simulation) return report(simulation.error());
  const Scene& made = simulation->scene();
  const auto previews = preview_forces(*simulation, run);
  if (!previews) return report(previews.error());

  print(stdout, fmt::format("{}\nframes {} to {} at {:g} frames/s, {:.4g} s\n", options.scene,
                            made.start, made.end, made.fps, (made.end - made.start) / made.fps));
  print(stdout, "surfaces\n");
  for (std::size_t k = 0; k < made.surfaces.size(); ++k) {
    print_surface(made.surfaces[k], simulation->rest_shapes()[k]);
  }
  print(stdout, "forces, each alone and on the surface at rest\n");
  std::size_t solver_memory = 0;
  for (const ForcePreview& preview : *previews) {
    print_preview(preview, *simulation);
    solver_memory = std::max(solver_memory, preview.solver_memory);
  }
  for (std::size_t k = 0; k < made.forces.size(); ++k) {
    const bool is_previewed =
        std::any_of(previews->begin(), previews->end(),
                    [&](const ForcePreview& preview) { return preview.force == k; });
    if (!is_previewed) print(stdout, idle_text(made.forces[k], made));
  }
  for (const Group& group : made.groups) {
    const bool is_empty =
        std::none_of(made.forces.begin(), made.forces.end(),
                     [&](const Force& force) { return force.group == group.name; });
    if (is_empty) print(stdout, fmt::format("  {} (group): no force in it\n", group.name));
  }
  if (made.forces.empty() && made.groups.empty()) print(stdout, "  none\n");
  print_channels(made);
  print(stdout,
        fmt::format("memory\n  {} for the surfaces, {} for the solver of the largest region "
                    "above\n",
                    bytes_text(simulation->surface_memory()), bytes_text(solver_memory)));
  return exit_done;
}

}  // namespace pliant::cli
