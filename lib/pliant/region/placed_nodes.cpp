#include "pliant/region/placed_nodes.hpp"

#include <algorithm>

namespace pliant {
namespace {

// Calls f(first, part) for the parts of `nodes`, of up to `size` each.
template <class F>
void for_each_part(std::span<const int> nodes, std::size_t size, const F& f) {
  for (std::size_t first = 0; first < nodes.size(); first += size)
    f(first, nodes.subspan(first, std::min(size, nodes.size() - first)));
}

}  // namespace

PlacedNodes::PlacedNodes(const Field& positions, const Transform& transform,
                         const std::vector<double>* densities, const NodeFaces* faces)
    : positions_(&positions),
      transform_(transform),
      densities_(densities && !densities->empty() ? densities : nullptr),
      faces_(faces) {
  // Of a transform that mirrors they point to the same side of the surface as before.
  if (faces_) to_normals_ = inverse_linear(transform).transpose();
}

Batch PlacedNodes::batch(int first, int count) const {
  const double* const x = positions_->col(0).data() + first;
  const double* const y = positions_->col(1).data() + first;
  const double* const z = positions_->col(2).data() + first;
  Batch batch;
  batch.count = count;
  if (!transform_) {
    std::copy_n(x, count, batch.x);
    std::copy_n(y, count, batch.y);
    std::copy_n(z, count, batch.z);
    return batch;
  }
  double* const images[] = {batch.x, batch.y, batch.z};
  for (int component = 0; component < 3; ++component) {
    const double ax = transform_->linear(component, 0);
    const double ay = transform_->linear(component, 1);
    const double az = transform_->linear(component, 2);
    const double moved = transform_->translation[component];
    double* const image = images[component];
    for (int k = 0; k < count; ++k) image[k] = (x[k] * ax + y[k] * ay + z[k] * az) + moved;
  }
  return batch;
}

Batch PlacedNodes::batch(std::span<const int> nodes) const {
  Batch batch;
  batch.count = static_cast<int>(nodes.size());
  for (int k = 0; k < batch.count; ++k) {
    const Vector3d p = at(nodes[k]);
    batch.x[k] = p[0], batch.y[k] = p[1], batch.z[k] = p[2];
  }
  return batch;
}

std::vector<Vector3d> PlacedNodes::places_of(std::span<const int> nodes) const {
  std::vector<Vector3d> places;
  places.reserve(nodes.size());
  for (const int node : nodes) places.push_back(at(node));
  return places;
}

std::vector<double> PlacedNodes::distances(std::span<const int> nodes, const ForceKind& force,
                                           std::vector<double> reuse) const {
  reuse.resize(nodes.size());
  const std::span<double> found = reuse;
  const auto* const own = takes_many(force) ? &std::get<SampledCustomForce>(force) : nullptr;
  for_each_part(nodes, asked_at_once(force), [&](std::size_t first, const auto& part) {
    if (own) return own->distance(places_of(part), found.subspan(first, part.size()));
    const BatchNumbers numbers = pliant::distances(force, batch(part));
    std::copy_n(numbers.of, part.size(), found.data() + first);
  });
  return reuse;
}

std::vector<Vector3d> PlacedNodes::loads_on(std::span<const int> nodes,
                                            const SampledForce& force) const {
  std::vector<Vector3d> loads;
  loads.reserve(nodes.size());
  if (!is_own(force)) {
    for (const int node : nodes) loads.push_back(load_on(node, force));
    return loads;
  }
  for_each_part(nodes, asked_at_once(force.kind), [&](std::size_t, const auto& part) {
    std::vector<Vector3d> normals;
    if (uses_normals(force))
      for (const int node : part) normals.push_back(normal(node));
    const std::vector<Vector3d> found = own_forces(force, places_of(part), normals);
    loads.insert(loads.end(), found.begin(), found.end());
  });
  return loads;
}

Vector3d PlacedNodes::load_on(int node, const SampledForce& force) const {
  const Vector3d side = uses_normals(force) ? normal(node) : Vector3d(Vector3d::Zero());
  const Vector3d load = force_on(force, at(node), node, side);
  return is_weighted(force) ? Vector3d(load * (*densities_)[static_cast<std::size_t>(node)]) : load;
}

void PlacedNodes::add_loads(int first, int count, const SampledForce& force, int place,
                            Batch& sums) const {
  if (!is_weighted(force)) {
    Batch normals;
    const bool has_normals = uses_normals(force);
    static_assert(batch_size <= most_normals);
    if (has_normals)
      normals_of_run(*faces_, *positions_, to_normals_, first, count,
                     {normals.x, normals.y, normals.z});
    return add_forces(force, batch(first, count), has_normals ? &normals : nullptr, first, place,
                      sums);
  }
  for (int k = 0; k < count; ++k) {
    const Vector3d load = load_on(first + k, force);
    sums.x[place + k] += load.x();
    sums.y[place + k] += load.y();
    sums.z[place + k] += load.z();
  }
}

}  // namespace pliant
