#include "pliant/scene/format/format.hpp"

#include <algorithm>
#include <utility>
#include <variant>

#include "pliant/scene/reading/key_text.hpp"
#include "pliant/scene/reading/net.hpp"
#include "pliant/scene/reading/path.hpp"
#include "pliant/scene/reading/read_elements.hpp"
#include "pliant/scene/text/expand.hpp"

namespace pliant {

using namespace xml;

namespace {

/// The formats of a table's rows. They do not refer to the table's places.
std::vector<AttributeFormat> formats_of(const Table& table) {
  std::vector<AttributeFormat> formats;
  for (const Slot& row : table) formats.push_back(format_of(row));
  return formats;
}

template <class Part>
ElementFormat element(std::vector<std::string_view> parents, Need need = Need::Optional) {
  Part part;
  return {Description<Part>::element, std::move(parents), need, formats_of(table_of(part))};
}

template <class Part>
ElementFormat key_element(std::string_view name, std::vector<std::string_view> parents, Need need,
                          KeyAxis axis) {
  Part part;
  return {name, std::move(parents), need, formats_of(table_of(part, axis, ValueKind::Number))};
}

/// <key> is placed by `frame` in an <animate>, by `at` in a <falloff>.
ElementFormat key() {
  ElementFormat format =
      key_element<KeyText<1>>("key", {"animate", "falloff"}, Need::Required, KeyAxis::Frame);
  KeyText<1> part;
  const Table table = table_of(part, KeyAxis::Falloff, ValueKind::Number);
  format.attributes.insert(format.attributes.begin() + 1, format_of(table.front()));
  return format;
}

std::vector<std::string_view> with_groups(std::vector<std::string_view> parents) {
  parents.emplace_back("group");
  return parents;
}

ElementFormat sheet_element() {
  GridSheet sheet;
  CacheFile cache;
  return {Description<GridSheet>::element,
          {"surface"},
          Need::Optional,
          formats_of(table_of(sheet, cache))};
}

ElementFormat mesh_element() {
  MeshFile mesh;
  MeshReading reading;
  CacheFile cache;
  return {Description<MeshFile>::element,
          {"surface"},
          Need::Optional,
          formats_of(table_of(mesh, reading, cache))};
}

ElementFormat cage_element() {
  MeshFile mesh;
  MeshReading reading;
  CacheFile cache;
  Subdivision subdivision;
  return {Description<Subdivision>::element,
          {"surface"},
          Need::Optional,
          formats_of(table_of(mesh, reading, cache, subdivision))};
}

/// An element of a <nurbs> that contains numbers.
ElementFormat numbers_element(std::string_view name, Need need, std::string_view text) {
  return {.name = name, .parents = {"nurbs"}, .need = need, .attributes = {}, .text = text};
}

}  // namespace

std::vector<ElementFormat> scene_format() {
  Loop<1> loop;
  std::vector<std::string_view> forces, positioned;
  std::vector<ElementFormat> force_formats;
  for (Force& force : force_kinds()) {
    const std::string_view kind = kind_of(force);
    const Table table = table_of(force);
    forces.push_back(kind);
    if (std::any_of(table.begin(), table.end(), [](const Slot& row) {
          return std::holds_alternative<PositionChannel*>(row.place);
        }))
      positioned.push_back(kind);
    force_formats.push_back({kind, {"scene", "group"}, Need::Optional, formats_of(table)});
  }
  std::vector<std::string_view> animated = {"surface", "transform", "material", "tangents",
                                            "solver"};
  animated.insert(animated.end(), forces.begin(), forces.end());
  animated.emplace_back("path");

  ElementFormat knots = element<KnotsText>({"nurbs"});
  knots.text = "columns + degreeU + 1 numbers that never fall; along v likewise";

  std::vector<std::string_view> defining = including_elements();
  defining.emplace_back(Description<IncludeText>::element);

  std::vector<ElementFormat> formats = {
      element<Scene>({}, Need::Required),
      element<Surface>({"scene"}),
      sheet_element(),
      mesh_element(),
      element<NurbsNet>({"surface"}),
      numbers_element("points", Need::Required, "`x y z` of each control point, along u first"),
      numbers_element("weights", Need::Optional, "one number above 0 for each control point"),
      knots,
      cage_element(),
      element<TransformChannels>({"surface"}),
      element<MaterialChannels>({"surface"}),
      element<MaterialMap>({"material"}),
      element<TangentChannels>({"surface"}),
      element<SolverSettings>({"surface"}),
      element<Group>({"scene"}),
      element<PathText>(with_groups(positioned)),
      element<Waypoint>({"path"}, Need::Required),
      key_element<AnimateText<1>>("falloff", forces, Need::Optional, KeyAxis::Falloff),
      key_element<AnimateText<1>>("animate", with_groups(animated), Need::Optional, KeyAxis::Frame),
      key(),
      {"loop", {"animate"}, Need::Optional, formats_of(table_of(loop, ValueKind::Number))},
      element<IncludeText>(including_elements()),
      element<DefineText>(std::move(defining)),
  };
  formats.insert(formats.end(), force_formats.begin(), force_formats.end());
  return formats;
}

}  // namespace pliant
