#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/base64.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/mesh.hpp"
#include "support/catch.hpp"

namespace pliant::testing {

/// 3 x 3 vertices, all of whose coordinates are exact in single precision.
inline Mesh small_sheet(bool triangles) {
  return make_mesh({.columns = 3, .rows = 3, .width = 2, .depth = 4, .triangles = triangles});
}

/// An unsigned integer of `size` bytes, little-endian.
inline std::string little_endian(std::uint64_t number, int size) {
  std::string bytes;
  for (int k = 0; k < size; ++k) bytes += static_cast<char>(number >> 8 * k & 0xff);
  return bytes;
}

/// Builds a glTF file; its v points downwards, as the format requires.
class Gltf {
 public:
  /// The mesh's triangles, and any further sets of (u,v), one pair per vertex. Returns the JSON.
  std::string primitive(const Mesh& mesh,
                        std::vector<std::vector<std::array<double, 2>>> more_uvs = {}) {
    std::vector<float> positions;
    for (int k = 0; k < mesh.vertex_count(); ++k)
      for (int axis = 0; axis < 3; ++axis)
        positions.push_back(static_cast<float>(mesh.positions(k, axis)));
    std::string attributes = fmt::format("\"POSITION\":{}", add(positions, "VEC3", 3));
    if (!mesh.uvs.empty()) more_uvs.insert(more_uvs.begin(), mesh.uvs);
    for (std::size_t set = 0; set < more_uvs.size(); ++set) {
      std::vector<float> uvs;
      for (const auto& [u, v] : more_uvs[set]) {
        uvs.push_back(static_cast<float>(u));
        uvs.push_back(static_cast<float>(1 - v));
      }
      attributes += fmt::format(",\"TEXCOORD_{}\":{}", set, add(uvs, "VEC2", 2));
    }
    std::string indices;
    for (const int vertex : mesh.corner_vertices) indices += little_endian(vertex, 4);
    const int accessor = add(indices, 5125, "SCALAR", mesh.corner_vertices.size());
    return fmt::format("{{\"attributes\":{{{}}},\"indices\":{}}}", attributes, accessor);
  }

  /// `buffer` is the URI of the numbers; empty: they are in the text.
  std::string text(const std::string& meshes, const std::string& nodes,
                   const std::string& roots = "0", std::string buffer = {}) const {
    if (buffer.empty()) buffer = "data:application/octet-stream;base64," + base64(bytes_);
    return json(meshes, nodes, roots, fmt::format(",\"uri\":\"{}\"", buffer));
  }

  std::string glb(const std::string& meshes, const std::string& nodes) const {
    std::string content = json(meshes, nodes, "0", "");
    content.append((4 - content.size() % 4) % 4, ' ');
    return "glTF" + little_endian(2, 4) +
           little_endian(12 + 8 + content.size() + 8 + bytes_.size(), 4) +
           little_endian(content.size(), 4) + "JSON" + content + little_endian(bytes_.size(), 4) +
           std::string("BIN\0", 4) + bytes_;
  }

  const std::string& bytes() const { return bytes_; }

 private:
  int add(const std::vector<float>& numbers, const std::string& type, std::size_t width) {
    std::string bytes;
    for (const float number : numbers)
      bytes += little_endian(std::bit_cast<std::uint32_t>(number), 4);
    return add(bytes, 5126, type, numbers.size() / width);
  }

  int add(const std::string& bytes, int component, const std::string& type, std::size_t count) {
    views_.push_back(fmt::format("{{\"buffer\":0,\"byteOffset\":{},\"byteLength\":{}}}",
                                 bytes_.size(), bytes.size()));
    accessors_.push_back(
        fmt::format("{{\"bufferView\":{},\"componentType\":{},\"count\":{},\"type\":\"{}\"}}",
                    accessors_.size(), component, count, type));
    bytes_ += bytes;
    return static_cast<int>(accessors_.size()) - 1;
  }

  std::string json(const std::string& meshes, const std::string& nodes, const std::string& roots,
                   const std::string& uri) const {
    return fmt::format(
        "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[{}]}}],"
        "\"nodes\":[{}],\"meshes\":[{}],\"accessors\":[{}],\"bufferViews\":[{}],"
        "\"buffers\":[{{\"byteLength\":{}{}}}]}}",
        roots, nodes, meshes, fmt::join(accessors_, ","), fmt::join(views_, ","), bytes_.size(),
        uri);
  }

  std::string bytes_;
  std::vector<std::string> views_, accessors_;
};

inline std::vector<double> numbers_of(const Mesh& mesh) {
  std::vector<double> numbers;
  for (int k = 0; k < mesh.vertex_count(); ++k)
    for (int axis = 0; axis < 3; ++axis) numbers.push_back(mesh.positions(k, axis));
  return numbers;
}

/// Triangles whose vertices each have a (u,v), as an OBJ.
inline std::string obj_text(const Mesh& mesh) {
  std::string obj;
  for (int k = 0; k < mesh.vertex_count(); ++k) {
    obj += fmt::format("v {} {} {}\nvt {} {}\n", mesh.positions(k, 0), mesh.positions(k, 1),
                       mesh.positions(k, 2), mesh.uvs[k][0], mesh.uvs[k][1]);
  }
  for (std::size_t k = 0; k < mesh.corner_vertices.size(); k += 3) {
    obj += fmt::format("f {0}/{0} {1}/{1} {2}/{2}\n", mesh.corner_vertices[k] + 1,
                       mesh.corner_vertices[k + 1] + 1, mesh.corner_vertices[k + 2] + 1);
  }
  return obj;
}

inline std::vector<double> uv_numbers_of(const Mesh& mesh) {
  std::vector<double> numbers;
  for (const auto& uv : mesh.uvs) numbers.insert(numbers.end(), uv.begin(), uv.end());
  return numbers;
}

/// A <source> of Collada.
inline std::string collada_source(const std::string& id, const std::vector<double>& numbers,
                                  std::size_t width) {
  std::string params;
  const std::string_view names = width == 3 ? "XYZ" : "ST";
  for (const char name : names) params += fmt::format("<param name=\"{}\" type=\"float\"/>", name);
  return fmt::format(
      "<source id=\"{0}\"><float_array id=\"{0}a\" count=\"{1}\">{2}</float_array>"
      "<technique_common><accessor source=\"#{0}a\" count=\"{3}\" stride=\"{4}\">{5}</accessor>"
      "</technique_common></source>\n",
      id, numbers.size(), fmt::join(numbers, " "), numbers.size() / width, width, params);
}

/// A <polylist> of Collada: faces first..last of the mesh. The second set exchanges u and v.
inline std::string collada_faces(const Mesh& mesh, std::size_t first, std::size_t last,
                                 bool has_two_sets) {
  std::vector<int> indices;
  std::size_t corner = 0;
  for (std::size_t face = 0; face < last; ++face) {
    for (int k = 0; k < mesh.face_sizes[face]; ++k, ++corner) {
      if (face < first) continue;
      indices.push_back(mesh.corner_vertices[corner]);
      indices.push_back(mesh.corner_uvs[corner]);
    }
  }
  const std::vector<int> sizes(mesh.face_sizes.begin() + static_cast<std::ptrdiff_t>(first),
                               mesh.face_sizes.begin() + static_cast<std::ptrdiff_t>(last));
  return fmt::format(
      "<polylist material=\"m{}\" count=\"{}\"><input semantic=\"VERTEX\" source=\"#v\" "
      "offset=\"0\"/><input semantic=\"TEXCOORD\" source=\"#t\" offset=\"1\" set=\"0\"/>{}"
      "<vcount>{}</vcount><p>{}</p></polylist>\n",
      first, sizes.size(),
      has_two_sets ? "<input semantic=\"TEXCOORD\" source=\"#w\" offset=\"1\" set=\"1\"/>" : "",
      fmt::join(sizes, " "), fmt::join(indices, " "));
}

/// A Collada file with one geometry `g` that the nodes may instance.
inline std::string collada(const Mesh& mesh, const std::string& faces, const std::string& nodes,
                           const std::string& asset = "") {
  std::vector<double> swapped;
  for (const auto& [u, v] : mesh.uvs) swapped.insert(swapped.end(), {v, u});
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"utf-8\"?>\n"
      "<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">\n"
      "<asset>{}</asset>\n<library_geometries><geometry id=\"g\" name=\"cloth\"><mesh>\n{}{}{}"
      "<vertices id=\"v\"><input semantic=\"POSITION\" source=\"#p\"/></vertices>\n{}"
      "</mesh></geometry></library_geometries>\n<library_visual_scenes><visual_scene id=\"s\">\n{}"
      "</visual_scene></library_visual_scenes>\n"
      "<scene><instance_visual_scene url=\"#s\"/></scene>\n</COLLADA>\n",
      asset, collada_source("p", numbers_of(mesh), 3), collada_source("t", uv_numbers_of(mesh), 2),
      collada_source("w", swapped, 2), faces, nodes);
}

inline std::vector<int> fbx_polygons(const Mesh& mesh) {
  std::vector<int> polygons;  // the last corner of each is its complement
  std::size_t corner = 0;
  for (const int size : mesh.face_sizes) {
    for (int k = 0; k < size; ++k, ++corner)
      polygons.push_back(k + 1 < size ? mesh.corner_vertices[corner]
                                      : ~mesh.corner_vertices[corner]);
  }
  return polygons;
}

/// A link to `property` of the parent; without one, to the parent as its child.
struct FbxLink {
  int child, parent;
  std::string property = {};
};

/// The content of an FBX file besides `cloth` (model 21) below `parent` (20) below the root (0).
struct FbxMore {
  std::vector<int> models = {};
  std::vector<FbxLink> links = {};
  std::size_t gap = 0;           ///< binary files only: zeros before the links
  bool has_layer_number = true;  ///< binary files only
  int version = 7400;            ///< binary files only
};

/// An FBX file as text: `cloth` below `parent`, which is translated by 1 2 3 and scaled by 2.
inline std::string fbx_text(const Mesh& mesh, const FbxMore& more = {}) {
  const auto uvs = uv_numbers_of(mesh);
  const auto uv_layer = [&](int index) {
    return fmt::format(
        "LayerElementUV: {} {{\nVersion: 101\nName: \"set{}\"\n"
        "MappingInformationType: \"ByPolygonVertex\"\nReferenceInformationType: "
        "\"IndexToDirect\"\nUV: *{} {{\na: {}\n}}\nUVIndex: *{} {{\na: {}\n}}\n}}\n",
        index, index, uvs.size(), fmt::join(uvs, ","), mesh.corner_uvs.size(),
        fmt::join(mesh.corner_uvs, ","));
  };
  const auto layer = [](int index) {
    return fmt::format(
        "Layer: {0} {{\nVersion: 100\nLayerElement:  {{\nType: \"LayerElementUV\"\nTypedIndex: "
        "{0}\n}}\n}}\n",
        index);
  };
  std::string models, links;
  for (const int id : more.models)
    models += fmt::format("Model: {0}, \"Model::m{0}\", \"Null\" {{\nVersion: 232\n}}\n", id);
  for (const auto& [child, parent, property] : more.links) {
    links += property.empty() ? fmt::format("C: \"OO\", {}, {}\n", child, parent)
                              : fmt::format("C: \"OP\", {}, {}, \"{}\"\n", child, parent, property);
  }
  const auto polygons = fbx_polygons(mesh);
  return fmt::format(
      "; FBX 7.4.0 project file\nFBXHeaderExtension:  {{\nFBXHeaderVersion: 1003\nFBXVersion: "
      "7400\n}}\nGlobalSettings:  {{\nVersion: 1000\nProperties70:  {{\n"
      "P: \"UnitScaleFactor\", \"double\", \"Number\", \"\", 1\n}}\n}}\nObjects:  {{\n"
      "Geometry: 10, \"Geometry::\", \"Mesh\" {{\nVertices: *{} {{\na: {}\n}}\n"
      "PolygonVertexIndex: *{} {{\na: {}\n}}\nGeometryVersion: 124\n{}{}{}{}}}\n"
      "Model: 20, \"Model::parent\", \"Null\" {{\nVersion: 232\nProperties70:  {{\n"
      "P: \"Lcl Translation\", \"Lcl Translation\", \"\", \"A\", 1, 2, 3\n"
      "P: \"Lcl Scaling\", \"Lcl Scaling\", \"\", \"A\", 2, 2, 2\n}}\n}}\n"
      "Model: 21, \"Model::cloth\", \"Mesh\" {{\nVersion: 232\n}}\n{}}}\n"
      "Connections:  {{\nC: \"OO\", 20, 0\nC: \"OO\", 21, 20\nC: \"OO\", 10, 21\n{}}}\n",
      mesh.vertex_count() * 3, fmt::join(numbers_of(mesh), ","), polygons.size(),
      fmt::join(polygons, ","), uv_layer(0), uv_layer(1), layer(0), layer(1), models, links);
}

/// One node of a binary FBX file: end, counts, name, properties, child nodes. The numbers have
/// `width` bytes, 4 up to version 7.4 and 8 from 7.5 on.
struct FbxNode {
  std::string name;
  std::vector<std::string> properties;
  std::vector<FbxNode> nodes = {};
  std::size_t gap = 0;  ///< zeros before the nodes

  std::string bytes(std::size_t at, int width) const {
    std::string values;
    for (const std::string& property : properties) values += property;
    const auto zeros = static_cast<std::size_t>(3 * width + 1);
    const std::size_t head = zeros + name.size() + values.size();
    std::string within(gap, '\0');
    for (const FbxNode& node : nodes) within += node.bytes(at + head + within.size(), width);
    if (!nodes.empty()) within.append(zeros, '\0');
    return little_endian(at + head + within.size(), width) +
           little_endian(properties.size(), width) + little_endian(values.size(), width) +
           static_cast<char>(name.size()) + name + values + within;
  }
};

inline std::string fbx_string(const std::string& text) {
  return 'S' + little_endian(text.size(), 4) + text;
}
inline std::string fbx_id(int id) { return 'L' + little_endian(static_cast<std::uint64_t>(id), 8); }
inline std::string fbx_int(int number) {
  return 'I' + little_endian(static_cast<std::uint32_t>(number), 4);
}
inline std::string fbx_double(double number) {
  return 'D' + little_endian(std::bit_cast<std::uint64_t>(number), 8);
}
inline std::string fbx_array(const std::vector<double>& numbers) {
  std::string bytes = 'd' + little_endian(numbers.size(), 4) + little_endian(0, 4) +
                      little_endian(8 * numbers.size(), 4);
  for (const double number : numbers)
    bytes += little_endian(std::bit_cast<std::uint64_t>(number), 8);
  return bytes;
}
inline std::string fbx_array(const std::vector<int>& numbers) {
  std::string bytes = 'i' + little_endian(numbers.size(), 4) + little_endian(0, 4) +
                      little_endian(4 * numbers.size(), 4);
  for (const int number : numbers) bytes += little_endian(static_cast<std::uint32_t>(number), 4);
  return bytes;
}

/// The same as `fbx_text`, binary, with one set of (u,v).
inline std::string fbx_binary(const Mesh& mesh, const FbxMore& more = {}) {
  const auto text = fbx_string;
  const auto vector = [&](const std::string& name, double x, double y, double z) {
    return FbxNode{
        "P",
        {text(name), text(name), text(""), text("A"), fbx_double(x), fbx_double(y), fbx_double(z)}};
  };
  const FbxNode uv_layer{"LayerElementUV",
                         {fbx_int(0)},
                         {{"Version", {fbx_int(101)}},
                          {"Name", {text("map")}},
                          {"MappingInformationType", {text("ByPolygonVertex")}},
                          {"ReferenceInformationType", {text("IndexToDirect")}},
                          {"UV", {fbx_array(uv_numbers_of(mesh))}},
                          {"UVIndex", {fbx_array(mesh.corner_uvs)}}}};
  const FbxNode layer{
      "Layer",
      more.has_layer_number ? std::vector{fbx_int(0)} : std::vector<std::string>{},
      {{"Version", {fbx_int(100)}},
       {"LayerElement", {}, {{"Type", {text("LayerElementUV")}}, {"TypedIndex", {fbx_int(0)}}}}}};
  const FbxNode geometry{"Geometry",
                         {fbx_id(10), text(std::string("\0\x01Geometry", 10)), text("Mesh")},
                         {{"Vertices", {fbx_array(numbers_of(mesh))}},
                          {"PolygonVertexIndex", {fbx_array(fbx_polygons(mesh))}},
                          uv_layer,
                          layer}};
  const FbxNode parent{
      "Model",
      {fbx_id(20), text(std::string("parent\0\x01Model", 13)), text("Null")},
      {{"Properties70", {}, {vector("Lcl Translation", 1, 2, 3), vector("Lcl Scaling", 2, 2, 2)}}}};
  const FbxNode cloth{"Model",
                      {fbx_id(21), text(std::string("cloth\0\x01Model", 12)), text("Mesh")},
                      {{"Version", {fbx_int(232)}}}};
  const auto link = [&](int from, int to) {
    return FbxNode{"C", {text("OO"), fbx_id(from), fbx_id(to)}};
  };
  FbxNode objects{"Objects", {}, {geometry, parent, cloth}};
  for (const int id : more.models) {
    objects.nodes.push_back({"Model",
                             {fbx_id(id), text(std::string("m\0\x01Model", 8)), text("Null")},
                             {{"Version", {fbx_int(232)}}}});
  }
  FbxNode connections{"Connections", {}, {link(20, 0), link(21, 20), link(10, 21)}, more.gap};
  for (const auto& [from, to, property] : more.links) {
    connections.nodes.push_back(link(from, to));
    if (!property.empty())
      connections.nodes.back().properties = {text("OP"), fbx_id(from), fbx_id(to), text(property)};
  }
  const std::vector<FbxNode> nodes = {
      {"FBXHeaderExtension", {}, {{"FBXVersion", {fbx_int(more.version)}}}},
      {"GlobalSettings",
       {},
       {{"Version", {fbx_int(1000)}},
        {"Properties70",
         {},
         {{"P",
           {text("UnitScaleFactor"), text("double"), text("Number"), text(""), fbx_double(1)}}}}}},
      objects,
      connections};
  std::string bytes = std::string("Kaydara FBX Binary  \0\x1a\0", 23) +
                      little_endian(static_cast<std::uint64_t>(more.version), 4);
  const int width = more.version >= 7500 ? 8 : 4;
  for (const FbxNode& node : nodes) bytes += node.bytes(bytes.size(), width);
  return bytes + std::string(25 + 160, '\0');
}

/// Compares meshes except for their shading.
inline void check_equal(const Mesh& mesh, const Mesh& expected) {
  CHECK(mesh.positions == expected.positions);
  CHECK(mesh.uvs == expected.uvs);
  CHECK(mesh.face_sizes == expected.face_sizes);
  CHECK(mesh.corner_vertices == expected.corner_vertices);
  CHECK(mesh.corner_uvs == expected.corner_uvs);
}

inline std::string repeated(const std::string& text, int count) {
  std::string all;
  for (int k = 0; k < count; ++k) all += text;
  return all;
}

}  // namespace pliant::testing
