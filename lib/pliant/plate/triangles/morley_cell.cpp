#include "pliant/plate/triangles/morley_cell.hpp"

#include <algorithm>

namespace pliant {

namespace {

// For a mixed stiffness and the root of the two others: positive for all that are elliptic.
double ratio_of_held(double mixed, double root) { return std::min(0.0, mixed / (4 * root) - 0.5); }

}  // namespace

Bending bending_of(const Stiffness& stiffness, const std::array<double, 2>& unit,
                   std::optional<double> poisson) {
  const auto& [b, c, d] = stiffness;
  const double root = std::sqrt(b * d);
  const double ratio = poisson ? *poisson : ratio_of_held(c, root);
  const double u2 = unit[0] * unit[0], v2 = unit[1] * unit[1];
  const double coupling = ratio * root * u2 * v2;
  return {b * u2 * u2, d * v2 * v2, coupling, c * u2 * v2 - 2 * coupling, poisson.has_value()};
}

Bending scaled(const Bending& bending, double b, double c, double d) {
  Bending form = bending;
  form.uu *= b;
  form.vv *= d;
  const double mixed = (bending.uv + 2 * bending.coupling) * c;
  const double root = std::sqrt(form.uu * form.vv);
  form.coupling =
      bending.is_free ? bending.coupling * std::sqrt(b * d) : ratio_of_held(mixed, root) * root;
  form.uv = mixed - 2 * form.coupling;
  return form;
}

MorleyCell::MorleyCell(const FlatTriangle& shape) {
  const double signed_area = shape.signed_area();
  const double turn = signed_area < 0 ? -1 : 1;
  area = std::abs(signed_area);
  const auto& [b, c] = shape;
  // The sides as vectors.
  const std::array<std::array<double, 2>, 3> sides = {
      b, {c[0] - b[0], c[1] - b[1]}, {-c[0], -c[1]}};
  for (int k = 0; k < 3; ++k) {
    const auto& [x, y] = sides[k];
    const double length = std::sqrt(x * x + y * y);
    normals[k] = {turn * y / length, -turn * x / length};
    const auto& [nx, ny] = normals[k];
    const double part = length / area;
    by_slope[k] = {part * nx * nx, part * ny * ny, part * nx * ny};
    // The hat of the corner opposite.
    hats[(k + 2) % 3] = {-0.5 * part * nx, -0.5 * part * ny};
  }
}

std::array<Curvature, 3> MorleyCell::by_corner() const {
  std::array<Curvature, 3> result = {};
  for (int corner = 0; corner < 3; ++corner) {
    for (int side = 0; side < 3; ++side) {
      const double slope = normals[side][0] * hats[corner][0] + normals[side][1] * hats[corner][1];
      for (int k = 0; k < 3; ++k) result[corner][k] -= slope * by_slope[side][k];
    }
  }
  return result;
}

}  // namespace pliant
