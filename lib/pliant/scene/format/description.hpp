#pragma once

#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>

#include "pliant/files/boxed/read_assimp.hpp"
#include "pliant/forces/force.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// The scene format, described once: a row for each attribute of each thing that a scene contains.
// Reading, checking, sampling, lists of channels, state keys, JSON and the tables of
// docs/scene-format.md are made from these rows. A new attribute is a member in scene.hpp and a row
// here; a new kind of force is a struct there and a `Description` here.

/// The most frames that a scene may have.
inline constexpr int max_frames = 1'000'000;

/// The largest absolute value of a frame number.
inline constexpr int largest_frame = 1'000'000'000;

/// The most frames of a preroll, and of a cycle.
inline constexpr int max_preroll = 100'000;
inline constexpr int max_loop = 100'000;

/// The most vertices that a grid sheet may have.
inline constexpr int max_sheet_vertices = 100'000'000;

/// The largest width or depth of a grid sheet [length]; it keeps products of coordinates and counts
/// finite.
inline constexpr double largest_extent = 1e300;

/// Whether an attribute or element is optional, required or not supported.
enum class Need {
  Optional,
  Required,
  Later,  ///< known to the format, not supported by this version
};

/// The numbers that an attribute accepts; of a vector, each component.
struct Range {
  double least = -std::numeric_limits<double>::infinity();
  double most = std::numeric_limits<double>::infinity();
  bool excludes_least = false;
  bool excludes_zero = false;

  /// The rule that a number breaks, such as "must be greater than 0"; null: none. Not a number
  /// breaks none.
  std::optional<std::string> broken_rule(std::span<const double> numbers) const;

  std::string to_text() const;  ///< `> 0`, `≥ 0`, `0 to 1`, `≠ 0`; empty: any finite number
};

inline constexpr Range any_number{};
inline constexpr Range positive{.least = 0, .excludes_least = true};
inline constexpr Range not_negative{.least = 0};
inline constexpr Range a_share{.least = 0, .most = 1};
inline constexpr Range not_zero{.excludes_zero = true};

/// How a text is written, if its member does not tell.
enum class Syntax {
  Plain,     ///< as its member
  Name,      ///< a letter or _, then letters, digits, _ and -
  Path,      ///< of a file, relative to the scene's folder
  Rate,      ///< a number, or a fraction of two
  Version,   ///< of the format: 1
  Position,  ///< the name of a position of the element around it
};

/// A row: one attribute of a thing.
struct Attribute {
  std::string_view name = {};
  std::string_view meaning = {};  ///< for people, in Markdown
  std::string_view unit = {};
  Range range = {};
  std::span<const std::string_view> words = {};  ///< of a word, in the order of its values
  std::span<const std::string_view> later = {};  ///< words that a later version will support
  std::string_view instead = {};                 ///< what to use instead of what is not supported
  std::string_view absent = {};                  ///< what its absence means, if that is not a value
  Need need = Need::Optional;
  Syntax syntax = Syntax::Plain;
};

/// The text in an element: numbers.
struct Numbers {
  std::string_view meaning;  ///< for people
  Range range = {};
  std::size_t together = 0;  ///< so many stand on a line; 0: all
};

inline constexpr int unlimited = std::numeric_limits<int>::max();

/// A row of the elements that a thing contains: how often they stand in it.
struct Child {
  int least = 0;
  int most = 1;
  /// The attribute in which several differ; empty: none.
  std::string_view unique_by = {};
  /// What several kinds are called of which one stands there; empty: it is one kind.
  std::string_view noun = {};
  bool is_of_driven = false;  ///< a driven surface has it too
};

/// The rows of T, a struct of scene.hpp: `rows(row, things...)` calls `row(attribute, members...)`
/// for each of them, with the member of each thing; `row(attribute)` if it is no member. Members
/// that are channels may be animated.
///
/// Of an element also its name, what it is, for people, and with `children(child, thing)` the
/// elements in it, in the order in which they are written: `child(row, member)` for each, a thing
/// that has a description, a list of such things, or a `Kinds` of things (contents.hpp).
template <class T>
struct Description;

/// Calls `row(attribute, member)` for each row of a thing.
template <class Row, class T, class... Others>
void describe(Row&& row, T& thing, Others&... others) {
  Description<std::remove_const_t<T>>::rows(row, thing, others...);
}

/// The share of a path's length, `progress` of a <path>.
inline constexpr Attribute progress_attribute{
    .name = "progress",
    .meaning = "position along the path, as a share of its length",
    .unit = "1",
    .range = a_share};

/// Calls `visit(part)` for a thing and each of its parts: elements that are always there, but for
/// those that a driven surface has not.
template <class T, class Visit>
void for_each_part(T& thing, Visit&& visit);

/// Calls `visit(name, attribute, channel)` for each channel of a thing, a `Channel<1>`,
/// `Channel<3>` or `Switch`; for a position on a path with the name `NAME.progress`.
template <class T, class Visit>
void for_each_channel(T& thing, Visit&& visit);

// The words of choices, in the order of their values.
inline constexpr std::string_view face_words[] = {"quads", "triangles"};
inline constexpr std::string_view rotate_order_words[] = {"xyz", "xzy", "yxz", "yzx", "zxy", "zyx"};
inline constexpr std::string_view stepping_words[] = {"exact", "overshoot"};
inline constexpr std::string_view reference_words[] = {"rest", "none"};
inline constexpr std::string_view combine_words[] = {"box", "islands", "union"};
inline constexpr std::string_view release_words[] = {"freeze", "recover"};
inline constexpr std::string_view measure_words[] = {"current", "rest"};
inline constexpr std::string_view wrap_words[] = {"none", "u", "v", "uv"};
inline constexpr std::string_view falloff_words[] = {"constant", "linear", "smooth", "gaussian"};

inline constexpr std::string_view uv_words[] = {"auto", "grid", "surface"};
inline constexpr std::string_view later_uv_words[] = {"virtual"};
inline constexpr std::string_view use_surface = "uv=\"surface\" solves on the mesh's own triangles";
inline constexpr std::string_view scheme_words[] = {"catmullClark", "loop"};
inline constexpr std::string_view border_words[] = {"clamped", "pinned", "free"};

inline constexpr std::string_view integrator_words[] = {"backwardEuler", "newmark", "exact"};
inline constexpr std::string_view region_words[] = {"forces", "all"};
inline constexpr std::string_view map_channel_words[] = {"density", "damping", "b",        "c",
                                                         "d",       "yield",   "hardening"};

inline constexpr Range frame_range{.least = -largest_frame, .most = largest_frame};

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

/// The forces of a scene that are in no group, and its groups, in the order of its file.
template <class Of>
struct ActingIn {
  Of& scene;
};

/// A group of a scene.
template <class Of>
struct GroupIn {
  Of& scene;
  std::size_t index;  ///< in scene.groups
  std::size_t first;  ///< of its forces, in scene.forces
};

/// The forces in a group of a scene.
template <class Of>
struct MembersOf {
  Of& scene;
  std::size_t group;
  std::size_t first;
};

template <>
struct Description<Scene> {
  static constexpr std::string_view element = "scene";
  static constexpr std::string_view meaning =
      "A scene: surfaces, the forces on them, and the frames of the animation.";
  static constexpr bool may_include = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{
        .name = "version", .meaning = "version of the format", .syntax = Syntax::Version});
    row(Attribute{.name = "fps",
                  .meaning = "frames in a second: a number or a fraction such as `24000/1001`",
                  .unit = "frames/s",
                  .range = positive,
                  .syntax = Syntax::Rate},
        of.fps...);
    row(Attribute{.name = "start",
                  .meaning = "first frame",
                  .unit = "frame",
                  .range = frame_range,
                  .need = Need::Required},
        of.start...);
    row(Attribute{.name = "end",
                  .meaning = "last frame: not before `start`, and at most 10⁶ frames in all",
                  .unit = "frame",
                  .range = frame_range,
                  .need = Need::Required},
        of.end...);
    row(Attribute{.name = "seed", .meaning = "seed of the noise forces"}, of.seed...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& scene) {
    child(Child{.most = unlimited}, scene.surfaces);
    child(Child{.most = unlimited}, ActingIn<Of>{scene});
  }
};

/// The name of a surface, force or group.
constexpr Attribute name_attribute(std::string_view meaning) {
  return {.name = "name", .meaning = meaning, .need = Need::Required, .syntax = Syntax::Name};
}

template <>
struct Description<Surface> {
  static constexpr std::string_view element = "surface";
  static constexpr std::string_view meaning =
      "An elastic surface: one shape, and at most one each of transform, material, tangents and "
      "solver.";
  static constexpr bool may_include = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(name_attribute("name for channels, targets and files"), of.name...);
    row(Attribute{.name = "enabled", .meaning = "`false`: written at rest, not solved"},
        of.enabled...);
    row(Attribute{.name = "drivenBy",
                  .meaning =
                      "the surface that it follows; it has only a shape and a transform then",
                  .absent = "none: it is solved itself"},
        of.driven_by...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& surface) {
    child(Child{.least = 1, .noun = "shape", .is_of_driven = true}, ShapeOf<Of>{surface});
    child(Child{.is_of_driven = true}, surface.transform);
    child(Child{}, MaterialOf<Of>{surface});
    child(Child{}, surface.tangents);
    child(Child{}, surface.solver);
  }
};

template <>
struct Description<GridSheet> {
  static constexpr Range count{.least = 3, .most = max_sheet_vertices};
  static constexpr Range extent{.least = 0, .most = largest_extent, .excludes_least = true};

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "columns",
                  .meaning = "vertices along u",
                  .unit = "vertices",
                  .range = count,
                  .need = Need::Required},
        of.columns...);
    row(Attribute{.name = "rows",
                  .meaning = "vertices along v; columns times rows at most 10⁸",
                  .unit = "vertices",
                  .range = count,
                  .need = Need::Required},
        of.rows...);
    row(Attribute{.name = "width", .meaning = "extent along x", .unit = "length", .range = extent},
        of.width...);
    row(Attribute{.name = "depth", .meaning = "extent along z", .unit = "length", .range = extent},
        of.depth...);
    row(Attribute{.name = "faces",
                  .meaning = "quads, or each quad split into two triangles",
                  .words = face_words},
        of.triangles...);
  }
};

template <>
struct Description<MeshFile> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "file",
                  .meaning = "the mesh, relative to the scene file; files that it refers to must "
                             "be in the scene's folder or below",
                  .need = Need::Required,
                  .syntax = Syntax::Path},
        of.path...);
    row(Attribute{.name = "object",
                  .meaning = "the object, if the file contains several",
                  .absent = "the only one"},
        of.object...);
    row(Attribute{.name = "uvSet",
                  .meaning = "the set of UVs to read, if the file contains several",
                  .range = {.least = 0, .most = max_uv_sets - 1}},
        of.uv_set...);
  }
};

/// The attributes of a sheet or a mesh that animate its shape.
template <>
struct Description<CacheFile> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "cache",
                  .meaning = "the shape at rest over time, .pc2, .mdd or .npy, relative to the "
                             "scene file; its vertices are those of the shape",
                  .absent = "none: it stays the same",
                  .syntax = Syntax::Path},
        of.path...);
    row(Attribute{.name = "cacheStart",
                  .meaning = "frame of the cache's first sample",
                  .unit = "frame",
                  .absent = "that of a .pc2; otherwise the scene's start"},
        of.first...);
  }
};

/// The attributes of a mesh, from a file or of a program, that say how it is read.
template <>
struct Description<MeshReading> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "wrap",
                  .meaning = "the closed directions: their first and last column (row) are one",
                  .words = wrap_words},
        of.wrap...);
    row(Attribute{.name = "uv",
                  .meaning = "`grid`: the UVs, which form an even grid; `surface`: lengths along "
                             "the surface of any mesh; `auto`: the grid if there is one",
                  .words = uv_words,
                  .later = later_uv_words,
                  .instead = use_surface},
        of.uv...);
    row(Attribute{.name = "resolution", .instead = use_surface, .need = Need::Later});
    row(Attribute{.name = "unit",
                  .meaning = "length that counts as 1 in u and v, or two of them, along u and v; "
                             "only of a surface",
                  .unit = "length/uv",
                  .range = positive,
                  .absent = "the root of its area"},
        of.unit...);
    row(Attribute{.name = "axis",
                  .meaning = "direction that u follows along the surface, in the mesh's own "
                             "coordinates; only of a surface",
                  .unit = "1",
                  .absent = "that of the UVs, or x"},
        of.axis...);
    row(Attribute{.name = "border",
                  .meaning = "what the mesh's own border does; only of a surface",
                  .words = border_words,
                  .absent = "clamped"},
        of.border...);
    row(Attribute{.name = "weld",
                  .meaning = "vertices that are not farther apart move together; only of a surface",
                  .unit = "length",
                  .range = not_negative,
                  .absent = "10⁻⁶ of the mesh's diagonal"},
        of.weld...);
  }
};

/// What a <subdivision> has besides the attributes of a mesh.
template <>
struct Description<Subdivision> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "levels",
                  .meaning = "how many times the cage is refined",
                  .range = {.least = 0, .most = Subdivision::most_levels}},
        of.levels...);
    row(Attribute{.name = "scheme",
                  .meaning = "rule of subdivision: `catmullClark` for all faces, `loop` for "
                             "triangles",
                  .words = scheme_words},
        of.scheme...);
  }
};

/// A net but for `wrap`, which is in both of its directions, and its numbers.
template <>
struct Description<NurbsNet> {
  static constexpr Range count{.least = 3, .most = max_sheet_vertices};
  static constexpr Range samples{.least = 2, .most = max_sheet_vertices};

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "columns",
                  .meaning = "control points along u",
                  .unit = "points",
                  .range = count,
                  .need = Need::Required},
        of.u.count...);
    row(Attribute{.name = "rows",
                  .meaning = "control points along v; columns times rows at most 10⁸",
                  .unit = "points",
                  .range = count,
                  .need = Need::Required},
        of.v.count...);
    row(Attribute{.name = "degreeU",
                  .meaning = "degree along u, less than `columns`",
                  .range = {.least = 1},
                  .need = Need::Required},
        of.u.degree...);
    row(Attribute{.name = "degreeV",
                  .meaning = "degree along v, less than `rows`",
                  .range = {.least = 1},
                  .need = Need::Required},
        of.v.degree...);
    row(Attribute{.name = "samplesU",
                  .meaning = "vertices that are written along u, at least 3 if u is closed",
                  .unit = "vertices",
                  .range = samples,
                  .absent = "8 (columns − degreeU) + 1; closed: 8 columns"},
        of.u.samples...);
    row(Attribute{.name = "samplesV",
                  .meaning = "vertices that are written along v, at least 3 if v is closed",
                  .unit = "vertices",
                  .range = samples,
                  .absent = "8 (rows − degreeV) + 1; closed: 8 rows"},
        of.v.samples...);
  }
};

// The shapes of a surface, as elements of a file.

/// A surface whose shape is a sheet.
template <class Of>
struct SheetOf {
  Of& surface;
};

template <class Of>
struct Description<SheetOf<Of>> {
  static constexpr std::string_view element = "grid";
  static constexpr std::string_view meaning =
      "A flat sheet in the xz-plane, centred on the origin.";

  template <class Row, class... Each>
  static void rows(Row&& row, Each&... each) {
    describe(row, std::get<GridSheet>(each.surface.shape)...);
    describe(row, each.surface.cache...);
  }
};

/// A surface whose shape is a mesh in a file.
template <class Of>
struct MeshOf {
  Of& surface;
};

template <class Of>
struct Description<MeshOf<Of>> {
  static constexpr std::string_view element = "mesh";
  static constexpr std::string_view meaning = "A polygon mesh from a file.";

  template <class Row, class... Each>
  static void rows(Row&& row, Each&... each) {
    describe(row, std::get<MeshFile>(each.surface.shape)...);
    describe(row, each.surface.reading...);
    describe(row, each.surface.cache...);
  }
};

/// A surface whose shape is the cage of a subdivision surface.
template <class Of>
struct CageOf {
  Of& surface;
};

template <class Of>
struct Description<CageOf<Of>> {
  static constexpr std::string_view element = "subdivision";
  static constexpr std::string_view meaning =
      "A cage from a file, simulated as a mesh and written as a subdivision surface.";

  template <class Row, class... Each>
  static void rows(Row&& row, Each&... each) {
    Description<MeshOf<Of>>::rows(row, each...);
    describe(row, *each.surface.subdivision...);
  }
};

/// The numbers in a <nurbs>: its control points, and their weights.
struct PointsOf {
  NurbsNet& net;
};
struct WeightsOf {
  NurbsNet& net;
};

template <>
struct Description<PointsOf> {
  static constexpr std::string_view element = "points";
  static constexpr std::string_view meaning = "The control points, x y z of each, along u first.";
  static constexpr Numbers text{.meaning = "`x y z` of each control point, along u first",
                                .together = 3};
};

template <>
struct Description<WeightsOf> {
  static constexpr std::string_view element = "weights";
  static constexpr std::string_view meaning = "The weights of the control points, in their order.";
  static constexpr Numbers text{.meaning = "one number above 0 for each control point",
                                .range = positive};
};

/// The knots of a net, a <knots> for each direction that has some.
struct KnotsOf {
  NurbsNet& net;
};

enum class Along { U, V };
inline constexpr std::string_view along_words[] = {"u", "v"};

struct Knots {
  std::optional<Along> along = {};
  std::vector<double> numbers = {};
};

template <>
struct Description<Knots> {
  static constexpr std::string_view element = "knots";
  static constexpr std::string_view meaning = "The knots along u or v.";
  static constexpr Numbers text{
      .meaning = "columns + degreeU + 1 numbers that never fall; along v likewise"};

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "along",
                  .meaning = "direction of the knots",
                  .words = along_words,
                  .need = Need::Required},
        of.along...);
  }
};

/// A surface whose shape is a net.
template <class Of>
struct NetOf {
  Of& surface;
};

template <class Of>
struct Description<NetOf<Of>> {
  static constexpr std::string_view element = "nurbs";
  static constexpr std::string_view meaning =
      "A net of control points, simulated as a grid and written as a NURBS surface.";

  template <class Row, class... Each>
  static void rows(Row&& row, Each&... each) {
    describe(row, std::get<NurbsNet>(each.surface.shape)...);
  }

  template <class Visit>
  static void children(Visit&& child, const NetOf<Of>& of) {
    NurbsNet& net = std::get<NurbsNet>(of.surface.shape);
    child(Child{.least = 1}, PointsOf{net});
    child(Child{}, WeightsOf{net});
    child(Child{.most = 2, .unique_by = "along"}, KnotsOf{net});
  }
};

template <>
struct Description<TransformChannels> {
  static constexpr std::string_view element = "transform";
  static constexpr std::string_view meaning = "Where the surface is.";

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

/// A map among the parts of its surface, as their lines are named: `map.b`.
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

// Rows that forces and groups share.
inline constexpr Attribute targets_attribute{
    .name = "targets", .meaning = "the surfaces it acts on", .absent = "all surfaces"};
inline constexpr Attribute deformation_radius_attribute{
    .name = "deformationRadius",
    .meaning = "nearer vertices select the region that is solved",
    .unit = "length",
    .range = not_negative};

/// What every kind of force has; the rows of its kind follow.
template <>
struct Description<Force> {
  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(name_attribute("name for channels and messages"), of.name...);
    row(Attribute{.name = "enabled",
                  .meaning = "a disabled force selects nothing and pushes nothing"},
        of.enabled...);
    row(targets_attribute, of.targets...);
    row(Attribute{.name = "magnitude",
                  .meaning = "strength; a negative one reverses the force",
                  .unit = "length/uv⁴"},
        of.magnitude...);
    row(deformation_radius_attribute, of.deformation_radius...);
    row(Attribute{.name = "forceRadius",
                  .meaning = "nearer vertices select the box that is pushed",
                  .unit = "length",
                  .range = not_negative},
        of.force_radius...);
    row(Attribute{.name = "falloff",
                  .meaning = "decrease of the strength over distance / `forceRadius`",
                  .words = falloff_words},
        of.falloff...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& force) {
    child(Child{}, force.falloff_curve);
  }
};

template <>
struct Description<Group> {
  static constexpr std::string_view element = "group";
  static constexpr std::string_view meaning = "Forces that share one region.";
  static constexpr bool may_include = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(name_attribute("name for channels and messages"), of.name...);
    row(Attribute{.name = "enabled",
                  .meaning = "a disabled group selects nothing, and its forces push nothing"},
        of.enabled...);
    row(targets_attribute, of.targets...);
    row(Attribute{.name = "center", .meaning = "centre of the region", .unit = "length"},
        of.center...);
    row(deformation_radius_attribute, of.deformation_radius...);
  }
};

template <class Of>
struct Description<GroupIn<Of>> : Description<Group> {
  template <class Row, class... Each>
  static void rows(Row&& row, Each&... each) {
    describe(row, each.scene.groups[each.index]...);
  }

  template <class Visit>
  static void children(Visit&& child, const GroupIn<Of>& of) {
    child(Child{.most = unlimited}, MembersOf<Of>{of.scene, of.index, of.first});
  }
};

// The kinds of forces. `Sampled` is the kind at one frame: its members have the same names. Kinds
// without it are sampled in sampling/sampling.cpp.

inline constexpr std::string_view push_direction =
    "direction of the push; its length does not matter";

template <>
struct Description<PointChannels> {
  static constexpr std::string_view element = "point";
  static constexpr std::string_view meaning =
      "A force that pushes along a direction, near its centre.";
  using Sampled = PointForce;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "center", .meaning = "position of the force", .unit = "length"},
        of.center...);
    row(Attribute{.name = "direction", .meaning = push_direction, .unit = "1"}, of.direction...);
  }
};

template <>
struct Description<RadialChannels> {
  static constexpr std::string_view element = "radial";
  static constexpr std::string_view meaning = "A force that pushes away from its centre.";
  using Sampled = RadialForce;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(
        Attribute{
            .name = "center", .meaning = "centre; the force pushes away from it", .unit = "length"},
        of.center...);
  }
};

template <>
struct Description<LineChannels> {
  static constexpr std::string_view element = "line";
  static constexpr std::string_view meaning = "A force around a segment.";
  using Sampled = LineForce;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "from", .meaning = "one end of the segment", .unit = "length"},
        of.from...);
    row(Attribute{.name = "to", .meaning = "the other end", .unit = "length"}, of.to...);
    row(Attribute{.name = "direction",
                  .meaning = "direction of the push; absent: away from the segment",
                  .unit = "1",
                  .absent = "away from the segment"},
        of.direction...);
  }
};

template <>
struct Description<UniformChannels> {
  static constexpr std::string_view element = "uniform";
  static constexpr std::string_view meaning =
      "A force that is the same everywhere, such as gravity or wind.";
  using Sampled = UniformForce;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "direction", .meaning = push_direction, .unit = "1"}, of.direction...);
  }
};

template <>
struct Description<VortexChannels> {
  static constexpr std::string_view element = "vortex";
  static constexpr std::string_view meaning = "A force that turns about an axis.";
  using Sampled = VortexForce;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "center", .meaning = "a point of the axis", .unit = "length"},
        of.center...);
    row(Attribute{.name = "axis",
                  .meaning = "the axis; its length does not matter. The rotation follows the "
                             "right-hand rule",
                  .unit = "1"},
        of.axis...);
    row(Attribute{.name = "pull",
                  .meaning = "part towards the axis, relative to the rotating part; a negative "
                             "one pushes away",
                  .unit = "1"},
        of.pull...);
  }
};

template <>
struct Description<NoiseChannels> {
  static constexpr std::string_view element = "noise";
  static constexpr std::string_view meaning =
      "A force that differs smoothly from place to place and from time to time.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "center",
                  .meaning = "origin of distances; the pattern moves with it",
                  .unit = "length"},
        of.center...);
    row(Attribute{.name = "frequency",
                  .meaning = "fineness of the pattern; a negative one mirrors it",
                  .unit = "cells/length"},
        of.frequency...);
    row(Attribute{.name = "rate",
                  .meaning = "speed of change; negative: backwards. Each frame adds its rate/fps, "
                             "so a keyed rate never makes the pattern jump",
                  .unit = "cells/s"},
        of.rate...);
    row(
        Attribute{
            .name = "seed", .meaning = "each seed gives another pattern", .absent = "the scene's"},
        of.seed...);
  }
};

template <>
struct Description<InertiaChannels> {
  static constexpr std::string_view element = "inertia";
  static constexpr std::string_view meaning =
      "The effect of the motion of the surface's transform or cache.";
  static constexpr double magnitude = 1;  ///< the default: the effect of the motion itself

  template <class Row, class... Of>
  static void rows(Row&&, Of&...) {}
};

/// A program's own kind has no element; the command never sees one.
template <>
struct Description<CustomForce> {
  static constexpr std::string_view element = "custom";
  static constexpr std::string_view meaning = "A force of a program.";

  template <class Row, class... Of>
  static void rows(Row&&, Of&...) {}
};

/// Finds the channels among the members of a thing.
template <class Visit>
struct ChannelFinder {
  Visit& visit;

  void operator()(const Attribute&) const {}
  template <class Member>
  void operator()(const Attribute& attribute, Member& member) const {
    using M = std::remove_const_t<Member>;
    if constexpr (std::is_same_v<M, Channel<1>> || std::is_same_v<M, Channel<3>> ||
                  std::is_same_v<M, Switch>) {
      visit(std::string(attribute.name), attribute, member);
    } else if constexpr (std::is_same_v<M, std::optional<Channel<1>>> ||
                         std::is_same_v<M, std::optional<Channel<3>>>) {
      if (member) (*this)(attribute, *member);
    } else if constexpr (std::is_same_v<M, TangentChannel>) {
      std::visit([&](auto& channel) { (*this)(attribute, channel); }, member);
    } else if constexpr (std::is_same_v<M, PositionChannel>) {
      if (auto* const motion = member.path()) {
        visit(std::string(attribute.name) + ".progress", progress_attribute, motion->progress);
      } else {
        (*this)(attribute, *member.channel());
      }
    }
  }
};

template <class T, class Visit>
void for_each_part(T& thing, Visit&& visit) {
  using Thing = std::remove_const_t<T>;
  visit(thing);
  if constexpr (std::is_same_v<Thing, Force>) std::visit(visit, thing.kind);
  const auto child = [&]([[maybe_unused]] const Child& row, auto&& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if constexpr (std::is_same_v<Thing, Surface>) {
      if (thing.is_driven() && !row.is_of_driven) return;
    }
    if constexpr (requires { Description<Member>::element; }) visit(member);
  };
  if constexpr (requires { Description<Thing>::children(child, thing); })
    Description<Thing>::children(child, thing);
}

/// Whether another value stands in place of that of an attribute.
template <class T>
bool is_replaced(const T& thing, const Attribute& attribute) {
  if constexpr (std::is_same_v<T, Surface>)  // the damping follows from its ratio
    return attribute.name == "damping" && thing.material.damping_ratio;
  else if constexpr (std::is_same_v<T, Force>)  // the group selects the region
    return attribute.name == deformation_radius_attribute.name && !thing.group.empty();
  else
    return false;
}

template <class T, class Visit>
void for_each_channel(T& thing, Visit&& visit) {
  const ChannelFinder<std::remove_reference_t<Visit>> finder{visit};
  const auto row = [&](const Attribute& attribute, auto&... member) {
    if (!is_replaced(thing, attribute)) finder(attribute, member...);
  };
  for_each_part(thing, [&](auto& part) { describe(row, part); });
}

}  // namespace pliant
