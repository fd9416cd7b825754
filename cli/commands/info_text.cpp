#include <algorithm>
#include <cmath>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/commands/info_formats.hpp"
#include "cli/terminal/report.hpp"
#include "cli/terminal/rounded.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant::cli {
namespace {

// `palm (point in hand)`.
std::string title(const Force& force) {
  return fmt::format("{} ({}{})", force.name, kind_of(force),
                     force.group.empty() ? "" : " in " + force.group);
}

std::string shape_text(const Surface& surface) {
  const std::string_view mesh = surface.subdivision ? "subdivided mesh" : "mesh";
  if (const auto* file = std::get_if<MeshFile>(&surface.shape)) {
    return fmt::format("{} {}", mesh, printable(file->path));
  }
  if (std::holds_alternative<NurbsNet>(surface.shape)) return "NURBS net";
  return std::holds_alternative<GridSheet>(surface.shape) ? "sheet" : std::string(mesh);
}

std::string box_text(const BoundingBox& box) {
  const double size = (box.high - box.low).norm();
  return place_text(box.low, size) + " to " + place_text(box.high, size);
}

std::string closed_text(const Grid& grid) {
  if (grid.is_open()) return {};
  return fmt::format(", closed along {}", !grid.is_closed_v   ? "u"
                                          : !grid.is_closed_u ? "v"
                                                              : "u and v");
}

// `grid 61 x 61`, or `surface of 507 nodes in 500 faces, …`.
std::string nodes_text(const SceneFacts::SurfaceFacts& facts) {
  if (facts.grid) {
    return fmt::format("grid {} x {}{}", facts.grid->columns, facts.grid->rows,
                       closed_text(*facts.grid));
  }
  const auto& [nodes, faces, pieces, border_edges, unit] = *facts.triangles;
  const std::string lengths = unit[0] == unit[1] ? fmt::format("{:.5g}", unit[0])
                                                 : fmt::format("{:.5g} {:.5g}", unit[0], unit[1]);
  return fmt::format("surface of {} in {}, {}, {}, unit {}", counted(nodes, "node"),
                     counted(faces, "face"), counted(pieces, "piece"),
                     counted(border_edges, "border edge"), lengths);
}

std::string surface_text(const Surface& surface, const SceneFacts::SurfaceFacts& facts) {
  std::string text =
      fmt::format("  {}  {}, {}, {}{}\n    bounding box {}\n", surface.name, shape_text(surface),
                  surface.is_driven() ? "driven by " + surface.driven_by : nodes_text(facts),
                  counted(facts.vertex_count, "vertex", "vertices"),
                  surface.enabled ? "" : "; disabled: written at rest", box_text(facts.placed));
  if (facts.own.low != facts.placed.low || facts.own.high != facts.placed.high) {
    text += fmt::format("    {} before its transform{}\n", box_text(facts.own),
                        facts.cache ? " and cache" : "");
  }
  if (facts.cache) {
    text +=
        fmt::format("    cache {}: {}, frames {} to {}\n", printable(surface.cache.path),
                    counted(facts.cache->samples, "sample"), facts.cache->first, facts.cache->last);
  }
  for (const MapSummary& map : facts.maps) {
    const auto& own = *std::ranges::find(surface.maps, map.channel, &MaterialMap::channel);
    text += fmt::format("    {} times {:.4g} to {:.4g} by {}\n",
                        map_channel_words[static_cast<std::size_t>(map.channel)], map.least,
                        map.most, printable(own.file.empty() ? own.attribute : own.file));
  }
  if (facts.held_nodes > 0)
    text += fmt::format("    holds {}\n", counted(facts.held_nodes, "node"));
  return text;
}

std::string frequency_text(double frequency) {
  if (!std::isfinite(frequency)) return "too high for a number";
  return frequency >= 0.001 ? fmt::format("{:.4g} Hz", frequency)
                            : fmt::format("{:.3e} Hz", frequency);
}

// Two lines about the vibration of a region.
std::string vibration_text(const RegionPreview& region, double fps) {
  std::string text = region.first_frequency > 0
                         ? fmt::format("    first natural frequency {}, damping ratio {:.3g}\n",
                                       frequency_text(region.first_frequency), region.damping_ratio)
                         : "    first natural frequency: none, the density is 0\n";
  const auto& [frequency, ratio] = region.animated;
  text += "    in the animation, with the damping of its steps: ";
  if (frequency > 0) {
    text += fmt::format("{}, damping ratio {:.3g}{}, it {}", frequency_text(frequency), ratio,
                        frequency > fps / 2 ? ", faster than frames can show" : "",
                        ratio < 0.7 ? "rings" : "hardly swings");
  } else {
    text +=
        !std::isfinite(ratio) ? "it creeps" : fmt::format("damping ratio {:.3g}, it creeps", ratio);
  }
  const Settling& settling = region.settling;
  if (!std::isfinite(settling.time)) return text + "; does not settle\n";
  text += fmt::format("; settles to 5 % in {}{:.3g} s ({})\n", settling.is_counted ? "" : "about ",
                      settling.time, counted(settling.frames, "frame"));
  return text;
}

// "columns 4 to 27", "columns 28 to 3 (across the seam)" or "all columns (a ring)".
std::string lines_text(std::string_view lines, int first, int last, int count, bool is_closed) {
  if (is_closed && last - first + 1 == count) return fmt::format("all {} (a ring)", lines);
  if (last < count) return fmt::format("{} {} to {}", lines, first, last);
  return fmt::format("{} {} to {} (across the seam)", lines, first, last - count);
}

// The nodes of a box on a grid, or of a part of a surface.
std::string selected_text(const Box& box, const CutCounts& counts,
                          const std::optional<Grid>& grid) {
  if (!grid) {
    return fmt::format("{} inside, {}", counted(counts.inside_nodes, "node"),
                       counted(counts.cells, "cell"));
  }
  return fmt::format("{} x {} nodes, {}, {}", box.columns(), box.rows(),
                     lines_text("columns", box.i0, box.i1, grid->columns, grid->is_closed_u),
                     lines_text("rows", box.j0, box.j1, grid->rows, grid->is_closed_v));
}

// One line per region if there are several; the largest peaks first, and only these if there are
// many.
std::string regions_text(const Preview& preview, const std::optional<Grid>& grid, double fps) {
  std::vector<const RegionPreview*> regions;
  for (const RegionPreview& region : preview.regions) regions.push_back(&region);
  std::stable_sort(regions.begin(), regions.end(),
                   [](const auto* a, const auto* b) { return a->static_peak > b->static_peak; });
  if (regions.size() == 1) {
    return regions[0]->has_vibration ? vibration_text(*regions[0], fps) : "";
  }
  constexpr std::size_t most = 8;
  std::string text;
  for (std::size_t k = 0; k < std::min(regions.size(), most); ++k) {
    text += fmt::format(
        "    region of {}: {}\n", selected_text(regions[k]->region.box, regions[k]->counts, grid),
        regions[k]->is_solvable ? fmt::format("static peak {:.4g}", regions[k]->static_peak)
        : grid                  ? "too few nodes to solve"
                                : "nothing holds it");
    if (regions[k]->has_vibration) text += vibration_text(*regions[k], fps);
  }
  if (regions.size() > most) text += fmt::format("    and {} more\n", regions.size() - most);
  return text;
}

std::string percent(double share) { return fmt::format("{:.3g} %", 100 * share); }

// "palm 98 %, weight 2 %": the largest first, and only these if there are many.
std::string shares_text(const Preview& preview, const Scene& scene) {
  if (preview.shares.size() < 2) return {};
  std::vector<ForceShare> shares = preview.shares;
  std::stable_sort(shares.begin(), shares.end(), [](const ForceShare& a, const ForceShare& b) {
    return std::abs(a.share) > std::abs(b.share);
  });
  constexpr std::size_t most = 8;
  std::string text = "    of the static peak:";
  for (std::size_t k = 0; k < std::min(shares.size(), most); ++k) {
    text += fmt::format("{} {} {}", k > 0 ? "," : "", scene.forces[shares[k].force].name,
                        percent(shares[k].share));
  }
  if (shares.size() > most) {
    double others = 0;
    for (std::size_t k = most; k < shares.size(); ++k) others += shares[k].share;
    text += fmt::format(", the {} others together {}", shares.size() - most, percent(others));
  }
  return text + '\n';
}

std::string distance_text(double distance) {
  return std::isfinite(distance) ? fmt::format("{:.4g}", distance) : "too far for a number";
}

std::string gap_text(const Preview& preview) {
  std::string text = "it selects nothing";
  if (!preview.gap) return text;
  const auto& [frame, to_vertex, to_centre, radius] = *preview.gap;
  text += fmt::format(
      "\n    nearest at frame {}: {} to the nearest vertex, {} to the middle of the bounding box, "
      "deformationRadius {:.4g}\n",
      frame, distance_text(to_vertex), distance_text(to_centre), radius);
  return text;
}

// The effect of forces, in as many lines as needed; `who` names the forces.
std::string preview_text(const Preview& preview, const std::string& who, const SceneFacts& facts) {
  const Scene& scene = facts.scene;
  const std::optional<Grid>& grid = facts.surfaces[preview.surface].grid;
  std::string text = fmt::format("  {} on {}: ", who, scene.surfaces[preview.surface].name);
  const bool is_force = preview.of == Preview::Of::Force;
  if (!preview.frame) {
    text += gap_text(preview);
    if (!is_force) return text.ends_with('\n') ? text : text + '\n';
    return text + fmt::format("    its largest magnitude is {:g} (frame {})\n",
                              preview.largest_magnitude, preview.largest_magnitude_frame);
  }
  const bool is_whole = scene.surfaces[preview.surface].solver.region == SolvedRegion::All;
  const std::string_view verb = preview.of == Preview::Of::All ? "they select" : "it selects";
  text += fmt::format("at frame {}{} {} {}\n", *preview.frame,
                      is_force ? fmt::format(", at magnitude {:g},", preview.magnitude) : "",
                      is_whole ? "on the whole surface," : verb,
                      selected_text(preview.selected, preview.counts, grid));
  if (!preview.is_every_frame)
    text += "    not every frame was examined, because the range is long\n";
  if (preview.is_apart) {
    text +=
        "    their boxes do not all meet: one region around all of them is solved, in which each "
        "force moves the surface more than alone; combine=\"islands\" solves each box by itself\n";
  }
  if (!preview.is_solvable) {
    text += grid ? "    fewer than 3 x 3 nodes: too few to solve\n" : "    none of them can move\n";
  } else if (!preview.is_held) {
    text += "    nothing holds the surface: it has no static peak\n";
    for (const RegionPreview& region : preview.regions) {
      if (region.is_held || region.first_frequency == 0) continue;
      text += fmt::format("    first natural frequency of its bending {}, damping ratio {:.3g}\n",
                          frequency_text(region.first_frequency), region.damping_ratio);
    }
  } else if (!preview.is_solved) {
    text += "    too many nodes to preview the static peak and the natural frequency\n";
  } else {
    text += fmt::format("    static peak displacement {:.4g}", preview.static_peak);
  }
  if (preview.played) {
    text += fmt::format("{}in the animation {:.4g} at frame {}\n",
                        preview.is_solved ? "; " : "    peak displacement ", preview.played->peak,
                        preview.played->frame);
  } else if (preview.is_solved) {
    const bool is_loop = scene.surfaces[preview.surface].solver.loop.has_value();
    text += is_loop ? "; its loop is not played here\n"
                    : "; too many frames and nodes to play the animation\n";
  }
  if (!preview.is_solved) return text;
  return text + shares_text(preview, scene) + regions_text(preview, grid, scene.fps);
}

// Whether the preview of all forces of a surface equals that of its only force.
bool is_told_already(const Preview& all, const std::vector<const Preview*>& of_forces) {
  if (of_forces.size() != 1) return false;
  const Preview& only = *of_forces.front();
  if (only.frame != all.frame || only.static_peak != all.static_peak) return false;
  return only.played.has_value() == all.played.has_value() &&
         (!only.played || only.played->peak == all.played->peak);
}

std::string forces_text(const SceneFacts& facts) {
  const Scene& scene = facts.scene;
  std::string text =
      "forces, each alone, at the frame of greatest effect, on the surface at rest\n";
  std::vector<std::vector<const Preview*>> on_surfaces(scene.surfaces.size());
  for (const Preview& preview : facts.previews) {
    if (preview.of != Preview::Of::Force) continue;
    text += preview_text(preview, title(scene.forces[preview.index]), facts);
    on_surfaces[preview.surface].push_back(&preview);
  }
  const std::vector<std::string> idle = idle_reasons(facts);
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    if (idle[k].empty()) continue;
    text += fmt::format("  {}: {}\n", title(scene.forces[k]), idle[k]);
  }
  if (scene.forces.empty()) text += "  none\n";
  if (!scene.groups.empty()) text += "groups, each with all its forces\n";
  const auto members = members_of_groups(scene);
  const PreviewLists of_groups = previews_of(facts, Preview::Of::Group);
  for (std::size_t k = 0; k < scene.groups.size(); ++k) {
    const std::string& name = scene.groups[k].name;
    for (const Preview* const preview : of_groups[k]) text += preview_text(*preview, name, facts);
    if (members[k].empty()) {
      text += fmt::format("  {} (group): it has no forces\n", name);
    } else if (of_groups[k].empty()) {
      text += fmt::format("  {} (group): none of its forces acts\n", name);
    }
  }
  std::string together;
  for (const Preview& preview : facts.previews) {
    if (preview.of != Preview::Of::All) continue;
    if (is_told_already(preview, on_surfaces[preview.surface])) continue;
    together += preview_text(preview, "together", facts);
  }
  if (!together.empty()) text += "all forces of a surface, together\n" + together;
  return text;
}

std::string colliders_text(const SceneFacts& facts) {
  if (facts.contacts.empty()) return {};
  const Scene& scene = facts.scene;
  std::string text = "colliders, over the animation\n";
  for (const ContactSummary& contact : facts.contacts) {
    const Collider& collider = scene.colliders[contact.collider];
    text += fmt::format("  {} ({}) on {}: ", collider.name, shape_of(collider),
                        scene.surfaces[contact.surface].name);
    if (contact.first_touch) {
      text += fmt::format(
          "first touches at frame {}; at most {} at frame {}, with a force of {:.4g} "
          "at frame {}\n",
          *contact.first_touch, counted(contact.most_nodes, "node"), contact.most_nodes_frame,
          contact.largest_force, contact.largest_force_frame);
    } else {
      text += facts.is_contact_played ? "touches nothing\n"
                                      : "too many frames and nodes to play the animation\n";
    }
    if (contact.hiding_offset && *contact.hiding_offset > 0)
      text += fmt::format("    offset {:.3g} keeps the faces between nodes outside too\n",
                          *contact.hiding_offset);
  }
  return text;
}

template <int D>
std::string value_text(const Value<D>& value) {
  return fmt::format("{:g}", fmt::join(value, " "));
}

template <int D>
std::string keys_text(const Channel<D>& channel, bool is_switch = false) {
  const auto& keys = channel.curve().keys().keys;
  std::string text = counted(keys.size(), "key") + ':';
  // For a long curve only the keys at its ends are shown.
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

std::string channels_text(const Scene& scene) {
  std::string text;
  for (const NamedChannel& channel : channels_of(scene)) {
    if (!channel.is_animated()) continue;
    text += fmt::format("  {}  {}\n", channel.path, std::visit(KeysText{}, channel.channel));
  }
  return "channels with keys\n" + (text.empty() ? "  none\n" : text);
}

}  // namespace

std::string objects_text(const std::string& file, std::span<const FileObject> objects) {
  std::string text = fmt::format("{}\n{}; a scene chooses one by <mesh object=\"…\"/>\n",
                                 printable(file), counted(objects.size(), "object"));
  text += fmt::format("  {:>6} {:>10} {:>10}  object\n", "number", "vertices", "faces");
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const FileObject& object = objects[k];
    const bool is_named = object.choice.starts_with(object.name);
    text += fmt::format("  {:>6} {:>10} {:>10}  {}{}\n", k + 1, object.vertices, object.faces,
                        printable(object.choice),
                        is_named ? "" : fmt::format(" (named {})", printable(object.name)));
  }
  return text;
}

std::string info_text(const SceneFacts& facts) {
  const Scene& scene = facts.scene;
  std::string text =
      fmt::format("{}\nframes {} to {} at {:g} frames/s, {:.4g} s\n", printable(facts.file),
                  scene.start, scene.end, scene.fps, (scene.end - scene.start) / scene.fps);
  if (facts.surfaces.empty()) return text + "no surfaces\n" + channels_text(scene);
  text += "surfaces\n";
  for (std::size_t k = 0; k < facts.surfaces.size(); ++k) {
    text += surface_text(scene.surfaces[k], facts.surfaces[k]);
  }
  text += forces_text(facts) + colliders_text(facts) + channels_text(scene);
  text += fmt::format("memory\n  {} for the surfaces", bytes_text(facts.surface_memory));
  if (facts.solver_memory > 0) {
    text += fmt::format(", {} for the solver of the largest region that was solved",
                        bytes_text(facts.solver_memory));
  }
  return text + '\n';
}

}  // namespace pliant::cli
