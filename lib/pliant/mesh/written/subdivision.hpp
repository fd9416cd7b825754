#pragma once

namespace pliant {

enum class SubdivisionScheme {
  CatmullClark,  ///< for all faces, which become quads
  Loop,          ///< for triangles
};

/// How a cage becomes a subdivision surface.
struct Subdivision {
  int levels = 2;  ///< times that it is refined, 0 to 6
  SubdivisionScheme scheme = SubdivisionScheme::CatmullClark;

  static constexpr int most_levels = 6;

  friend bool operator==(const Subdivision&, const Subdivision&) = default;
};

/// Whether this build can subdivide: PLIANT_WITH_OPENSUBDIV.
bool has_opensubdiv();

}  // namespace pliant
