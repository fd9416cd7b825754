#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

namespace pliant {

/// Twice the signed area of a triangle: > 0 if it is counter-clockwise.
inline double turn(const Eigen::Vector2d& a, const Eigen::Vector2d& b, const Eigen::Vector2d& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// The triangles of a polygon, as indices of its corners, each counter-clockwise or without area.
/// nullopt: it intersects itself, or touches itself in a way that is not told from this. Requires:
/// three corners or more, counter-clockwise and finite. Cost: O(#corners log #corners). Source:
/// Hertel, Mehlhorn, Fast triangulation of simple polygons, 1983. Internal to mesh.
std::optional<std::vector<std::array<int, 3>>> swept_triangles(
    std::span<const Eigen::Vector2d> points);

}  // namespace pliant
