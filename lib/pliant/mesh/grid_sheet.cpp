#include "pliant/mesh/grid_sheet.hpp"

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// width (2i - (n-1)) / (2 (n-1)): only the division rounds, so opposite vertices are exact mirror
// images and the middle one is exactly 0.
double coordinate(double extent, int index, int count) {
  return extent * (2 * index - (count - 1)) / (2 * (count - 1));
}

void add_face(Mesh& mesh, std::initializer_list<int> vertices) {
  mesh.face_sizes.push_back(static_cast<int>(vertices.size()));
  for (const int vertex : vertices) {
    mesh.corner_vertices.push_back(vertex);
    mesh.corner_uvs.push_back(vertex);
  }
}

}  // namespace

Mesh make_mesh(const GridSheet& sheet) { return *make_mesh(sheet, {}); }

Result<Mesh> make_mesh(const GridSheet& sheet, const StopRequest& should_stop) {
  PLIANT_EXPECTS(sheet.columns >= 3 && sheet.rows >= 3 && sheet.width > 0 && sheet.depth > 0);
  const int columns = sheet.columns;
  StopPoll poll(should_stop);
  Mesh mesh;
  mesh.positions.resize(Eigen::Index{columns} * sheet.rows, 3);
  mesh.uvs.resize(static_cast<std::size_t>(columns) * sheet.rows);
  for (int j = 0; j < sheet.rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      if (poll.after(8)) return interrupted();
      const int vertex = j * columns + i;
      mesh.positions.row(vertex) << coordinate(sheet.width, i, columns), 0,
          coordinate(sheet.depth, j, sheet.rows);
      mesh.uvs[vertex] = {static_cast<double>(i) / (columns - 1),
                          static_cast<double>(j) / (sheet.rows - 1)};
    }
  }
  for (int j = 0; j + 1 < sheet.rows; ++j) {
    for (int i = 0; i + 1 < columns; ++i) {
      if (poll.after(8)) return interrupted();
      const int first = j * columns + i;  // z x x = +y: first along v, then along u
      if (sheet.triangles) {
        add_face(mesh, {first, first + columns, first + columns + 1});
        add_face(mesh, {first, first + columns + 1, first + 1});
      } else {
        add_face(mesh, {first, first + columns, first + columns + 1, first + 1});
      }
    }
  }
  return mesh;
}

}  // namespace pliant
