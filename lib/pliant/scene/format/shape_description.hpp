#pragma once

#include <cstddef>
#include <string_view>
#include <utility>

#include "pliant/files/boxed/read_assimp.hpp"
#include "pliant/scene/format/attribute.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

// The words of choices, in the order of their values.

inline constexpr std::string_view face_words[] = {"quads", "triangles"};
inline constexpr std::string_view wrap_words[] = {"none", "u", "v", "uv"};
inline constexpr std::string_view uv_words[] = {"auto", "grid", "surface"};
inline constexpr std::string_view later_uv_words[] = {"virtual"};
inline constexpr std::string_view use_surface = "uv=\"surface\" solves on the mesh's own triangles";
inline constexpr std::string_view scheme_words[] = {"catmullClark", "loop"};
inline constexpr std::string_view border_words[] = {"clamped", "pinned", "free"};

/// Of a surface of triangles.
constexpr Attribute unit_attribute(std::string_view absent) {
  return {.name = "unit",
          .meaning =
              "length that counts as 1 in u and v, or two of them, along u and v; only of a "
              "surface",
          .unit = "length/uv",
          .range = positive,
          .absent = absent};
}

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
struct Description<ShapeCache> {
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
    row(unit_attribute("the root of its area"), of.unit...);
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
    row(Attribute{.name = "uv",
                  .meaning = "`grid`: the sheet is a grid of columns and rows; `surface`: it is "
                             "read as a mesh with `uv=\"surface\"`, so that regions are round",
                  .words = uv_words,
                  .later = later_uv_words,
                  .instead = use_surface,
                  .absent = "grid"},
        each.surface.reading.uv...);
    row(unit_attribute("width and depth"), each.surface.reading.unit...);
    row(Attribute{.name = "axis",
                  .meaning = "direction that u follows along the surface; only of a surface",
                  .unit = "1",
                  .absent = "that of its columns, x"},
        each.surface.reading.axis...);
    row(Attribute{.name = "border",
                  .meaning = "what the sheet's border does; only of a surface",
                  .words = border_words,
                  .absent = "clamped"},
        each.surface.reading.border...);
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

}  // namespace pliant
