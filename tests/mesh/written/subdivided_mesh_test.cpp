// Tests of the builds that have OpenSubdiv.

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <set>
#include <utility>

#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/written/subdivide.hpp"
#include "support/catch.hpp"
#include "support/meshes.hpp"
#include "support/sanitized.hpp"
#include "support/stopping.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

constexpr SubdivisionScheme catmull_clark = SubdivisionScheme::CatmullClark;
constexpr SubdivisionScheme loop = SubdivisionScheme::Loop;

SubdividedMesh refined(const Mesh& mesh, int levels, SubdivisionScheme scheme = catmull_clark) {
  const TriangleSurface surface = make_surface(mesh).value();
  SubdividedMesh made = subdivide(mesh, surface, {levels, scheme}).value();
  CHECK(check_mesh(made.mesh));
  const WrittenSize size = check_subdivision(mesh, surface, {levels, scheme}).value();
  CHECK(made.mesh.vertex_count() == size.vertices);
  CHECK(made.weights.vertex_count() == size.vertices);
  CHECK(static_cast<std::int64_t>(made.mesh.face_sizes.size()) == size.faces);
  CHECK(static_cast<std::int64_t>(made.weights.nodes.size()) <= size.weights);
  return made;
}

std::string complaint_of_subdivide(const Mesh& mesh, const Subdivision& subdivision) {
  const auto made = subdivide(mesh, make_surface(mesh).value(), subdivision);
  REQUIRE_FALSE(made);
  CHECK(made.error().code == ErrorCode::InvalidInput);
  return made.error().message;
}

// The cube from -1 to 1: vertex 4z + 2y + x.
Mesh wide_cube() {
  std::vector<Vector3d> positions;
  for (int k = 0; k < 8; ++k)
    positions.push_back({2.0 * (k % 2) - 1, 2.0 * (k / 2 % 2) - 1, 2.0 * (k / 4) - 1});
  return mesh_of(
      positions,
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}});
}

// A pentagon, a quad and a triangle round a vertex, and a hole beside.
Mesh mixed() {
  return mesh_of({{0, 0, 0},
                  {2, 0, 0.3},
                  {2, 2, 0},
                  {0, 2, 1},
                  {-2, 0, 0},
                  {-1, -2, 0.5},
                  {1, -2, 0},
                  {3, -2, 1}},
                 {{0, 1, 2, 3}, {0, 3, 4}, {0, 4, 5, 6, 1}, {1, 6, 7}});
}

int edge_count(const Mesh& mesh) {
  std::set<std::pair<int, int>> edges;
  int start = 0;
  for (const int size : mesh.face_sizes) {
    for (int k = 0; k < size; ++k) {
      const int a = mesh.corner_vertices[start + k];
      edges.insert(std::minmax(a, mesh.corner_vertices[start + (k + 1) % size]));
    }
    start += size;
  }
  return static_cast<int>(edges.size());
}

int corner_count(const Mesh& mesh) { return static_cast<int>(mesh.corner_vertices.size()); }
int face_count(const Mesh& mesh) { return static_cast<int>(mesh.face_sizes.size()); }

// The (u,v) of every corner.
std::vector<std::array<double, 2>> corner_uvs(const Mesh& mesh) {
  std::vector<std::array<double, 2>> uvs;
  for (const int uv : mesh.corner_uvs) uvs.push_back(mesh.uvs[uv]);
  return uvs;
}

// Two quads side by side in the xz-plane, whose UVs have a seam between them.
Mesh seamed() {
  Mesh mesh = mesh_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {0, 0, 1}, {1, 0, 1}, {2, 0, 1}},
                      {{0, 3, 4, 1}, {1, 4, 5, 2}});
  mesh.uvs = {{0, 0}, {0, 1}, {0.4, 1}, {0.4, 0}, {0.5, 0}, {0.5, 1}, {1, 1}, {1, 0}};
  std::iota(mesh.corner_uvs.begin(), mesh.corner_uvs.end(), 0);
  return mesh;
}

}  // namespace

TEST_CASE("level 0 is the cage", "[mesh][subdivision]") {
  Mesh mesh = mixed();
  mesh.materials = {{"a", "b"}, {1, 0, -1, 1}};
  mesh.groups = {{"g"}, {0, -1, 0, -1}};
  mesh.object = "thing";
  const SubdividedMesh made = refined(mesh, 0);
  CHECK(made.mesh.positions == mesh.positions);
  CHECK(made.mesh.face_sizes == mesh.face_sizes);
  CHECK(made.mesh.corner_vertices == mesh.corner_vertices);
  CHECK(made.mesh.corner_uvs == mesh.corner_uvs);
  CHECK(made.mesh.materials == mesh.materials);
  CHECK(made.mesh.groups == mesh.groups);
  CHECK(made.mesh.object == "thing");
  CHECK(made.weights.weights == std::vector<double>(8, 1));
}

TEST_CASE("each level has the counts of its scheme", "[mesh][subdivision]") {
  for (const auto& [cage, scheme] :
       {std::pair(wide_cube(), catmull_clark), std::pair(mixed(), catmull_clark),
        std::pair(sphere(0), catmull_clark), std::pair(sphere(0), loop),
        std::pair(square(3, 1, 0.2), loop)}) {
    const int euler = cage.vertex_count() - edge_count(cage) + face_count(cage);
    Mesh before = cage;
    for (int level = 1; level <= 4; ++level) {
      const Mesh mesh = refined(cage, level, scheme).mesh;
      const bool is_loop = scheme == loop;
      const int edges = edge_count(before);
      CHECK(face_count(mesh) == (is_loop ? 4 * face_count(before) : corner_count(before)));
      CHECK(mesh.vertex_count() ==
            before.vertex_count() + edges + (is_loop ? 0 : face_count(before)));
      CHECK(edge_count(mesh) ==
            2 * edges + (is_loop ? 3 * face_count(before) : corner_count(before)));
      CHECK(std::ranges::count(mesh.face_sizes, is_loop ? 3 : 4) == face_count(mesh));
      CHECK(mesh.vertex_count() - edge_count(mesh) + face_count(mesh) == euler);
      before = mesh;
    }
  }
}

TEST_CASE("Catmull and Clark's cube, worked out by hand", "[mesh][subdivision]") {
  const Mesh mesh = refined(wide_cube(), 1).mesh;
  REQUIRE(mesh.vertex_count() == 26);
  // A corner: (Q + 2 R + 0 S) / 3 with the mean Q of its faces' centres, 1/3 of it, and the mean R
  // of its edges' middles, 2/3 of it: 1/3 (1/3 + 4/3) = 5/9.
  for (int k = 0; k < 8; ++k) {
    CHECK((mesh.positions.row(k) - wide_cube().positions.row(k) * 5 / 9).norm() < 1e-15);
  }
  // The centres of the faces, in their order.
  const std::vector<Eigen::RowVector3d> centres = {{0, 0, -1}, {0, 0, 1},  {0, -1, 0},
                                                   {0, 1, 0},  {-1, 0, 0}, {1, 0, 0}};
  for (int k = 0; k < 6; ++k) CHECK(mesh.positions.row(8 + k) == centres[k]);
  // An edge: the mean of its two ends (1, 1, +-1) and of the centres (1, 0, 0) and (0, 1, 0).
  for (int k = 14; k < 26; ++k) {
    Eigen::RowVector3d sizes = mesh.positions.row(k).cwiseAbs();
    std::sort(sizes.data(), sizes.data() + 3);
    CHECK((sizes - Eigen::RowVector3d(0, 0.75, 0.75)).norm() < 1e-15);
  }
  // Each face's children are its corners' quads, in their order, turned as before.
  CHECK(mesh.corner_vertices[0] == 0);
  CHECK(mesh.corner_vertices[2] == 8);
  CHECK(mesh.corner_vertices[5] == 2);
  CHECK(mesh.corner_vertices[4 * 4 + 2] == 9);
}

TEST_CASE("Loop's octahedron, worked out by hand", "[mesh][subdivision]") {
  const Mesh octahedron = mesh_of(
      {{1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}},
      {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {1, 0, 5}, {2, 1, 5}, {3, 2, 5}, {0, 3, 5}});
  const Mesh mesh = refined(octahedron, 1, loop).mesh;
  // Valence 4: 5/8 - (3/8 + cos(90 deg)/4)^2 = 31/64 goes to the neighbours, which cancel.
  for (int k = 0; k < 6; ++k) {
    CHECK((mesh.positions.row(k) - octahedron.positions.row(k) * 33 / 64).norm() < 1e-15);
  }
  // An edge: 3/8 of its ends, 1/8 of the corners opposite, which cancel.
  for (int k = 6; k < 18; ++k) {
    CHECK_THAT(mesh.positions.row(k).norm(), WithinAbs(0.375 * std::numbers::sqrt2, 1e-15));
  }
}

TEST_CASE("an even grid of quads becomes the cubic B-spline", "[mesh][subdivision]") {
  const Mesh cage = make_mesh({.columns = 6, .rows = 6, .width = 5, .depth = 5});
  const SubdividedMesh made = refined(cage, 1);
  // Vertex (2, 2), valence 4: 9/16 of itself, 3/32 of edge and 1/64 of diagonal neighbours.
  const auto entry = [&](int node) {
    const VertexWeights& weights = made.weights;
    for (std::size_t k = weights.starts[14]; k < weights.starts[15]; ++k) {
      if (weights.nodes[k] == node) return weights.weights[k];
    }
    return 0.0;
  };
  for (int j = 0; j < 6; ++j) {
    for (int i = 0; i < 6; ++i) {
      const double along[] = {0.75, 0.125};
      const int di = std::abs(i - 2), dj = std::abs(j - 2);
      CHECK(entry(j * 6 + i) == (di < 2 && dj < 2 ? along[di] * along[dj] : 0));
    }
  }
}

TEST_CASE("a plane stays a plane, and its border on its lines", "[mesh][subdivision]") {
  const SubdivisionScheme scheme = GENERATE(catmull_clark, loop);
  const Mesh cage = square(4, 2, 0.2);
  const TriangleSurface surface = make_surface(cage).value();
  const Mesh mesh = refined(cage, 3, scheme).mesh;
  CHECK(mesh.positions.col(1).isZero(0));
  int on_border = 0;
  for (const auto& place : mesh.positions.rowwise()) on_border += place.cwiseAbs().maxCoeff() == 1;
  // A corner of two faces becomes round. A node reaches 2 (8 - 1) parts of the border's curve, 8 to
  // an edge: those next to the corner reach 6 parts of the side beyond it. With the corner: 13.
  int expected = 4 * 4 * 8;
  for (const int corner : {0, 4, 20, 24}) {
    const bool is_sharp = surface.faces_of(corner).size() == 1;
    CHECK((mesh.positions.row(corner) == cage.positions.row(corner)) == is_sharp);
    if (!is_sharp) expected -= 13;
  }
  CHECK(on_border == expected);
}

TEST_CASE("corners of one face stay", "[mesh][subdivision]") {
  const Mesh cage = square(4, 2, 0.2, true);
  const Mesh mesh = refined(cage, 3).mesh;
  for (const int corner : {0, 4, 20, 24})
    CHECK(mesh.positions.row(corner) == cage.positions.row(corner));
}

TEST_CASE("weights add up to 1, and maps of the cage map the surface", "[mesh][subdivision]") {
  for (const auto& [cage, scheme] :
       {std::pair(mixed(), catmull_clark), std::pair(wide_cube(), catmull_clark),
        std::pair(sphere(1), loop), std::pair(square(3, 1, 0.2), catmull_clark)}) {
    const TriangleSurface surface = make_surface(cage).value();
    const SubdividedMesh made = refined(cage, 3, scheme);
    const Field ones = made.weights.apply(Field::Ones(surface.node_count(), 3));
    CHECK((ones.array() - 1).abs().maxCoeff() < 1e-15 * 8);
    for (int vertex = 0; vertex < made.weights.vertex_count(); ++vertex) {
      const auto begin = made.weights.nodes.begin();
      CHECK(std::is_sorted(begin + made.weights.starts[vertex],
                           begin + made.weights.starts[vertex + 1], std::less_equal<>{}));
    }
    Matrix3d map;
    map << 1, -2, 0.5, 0.25, 3, -1, 2, 0, 0.75;
    const Eigen::RowVector3d shift(3, -2, 1);
    const Field moved = made.weights.apply((surface.rest * map).rowwise() + shift);
    CHECK((moved - ((made.mesh.positions * map).rowwise() + shift)).cwiseAbs().maxCoeff() < 1e-13);
  }
}

TEST_CASE("refining in two steps is refining twice", "[mesh][subdivision]") {
  // Faces and their corners keep their order; vertices need not, as edges are found anew.
  for (const auto& [cage, scheme] :
       {std::pair(mixed(), catmull_clark), std::pair(square(3, 1, 0.2), loop)}) {
    const Mesh once = refined(cage, 1, scheme).mesh;
    const Mesh twice = refined(once, 1, scheme).mesh, both = refined(cage, 2, scheme).mesh;
    REQUIRE(corner_count(twice) == corner_count(both));
    double worst = 0;
    for (int corner = 0; corner < corner_count(both); ++corner) {
      const auto difference = twice.positions.row(twice.corner_vertices[corner]) -
                              both.positions.row(both.corner_vertices[corner]);
      worst = std::max(worst, difference.cwiseAbs().maxCoeff());
    }
    CHECK(worst < 1e-14);
  }
}

TEST_CASE("a mesh is refined as a surface: twins, and faces without part", "[mesh][subdivision]") {
  // Vertex 8 is a twin of 1; vertex 9 is only in a face that takes no part, and 10 in none.
  Mesh mesh = mixed();
  mesh.positions.conservativeResize(11, 3);
  mesh.positions.row(8) = mesh.positions.row(1);
  mesh.positions.row(9) << 9, 9, 9;
  mesh.positions.row(10) << -9, 9, 9;
  mesh.face_sizes.insert(mesh.face_sizes.begin(), 3);
  mesh.corner_vertices.insert(mesh.corner_vertices.begin(), {9, 0, 9});
  mesh.corner_uvs.assign(mesh.corner_vertices.size(), -1);
  mesh.corner_vertices[3 + 4 + 3 + 5] = 8;  // of the last face
  mesh.materials = {{"none", "a", "b"}, {0, 1, 2, 1, 2}};
  const SubdividedMesh made = refined(mesh, 2);
  const SubdividedMesh expected = refined(mixed(), 2);
  CHECK(made.mesh.corner_vertices == expected.mesh.corner_vertices);
  CHECK(made.mesh.positions == expected.mesh.positions);
  CHECK(made.mesh.materials.names == mesh.materials.names);
  std::vector<int> materials;
  for (const auto& [corners, material] : {std::pair(4, 1), {3, 2}, {5, 1}, {3, 2}})
    materials.insert(materials.end(), static_cast<std::size_t>(4 * corners), material);
  CHECK(made.mesh.materials.of_faces == materials);
  CHECK(made.mesh.groups == FaceNames{});
}

TEST_CASE("weights count the nodes of the surface", "[mesh][subdivision]") {
  Mesh mesh =
      mesh_of({{5, 5, 5}, {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}, {{0, 1, 0}, {1, 2, 3, 4}});
  const SubdividedMesh made = refined(mesh, 0);
  CHECK(made.weights.nodes == std::vector{1, 2, 3, 4});
  CHECK(made.mesh.positions == mesh.positions.bottomRows(4));
}

TEST_CASE("UVs are refined, and stay on the corners of their charts", "[mesh][subdivision]") {
  const Mesh cage = seamed();
  for (int level = 0; level <= 3; ++level) {
    const Mesh mesh = refined(cage, level).mesh;
    const int parts = 1 << level;
    REQUIRE(mesh.uvs.size() == static_cast<std::size_t>(2 * (parts + 1) * (parts + 1)));
    const auto uvs = corner_uvs(mesh);
    // Both charts are bilinear over their quads, and their borders straight.
    for (std::size_t corner = 0; corner < uvs.size(); ++corner) {
      const auto place = mesh.positions.row(mesh.corner_vertices[corner]);
      const bool is_left = corner < uvs.size() / 2;
      CHECK_THAT(uvs[corner][1], WithinAbs(place.z(), 1e-15));
      CHECK(uvs[corner][0] >= (is_left ? 0 : 0.5));
      CHECK(uvs[corner][0] <= (is_left ? 0.4 : 1));
    }
    for (const auto& corner : cage.uvs) CHECK(std::ranges::count(mesh.uvs, corner) == 1);
  }
}

TEST_CASE("equal UVs at one node are one", "[mesh][subdivision]") {
  Mesh one = make_mesh({.columns = 4, .rows = 4, .width = 1, .depth = 1});
  Mesh apart = one;  // each corner its own
  apart.uvs = corner_uvs(one);
  std::iota(apart.corner_uvs.begin(), apart.corner_uvs.end(), 0);
  const Mesh expected = refined(one, 2).mesh, mesh = refined(apart, 2).mesh;
  CHECK(mesh.uvs == expected.uvs);
  CHECK(mesh.corner_uvs == expected.corner_uvs);
  // One index may serve many nodes.
  Mesh shared = one;
  std::ranges::fill(shared.corner_uvs, 5);
  for (const auto& uv : refined(shared, 2).mesh.uvs) {
    CHECK_THAT(uv[0], WithinAbs(one.uvs[5][0], 1e-15));
    CHECK_THAT(uv[1], WithinAbs(one.uvs[5][1], 1e-15));
  }
}

TEST_CASE("a corner without a UV leaves its surroundings without", "[mesh][subdivision]") {
  Mesh cage = seamed();
  for (int corner = 4; corner < 8; ++corner) cage.corner_uvs[corner] = -1;
  const Mesh half = refined(cage, 2).mesh;
  for (int corner = 0; corner < corner_count(half); ++corner)
    CHECK((half.corner_uvs[corner] >= 0) == (corner < corner_count(half) / 2));
  CHECK(half.uvs.size() == 25);
  cage.corner_uvs[6] = 6;  // of one corner alone: the child there keeps that UV at that corner
  const Mesh alone = refined(cage, 1).mesh;
  CHECK(std::ranges::count_if(alone.corner_uvs, [](int uv) { return uv >= 0; }) == 16 + 1);
  CHECK(refined(mixed(), 2).mesh.uvs.empty());
}

TEST_CASE("any cage is refined: branches, bow ties, mirrored faces", "[mesh][subdivision]") {
  const std::vector<Vector3d> places = {{0, 0, 0}, {1, 0, 0},  {0, 1, 0},  {1, 1, 0}, {0, 0, 1},
                                        {1, 0, 1}, {0, -1, 0}, {1, -1, 0}, {2, 2, 2}};
  const SubdivisionScheme scheme = GENERATE(catmull_clark, loop);
  std::mt19937 random(8);
  const auto node = [&] { return static_cast<int>(random() % 9); };
  for (int round = 0; round < 200; ++round) {
    std::vector<std::vector<int>> faces = {{0, 1, 2}};
    const std::size_t count = 1 + random() % 12;
    while (faces.size() < count) {
      if (scheme == loop || random() % 2 == 0)
        faces.push_back({node(), node(), node()});
      else
        faces.push_back({node(), node(), node(), node(), node()});
    }
    Mesh mesh = mesh_of(places, faces);
    if (round % 2 == 0) {
      mesh.uvs = {{0, 0}, {1, 0}, {0, 1}, {1, 1}};
      for (int& uv : mesh.corner_uvs) uv = static_cast<int>(random() % 4);
    }
    const TriangleSurface surface = make_surface(mesh).value();
    const bool has_only_triangles =
        surface.mesh_corners.size() == 3 * static_cast<std::size_t>(surface.face_count());
    REQUIRE((scheme == catmull_clark || has_only_triangles));
    const SubdividedMesh made = refined(mesh, 2, scheme);
    CHECK(made.mesh.positions.minCoeff() >= -1);
    CHECK(made.mesh.positions.maxCoeff() <= 2);
    for (const auto& [u, v] : made.mesh.uvs) CHECK((u >= 0 && u <= 1 && v >= 0 && v <= 1));
  }
}

TEST_CASE("the scheme loop and levels have rules", "[mesh][subdivision]") {
  Mesh mesh = mixed();
  mesh.first_index = 1;
  CHECK(complaint_of_subdivide(mesh, {2, loop}) ==
        "face 1 has 4 corners, but the scheme \"loop\" takes triangles only; \"catmullClark\" "
        "takes all faces");
  Mesh later =
      mesh_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {{0, 1, 1}, {0, 1, 2}, {0, 1, 3, 2}});
  CHECK_THAT(complaint_of_subdivide(later, {2, loop}), contains_text("face 2 has 4 corners"));
  CHECK(complaint_of_subdivide(mesh, {-1}) == "levels is -1, but must be from 0 to 6");
  CHECK(complaint_of_subdivide(mesh, {7}) == "levels is 7, but must be from 0 to 6");
}

TEST_CASE("a cage that becomes too large is refused before it takes memory",
          "[mesh][subdivision]") {
  if (is_sanitized) return;  // its size is what it is about
  const Mesh cage = make_mesh({.columns = 200, .rows = 200, .width = 1, .depth = 1});
  CHECK(complaint_of_subdivide(cage, {6}) ==
        "levels is 6: the cage would become 162231169 vertices and 162205696 faces, but 100000000 "
        "and 500000000 are the most");
  CHECK(check_subdivision(cage, make_surface(cage).value(), {5}).value().vertices == 6369 * 6369);
}

TEST_CASE("a node has a most of faces", "[mesh][subdivision]") {
  const auto fan = [](int count) {
    std::vector<Vector3d> positions = {{0, 0, 0}};
    std::vector<std::vector<int>> faces;
    for (int k = 1; k <= count; ++k) {
      const double angle = 2 * std::numbers::pi * k / count;
      positions.push_back({std::cos(angle), std::sin(angle), 0});
      faces.push_back({0, k, k % count + 1});
    }
    return mesh_of(positions, faces);
  };
  CHECK(refined(fan(40), 3, loop).mesh.vertex_count() == 40 * 4 * 9 + 1);
  if (is_sanitized) return;  // the rest is about sizes
  CHECK_THAT(complaint_of_subdivide(fan(65536), {1}),
             contains_text("vertex 0 has 65536 faces or edges, but 65535 is the most"));
  CHECK_THAT(complaint_of_subdivide(fan(30000), {5}),
             contains_text("vertices of the cage would depend on too many of its nodes"));
}

TEST_CASE("a subdivision is stopped", "[mesh][stopping][subdivision]") {
  const Mesh cage = make_mesh({.columns = 60, .rows = 60, .width = 1, .depth = 1});
  const TriangleSurface surface = make_surface(cage).value();
  check_stops(
      [&](const StopRequest& should_stop) {
        return subdivide(cage, surface, {.levels = 3}, should_stop);
      },
      60);
}
