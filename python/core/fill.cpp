#include "fill.hpp"

namespace pliant::python {
namespace {

// Compiled for each case, so that nothing is asked for a vertex.
template <class T, bool is_by_rows, class Place>
void fill(const Field& points, T* to, const Place& place) {
  const Eigen::Index rows = points.rows();
  const double *const x = points.data(), *const y = x + rows, *const z = y + rows;
  for (Eigen::Index row = 0; row < rows; ++row) {
    const Vector3d at = place({x[row], y[row], z[row]});
    for (int c = 0; c < 3; ++c)
      to[is_by_rows ? 3 * row + c : row + c * rows] = static_cast<T>(at[c]);
  }
}

template <class T, bool is_by_rows>
void fill(const SurfaceFrame& surface, bool in_world, T* to) {
  const Field& points = surface.object_positions();
  if (!in_world)
    return fill<T, is_by_rows>(points, to, [](const Vector3d& point) { return point; });
  const Transform transform = surface.transform();  // which `to` cannot overlap
  fill<T, is_by_rows>(points, to,
                      [&](const Vector3d& point) { return to_world(transform, point); });
}

template <class T>
void fill(const SurfaceFrame& surface, bool in_world, T* to, bool is_by_rows) {
  if (is_by_rows)
    fill<T, true>(surface, in_world, to);
  else
    fill<T, false>(surface, in_world, to);
}

}  // namespace

void fill(const SurfaceFrame& surface, bool in_world, void* to, Layout layout) {
  if (layout.is_single)
    fill(surface, in_world, static_cast<float*>(to), layout.is_by_rows);
  else
    fill(surface, in_world, static_cast<double*>(to), layout.is_by_rows);
}

}  // namespace pliant::python
