#include "pliant/simulation/rest_shape.hpp"

#include <utility>

#include <fmt/format.h>

#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/read_obj.hpp"
#include "pliant/scene/check.hpp"

namespace pliant {
namespace {

struct MakeMesh {
  Result<Mesh> operator()(const GridSheet& sheet) const { return make_mesh(sheet); }
  Result<Mesh> operator()(const MeshFile& file) const {
    const std::string ending = file.path.extension().string();
    if (ending != ".obj" && ending != ".OBJ") {
      return fail(
          ErrorCode::InvalidInput,
          fmt::format("the mesh file {} is not read by this version of pliant; allowed: .obj",
                      file.path.string()));
    }
    return read_obj(file.path, file.object);
  }
  Result<Mesh> operator()(const Mesh& mesh) const {
    if (auto checked = check_mesh(mesh); !checked) return fail(checked.error());
    return mesh;
  }
};

}  // namespace

Result<RestShape> make_rest_shape(const Surface& surface, const SceneOrigin& origin) {
  const auto at_scene = [&](Error error) {
    // A file that cannot be opened is the scene's mistake; one with bad contents speaks for itself.
    if (error.code == ErrorCode::Unreadable)
      return fail(unreadable_mesh(error, surface.name, origin));
    if (error.file.empty()) {
      error.file = origin.file;
      error.line = origin.line_of(surface.name, "file");
    }
    return fail(std::move(error));
  };
  auto mesh = std::visit(MakeMesh{}, surface.shape);
  if (!mesh) return at_scene(mesh.error());
  auto mapping = find_grid(*mesh);
  if (!mapping) {
    Error error = mapping.error();
    const auto* file = std::get_if<MeshFile>(&surface.shape);
    error.message = fmt::format("surface \"{}\"{}: {}", surface.name,
                                file ? ", mesh " + file->path.string() : "", error.message);
    return at_scene(std::move(error));
  }
  return RestShape{surface.name, *std::move(mesh), *std::move(mapping)};
}

}  // namespace pliant
