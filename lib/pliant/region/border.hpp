#pragma once

namespace pliant {

/// What the border of a surface of triangles does.
enum class Border {
  Clamped,  ///< it is held, with the slopes of the tangents
  Pinned,   ///< it is held, and may turn
  Free,     ///< it moves
};

}  // namespace pliant
