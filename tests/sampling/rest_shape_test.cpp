#include "pliant/sampling/rest_shape.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;
using Catch::Matchers::StartsWith;

namespace {

Surface with_shape(SurfaceShape shape) {
  Surface surface;
  surface.name = "s";
  surface.shape = std::move(shape);
  return surface;
}

const SceneOrigin origin = origin_of("a.xml", {{"s", 2}, {"s.file", 4}});

std::string complaint(SurfaceShape shape) {
  const auto rest = make_rest_shape(with_shape(std::move(shape)), origin);
  return rest ? "none" : to_lines(rest.error()).front();
}

}  // namespace

TEST_CASE("a sheet, its mesh in code and its file are one surface", "[sampling][rest_shape]") {
  const GridSheet sheet{.columns = 4, .rows = 3, .width = 3, .depth = 2};
  const RestShape from_sheet = make_rest_shape(with_shape(sheet), {})->shape;
  CHECK(from_sheet.name == "s");
  CHECK(make_rest_shape(with_shape(make_mesh(sheet)), {})->shape.rest == from_sheet.rest);

  const ScratchFolder folder;
  std::string obj;
  for (int j = 0; j < 3; ++j) {
    for (int i = 0; i < 4; ++i) {
      obj += "v " + std::to_string(i - 1.5) + " 0 " + std::to_string(j - 1) + "\nvt " +
             std::to_string(i) + " " + std::to_string(j) + "\n";
    }
  }
  for (int k : {1, 2, 3, 5, 6, 7}) {
    obj += "f";
    for (int corner : {k, k + 4, k + 5, k + 1})
      obj += " " + std::to_string(corner) + "/" + std::to_string(corner);
    obj += "\n";
  }
  const auto from_file = make_rest_shape(with_shape(MeshFile{folder.write("m.obj", obj)}), {});
  REQUIRE(from_file);
  CHECK(from_file->shape.rest == from_sheet.rest);
}

TEST_CASE("a sheet is the grid that its mesh would be, however thin it is",
          "[sampling][rest_shape]") {
  for (int columns = 3; columns < 60; columns += 2) {
    for (const bool triangles : {false, true}) {
      const GridSheet sheet{.columns = columns,
                            .rows = columns / 2 + 2,
                            .width = 0.7,
                            .depth = 3,
                            .triangles = triangles};
      const RestShape own = make_rest_shape(with_shape(sheet), {})->shape;
      const RestShape mesh = make_rest_shape(with_shape(make_mesh(sheet)), {})->shape;
      REQUIRE((own.grid && mesh.grid));
      CHECK((own.grid->hu == mesh.grid->hu && own.grid->hv == mesh.grid->hv));
      CHECK((own.rest == mesh.rest && own.vertex_nodes == mesh.vertex_nodes));
    }
  }
  for (const double width : {1e-12, 1e-6, 1e6, 1e12}) {
    const RestShape thin =
        make_rest_shape(with_shape(GridSheet{.columns = 5, .rows = 41, .width = width}), {})->shape;
    REQUIRE(thin.grid);
    CHECK(thin.grid->node_count() == 205);
    CHECK(thin.note.empty());
  }
}

TEST_CASE("the memory of a shape is reserved as long as it is held", "[simulation][rest_shape]") {
  const Surface surface = with_shape(GridSheet{.columns = 4, .rows = 3, .width = 3, .depth = 2});
  MemoryBudget budget(1'000'000);
  const RunContext context{.memory = &budget};
  std::size_t checked_bytes = 0;
  {
    const auto checked = check_rest_shape(surface, origin, context);
    REQUIRE(checked);
    checked_bytes = checked->memory.bytes();
    CHECK(checked_bytes > 0);
    CHECK(budget.total() - budget.available() == checked_bytes);
  }
  CHECK(budget.available() == budget.total());
  {
    const auto made = make_rest_shape(surface, origin, context);
    REQUIRE(made);
    CHECK(made->memory.bytes() == checked_bytes);
    CHECK(budget.total() - budget.available() == checked_bytes);
  }
  CHECK(budget.available() == budget.total());

  MemoryBudget little(checked_bytes - 1);
  CHECK(check_rest_shape(surface, origin, {.memory = &little}).error().code ==
        ErrorCode::OutOfMemory);
  CHECK(make_rest_shape(surface, origin, {.memory = &little}).error().code ==
        ErrorCode::OutOfMemory);
}

TEST_CASE("a mesh is read in the way that suits it, or that the scene asks for",
          "[sampling][rest_shape]") {
  const Mesh sheet = make_mesh({.columns = 4, .rows = 3, .width = 3, .depth = 2});
  Mesh bare = sheet;  // without UVs
  std::fill(bare.corner_uvs.begin(), bare.corner_uvs.end(), -1);
  const auto shape_of = [&](const Mesh& mesh, const MeshReading& reading) {
    Surface surface = with_shape(mesh);
    surface.reading = reading;
    return make_rest_shape(surface, origin).value().shape;
  };
  const RestShape grid = shape_of(sheet, {});
  CHECK(grid.grid);
  CHECK_FALSE(grid.surface);
  CHECK(grid.note.empty());
  const RestShape surface = shape_of(bare, {});
  CHECK_FALSE(surface.grid);
  REQUIRE(surface.surface);
  CHECK_THAT(surface.note,
             StartsWith("s: the mesh is read as a surface,") && Contains("(it has no (u,v)"));
  CHECK(surface.rest == sheet.positions);
  // Asked for, so that there is nothing to note.
  for (const MeshReading& reading :
       {MeshReading{.uv = UvReading::Surface}, MeshReading{.unit = {{1, 2}}},
        MeshReading{.axis = {{0, 0, 1}}}, MeshReading{.border = Border::Free},
        MeshReading{.weld = 0}}) {
    const RestShape asked = shape_of(sheet, reading);
    CHECK(asked.surface);
    CHECK(asked.note.empty());
  }
  Surface refused = with_shape(bare);
  refused.reading.uv = UvReading::Grid;
  CHECK_THAT(make_rest_shape(refused, origin).error().message,
             Contains("the mesh is no even grid: it has no (u,v)") && Contains("uv=\"surface\""));
  refused = with_shape(bare);
  refused.solver.reference = Reference::None;
  CHECK_THAT(make_rest_shape(refused, origin).error().message,
             Contains("reference=\"none\" needs a grid"));
}

TEST_CASE("a mesh of a program closes by wrap as a file does", "[sampling][rest_shape]") {
  // A tube of 6 columns, whose seam is there once, with both (u,v).
  Mesh tube = make_mesh({.columns = 7, .rows = 4});
  for (int k = 0; k < 28; ++k) {
    const double angle = 2 * std::numbers::pi * (k % 7 % 6) / 6;
    tube.positions.row(k) << std::cos(angle), k / 7, std::sin(angle);
  }
  Surface surface = with_shape(tube);
  surface.reading.wrap = Wrap::U;
  const RestShape shape = make_rest_shape(surface, {}).value().shape;
  REQUIRE(shape.grid);
  CHECK(shape.grid->columns == 6);
  CHECK(shape.grid->is_closed_u);
  CHECK_FALSE(shape.grid->is_closed_v);
}

TEST_CASE("vertices of one node keep their offsets, those in no face their place",
          "[sampling][rest_shape]") {
  Mesh mesh;
  mesh.positions.resize(5, 3);
  mesh.positions << 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 1e-7, 0, 7, 7, 7;
  mesh.face_sizes = {3, 3};
  mesh.corner_vertices = {0, 1, 2, 0, 2, 3};
  mesh.corner_uvs.assign(6, -1);
  mesh.positions.row(3) << 1e-7, 0, 0;  // beside vertex 0: a twin
  mesh.corner_vertices = {0, 1, 2, 3, 2, 1};
  const RestShape shape = make_rest_shape(with_shape(mesh), origin).value().shape;
  REQUIRE(shape.rest.rows() == 3);
  CHECK(shape.vertex_nodes == std::vector{0, 1, 2, 0, -1});
  CHECK(shape.to_vertices(shape.rest) == mesh.positions);
  Field nodes = shape.rest;
  nodes.row(0) += Eigen::RowVector3d(0, 2, 0);
  const Field vertices = shape.to_vertices(nodes);
  CHECK(vertices.row(3) - vertices.row(0) == Eigen::RowVector3d(1e-7, 0, 0));
  CHECK(vertices(3, 1) == 2);
  CHECK(vertices.row(4) == mesh.positions.row(4));
}

TEST_CASE("pieces are of faces that take part", "[sampling][rest_shape]") {
  // Two triangles that share a corner, one apart, and one that has a corner twice.
  Mesh mesh;
  mesh.positions = Field::Zero(10, 3);
  for (int vertex = 0; vertex < 10; ++vertex) {
    mesh.positions.row(vertex) << vertex, 0, vertex * vertex;
  }
  mesh.face_sizes = {3, 3, 3, 3};
  mesh.corner_vertices = {0, 1, 2, 2, 3, 4, 5, 6, 7, 8, 9, 9};
  mesh.corner_uvs.assign(12, -1);
  const SurfaceSummary told =
      summary_of(make_rest_shape(with_shape(mesh), origin).value().shape).value();
  CHECK(told.nodes == 10);
  CHECK(told.faces == 3);
  CHECK(told.pieces == 2);
  CHECK(told.border_edges == 9);
}

TEST_CASE("a shape that cannot be had is the scene's error or the file's",
          "[sampling][rest_shape]") {
  const ScratchFolder folder;
  CHECK_THAT(complaint(MeshFile{folder.file("none.obj")}),
             StartsWith("a.xml:4: error: surface \"s\": ") && Contains("none.obj") &&
                 Contains("No such file"));
  CHECK_THAT(complaint(MeshFile{folder.write("bad.obj", "v 1 2\n")}),
             Contains("bad.obj:1: error: vertex has 2 numbers, but needs 3"));
  CHECK_THAT(
      complaint(MeshFile{folder.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 2\n")}),
      StartsWith("a.xml:4: error: surface \"s\", mesh ") && Contains("none of the mesh's 1"));
  for (const std::string ending : {".ply", ".gltf", ".glb", ".fbx", ".dae"}) {
    CHECK_THAT(complaint(MeshFile{folder.file("none" + ending)}),
               StartsWith("a.xml:4: error: surface \"s\": ") && Contains("No such file"));
  }
  CHECK_THAT(complaint(MeshFile{folder.write("mesh.stl", "")}),
             StartsWith("a.xml:4: error: ") && Contains("allowed: .obj, .ply"));
  CHECK_THAT(
      complaint(MeshFile{folder.write("set.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "", 1}),
      Contains("set.obj: error: the object has 0 UV sets"));
  CHECK_THAT(complaint(Mesh{}), StartsWith("a.xml:2: error: ") || StartsWith("a.xml:4: error: "));
}
