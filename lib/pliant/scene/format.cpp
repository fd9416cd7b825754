#include "pliant/scene/format.hpp"

#include <utility>

#include "pliant/scene/key_text.hpp"
#include "pliant/scene/tables.hpp"

namespace pliant {

using namespace xml;

namespace {

/// The formats of a table's rows. The table's places need not live any longer.
std::vector<AttributeFormat> formats_of(const Table& table) {
  std::vector<AttributeFormat> formats;
  for (const Attribute& row : table) formats.push_back(row.format);
  return formats;
}

template <class Part>
ElementFormat element(std::string_view name, std::vector<std::string_view> parents, Need need,
                      Part part) {
  return {name, std::move(parents), need, formats_of(attributes_of(part))};
}

template <class Part>
ElementFormat key_element(std::string_view name, std::vector<std::string_view> parents, Need need) {
  Part part;
  return {name, std::move(parents), need, formats_of(attributes_of(part, ValueKind::Number))};
}

ElementFormat force(std::string_view name, decltype(Force::shape) shape) {
  Force force;
  force.shape = std::move(shape);
  return element(name, {"scene"}, Need::Optional, std::move(force));
}

ElementFormat later_element(std::string_view name, std::vector<std::string_view> parents) {
  return {name, std::move(parents), Need::Later, {}};
}

}  // namespace

std::vector<ElementFormat> scene_format() {
  MeshFile mesh;
  return {
      element("scene", {}, Need::Required, Scene{}),
      element("surface", {"scene"}, Need::Optional, Surface{}),
      element("grid", {"surface"}, Need::Optional, GridSheet{}),
      {"mesh", {"surface"}, Need::Optional, formats_of(attributes_of(mesh, {}))},
      later_element("nurbs", {"surface"}),
      later_element("subdivision", {"surface"}),
      element("transform", {"surface"}, Need::Optional, TransformChannels{}),
      element("material", {"surface"}, Need::Optional, MaterialChannels{}),
      element("tangents", {"surface"}, Need::Optional, TangentChannels{}),
      element("solver", {"surface"}, Need::Optional, SolverSettings{}),
      force("point", PointChannels{}),
      force("radial", RadialChannels{}),
      force("line", LineChannels{}),
      later_element("uniform", {"scene"}),
      later_element("vortex", {"scene"}),
      later_element("noise", {"scene"}),
      later_element("inertia", {"scene"}),
      later_element("group", {"scene"}),
      later_element("falloff", {"point", "radial", "line"}),
      key_element<AnimateText<1>>(
          "animate",
          {"surface", "transform", "material", "tangents", "solver", "point", "radial", "line"},
          Need::Optional),
      key_element<KeyText<1>>("key", {"animate"}, Need::Required),
      key_element<Loop<1>>("loop", {"animate"}, Need::Optional),
  };
}

}  // namespace pliant
