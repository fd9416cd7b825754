#include "pliant/sampling/memory.hpp"

#include "pliant/files/open_file.hpp"
#include "pliant/files/opened_mesh.hpp"

namespace pliant {
namespace {

constexpr std::size_t bytes_of_vector = 3 * sizeof(double);
constexpr std::size_t bytes_of_uv = 2 * sizeof(double);

std::size_t bytes_of_mesh(std::size_t vertices, std::size_t uvs, std::size_t faces,
                          std::size_t corners) {
  return vertices * bytes_of_vector + uvs * bytes_of_uv + (faces + 2 * corners) * sizeof(int);
}

std::size_t corners_of(const GridSheet& sheet) {
  const std::size_t quads =
      (static_cast<std::size_t>(sheet.columns) - 1) * (static_cast<std::size_t>(sheet.rows) - 1);
  return (sheet.triangles ? 6 : 4) * quads;
}

std::size_t bytes_as_surface(std::size_t corners, std::size_t vertices) {
  // A corner: its node, edge and origin, twice while edges are numbered, its face at its node, and,
  // as a triangle of a face, what is laid flat, and two cells of a region with their points,
  // slopes, and sides.
  constexpr std::size_t bytes_of_corner = 40 + 60 + 8 + 32 + 2 * 250;
  // A vertex: in the trees for welding and for selecting, its rest position twice, its place in the
  // region.
  constexpr std::size_t bytes_of_vertex = 300;
  return corners * bytes_of_corner + vertices * bytes_of_vertex;
}

}  // namespace

std::size_t bytes_of(const Mesh& mesh) {
  const std::size_t names = mesh.materials.of_faces.size() + mesh.groups.of_faces.size();
  return bytes_of_mesh(static_cast<std::size_t>(mesh.positions.rows()), mesh.uvs.size(),
                       mesh.face_sizes.size(), mesh.corner_vertices.size()) +
         (mesh.corner_normals.size() + mesh.file_vertices.size() + names) * sizeof(int);
}

std::size_t bytes_to_read(const OpenFile& file) {
  return bytes_to_read_byte * static_cast<std::size_t>(file.size());
}

std::size_t bytes_to_read_references(const OpenFile& file, const std::string& root,
                                     const StopRequest& should_stop) {
  std::size_t bytes = 0;
  for (const auto& reference : mesh_references(file, root, should_stop)) {
    // If it cannot be opened, reading it reports that.
    if (const auto opened = OpenFile::open(reference, root)) bytes += bytes_to_read(*opened);
  }
  return bytes;
}

std::size_t bytes_of(const GridSheet& sheet) {
  const auto columns = static_cast<std::size_t>(sheet.columns);
  const auto rows = static_cast<std::size_t>(sheet.rows);
  const std::size_t quads = (columns - 1) * (rows - 1);
  return bytes_of_mesh(columns * rows, columns * rows, (sheet.triangles ? 2 : 1) * quads,
                       corners_of(sheet));
}

std::size_t bytes_of(const WrittenSize& size) {
  const auto vertices = static_cast<std::size_t>(size.vertices);
  const auto faces = static_cast<std::size_t>(size.faces);
  // An entry of the weights, and its copy while it is put in order.
  constexpr std::size_t bytes_of_weight = 32;
  return bytes_of_mesh(vertices, 2 * vertices, faces, 4 * faces) +
         static_cast<std::size_t>(size.weights) * bytes_of_weight +
         vertices * 2 * sizeof(std::size_t);
}

std::size_t bytes_to_bind(std::size_t vertex_count, const TriangleSurface* surface,
                          const Mesh& mesh) {
  // A vertex: in world space, its triangle, weights and displacement.
  constexpr std::size_t bytes_of_bound_vertex = 100;
  // A corner of a driver: a triangle, its gradients, a centre's part; in the tree; a node with w
  // and its gradient.
  constexpr std::size_t bytes_of_corner = 400;
  const std::size_t corners = surface ? surface->corner_nodes.size() : mesh.corner_vertices.size();
  return vertex_count * bytes_of_bound_vertex + corners * bytes_of_corner +
         (surface ? 0 : bytes_as_surface(mesh));
}

std::size_t bytes_of_faces(const Mesh& mesh) {
  // A corner: its node, and its face at its node; a face and a vertex: where theirs begin.
  return (2 * mesh.corner_vertices.size() + mesh.face_sizes.size() +
          static_cast<std::size_t>(mesh.vertex_count())) *
         sizeof(int);
}

std::size_t bytes_as_surface(const Mesh& mesh) {
  return bytes_as_surface(mesh.corner_vertices.size(),
                          static_cast<std::size_t>(mesh.vertex_count()));
}

std::size_t bytes_as_surface(const GridSheet& sheet) {
  const auto columns = static_cast<std::size_t>(sheet.columns);
  const auto rows = static_cast<std::size_t>(sheet.rows);
  return bytes_as_surface(corners_of(sheet), columns * rows);
}
std::size_t bytes_to_run(std::size_t vertex_count) {
  // Vectors per node: rest in the mapping and in the body; position and velocity, present and new;
  // load, displacement and velocity of the plate, twice as many in a solver with sparse factors;
  // the frame in object space, in world space and in the writer's order; and some spare. In
  // addition the text of an OBJ file; finding the grid needs less, for index arrays and sorted
  // (u,v).
  constexpr std::size_t vectors = 24;
  constexpr std::size_t text = 200;
  return vertex_count * (vectors * bytes_of_vector + text);
}

}  // namespace pliant
