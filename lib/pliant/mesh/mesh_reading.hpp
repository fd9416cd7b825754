#pragma once

#include <array>
#include <optional>

#include "pliant/core/grid.hpp"

namespace pliant {

/// Where the u and v of a mesh come from.
enum class UvReading {
  Auto,     ///< its UVs if they form an even grid, otherwise its surface
  Grid,     ///< its UVs, which form an even grid: the thesis
  Surface,  ///< lengths along its surface, on its own triangles; no UVs are needed
};

/// What the border of a surface does.
enum class Border {
  Clamped,  ///< it is held, with the slopes of the tangents
  Pinned,   ///< it is held, and may turn
  Free,     ///< it moves
};

/// How a mesh is read. `wrap` is of a grid; all but `uv` are of a surface otherwise. A sheet is a
/// surface only by `uv`, and has neither `wrap` nor `weld`.
struct MeshReading {
  UvReading uv = UvReading::Auto;

  Wrap wrap = Wrap::None;  ///< the closed directions of its grid

  /// The lengths that count as 1 along u and along v [length/uv], > 0; none: the root of the
  /// surface's area, for both; of a sheet its width and depth.
  std::optional<std::array<double, 2>> unit = {};

  /// The direction that u follows, projected into each triangle, not 0; none: that of the UVs.
  std::optional<std::array<double, 3>> axis = {};

  std::optional<Border> border = {};  ///< none: clamped

  /// Vertices joined by steps of this length are one node [length], >= 0; none: 1e-6 of the
  /// diagonal of the bounding box of all vertices in faces.
  std::optional<double> weld = {};

  /// Whether anything of it asks for a surface.
  bool asks_for_surface() const {
    return uv == UvReading::Surface || unit || axis || border || weld;
  }

  friend bool operator==(const MeshReading&, const MeshReading&) = default;
};

}  // namespace pliant
