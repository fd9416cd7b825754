// What is made of a mesh can be stopped, and asks the more the larger the mesh is.

#include "support/stopping.hpp"

#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/normals.hpp"
#include "pliant/mesh/triangles/point_tree.hpp"
#include "pliant/mesh/written/binding.hpp"
#include "pliant/mesh/written/nurbs_surface.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

GridSheet sheet_of(int side) { return {.columns = side, .rows = side, .width = 2, .depth = 2}; }

// Checks also that the work on a sheet with sides twice as long asks more than twice as often.
template <class WorkOn>
void check(const WorkOn& work_on, int least_asks) {
  check_stops(work_on(make_mesh(sheet_of(300))), least_asks);
  if (is_sanitized) return;
  const int asks = asks_of(work_on(make_mesh(sheet_of(300))));
  CHECK(asks_of(work_on(make_mesh(sheet_of(600)))) > 2 * asks);
}

}  // namespace

TEST_CASE("a sheet and its grid are stopped", "[mesh][stopping]") {
  check_stops([](const StopRequest& should_stop) { return make_mesh(sheet_of(600), should_stop); },
              10);
  for (const Wrap wrap : {Wrap::None, Wrap::U}) {
    check(
        [wrap](const Mesh& mesh) {
          return [mesh, wrap](const StopRequest& should_stop) -> Result<void> {
            const auto grid = find_grid(mesh, wrap, Seams::Refused, should_stop);
            if (!grid && grid.error().code == ErrorCode::Interrupted) return fail(grid.error());
            return {};
          };
        },
        8);
  }
}

TEST_CASE("a surface of triangles and its tree are stopped", "[mesh][stopping]") {
  check(
      [](const Mesh& mesh) {
        return
            [mesh](const StopRequest& should_stop) { return make_surface(mesh, {}, should_stop); };
      },
      60);
  check(
      [](const Mesh& mesh) {
        return [mesh](const StopRequest& should_stop) {
          return PointTree::make(mesh.positions, should_stop);
        };
      },
      10);
}

TEST_CASE("a binding, and what it moves, are stopped", "[mesh][stopping]") {
  const TriangleSurface driver = make_surface(make_mesh(sheet_of(100))).value();
  check(
      [&](const Mesh& mesh) {
        return [&driver, mesh](const StopRequest& should_stop) {
          return Binding::make(driver, {}, mesh.positions, should_stop);
        };
      },
      is_sanitized ? 50 : 500);
  const int side = is_sanitized ? 200 : 300;
  const Binding binding = Binding::make(driver, {}, make_mesh(sheet_of(side)).positions).value();
  check_stops(
      [&](const StopRequest& should_stop) {
        return binding.displacements(driver.rest, {}, should_stop);
      },
      8);
}

TEST_CASE("normals are stopped", "[mesh][stopping]") {
  check(
      [](const Mesh& mesh) {
        return [mesh](const StopRequest& should_stop) {
          return unit_normals(mesh, mesh.positions, should_stop);
        };
      },
      10);
}

TEST_CASE("a net is stopped, whatever its degree", "[mesh][stopping][nurbs]") {
  for (const int degree : {3, 12}) {
    NurbsNet net{.u = {.count = 40, .degree = degree}, .v = {.count = 30, .degree = degree}};
    net.points = make_mesh({.columns = 40, .rows = 30, .width = 1, .depth = 1}).positions;
    const auto work = [&](const StopRequest& should_stop) { return make_nurbs(net, should_stop); };
    net.u.samples = net.v.samples = 300;
    check_stops(work, 10);
    if (is_sanitized) continue;
    const int asks = asks_of(work);
    net.u.samples = net.v.samples = 600;
    CHECK(asks_of(work) > 2 * asks);
  }
}
