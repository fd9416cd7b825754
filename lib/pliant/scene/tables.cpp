#include "pliant/scene/tables.hpp"

#include <iterator>
#include <limits>

#include "pliant/mesh/read_assimp.hpp"
#include "pliant/scene/check.hpp"

namespace pliant::xml {
namespace {

Table attributes_of(PointChannels& point) {
  return {channel("center", point.center, "length"), channel("direction", point.direction, "1")};
}

Table attributes_of(RadialChannels& radial) { return {channel("center", radial.center, "length")}; }

Table attributes_of(LineChannels& line) {
  return {channel("from", line.from, "length"), channel("to", line.to, "length"),
          if_absent(channel("direction", line.direction, "1"), "away from the segment")};
}

Table attributes_of(UniformChannels& uniform) {
  return {channel("direction", uniform.direction, "1")};
}

Table attributes_of(VortexChannels& vortex) {
  return {channel("center", vortex.center, "length"), channel("axis", vortex.axis, "1"),
          channel("pull", vortex.pull, "1")};
}

template <class Place>
Attribute seed(Place& place, std::string standard) {
  return custom("seed", "integer", "", std::move(standard), "0 to 18446744073709551615",
                [&place](std::string_view text) -> Reading<void> {
                  const Reading<std::uint64_t> number = parse_natural(text);
                  if (!number) return tl::unexpected(number.error());
                  place = *number;
                  return {};
                });
}

Table attributes_of(NoiseChannels& noise) {
  return {channel("center", noise.center, "length"),
          channel("frequency", noise.frequency, "cells/length"),
          channel("rate", noise.rate, "cells/s"), if_absent(seed(noise.seed, ""), "the scene's")};
}

Table attributes_of(InertiaChannels&) { return {}; }

Table attributes_of(CustomForce&) { return {}; }

/// The format has one version so far; any other is a problem, not read as this one.
Attribute version() {
  return custom("version", "integer", "", "1", "1", [](std::string_view text) -> Reading<void> {
    const Reading<std::int64_t> number = parse_integer(text, 1, std::numeric_limits<int>::max());
    if (!number) return tl::unexpected(number.error());
    if (*number != 1) return tl::unexpected(not_supported() + ", which reads version 1");
    return {};
  });
}

Attribute frame_rate(double& fps) {
  return custom("fps", "rate", "frames/s", "24", "> 0",
                [&fps](std::string_view text) -> Reading<void> {
                  const Reading<double> rate = parse_rate(text);
                  if (!rate) return tl::unexpected(rate.error());
                  fps = *rate;
                  return {};
                });
}

/// Makes a path relative to the scene's folder into one that can be opened.
Attribute mesh_path(std::string& path, const std::filesystem::path& folder) {
  return required(custom("file", "path", "", "", "", [&path, folder](std::string_view text) {
    if (trimmed(text).empty())
      return Reading<void>(tl::unexpected(std::string("is empty; the name of a file is required")));
    path = (folder / text).string();
    return Reading<void>();
  }));
}

Attribute object_name(std::string& object) {
  return custom("object", "text", "", "", "", [&object](std::string_view text) -> Reading<void> {
    if (text.empty())
      return tl::unexpected(
          std::string("is empty; leave the attribute out if the file has only one object"));
    object = text;
    return {};
  });
}

}  // namespace

Table attributes_of(Scene& scene) {
  return {
      version(),
      frame_rate(scene.fps),
      required(integer("start", scene.start, "frame", -largest_frame, largest_frame)),
      required(integer("end", scene.end, "frame", -largest_frame, largest_frame)),
      seed(scene.seed, "0"),
  };
}

Table attributes_of(Surface& surface) {
  return {name_of(surface.name), boolean("enabled", surface.enabled)};
}

Table attributes_of(GridSheet& grid) {
  return {
      required(integer("columns", grid.columns, "vertices", 3, max_sheet_vertices)),
      required(integer("rows", grid.rows, "vertices", 3, max_sheet_vertices)),
      number("width", grid.width, "length", positive),
      number("depth", grid.depth, "length", positive),
      choice("faces", grid.triangles, {{"quads", false}, {"triangles", true}}),
  };
}

Table attributes_of(MeshFile& mesh, const std::filesystem::path& folder) {
  return {
      mesh_path(mesh.path, folder),
      if_absent(object_name(mesh.object), "the only one"),
      integer("uvSet", mesh.uv_set, "", 0, max_uv_sets - 1),
      fixed("uv", "grid", {"virtual"}),
      later("resolution"),
      fixed("wrap", "none", {"u", "v", "uv"}),
  };
}

Table attributes_of(TransformChannels& transform) {
  return {
      channel("translate", transform.translate, "length"),
      channel("rotate", transform.rotate, "degrees"),
      channel("scale", transform.scale, "1", not_zero),
      choice("rotateOrder", transform.rotate_order,
             {{"xyz", RotateOrder::Xyz},
              {"xzy", RotateOrder::Xzy},
              {"yxz", RotateOrder::Yxz},
              {"yzx", RotateOrder::Yzx},
              {"zxy", RotateOrder::Zxy},
              {"zyx", RotateOrder::Zyx}}),
  };
}

Table attributes_of(MaterialChannels& material) {
  return {
      channel("density", material.density, "s²/uv⁴", not_negative),
      channel("damping", material.damping, "s/uv⁴", not_negative),
      channel("b", material.b, "1", positive),
      channel("c", material.c, "1"),
      channel("d", material.d, "1", positive),
      later("yield"),
      later("hardening"),
      later("poisson"),
  };
}

Table attributes_of(TangentChannels& tangents) {
  return {
      channel("su0", tangents.su0, "length/uv"),
      channel("su1", tangents.su1, "length/uv"),
      channel("sv0", tangents.sv0, "length/uv"),
      channel("sv1", tangents.sv1, "length/uv"),
  };
}

Table attributes_of(SolverSettings& solver) {
  return {
      channel("dt", solver.dt, "s", positive),
      if_absent(integer("startFrame", solver.start_frame, "frame", -largest_frame, largest_frame),
                "the scene's start"),
      choice("stepping", solver.stepping,
             {{"exact", Stepping::Exact}, {"overshoot", Stepping::Overshoot}}),
      choice("reference", solver.reference, {{"rest", Reference::Rest}, {"none", Reference::None}}),
      choice("combine", solver.combine,
             {{"box", Combine::Box}, {"islands", Combine::Islands}, {"union", Combine::Union}}),
      choice("release", solver.release,
             {{"freeze", Release::Freeze}, {"recover", Release::Recover}}),
      choice("measure", solver.measure, {{"current", Measure::Current}, {"rest", Measure::Rest}}),
      fixed("integrator", "backwardEuler", {"newmark", "exact"}),
      fixed("region", "forces", {"all"}),
  };
}

Table attributes_of(Force& force) {
  Table table = {
      name_of(force.name),
      channel("enabled", force.enabled),
      if_absent(names("targets", force.targets), "all surfaces"),
      channel("magnitude", force.magnitude, "length/uv⁴"),
      channel("deformationRadius", force.deformation_radius, "length", not_negative),
      channel("forceRadius", force.force_radius, "length", not_negative),
      choice("falloff", force.falloff,
             {{"constant", Falloff::Constant},
              {"linear", Falloff::Linear},
              {"smooth", Falloff::Smooth},
              {"gaussian", Falloff::Gaussian}}),
  };
  Table own = std::visit([](auto& shape) { return attributes_of(shape); }, force.shape);
  table.insert(table.end(), std::make_move_iterator(own.begin()),
               std::make_move_iterator(own.end()));
  return table;
}

Table attributes_of(Group& group) {
  return {
      name_of(group.name),
      channel("enabled", group.enabled),
      if_absent(names("targets", group.targets), "all surfaces"),
      channel("center", group.center, "length"),
      channel("deformationRadius", group.deformation_radius, "length", not_negative),
  };
}

Table attributes_of(PathText& path) {
  return {
      required(custom("attribute", "word", "", "", "a position of its element",
                      [](std::string_view) { return Reading<void>(); })),
      channel("progress", path.progress, "1", a_share),
      boolean("closed", path.is_closed),
  };
}

Table attributes_of(Waypoint& waypoint) {
  return {required(custom("at", "vector", "length", "", "", [&waypoint](std::string_view text) {
    return parse_numbers(text, waypoint.at);
  }))};
}

}  // namespace pliant::xml
