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

  /// Whether they hold a plate that nothing else does: one clamped edge, or two pinned ones. A
  /// plate that is closed along u has no edges u0 and u1.
  bool hold(bool is_closed_u = false, bool is_closed_v = false) const {
    int strength = 0;  // 2 are enough
    const auto add = [&](Edge edge) {
      strength += edge == Edge::Clamped ? 2 : edge == Edge::Pinned ? 1 : 0;
    };
    if (!is_closed_u) add(u0), add(u1);
    if (!is_closed_v) add(v0), add(v1);
    return strength >= 2;
  }

  friend bool operator==(const Edges&, const Edges&) = default;
};

}  // namespace pliant
