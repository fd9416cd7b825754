#include "pliant/states/state_key.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <tuple>
#include <type_traits>

#include "pliant/core/byte_order.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/sampling/rest_shape.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/states/engine.hpp"

namespace pliant {
namespace {

// The functions below use structured bindings for their values, so that a new member causes a
// compile error here and cannot be forgotten in the keys.

// The data to hash, in a fixed order. Numbers are added by their bits.
class HashedValues {
 public:
  void add(std::uint64_t number) { append_number(bytes_, number); }
  void add(std::int64_t number) { add(static_cast<std::uint64_t>(number)); }
  void add(int number) { add(std::int64_t{number}); }
  void add(double number) { append_number(bytes_, number); }
  void add(std::string_view text) {
    add(std::uint64_t{text.size()});
    bytes_ += text;
  }
  void add(const Hash& hash) {
    add(hash.high);
    add(hash.low);
  }
  template <class Enum>
  requires std::is_enum_v<Enum>
  void add(Enum choice) { add(static_cast<std::int64_t>(choice)); }

  void add(const Vector3d& vector) {
    for (const double number : vector) add(number);
  }
  void add(const Matrix3d& matrix) {
    for (int row = 0; row < 3; ++row) add(Vector3d(matrix.row(row)));
  }
  void add(const std::shared_ptr<const Field>& field) {
    add(int{field != nullptr});
    if (field) add(hash_of(*field));
  }
  template <std::size_t D>
  void add(const std::array<double, D>& numbers) {
    for (const double number : numbers) add(number);
  }
  template <class T>
  void add(const std::optional<T>& value) {
    add(int{value.has_value()});
    if (value) add(*value);
  }
  template <class T>
  void add(const std::vector<T>& values) {
    add(std::uint64_t{values.size()});
    for (const T& value : values) add(value);
  }

  void add(const Transform& transform) {
    const auto& [linear, translation] = transform;
    add_all(linear, translation);
  }
  void add(const Stiffness& stiffness) {
    const auto& [b, c, d] = stiffness;
    add_all(b, c, d);
  }
  void add(const Dynamics& dynamics) {
    const auto& [density, damping] = dynamics;
    add_all(density, damping);
  }
  void add(const EdgeTangents& tangents) {
    const auto& [su0, su1, sv0, sv1] = tangents;
    add_all(su0, su1, sv0, sv1);
  }
  void add(const Grid& grid) {
    const auto& [columns, rows, hu, hv, is_closed_u, is_closed_v] = grid;
    add_all(columns, rows, hu, hv, int{is_closed_u}, int{is_closed_v});
  }
  void add(const NodeFaces& faces) {
    add_bytes(faces.face_starts);
    add_bytes(faces.corner_nodes);
  }
  // What of a surface the states depend on, besides the rest positions: all else follows from it.
  void add(const TriangleSurface& surface) {
    add(static_cast<const NodeFaces&>(surface));
    add_bytes(surface.triangles);
    add(surface.unit);
  }
  void add(const NodeFactors& factors) {
    const auto& [density, damping, b, c, d, yield, hardening, goal] = factors;
    for (const auto* of_nodes : {&density, &damping, &b, &c, &d, &yield, &hardening, &goal})
      add_bytes(*of_nodes);
  }
  void add(const NodeMarks& marks) { add_bytes(marks); }
  void add(const PlasticLaw& law) {
    const auto& [yield, hardening] = law;
    add_all(yield, hardening);
  }
  void add(const BodySettings& settings) {
    const auto& [integrator, stepping, reference, measure, region, combine, release, border, edges,
                 is_animated, yields, exact_parts] = settings;
    add_all(integrator, stepping, reference, measure, region, combine, release, border,
            int{is_animated}, int{yields});
    const auto& [u0, u1, v0, v1] = edges;
    add_all(u0, u1, v0, v1, exact_parts);
  }

  void add(const Interpolation& interpolation) {
    const auto& [kind, ease, side, amplitude, period, back, control] = interpolation;
    add_all(kind, ease, side, amplitude, period, back, control);
  }
  void add(const Tangent<1>& tangent) {
    const auto& [kind, slope, length, handle_frames, handle_value] = tangent;
    add_all(kind, slope, length, handle_frames, handle_value);
  }
  void add(const Key<1>& key) {
    const auto& [frame, value, next, in, out, left] = key;
    add_all(frame, value, next, in, out, left);
  }
  void add(const Extrapolation<1>& extrapolation) {
    const auto& [kind, slope, count] = extrapolation;
    add_all(kind, slope, count);
  }
  void add(const Loop<1>& loop) {
    const auto& [from, to, before, after, offset] = loop;
    add_all(from, to, before, after, offset);
  }
  void add(const CurveKeys<1>& curve) {
    const auto& [keys, before, after, loop, overshoot] = curve;
    add_all(keys, before, after, loop, overshoot);
  }

  // A force of any kind.
  template <class Kind>
  requires requires(const Kind& kind) { kind.values(); }
  void add(const Kind& kind) {
    std::apply([&](const auto&... values) { add_all(values...); }, kind.values());
  }

  void add(const SampledForce& force) {
    const auto& [shape, magnitude, deformation_radius, force_radius, falloff, falloff_curve,
                 is_along_normal] = force;
    add(std::uint64_t{shape.index()});
    std::visit([this](const auto& of_kind) { add(of_kind); }, shape);
    add_all(magnitude, deformation_radius, force_radius, falloff, int{is_along_normal});
    add(int{falloff_curve != nullptr});
    if (falloff_curve) add(falloff_curve->keys());
  }
  void add(const Placement& placement) {
    const auto& [translate, rotate, scale, order] = placement;
    add_all(translate, rotate, scale, order);
  }
  void add(const SphereSolid& sphere) {
    const auto& [radius] = sphere;
    add(radius);
  }
  void add(const CapsuleSolid& capsule) {
    const auto& [radius, length] = capsule;
    add_all(radius, length);
  }
  void add(const BoxSolid& box) {
    const auto& [size, round] = box;
    add_all(size, round);
  }
  void add(const PlaneSolid&) {}
  void add(const MeshSolid& mesh) {
    add(mesh.posed->mesh().hash());
    add(hash_of(mesh.posed->points()));
    add(int{mesh.posed->is_mirrored()});
  }
  void add(const ColliderPose& pose) {
    const auto& [shape, placement, offset] = pose;
    add(std::uint64_t{shape.index()});
    std::visit([this](const auto& kind) { add(kind); }, shape);
    add_all(placement, offset);
  }
  void add(const SampledCollider& collider) {
    const auto& [first, last, deformation_radius, friction, sticks, index] = collider;
    add_all(first, last, deformation_radius, friction, int{sticks}, index);
  }
  void add(const BodyMotion& motion) {
    const auto& [first, last, next_shape] = motion;
    add_all(first, last, next_shape);
  }
  void add(const BodyInputs& inputs) {
    const auto& [transform, stiffness, dynamics, damping_ratio, tangents, poisson, law, goal,
                 frame_length, dt, forces, shape, selectors, colliders, motion] = inputs;
    add_all(transform, stiffness, dynamics, damping_ratio, tangents, poisson, law, goal,
            frame_length, dt, forces, shape, selectors, colliders, motion);
  }

  Hash hash() const { return hash_of(std::string_view(bytes_)); }

 private:
  template <class... Values>
  void add_all(const Values&... values) {
    (add(values), ...);
  }

  template <class T>
  void add_bytes(const std::vector<T>& values) {
    const auto bytes = std::as_bytes(std::span(values));
    add(hash_of(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size())));
  }

  std::string bytes_;
};

}  // namespace

Hash rest_key(const RestShape& shape, const BodySettings& settings, SolverChoice solver) {
  HashedValues values;
  values.add(engine_name());
  if (shape.grid) values.add(*shape.grid);
  values.add(hash_of(shape.rest));
  if (shape.surface) values.add(*shape.surface);
  values.add(int{shape.faces != nullptr});
  if (shape.faces) values.add(*shape.faces);
  values.add(int{shape.factors != nullptr});
  if (shape.factors) values.add(*shape.factors);
  if (shape.held) values.add(*shape.held);
  values.add(settings);
  values.add(solver);
  // The available solvers decide which sparse solver a choice means.
  for (const SolverChoice kind : available_solvers()) values.add(name_of(kind));
  return values.hash();
}

Hash unnamed_key(const Hash& rest) {
  HashedValues values;
  values.add(rest);
  values.add(std::string_view("unnamed"));
  return values.hash();
}

std::optional<Hash> next_key(const Hash& before, const SurfaceInputs& inputs, int frame) {
  HashedValues values;
  values.add(before);
  values.add(inputs.body);
  for (std::size_t k = 0; k < inputs.body.forces.size(); ++k) {
    if (!is_own(inputs.body.forces[k])) continue;
    const std::string_view key = inputs.sources[k].key;
    if (key.empty()) return {};
    values.add(key);
    values.add(frame);
  }
  return values.hash();
}

std::optional<Hash> cycle_key(const std::optional<Hash>& round, double frame_time) {
  if (!round) return {};
  HashedValues values;
  values.add(*round);
  values.add(std::string_view("cycle"));
  values.add(frame_time);
  return values.hash();
}

void KeyChain::append(const SurfaceInputs* inputs, int frame) {
  const std::optional<Hash> before = keys_.back();
  if (!inputs || !before) {
    keys_.push_back(before);
  } else {
    keys_.push_back(next_key(*before, *inputs, frame));
  }
}

}  // namespace pliant
