#include "pliant/mesh/read_assimp.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <limits>
#include <memory>
#include <new>
#include <span>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <assimp/BaseImporter.h>
#include <assimp/Importer.hpp>
#include <assimp/config.h>
#include <assimp/importerdesc.h>
#include <assimp/material.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/file_ending.hpp"
#include "pliant/core/read_file.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/mesh/assimp_files.hpp"
#include "pliant/mesh/assimp_guard.hpp"
#include "pliant/mesh/file_object.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant {
namespace {

using Eigen::Matrix4d;

static_assert(max_uv_sets == AI_MAX_NUMBER_OF_TEXTURECOORDS);

constexpr std::size_t max_bytes = std::size_t{4} << 30;

// How far the last row of a transform may be from 0 0 0 1: assimp inverts pivots in float.
constexpr double affine_tolerance = 1e-5;

// A node that carries faces.
struct Object {
  std::string node_name;
  std::string mesh_name;  // of the first mesh with faces
  Matrix4d to_file;       // the product of the transforms down to the node
  std::vector<const aiMesh*> meshes;
};

Error broken(std::string message) { return {ErrorCode::InvalidInput, std::move(message)}; }

// One line of what may hold anything: assimp quotes the file in some of its reasons.
std::string in_one_line(std::string_view reason) {
  constexpr std::size_t longest = 200;
  std::string line;
  for (const char c : reason.substr(0, longest)) {
    const bool is_blank = c == ' ' || c == '\n' || c == '\r' || c == '\t';
    if (is_blank && (line.empty() || line.back() == ' ')) continue;
    line += is_blank ? ' ' : c > ' ' && c < '\x7f' ? c : '?';
  }
  while (line.ends_with(' ')) line.pop_back();
  return reason.size() > longest ? line + "…" : line;
}

// Leaves assimp the readers of one ending: it would try all of its forty on a file that those
// refuse.
void keep_readers(Assimp::Importer& importer, std::string_view ending) {
  for (std::size_t k = importer.GetImporterCount(); k-- > 0;) {
    const std::string known = fmt::format(" {} ", importer.GetImporterInfo(k)->mFileExtensions);
    if (known.find(fmt::format(" {} ", ending)) != std::string::npos) continue;
    const std::unique_ptr<Assimp::BaseImporter> dropped(importer.GetImporter(k));
    importer.UnregisterLoader(dropped.get());
  }
}

// No post-processing: nothing is reordered, joined, split into triangles or dropped.
// The scene belongs to `importer`.
Result<const aiScene*> import(Assimp::Importer& importer, const std::filesystem::path& file,
                              std::string bytes) {
  keep_readers(importer, ending_of(file).substr(1));
  auto owned_files = std::make_unique<AssimpFiles>(file, std::move(bytes), max_bytes);
  const AssimpFiles& files = *owned_files;
  importer.SetIOHandler(owned_files.release());                                // takes it
  importer.SetPropertyBool(AI_CONFIG_IMPORT_COLLADA_USE_COLLADA_NAMES, true);  // not the ids
  const aiScene* scene = importer.ReadFile(file.string(), 0);
  if (scene && scene->mRootNode) return scene;
  if (importer.GetException()) {
    try {
      std::rethrow_exception(importer.GetException());
    } catch (const std::bad_alloc&) {
      throw;
    } catch (...) {  // its message is the error string
    }
  }
  if (const auto& missing = files.missing()) {
    return fail(broken(fmt::format("the file refers to {}: {}", missing->file, missing->message)));
  }
  return fail(
      broken(fmt::format("the file cannot be read: {}", in_one_line(importer.GetErrorString()))));
}

Matrix4d to_matrix(const aiMatrix4x4& m) {
  Matrix4d matrix;
  matrix << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2,
      m.d3, m.d4;
  return matrix;
}

bool has_faces(const aiMesh& mesh) {
  return std::any_of(mesh.mFaces, mesh.mFaces + mesh.mNumFaces,
                     [](const aiFace& face) { return face.mNumIndices >= 3; });
}

std::vector<const aiMesh*> meshes_with_faces(const aiScene& scene, const aiNode& node) {
  std::vector<const aiMesh*> meshes;
  for (unsigned k = 0; k < node.mNumMeshes; ++k) {
    if (node.mMeshes[k] >= scene.mNumMeshes) continue;
    const aiMesh* mesh = scene.mMeshes[node.mMeshes[k]];
    if (mesh && has_faces(*mesh)) meshes.push_back(mesh);
  }
  return meshes;
}

// Depth first, in the order of the file. A stack of our own: a file may be deep.
std::vector<Object> objects_of(const aiScene& scene) {
  struct Visit {
    const aiNode* node;
    Matrix4d above;
  };
  std::vector<Object> objects;
  std::vector<Visit> visits = {{scene.mRootNode, Matrix4d::Identity()}};
  while (!visits.empty()) {
    const auto [node, above] = visits.back();
    visits.pop_back();
    const Matrix4d to_file = above * to_matrix(node->mTransformation);
    if (auto meshes = meshes_with_faces(scene, *node); !meshes.empty()) {
      std::string mesh_name = meshes.front()->mName.C_Str();
      objects.push_back({node->mName.C_Str(), std::move(mesh_name), to_file, std::move(meshes)});
    }
    for (unsigned k = node->mNumChildren; k-- > 0;) visits.push_back({node->mChildren[k], to_file});
  }
  return objects;
}

// By the names of the nodes, and by those of the meshes where no node has the name.
Result<Object> choose(std::vector<Object> objects, const std::string& object) {
  if (objects.empty()) return fail(broken("the file holds no faces"));
  std::vector<std::string> nodes, meshes;
  for (const Object& each : objects) {
    nodes.push_back(each.node_name.empty() ? each.mesh_name : each.node_name);
    meshes.push_back(each.mesh_name);
  }
  const bool is_node = std::find(nodes.begin(), nodes.end(), object) != nodes.end();
  const bool is_mesh = std::find(meshes.begin(), meshes.end(), object) != meshes.end();
  const auto chosen =
      choose_object(!object.empty() && !is_node && is_mesh ? meshes : nodes, object);
  if (!chosen) return fail(chosen.error());
  return std::move(objects[*chosen]);
}

int uv_set_count(const aiMesh& mesh) {
  int count = 0;
  for (unsigned set = 0; set < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++set)
    count += mesh.HasTextureCoords(set);
  return count;
}

Result<void> check_sets(const Object& object, int uv_set) {
  for (const aiMesh* mesh : object.meshes) {
    if (mesh->HasTextureCoords(static_cast<unsigned>(uv_set))) continue;
    if (auto checked = check_uv_set(uv_set, uv_set_count(*mesh)); !checked) return checked;
    if (uv_set_count(*mesh) > 0)  // a file may leave out its first set
      return fail(broken(fmt::format("the object has no UV set {}, but others", uv_set)));
  }
  return {};
}

// Whether vertices and corners can be counted in int.
Result<void> check_size(const Object& object) {
  std::uint64_t vertices = 0, corners = 0;
  for (const aiMesh* mesh : object.meshes) {
    vertices += mesh->mNumVertices;
    for (unsigned face = 0; face < mesh->mNumFaces; ++face)
      corners += mesh->mFaces[face].mNumIndices;
  }
  constexpr std::uint64_t most = std::numeric_limits<int>::max();
  if (vertices <= most && corners <= most) return {};
  return fail(
      broken(fmt::format("the object has {} vertices and {} corners of faces; at most {} "
                         "of each can be counted",
                         vertices, corners, most)));
}

// Appends the faces of one mesh, whose vertices and (u,v) are numbered from those given.
Result<void> append_faces(const aiMesh& source, int first_vertex, int first_uv, Mesh& mesh) {
  for (unsigned k = 0; k < source.mNumFaces; ++k) {
    const aiFace& face = source.mFaces[k];
    if (face.mNumIndices < 3) continue;  // a point or a line
    mesh.face_sizes.push_back(static_cast<int>(face.mNumIndices));
    for (unsigned corner = 0; corner < face.mNumIndices; ++corner) {
      const unsigned index = face.mIndices[corner];
      if (index >= source.mNumVertices) {
        return fail(broken(fmt::format("corner {} of face {} refers to vertex {} of {}", corner + 1,
                                       k + 1, std::uint64_t{index} + 1, source.mNumVertices)));
      }
      mesh.corner_vertices.push_back(first_vertex + static_cast<int>(index));
      mesh.corner_uvs.push_back(first_uv < 0 ? -1 : first_uv + static_cast<int>(index));
    }
  }
  return {};
}

// Appends what a mesh says of the shading of its faces: of `face_count` and of their corners.
void append_shading(const aiMesh& source, int shading_without, std::size_t face_count,
                    std::span<const int> corner_vertices, int first_vertex, Shading& shading) {
  const auto first_normal = static_cast<int>(shading.normals.size());
  const bool has_normals = source.HasNormals();
  for (const int vertex : corner_vertices)
    shading.corner_normals.push_back(has_normals ? first_normal + vertex - first_vertex : -1);
  shading.smoothing.resize(shading.smoothing.size() + face_count,
                           has_normals ? Shading::unsaid : shading_without);
  for (unsigned k = 0; has_normals && k < source.mNumVertices; ++k) {
    const aiVector3D& normal = source.mNormals[k];
    const bool is_finite =
        std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z);
    shading.normals.push_back(is_finite ? std::array<double, 3>{normal.x, normal.y, normal.z}
                                        : std::array<double, 3>{});
  }
}

std::string material_name(const aiScene& scene, const aiMesh& mesh) {
  if (mesh.mMaterialIndex >= scene.mNumMaterials || !scene.mMaterials[mesh.mMaterialIndex])
    return {};
  aiString name;
  scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_NAME, name);
  return name.C_Str();
}

// Appends the material of faces that one mesh has.
void append_material(const std::string& name, std::size_t face_count, FaceNames& materials) {
  int index = -1;
  if (!name.empty()) {
    const auto found = std::find(materials.names.begin(), materials.names.end(), name);
    index = static_cast<int>(found - materials.names.begin());
    if (found == materials.names.end()) materials.names.push_back(name);
  }
  materials.of_faces.resize(materials.of_faces.size() + face_count, index);
}

Result<Mesh> merged(const aiScene& scene, const Object& object, int uv_set, int shading_without) {
  Mesh mesh;
  Shading shading;
  Eigen::Index vertex_count = 0;
  for (const aiMesh* source : object.meshes) vertex_count += source->mNumVertices;
  mesh.positions.resize(vertex_count, 3);
  Eigen::Index row = 0;
  for (const aiMesh* source : object.meshes) {
    const aiVector3D* uvs = source->mTextureCoords[uv_set];
    const int first_uv = uvs ? static_cast<int>(mesh.uvs.size()) : -1;
    const auto first_vertex = static_cast<int>(row);
    const std::size_t first_corner = mesh.corner_vertices.size();
    const std::size_t first_face = mesh.face_sizes.size();
    if (auto added = append_faces(*source, first_vertex, first_uv, mesh); !added)
      return fail(added.error());
    const std::size_t face_count = mesh.face_sizes.size() - first_face;
    append_shading(*source, shading_without, face_count,
                   std::span(mesh.corner_vertices).subspan(first_corner), first_vertex, shading);
    append_material(material_name(scene, *source), face_count, mesh.materials);
    for (unsigned k = 0; k < source->mNumVertices; ++k, ++row) {
      const aiVector3D& position = source->mVertices[k];
      mesh.positions.row(row) << position.x, position.y, position.z;
      if (uvs) mesh.uvs.push_back({uvs[k].x, uvs[k].y});
    }
  }
  if (mesh.materials.names.empty()) mesh.materials.of_faces.clear();
  mesh.object = object.node_name.empty() ? object.mesh_name : object.node_name;
  if (auto checked = check_mesh(mesh); !checked) return fail(checked.error());
  mesh.corner_normals = shared_normals(mesh, shading);
  return mesh;
}

Result<void> apply(const Matrix4d& to_file, Field& positions) {
  if (to_file == Matrix4d::Identity()) return {};  // -0 would become 0
  const Eigen::RowVector4d last_row = to_file.row(3);
  if (!((last_row - Eigen::RowVector4d(0, 0, 0, 1)).cwiseAbs().maxCoeff() <= affine_tolerance)) {
    return fail(
        broken(fmt::format("the object's transform is not affine: its last row is "
                           "{} {} {} {}, not 0 0 0 1",
                           last_row[0], last_row[1], last_row[2], last_row[3])));
  }
  positions = to_world({to_file.topLeftCorner<3, 3>(), to_file.topRightCorner<3, 1>()}, positions);
  return {};
}

Result<Mesh> read_object(const std::filesystem::path& file, std::string bytes,
                         const std::string& name, int uv_set) {
  if (auto checked = check_for_assimp(bytes, ending_of(file).substr(1)); !checked) {
    checked.error().message = in_one_line(checked.error().message);
    return fail(checked.error());
  }
  Assimp::Importer importer;
  const auto scene = import(importer, file, std::move(bytes));
  if (!scene) return fail(scene.error());
  const auto object = choose(objects_of(**scene), name);
  if (!object) return fail(object.error());
  if (auto checked = check_sets(*object, uv_set); !checked) return fail(checked.error());
  if (auto checked = check_size(*object); !checked) return fail(checked.error());
  const std::string ending = ending_of(file);
  const bool is_gltf = ending == ".gltf" || ending == ".glb";
  auto mesh = merged(**scene, *object, uv_set, is_gltf ? Shading::flat : Shading::unsaid);
  if (!mesh) return mesh;
  if (auto applied = apply(object->to_file, mesh->positions); !applied)
    return fail(applied.error());
  if (auto checked = check_mesh(*mesh); !checked) return fail(checked.error());
  return mesh;
}

}  // namespace

Result<Mesh> read_assimp(const std::filesystem::path& file, const std::string& object, int uv_set) {
  PLIANT_EXPECTS(uv_set >= 0 && uv_set < max_uv_sets);
  const auto in_file = [&](Error error) {
    error.file = file.string();
    return fail(std::move(error));
  };
  try {
    auto bytes = read_file(file, max_bytes);
    if (!bytes) return fail(bytes.error());
    auto mesh = read_object(file, *std::move(bytes), object, uv_set);
    return mesh ? std::move(mesh) : in_file(mesh.error());
  } catch (const std::bad_alloc&) {
    return in_file({ErrorCode::OutOfMemory, "the mesh does not fit in memory"});
  } catch (const std::exception& trouble) {
    return in_file(broken(fmt::format("the file cannot be read: {}", in_one_line(trouble.what()))));
  }
}

}  // namespace pliant
