#pragma once

#include <cstddef>
#include <string_view>
#include <utility>

#include "pliant/scene/format/shape_description.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// The words of choices, in the order of their values.

inline constexpr std::string_view rotate_order_words[] = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};
inline constexpr std::string_view stepping_words[] = {"exact", "overshoot"};
inline constexpr std::string_view reference_words[] = {"rest", "none"};
inline constexpr std::string_view combine_words[] = {"box", "islands", "union"};
inline constexpr std::string_view release_words[] = {"freeze", "recover"};
inline constexpr std::string_view measure_words[] = {"current", "rest"};

inline constexpr std::string_view integrator_words[] = {"backwardEuler", "newmark", "exact"};
inline constexpr std::string_view region_words[] = {"forces", "all"};
inline constexpr std::string_view map_channel_words[] = {"density", "damping", "b",         "c",
                                                         "d",       "yield",   "hardening", "goal"};

// What an element says that is stored in several members of a thing; `Of` is the thing, const or
// not.

/// The shape of a surface.
template <class Of>
struct ShapeOf {
  Of& surface;
};

/// The material of a surface with its maps.
template <class Of>
struct MaterialOf {
  Of& surface;
};

template <>
struct Description<Surface> {
  static constexpr std::string_view element = "surface";
  static constexpr std::string_view meaning =
      "An elastic surface: one shape, at most one each of transform, material, tangents and "
      "solver, "
      "and any number of holds.";
  static constexpr bool may_include = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(name_attribute("name for channels, targets and files"), of.name...);
    row(Attribute{.name = "enabled", .meaning = "`false`: written at rest, not solved"},
        of.enabled...);
    row(Attribute{.name = "drivenBy",
                  .meaning =
                      "the surface that it follows; it has only a shape and a transform then",
                  .absent = "none: it is solved itself",
                  .syntax = Syntax::Surface},
        of.driven_by...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& surface) {
    child(Child{.least = 1, .noun = "shape", .is_of_driven = true}, ShapeOf<Of>{surface});
    child(Child{.is_of_driven = true}, surface.transform);
    child(Child{}, MaterialOf<Of>{surface});
    child(Child{}, surface.tangents);
    child(Child{.most = unlimited}, surface.holds);
    child(Child{}, surface.solver);
  }
};

template <>
struct Description<TransformChannels> {
  static constexpr std::string_view element = "transform";
  static constexpr std::string_view meaning = "Where the surface or collider is.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "translate", .meaning = "position of the surface", .unit = "length"},
        of.translate...);
    row(Attribute{.name = "rotate", .meaning = "rotation about x, y and z", .unit = "degrees"},
        of.rotate...);
    row(
        Attribute{
            .name = "scale", .meaning = "scale along x, y and z", .unit = "1", .range = not_zero},
        of.scale...);
    row(Attribute{.name = "rotateOrder",
                  .meaning = "order of the rotations; `xyz` rotates about x first",
                  .words = rotate_order_words},
        of.rotate_order...);
  }
};

template <>
struct Description<MaterialChannels> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "density",
                  .meaning = "ρ: inertia; more makes the surface slower",
                  .unit = "s²/uv⁴",
                  .range = not_negative},
        of.density...);
    row(Attribute{.name = "damping",
                  .meaning = "η: how fast its motion decays",
                  .unit = "s/uv⁴",
                  .range = not_negative},
        of.damping...);
    row(Attribute{.name = "b", .meaning = "stiffness along u", .unit = "1", .range = positive},
        of.b...);
    row(Attribute{.name = "c", .meaning = "mixed stiffness; always > −2√(bd)", .unit = "1"},
        of.c...);
    row(Attribute{.name = "d", .meaning = "stiffness along v", .unit = "1", .range = positive},
        of.d...);
    row(Attribute{.name = "dampingRatio",
                  .meaning = "ζ: the damping ratio of the slowest vibration of each region that is "
                             "solved, in place of `damping`, see below",
                  .unit = "1",
                  .range = not_negative,
                  .absent = "damping counts"},
        of.damping_ratio...);
    row(Attribute{.name = "yield",
                  .meaning = "Y: the stress from which on the surface bends for good, see below",
                  .unit = "length/uv²",
                  .range = positive,
                  .absent = "none: it is elastic"},
        of.yield...);
    row(Attribute{.name = "hardening",
                  .meaning =
                      "H: how much harder it is to bend further what was bent for good; only "
                      "with `yield`",
                  .unit = "1",
                  .range = not_negative},
        of.hardening...);
    row(Attribute{.name = "poisson",
                  .meaning =
                      "ν: how much bending along one direction bends the other; acts with "
                      "a free border or edge, a map of b, c or d, or `yield`, and must be between "
                      "−1 and 1 there",
                  .unit = "1"},
        of.poisson...);
    row(Attribute{.name = "goal",
                  .meaning = "g: how strongly each node is pulled back to rest, whatever its "
                             "neighbours do, see below",
                  .unit = "1/uv⁴",
                  .range = not_negative},
        of.goal...);
  }
};

template <class Of>
struct Description<MaterialOf<Of>> {
  static constexpr std::string_view element = "material";
  static constexpr std::string_view meaning = "How the surface resists, moves and fades.";
  static constexpr bool may_include = true;

  template <class Row, class... Each>
  static void rows(Row&& row, Each&... each) {
    describe(row, each.surface.material...);
  }

  template <class Visit>
  static void children(Visit&& child, const MaterialOf<Of>& of) {
    child(Child{.most = unlimited, .unique_by = "channel"}, of.surface.maps);
  }
};

/// A map among the parts of its surface, as their places are named: `map.b`.
std::string name_of(MapChannel channel);

template <>
struct Description<MaterialMap> {
  static constexpr std::string_view element = "map";
  static constexpr std::string_view meaning =
      "A channel of the material that differs over the surface.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "channel",
                  .meaning = "the channel of the material that it multiplies; one map a channel",
                  .words = map_channel_words,
                  .need = Need::Required},
        of.channel...);
    row(Attribute{.name = "file",
                  .meaning = "picture (`.png`) or numbers of a grid's nodes (`.npy`), relative to "
                             "the scene file",
                  .absent = "none: an attribute",
                  .syntax = Syntax::Path},
        of.file...);
    row(Attribute{.name = "attribute",
                  .meaning = "vertex property of a `.ply`, or `_NAME` of a glTF, in place of a "
                             "file",
                  .absent = "none: a file"},
        of.attribute...);
    row(Attribute{.name = "low", .meaning = "the factor where the map is 0, or black", .unit = "1"},
        of.low...);
    row(
        Attribute{
            .name = "high", .meaning = "the factor where the map is 1, or white", .unit = "1"},
        of.high...);
  }
};

template <>
struct Description<Hold> {
  static constexpr std::string_view element = "hold";
  static constexpr std::string_view meaning =
      "Nodes that stay where they are; several add up. Their slopes are free.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "file",
                  .meaning = "picture (`.png`) or numbers of a grid's nodes (`.npy`), as of a map, "
                             "relative to the scene file",
                  .absent = "none: an attribute, or vertices",
                  .syntax = Syntax::Path},
        of.file...);
    row(Attribute{.name = "attribute",
                  .meaning = "vertex property of a `.ply`, or `_NAME` of a glTF",
                  .absent = "none: a file, or vertices"},
        of.attribute...);
    row(Attribute{.name = "above",
                  .meaning = "nodes are held where the value of the file or attribute is greater",
                  .unit = "1"},
        of.above...);
    row(Attribute{.name = "vertices",
                  .meaning = "in place of a file or attribute: the vertices whose nodes are held, "
                             "counted from 0 in every format; of a net its points, of a cage its "
                             "vertices",
                  .range = {.least = 0},
                  .absent = "none: a file, or an attribute"},
        of.vertices...);
  }
};

/// The name of a hold among the parts of its surface, counted from 0: `hold.0`.
std::string name_of_hold(std::size_t number);

/// The unit of boundary tangents.
inline constexpr std::string_view edge_slope = "length/uv";

template <>
struct Description<TangentChannels> {
  static constexpr std::string_view element = "tangents";
  static constexpr std::string_view meaning =
      "The slopes of the surface on the edges of its region.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "su0", .meaning = "∂/∂u on the edge of smallest u", .unit = edge_slope},
        of.su0...);
    row(Attribute{.name = "su1", .meaning = "∂/∂u on the edge of largest u", .unit = edge_slope},
        of.su1...);
    row(Attribute{.name = "sv0", .meaning = "∂/∂v on the edge of smallest v", .unit = edge_slope},
        of.sv0...);
    row(Attribute{.name = "sv1", .meaning = "∂/∂v on the edge of largest v", .unit = edge_slope},
        of.sv1...);
  }
};

template <>
struct Description<SolverSettings> {
  static constexpr std::string_view element = "solver";
  static constexpr std::string_view meaning = "How the surface is solved.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "dt",
                  .meaning = "longest time step; a frame may have at most 10⁵ steps",
                  .unit = "s",
                  .range = positive},
        of.dt...);
    row(Attribute{.name = "timeScale",
                  .meaning = "speed of the surface's own time: a frame lasts timeScale / fps "
                             "seconds for it; 0 halts it. The forces keep the scene's time",
                  .unit = "1",
                  .range = {.least = 0, .most = 1000}},
        of.time_scale...);
    row(Attribute{.name = "startFrame",
                  .meaning = "the surface is at rest up to this frame; one before the scene's "
                             "start counts as the start",
                  .unit = "frame",
                  .range = frame_range,
                  .absent = "the scene's start"},
        of.start_frame...);
    row(Attribute{.name = "stepping",
                  .meaning = "`exact`: steps divide a frame evenly; `overshoot`: the loop of the "
                             "2005 listing",
                  .words = stepping_words},
        of.stepping...);
    row(Attribute{.name = "reference",
                  .meaning = "`rest`: elastic about the rest shape; `none`: the 2005 equation to "
                             "the letter",
                  .words = reference_words},
        of.reference...);
    row(Attribute{.name = "combine",
                  .meaning = "how the selections of several forces are combined, see below",
                  .words = combine_words},
        of.combine...);
    row(Attribute{.name = "release",
                  .meaning = "vertices that leave the region stay where they are, or are solved "
                             "until they are back at rest, see below",
                  .words = release_words},
        of.release...);
    row(Attribute{.name = "measure",
                  .meaning = "measures distances to the moving mesh, or to the mesh at rest",
                  .words = measure_words,
                  .absent = "current; rest on a surface"},
        of.measure...);
    row(Attribute{.name = "integrator",
                  .meaning =
                      "`backwardEuler`: of first order in dt, damps; `newmark`: the "
                      "trapezoidal rule, of second order, keeps energy; `exact`: the solution "
                      "itself, whatever dt is, see below",
                  .words = integrator_words},
        of.integrator...);
    row(Attribute{.name = "region",
                  .meaning = "`forces`: only the selections of forces are solved; `all`: the whole "
                             "surface in every frame, see below",
                  .words = region_words},
        of.region...);
    row(Attribute{.name = "edges",
                  .meaning = "what holds the edges u0, u1, v0 and v1 of a grid: place and slope, "
                             "place only, or nothing; only with `region=\"all\"`, see below",
                  .words = border_words},
        of.edges...);
    row(Attribute{.name = "preroll",
                  .meaning = "frames that are solved ahead of the surface's start, with the "
                             "channels' values there; they are not written",
                  .unit = "frame",
                  .range = {.least = 0, .most = max_preroll}},
        of.preroll...);
    row(Attribute{.name = "loop",
                  .meaning = "the surface moves in a cycle of so many frames from its start on, "
                             "see below",
                  .unit = "frame",
                  .range = {.least = 1, .most = max_loop},
                  .absent = "none"},
        of.loop...);
  }
};

}  // namespace pliant
