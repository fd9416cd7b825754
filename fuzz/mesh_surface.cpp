// A small sheet with arbitrary faces on a coarse lattice, so that vertices coincide, edges cross
// and faces vanish; then its surface, pushed by one or two forces.

#include <array>
#include <initializer_list>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include <fuzzer/FuzzedDataProvider.h>

#include "fuzz.hpp"
#include "pliant/body/triangle_body.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/mesh/written/binding.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

constexpr int frame_count = 3;

Vector3d lattice_point(FuzzedDataProvider& input, double spacing) {
  Vector3d place;
  for (double& coordinate : place) coordinate = spacing * input.ConsumeIntegralInRange(-4, 4);
  return place;
}

void add_face(Mesh& mesh, std::initializer_list<int> vertices) {
  mesh.face_sizes.push_back(static_cast<int>(vertices.size()));
  mesh.corner_vertices.insert(mesh.corner_vertices.end(), vertices);
}

// A sheet, so that there are nodes within, some of whose vertices lie elsewhere; or only vertices.
// Then any faces.
Mesh lattice_mesh(FuzzedDataProvider& input, double spacing) {
  const int side = input.ConsumeIntegralInRange(0, 4);
  const int across = side + 1;
  const int free_vertices = input.ConsumeIntegralInRange(side == 0 ? 2 : 0, 12);
  Mesh mesh;
  mesh.positions.resize(across * across + free_vertices, 3);
  for (int j = 0; j < across; ++j) {
    for (int i = 0; i < across; ++i) {
      mesh.positions.row(j * across + i) << spacing * (2 * i - side), 0, spacing * (2 * j - side);
    }
  }
  const int vertex_count = mesh.vertex_count();
  for (int vertex = across * across; vertex < vertex_count; ++vertex) {
    mesh.positions.row(vertex) = lattice_point(input, spacing).transpose();
  }
  const int moved_vertices = input.ConsumeIntegralInRange(0, 6);
  for (int k = 0; k < moved_vertices; ++k) {
    const int vertex = input.ConsumeIntegralInRange(0, vertex_count - 1);
    mesh.positions.row(vertex) = lattice_point(input, spacing).transpose();
  }
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) {
      const int a = j * across + i, b = a + 1, c = a + across, d = c + 1;
      switch (input.ConsumeIntegralInRange(0, 3)) {
        case 0:
          add_face(mesh, {a, c, d, b});
          break;
        case 1:
          add_face(mesh, {a, c, b});
          add_face(mesh, {b, c, d});
          break;
        case 2:
          add_face(mesh, {a, c, d});
          add_face(mesh, {a, b, d});  // turned round
          break;
        default:  // a hole
          break;
      }
    }
  }
  const int face_count = input.ConsumeIntegralInRange(mesh.face_sizes.empty() ? 1 : 0, 16);
  for (int face = 0; face < face_count; ++face) {
    mesh.face_sizes.push_back(input.ConsumeIntegralInRange(3, 8));
    for (int k = 0; k < mesh.face_sizes.back(); ++k) {
      mesh.corner_vertices.push_back(input.ConsumeIntegralInRange(0, vertex_count - 1));
    }
  }
  if (input.ConsumeBool()) mesh.uvs = {{0, 0}, {1, 0}, {0, 1}, {0.5, 0.5}};
  for (std::size_t corner = 0; corner < mesh.corner_vertices.size(); ++corner) {
    mesh.corner_uvs.push_back(mesh.uvs.empty() ? -1 : input.ConsumeIntegralInRange(-1, 3));
  }
  return mesh;
}

struct Play {
  BodySettings settings;
  BodyInputs inputs;
};

Play any_play(FuzzedDataProvider& input, double spacing) {
  Play play;
  play.settings.measure = input.ConsumeBool() ? Measure::Rest : Measure::Current;
  play.settings.release = input.ConsumeBool() ? Release::Recover : Release::Freeze;
  play.settings.border = input.PickValueInArray({Border::Clamped, Border::Pinned, Border::Free});
  BodyInputs& in = play.inputs;
  in.frame_length = 1.0 / 24;
  in.dt = input.PickValueInArray({1.0, 0.02, 5e-3});
  in.dynamics = {input.PickValueInArray({0.01, 0.0, 1e6}),
                 input.PickValueInArray({0.05, 0.0, 1e6})};
  in.poisson = input.PickValueInArray({0.3, 0.0, 0.99, -0.99});
  in.stiffness = {1, 2, input.PickValueInArray({1.0, 1e-6, 1e6})};
  if (play.settings.release == Release::Freeze && input.ConsumeBool())
    in.tangents.su1 = lattice_point(input, spacing);
  const int force_count = input.ConsumeIntegralInRange(1, 2);
  for (int k = 0; k < force_count; ++k) {
    SampledForce force;
    const Vector3d center = lattice_point(input, 0.5 * spacing);
    if (input.ConsumeBool()) {
      force.kind = PointForce{center, lattice_point(input, 1)};
    } else {
      force.kind = RadialForce{center};
    }
    force.magnitude = input.PickValueInArray({1.0, -1e3, 0.0, 1e12}) * spacing;
    force.deformation_radius = 0.5 * spacing * input.ConsumeIntegralInRange(0, 16);
    force.force_radius = 0.5 * spacing * input.ConsumeIntegralInRange(0, 16);
    force.falloff = input.PickValueInArray({Falloff::Smooth, Falloff::Constant});
    in.forces.push_back(force);
  }
  return play;
}

bool is_outside(const BodyInputs& inputs, const Vector3d& place) {
  return std::ranges::all_of(inputs.forces, [&](const SampledForce& force) {
    return distance(force.kind, place) >= force.deformation_radius;
  });
}

// The positions after some frames, in the last of which the forces rest; a frame that fails changes
// nothing.
Field played(const std::shared_ptr<const TriangleSurface>& surface, const Play& play) {
  MemoryBudget memory(std::size_t{100} << 20);
  RunContext context;
  context.memory = &memory;
  TriangleBody body(surface, play.settings, SolverChoice::Auto, context);
  BodyInputs in = play.inputs;
  for (int frame = 0; frame < frame_count; ++frame) {
    for (SampledForce& force : in.forces) {
      if (frame + 1 == frame_count) force.magnitude = 0;
    }
    if (const auto done = body.step(in); !done) check_error(done.error());
  }
  return body.state().positions;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  FuzzedDataProvider input(bytes, size);
  const double spacing = input.PickValueInArray({0.25, 1e-9, 1e9, 0.1, 1e-150, 1e150});
  MeshReading reading;
  if (input.ConsumeBool()) reading.weld = spacing * input.ConsumeIntegralInRange(0, 3);
  if (input.ConsumeBool()) {
    const Vector3d axis = lattice_point(input, 1);
    if (!axis.isZero(0)) reading.axis = {axis.x(), axis.y(), axis.z()};
  }
  if (input.ConsumeBool()) reading.unit = {1, input.PickValueInArray({1.0, 1e-3, 1e3})};
  const Play play = any_play(input, spacing);
  const Mesh mesh = lattice_mesh(input, spacing);
  require(check_mesh(mesh).has_value());
  check_readings(mesh);

  auto made = make_surface(mesh, reading);
  if (!made) {
    check_error(made.error());
    return 0;
  }
  const auto surface = std::make_shared<const TriangleSurface>(*std::move(made));
  const Field positions = played(surface, play);
  require(positions.allFinite());
  for (int node = 0; node < surface->node_count(); ++node) {
    if (is_outside(play.inputs, surface->rest.row(node).transpose()))
      require(positions.row(node) == surface->rest.row(node));
  }
  require(played(surface, play) == positions);

  // The mesh's own vertices, and some points beside it, as a surface that it drives.
  Field points(mesh.vertex_count() + 4, 3);
  points.topRows(mesh.vertex_count()) = mesh.positions;
  for (int k = 0; k < 4; ++k) {
    points.row(mesh.vertex_count() + k) = lattice_point(input, spacing).transpose();
  }
  const auto binding = Binding::make(*surface, Transform{}, points);
  require(binding.has_value());
  require(binding->displacements(Field::Zero(surface->node_count(), 3)).isZero(0));
  require(binding->displacements(positions - surface->rest).allFinite());
  return 0;
}
