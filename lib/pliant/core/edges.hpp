#pragma once

namespace pliant {

/// What holds an edge of a plate.
enum class Edge {
  Clamped,  ///< place and slope are given
  Pinned,   ///< the place is given, and no moment acts across the edge
  Free,     ///< nothing is given: neither a moment nor a force acts
};

/// The edges of a rectangle at its smallest and largest u, and its smallest and largest v.
struct Edges {
  Edge u0 = Edge::Clamped;
  Edge u1 = Edge::Clamped;
  Edge v0 = Edge::Clamped;
  Edge v1 = Edge::Clamped;

  bool are_clamped() const { return *this == Edges{}; }
  bool have_free() const {
    return u0 == Edge::Free || u1 == Edge::Free || v0 == Edge::Free || v1 == Edge::Free;
  }

  friend bool operator==(const Edges&, const Edges&) = default;
};

}  // namespace pliant
