#include <algorithm>
#include <array>
#include <variant>

#include "cli/commands/info_formats.hpp"
#include "cli/terminal/json.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant::cli {
namespace {

Json bounds_json(const BoundingBox& box) {
  return {{"low", to_json(box.low)}, {"high", to_json(box.high)}};
}

Json surface_json(const Surface& surface, const SceneFacts::SurfaceFacts& facts) {
  Json json = {{"name", surface.name}, {"enabled", surface.enabled}};
  const auto* file = std::get_if<MeshFile>(&surface.shape);
  json["mesh"] = file ? Json(file->path) : Json(nullptr);
  if (surface.subdivision) json["levels"] = surface.subdivision->levels;
  if (surface.is_driven()) {
    json["drivenBy"] = surface.driven_by;
  } else if (facts.grid) {
    json["columns"] = facts.grid->columns;
    json["rows"] = facts.grid->rows;
    if (!facts.grid->is_open()) json["wrap"] = wrap_word(*facts.grid);
  } else {
    const auto& [nodes, faces, pieces, border_edges, unit] = *facts.triangles;
    json["grid"] = nullptr;
    json["nodes"] = nodes;
    json["faces"] = faces;
    json["pieces"] = pieces;
    json["borderEdges"] = border_edges;
    json["unit"] = unit;
  }
  if (facts.cache) {
    json["cache"] = {{"file", surface.cache.path},
                     {"samples", facts.cache->samples},
                     {"first", facts.cache->first},
                     {"last", facts.cache->last}};
  }
  for (const MapSummary& map : facts.maps) {
    const auto& own = *std::ranges::find(surface.maps, map.channel, &MaterialMap::channel);
    Json told = {{"channel", map_channel_words[static_cast<std::size_t>(map.channel)]},
                 {"file", own.file.empty() ? Json() : Json(own.file)},
                 {"attribute", own.attribute.empty() ? Json() : Json(own.attribute)},
                 {"least", map.least},
                 {"most", map.most}};
    json["maps"].push_back(std::move(told));
  }
  if (!surface.holds.empty()) json["pinnedNodes"] = facts.held_nodes;
  json["vertices"] = facts.vertex_count;
  json["boundingBox"] = bounds_json(facts.placed);
  json["ownBoundingBox"] = bounds_json(facts.own);
  return json;
}

Json region_json(const RegionPreview& region) {
  Json json;
  if (region.counts.cells > 0) {
    json = region.counts;
  } else {
    json = {{"box", region.region.box}, {"parts", region.region.parts}};
  }
  json["solvable"] = region.is_solvable;
  json["staticPeak"] = region.static_peak;
  if (!region.is_held) {
    json["vibration"] = {{"naturalFrequency", region.first_frequency},
                         {"naturalDampingRatio", region.damping_ratio}};
    return json;
  }
  if (!region.has_vibration) {
    json["vibration"] = nullptr;
    return json;
  }
  // Numbers that are not finite become null.
  json["vibration"] = {{"naturalFrequency", region.first_frequency},
                       {"naturalDampingRatio", region.damping_ratio},
                       {"frequency", region.animated.frequency},
                       {"dampingRatio", region.animated.damping_ratio},
                       {"settlingTime", region.settling.time},
                       {"settlingFrames", region.settling.frames},
                       {"settlingIsCounted", region.settling.is_counted}};
  return json;
}

Json contact_json(const ContactSummary& contact, const SceneFacts& facts) {
  const Collider& collider = facts.scene.colliders[contact.collider];
  const auto at = [](int frame, double value) { return value == 0 ? Json(nullptr) : Json(frame); };
  return {{"name", collider.name},
          {"shape", shape_of(collider)},
          {"surface", facts.scene.surfaces[contact.surface].name},
          {"everyFrame", facts.is_contact_played},
          {"firstTouch", contact.first_touch ? Json(*contact.first_touch) : Json(nullptr)},
          {"mostNodes", contact.most_nodes},
          {"mostNodesFrame", at(contact.most_nodes_frame, contact.most_nodes)},
          {"largestForce", contact.largest_force},
          {"largestForceFrame", at(contact.largest_force_frame, contact.largest_force)},
          {"hidingOffset", contact.hiding_offset ? Json(*contact.hiding_offset) : Json(nullptr)}};
}

Json previews_json(const std::vector<const Preview*>& previews, const Scene& scene) {
  Json json = Json::array();
  for (const Preview* const preview : previews) json.push_back(preview_json(*preview, scene));
  return json;
}

template <int D>
Json keys_json(const Channel<D>& channel, bool is_switch = false) {
  Json json = Json::array();
  for (const auto& key : channel.curve().keys().keys) {
    Json value;
    if constexpr (D == 1) {
      value = is_switch ? Json(key.value[0] != 0) : Json(key.value[0]);
    } else {
      value = key.value;
    }
    json.push_back({{"frame", key.frame}, {"value", value}});
  }
  return json;
}

struct KeysJson {
  Json operator()(const Channel<1>* channel) const { return keys_json(*channel); }
  Json operator()(const Channel<3>* channel) const { return keys_json(*channel); }
  Json operator()(const Switch* channel) const { return keys_json(channel->channel(), true); }
};

}  // namespace

Json preview_json(const Preview& preview, const Scene& scene) {
  Json json = {{"surface", scene.surfaces[preview.surface].name}};
  const bool is_force = preview.of == Preview::Of::Force;
  if (is_force) {
    json["largestMagnitude"] = preview.largest_magnitude;
    json["largestMagnitudeFrame"] = preview.largest_magnitude_frame;
  }
  json["frame"] = preview.frame ? Json(*preview.frame) : Json(nullptr);
  json["everyFrame"] = preview.is_every_frame;
  if (is_force) json["magnitude"] = preview.magnitude;
  json["selected"] = preview.counts.cells > 0 ? Json(preview.counts) : Json(preview.selected);
  if (preview.of == Preview::Of::All) json["apart"] = preview.is_apart;
  json["solvable"] = preview.is_solvable;
  json["staticPeak"] = preview.is_solved ? Json(preview.static_peak) : Json(nullptr);
  json["animation"] = nullptr;
  if (preview.played) {
    json["animation"] = {{"peak", preview.played->peak}, {"frame", preview.played->frame}};
  }
  if (!is_force) {
    json["shares"] = Json::array();
    for (const ForceShare& one : preview.shares) {
      json["shares"].push_back({{"force", scene.forces[one.force].name}, {"share", one.share}});
    }
  }
  json["regions"] = Json::array();
  for (const RegionPreview& region : preview.regions) {
    json["regions"].push_back(region_json(region));
  }
  if (preview.gap) {
    json["gap"] = {{"frame", preview.gap->frame},
                   {"toVertex", preview.gap->to_vertex},
                   {"toCentre", preview.gap->to_centre},
                   {"deformationRadius", preview.gap->deformation_radius}};
  }
  return json;
}

std::string objects_json(const std::string& file, std::span<const FileObject> objects) {
  Json json = {{"format", "pliant-mesh-1"}, {"file", file}, {"objects", Json::array()}};
  for (const FileObject& object : objects) {
    json["objects"].push_back({{"number", json["objects"].size() + 1},
                               {"name", object.name},
                               {"object", object.choice},
                               {"vertices", object.vertices},
                               {"faces", object.faces}});
  }
  return json.dump(2, ' ', true, Json::error_handler_t::replace) + '\n';
}

std::string info_json(const SceneFacts& facts) {
  const Scene& scene = facts.scene;
  Json json = {{"format", "pliant-info-1"}, {"file", facts.file},
               {"start", scene.start},      {"end", scene.end},
               {"fps", scene.fps},          {"seconds", (scene.end - scene.start) / scene.fps}};
  json["surfaces"] = Json::array();
  for (std::size_t k = 0; k < facts.surfaces.size(); ++k) {
    json["surfaces"].push_back(surface_json(scene.surfaces[k], facts.surfaces[k]));
  }
  const auto members = members_of_groups(scene);
  const std::vector<std::string> idle = idle_reasons(facts);
  json["forces"] = Json::array();
  const PreviewLists of_forces = previews_of(facts, Preview::Of::Force);
  for (std::size_t k = 0; k < scene.forces.size(); ++k) {
    const Force& force = scene.forces[k];
    json["forces"].push_back({{"name", force.name},
                              {"kind", kind_of(force)},
                              {"group", force.group.empty() ? Json(nullptr) : Json(force.group)},
                              {"idle", idle[k].empty() ? Json(nullptr) : Json(idle[k])},
                              {"previews", previews_json(of_forces[k], scene)}});
  }
  json["groups"] = Json::array();
  const PreviewLists of_groups = previews_of(facts, Preview::Of::Group);
  for (std::size_t k = 0; k < scene.groups.size(); ++k) {
    Json names = Json::array();
    for (const std::size_t force : members[k]) names.push_back(scene.forces[force].name);
    json["groups"].push_back({{"name", scene.groups[k].name},
                              {"forces", std::move(names)},
                              {"previews", previews_json(of_groups[k], scene)}});
  }
  json["together"] = previews_json(previews_of(facts, Preview::Of::All).front(), scene);
  json["colliders"] = Json::array();
  for (const ContactSummary& contact : facts.contacts)
    json["colliders"].push_back(contact_json(contact, facts));
  json["channels"] = Json::array();
  for (const NamedChannel& channel : channels_of(scene)) {
    if (!channel.is_animated()) continue;
    json["channels"].push_back(
        {{"path", channel.path}, {"keys", std::visit(KeysJson{}, channel.channel)}});
  }
  json["warnings"] = Json::array();
  for (const Warning& warning : facts.warnings) {
    const ScenePlace place = place_of(warning, scene.origin);
    json["warnings"].push_back({{"file", place.file},
                                {"line", place.line > 0 ? Json(place.line) : Json(nullptr)},
                                {"message", place.told(warning.message())}});
  }
  json["memory"] = {{"surfaces", facts.surface_memory}, {"solver", facts.solver_memory}};
  return json.dump(2, ' ', true, Json::error_handler_t::replace) + '\n';
}

}  // namespace pliant::cli
