#include "pliant/files/boxed/program/write_message.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <limits>
#include <optional>
#include <string_view>
#include <type_traits>
#include <vector>

#include <assimp/material.h>
#include <unistd.h>

#include "pliant/files/boxed/mesh_message.hpp"
#include "pliant/files/object_choice.hpp"

namespace pliant {
namespace {

using Eigen::Matrix4d;

// A node that has faces.
struct Object {
  std::string node_name = {};
  std::string mesh_name = {};
  Matrix4d to_file;  // the product of the transforms down to the node
  std::vector<const aiMesh*> meshes = {};
  std::uint64_t vertices = 0, faces = 0;  // of these
  std::uint64_t small_faces = 0;          // of all meshes of the node: points and lines
};

// Buffers bytes and writes them to a descriptor.
class MessageWriter {
 public:
  explicit MessageWriter(int descriptor) : descriptor_(descriptor) {
    gathered_.reserve(gathered_bytes);
    number(message_begin);
  }

  void bytes(const void* from, std::size_t size) {
    const auto* at = static_cast<const char*>(from);
    while (size > 0) {
      const std::size_t count = std::min(size, gathered_bytes - gathered_.size());
      gathered_.append(at, count);
      at += count;
      size -= count;
      if (gathered_.size() == gathered_bytes) flush();
    }
  }

  template <class T>
  void number(T number) {
    static_assert(std::is_arithmetic_v<T>);
    bytes(&number, sizeof number);
  }

  void kind(MessageKind kind) { number(static_cast<std::uint32_t>(kind)); }

  void text(std::string_view text) {
    number(static_cast<std::uint32_t>(text.size()));
    bytes(text.data(), text.size());
  }

  bool end() {
    number(message_end);
    flush();
    return is_sound_;
  }

 private:
  static constexpr std::size_t gathered_bytes = std::size_t{1} << 16;

  void flush() {
    std::string_view rest = gathered_;
    while (is_sound_ && !rest.empty()) {
      const ssize_t count = write(descriptor_, rest.data(), rest.size());
      if (count >= 0) rest.remove_prefix(static_cast<std::size_t>(count));
      is_sound_ = count >= 0 || errno == EINTR;
    }
    gathered_.clear();
  }

  int descriptor_;
  std::string gathered_;
  bool is_sound_ = true;
};

Matrix4d to_matrix(const aiMatrix4x4& m) {
  Matrix4d matrix;
  matrix << m.a1, m.a2, m.a3, m.a4, m.b1, m.b2, m.b3, m.b4, m.c1, m.c2, m.c3, m.c4, m.d1, m.d2,
      m.d3, m.d4;
  return matrix;
}

bool is_face(const aiFace& face) { return face.mNumIndices >= 3; }  // no point or line

// Counted once for each mesh of the file, as many nodes may have the same one.
struct FaceCount {
  std::uint64_t faces = 0, small_faces = 0;  // those with three corners or more, and the others
};

std::vector<FaceCount> count_faces(const aiScene& scene) {
  std::vector<FaceCount> counts(scene.mNumMeshes);
  for (unsigned k = 0; k < scene.mNumMeshes; ++k) {
    const aiMesh* const mesh = scene.mMeshes[k];
    if (!mesh || !mesh->mFaces) continue;
    const auto faces = std::count_if(mesh->mFaces, mesh->mFaces + mesh->mNumFaces, is_face);
    counts[k].faces = mesh->mVertices ? static_cast<std::uint64_t>(faces) : 0;
    counts[k].small_faces = mesh->mNumFaces - static_cast<std::uint64_t>(faces);
  }
  return counts;
}

// Depth first, in the order of the file. Explicit stack: a file may be deeply nested.
std::vector<Object> objects_of(const aiScene& scene) {
  struct Visit {
    const aiNode* node;
    Matrix4d above;
  };
  const std::vector<FaceCount> counts = count_faces(scene);
  std::vector<Object> objects;
  std::vector<Visit> visits = {{scene.mRootNode, Matrix4d::Identity()}};
  while (!visits.empty()) {
    const auto [node, above] = visits.back();
    visits.pop_back();
    const Matrix4d to_file = above * to_matrix(node->mTransformation);
    Object object{.node_name = node->mName.C_Str(), .to_file = to_file};
    for (unsigned k = 0; k < node->mNumMeshes; ++k) {
      const unsigned number = node->mMeshes[k];
      if (number >= scene.mNumMeshes) continue;
      object.small_faces += counts[number].small_faces;
      if (counts[number].faces == 0) continue;
      object.meshes.push_back(scene.mMeshes[number]);
      object.faces += counts[number].faces;
      object.vertices += scene.mMeshes[number]->mNumVertices;
    }
    if (!object.meshes.empty()) {
      object.mesh_name = object.meshes.front()->mName.C_Str();
      objects.push_back(std::move(object));
    }
    for (unsigned k = node->mNumChildren; k-- > 0;) visits.push_back({node->mChildren[k], to_file});
  }
  return objects;
}

// The only object that the text chooses; if there are none or several, the receiver of the names
// reports it.
std::optional<std::size_t> chosen(const std::vector<Object>& objects, const std::string& object) {
  std::vector<std::string_view> nodes, meshes;
  for (const Object& each : objects) {
    nodes.emplace_back(each.node_name.empty() ? each.mesh_name : each.node_name);
    meshes.push_back(each.mesh_name);
  }
  const ObjectMatch match = find_objects(nodes, meshes, object);
  return match.count == 1 ? std::optional(match.first) : std::nullopt;
}

std::string_view text_of(const aiString& text) {
  return {text.data, strnlen(text.data, sizeof text.data)};
}

void write_submesh(MessageWriter& writer, const aiScene& scene, const aiMesh& mesh, int uv_set) {
  aiString material;
  if (mesh.mMaterialIndex < scene.mNumMaterials && scene.mMaterials[mesh.mMaterialIndex])
    scene.mMaterials[mesh.mMaterialIndex]->Get(AI_MATKEY_NAME, material);
  writer.text(text_of(material));
  std::uint32_t sets = 0;
  for (unsigned set = 0; set < AI_MAX_NUMBER_OF_TEXTURECOORDS; ++set)
    if (mesh.HasTextureCoords(set)) sets |= 1u << set;
  const bool has_uvs = mesh.HasTextureCoords(static_cast<unsigned>(uv_set));
  writer.number(sets);
  writer.number(std::uint32_t{mesh.HasNormals()});
  writer.number(std::uint32_t{has_uvs});
  std::uint32_t faces = 0;
  std::uint64_t corners = 0;
  for (unsigned k = 0; k < mesh.mNumFaces; ++k) {
    if (!is_face(mesh.mFaces[k])) continue;
    ++faces;
    corners += mesh.mFaces[k].mNumIndices;
  }
  writer.number(std::uint32_t{mesh.mNumVertices});
  writer.number(faces);
  writer.number(static_cast<std::uint32_t>(
      std::min<std::uint64_t>(corners, std::numeric_limits<std::uint32_t>::max())));
  static_assert(sizeof(aiVector3D) == 3 * sizeof(float));
  writer.bytes(mesh.mVertices, mesh.mNumVertices * sizeof(aiVector3D));
  if (mesh.HasNormals()) writer.bytes(mesh.mNormals, mesh.mNumVertices * sizeof(aiVector3D));
  for (unsigned k = 0; has_uvs && k < mesh.mNumVertices; ++k)
    writer.bytes(&mesh.mTextureCoords[uv_set][k], 2 * sizeof(float));
  for (unsigned k = 0; k < mesh.mNumFaces; ++k)
    if (is_face(mesh.mFaces[k])) writer.number(std::uint32_t{mesh.mFaces[k].mNumIndices});
  for (unsigned k = 0; k < mesh.mNumFaces; ++k) {
    const aiFace& face = mesh.mFaces[k];
    if (is_face(face)) writer.bytes(face.mIndices, face.mNumIndices * sizeof(unsigned));
  }
}

void write_scene(MessageWriter& writer, const aiScene& scene, const std::string& object,
                 int uv_set) {
  const std::vector<Object> objects = objects_of(scene);
  if (objects.size() > most_objects) {
    writer.kind(MessageKind::TooManyObjects);
    return;
  }
  writer.kind(MessageKind::Scene);
  writer.number(static_cast<std::uint32_t>(objects.size()));
  for (const Object& each : objects) {
    writer.text(each.node_name);
    writer.text(each.mesh_name);
    writer.number(each.vertices);
    writer.number(each.faces);
    writer.number(each.small_faces);
  }
  const auto index = chosen(objects, object);
  writer.number(index ? static_cast<std::uint32_t>(*index) : no_object);
  if (!index) return;
  const Object& taken = objects[*index];
  for (int row = 0; row < 4; ++row)
    for (int column = 0; column < 4; ++column) writer.number(taken.to_file(row, column));
  writer.number(static_cast<std::uint32_t>(taken.meshes.size()));
  for (const aiMesh* mesh : taken.meshes) write_submesh(writer, scene, *mesh, uv_set);
}

}  // namespace

bool write_message(int descriptor, const AssimpScene& read, const std::string& object, int uv_set) {
  MessageWriter writer(descriptor);
  if (read.scene) {
    write_scene(writer, *read.scene, object, uv_set);
  } else if (read.is_other_format) {
    writer.kind(MessageKind::OtherFormat);
  } else {
    writer.kind(MessageKind::Refused);
    writer.text(std::string_view(read.reason).substr(0, 4096));
  }
  return writer.end();
}

}  // namespace pliant
