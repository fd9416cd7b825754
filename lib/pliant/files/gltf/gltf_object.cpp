#include "pliant/files/gltf/gltf_object.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/files/file_object.hpp"
#include "pliant/mesh/face_names.hpp"
#include "pliant/mesh/normals.hpp"

namespace pliant::gltf {
namespace {

constexpr std::uint64_t most = std::numeric_limits<int>::max();  // the most that an int can count

enum Mode : std::uint64_t { Triangles = 4, Strip = 5, Fan = 6 };

// The corners of a primitive's triangles, as indices into its list of vertices. Those of a strip
// all have the same orientation. Requires: `count` >= 3.
template <class Add>
void for_each_triangle(std::uint64_t mode, std::size_t count, const Add& add) {
  if (mode == Triangles)
    for (std::size_t k = 0; k + 2 < count; k += 3) add(k, k + 1, k + 2);
  if (mode == Strip) {
    for (std::size_t k = 0; k + 2 < count; ++k) {
      const std::size_t turn = k % 2;
      add(k + turn, k + 1 - turn, k + 2);
    }
  }
  if (mode == Fan)
    for (std::size_t k = 1; k + 1 < count; ++k) add(0, k, k + 1);
}

// The first indices of a primitive's vertices, (u,v) and normals in the whole mesh.
struct Place {
  int vertex = 0;
  std::size_t count = 0;
  int uv = -1;      // -1: none
  int normal = -1;  // likewise
};

class Merger {
 public:
  Merger(const Document& document, const Object& object, AccessorReader& accessors, int uv_set,
         std::span<const std::string> attributes, const StopRequest& should_stop)
      : document_(document),
        object_(object),
        accessors_(accessors),
        uv_set_(uv_set),
        should_stop_(should_stop),
        poll_(should_stop),
        material_numbers_(document.materials.size(), unknown) {
    const std::vector<Primitive>& all = document.meshes[object.mesh].primitives;
    for (std::size_t k = 0; k < all.size(); ++k)
      if (has_faces(document, all[k])) primitives_.push_back(k);
    for (const std::string& name : attributes) mesh_.attributes.push_back({name, {}});
  }

  Result<Mesh> merge() {
    for (const std::size_t k : primitives_)
      if (auto checked = check_sets(primitive(k)); !checked) return fail(checked.error());
    for (const std::size_t k : primitives_)
      if (auto added = add(k); !added) return fail(added.error());
    mesh_.positions = to_positions(coordinates_);
    mesh_.materials = part_of(materials_.names(), 0, mesh_.face_sizes.size());
    mesh_.object = document_.nodes[object_.node].name;
    mesh_.left_out = left_out();
    if (auto checked = check_mesh(mesh_, should_stop_); !checked) return fail(checked.error());
    auto shared = shared_normals(mesh_, shading_, should_stop_);
    if (!shared) return fail(shared.error());
    mesh_.corner_normals = *std::move(shared);
    return std::move(mesh_);
  }

 private:
  std::string left_out() {
    LeftOut left_out;
    const std::size_t count = document_.meshes[object_.mesh].primitives.size();
    left_out.add("primitive of points or lines", "primitives of points or lines",
                 static_cast<std::int64_t>(count - primitives_.size()));
    left_out.add("(u,v) that is not a pair of numbers", "(u,v) that are not pairs of numbers",
                 drop_invalid_uvs(mesh_));
    constexpr std::size_t most_told = 10;
    const auto told = std::span(document_.looks).first(std::min(document_.looks.size(), most_told));
    const std::string names = fmt::format("{}{}", fmt::join(told, ", "),
                                          told.size() < document_.looks.size() ? ", …" : "");
    left_out.add("extension that concerns looks (" + names + ")",
                 "extensions that concern looks (" + names + ")",
                 static_cast<std::int64_t>(document_.looks.size()));
    return left_out.text();
  }

  const Primitive& primitive(std::size_t k) const {
    return document_.meshes[object_.mesh].primitives[k];
  }

  std::string name_of(std::size_t k) const {
    return fmt::format("meshes[{}].primitives[{}]", object_.mesh, k);
  }

  Result<void> check_sets(const Primitive& primitive) const {
    if (primitive.uvs[static_cast<std::size_t>(uv_set_)]) return {};
    const auto count =
        std::count_if(primitive.uvs.begin(), primitive.uvs.end(),
                      [](const std::optional<std::size_t>& set) { return set.has_value(); });
    if (auto checked = check_uv_set(uv_set_, static_cast<int>(count)); !checked) return checked;
    if (count > 0)  // a file may omit its first set
      return invalid(fmt::format("the object has UV sets, but not set {}", uv_set_));
    return {};
  }

  Result<void> add(std::size_t k) {
    const auto place = place_of(k);
    if (!place) return fail(place.error());
    return add_faces(k, *place);
  }

  // The place of the vertices of a primitive, read once for all primitives that share them.
  Result<Place> place_of(std::size_t k) {
    const Primitive& from = primitive(k);
    const auto uvs = from.uvs[static_cast<std::size_t>(uv_set_)];
    const auto customs = customs_of(k);
    if (!customs) return fail(customs.error());
    const std::tuple key(*from.positions, from.normals, uvs, *customs);
    if (const auto known = places_.find(key); known != places_.end()) return known->second;
    const auto positions = accessors_.vectors(*from.positions, 3);
    if (!positions) return fail(positions.error());
    Place place{static_cast<int>(coordinates_.size() / 3), positions->size() / 3};
    if (coordinates_.size() / 3 + place.count > most)
      return invalid(fmt::format("the object has more than {} vertices", most));
    coordinates_.insert(coordinates_.end(), positions->begin(), positions->end());
    if (uvs) {
      if (auto added = add_uvs(k, *uvs, place); !added) return fail(added.error());
    }
    if (from.normals) {
      if (auto added = add_normals(k, *from.normals, place); !added) return fail(added.error());
    }
    for (std::size_t n = 0; n < customs->size(); ++n) {
      if (auto added = add_attribute(k, (*customs)[n], place, mesh_.attributes[n]); !added)
        return fail(added.error());
    }
    places_.emplace(key, place);
    return place;
  }

  // One vector per vertex.
  Result<std::vector<double>> vectors(std::size_t k, std::size_t accessor, int width,
                                      const char* thing, const Place& place) {
    auto numbers = accessors_.vectors(accessor, width);
    if (!numbers) return numbers;
    const std::size_t count = numbers->size() / static_cast<std::size_t>(width);
    if (count == place.count) return numbers;
    return invalid(
        fmt::format("{} has {} vertices, but {} {}", name_of(k), place.count, count, thing));
  }

  // The accessors of the attributes that are asked for.
  Result<std::vector<std::size_t>> customs_of(std::size_t k) const {
    std::vector<std::size_t> accessors;
    for (const VertexAttribute& attribute : mesh_.attributes) {
      const auto& customs = primitive(k).customs;
      const auto found = std::find_if(customs.begin(), customs.end(), [&](const auto& custom) {
        return custom.first == attribute.name;
      });
      if (found == customs.end()) {
        std::vector<std::string> names;
        for (const auto& custom : customs) names.push_back(custom.first);
        const bool is_read = attribute.name.starts_with('_');
        return invalid(
            fmt::format("{}{} attribute {}{}{}", name_of(k), is_read ? " has no" : ":",
                        in_quotes(attribute.name),
                        is_read ? "" : " is not read, only those whose names begin with _",
                        names.empty() ? "" : "; it has " + listed_names(names)));
      }
      accessors.push_back(found->second);
    }
    return accessors;
  }

  Result<void> add_attribute(std::size_t k, std::size_t accessor, const Place& place,
                             VertexAttribute& attribute) {
    const auto numbers = accessors_.scalars(accessor);
    if (!numbers) return fail(numbers.error());
    if (numbers->size() != place.count) {
      return invalid(fmt::format("{} has {} vertices, but {} numbers {}", name_of(k), place.count,
                                 numbers->size(), in_quotes(attribute.name)));
    }
    attribute.values.insert(attribute.values.end(), numbers->begin(), numbers->end());
    return {};
  }

  Result<void> add_uvs(std::size_t k, std::size_t accessor, Place& place) {
    const auto numbers = vectors(k, accessor, 2, "(u,v)", place);
    if (!numbers) return fail(numbers.error());
    place.uv = static_cast<int>(mesh_.uvs.size());
    for (std::size_t n = 0; n < numbers->size(); n += 2)
      mesh_.uvs.push_back({(*numbers)[n], 1 - (*numbers)[n + 1]});
    return {};
  }

  Result<void> add_normals(std::size_t k, std::size_t accessor, Place& place) {
    const auto numbers = vectors(k, accessor, 3, "normals", place);
    if (!numbers) return fail(numbers.error());
    place.normal = static_cast<int>(shading_.normals.size());
    for (std::size_t n = 0; n < numbers->size(); n += 3) {
      std::array normal = {(*numbers)[n], (*numbers)[n + 1], (*numbers)[n + 2]};
      if (!std::all_of(normal.begin(), normal.end(), [](double x) { return std::isfinite(x); }))
        normal = {};
      shading_.normals.push_back(normal);
    }
    return {};
  }

  // The vertices of a primitive in the order that its mode uses.
  Result<std::vector<std::uint32_t>> list_of(std::size_t k, const Place& place) {
    const Primitive& from = primitive(k);
    if (!from.indices) {
      if (auto charged = accessors_.charge(*from.positions); !charged) return fail(charged.error());
      std::vector<std::uint32_t> all(place.count);
      std::iota(all.begin(), all.end(), 0u);
      return all;
    }
    auto indices = accessors_.indices(*from.indices);
    if (!indices) return indices;
    for (std::size_t n = 0; n < indices->size(); ++n) {
      if ((*indices)[n] < place.count) continue;
      return invalid(
          fmt::format("{}: index {} refers to vertex {}, but there are {} (counted from 0)",
                      name_of(k), n, (*indices)[n], place.count));
    }
    return indices;
  }

  Result<void> add_faces(std::size_t k, const Place& place) {
    const Primitive& from = primitive(k);
    const auto list = list_of(k, place);
    if (!list) return fail(list.error());
    if (from.mode == Triangles && list->size() % 3 != 0) {
      return invalid(fmt::format("{} has {} corners of triangles, which is not a multiple of 3",
                                 name_of(k), list->size()));
    }
    const std::size_t face_count = from.mode == Triangles ? list->size() / 3 : list->size() - 2;
    if (mesh_.corner_vertices.size() + 3 * face_count > most)
      return invalid(fmt::format("the object's faces have more than {} corners", most));
    for_each_triangle(from.mode, list->size(), [&](std::size_t a, std::size_t b, std::size_t c) {
      if (poll_.after(parts_of_face)) return;
      mesh_.face_sizes.push_back(3);
      for (const std::size_t corner : {a, b, c}) add_corner((*list)[corner], place);
    });
    if (poll_.after(0)) return interrupted();
    shading_.smoothing.resize(shading_.smoothing.size() + face_count,
                              place.normal < 0 ? Shading::flat : Shading::unsaid);
    materials_.add_faces(material_of(from), face_count);
    return {};
  }

  void add_corner(std::uint32_t vertex, const Place& place) {
    const auto index = static_cast<int>(vertex);
    mesh_.corner_vertices.push_back(place.vertex + index);
    mesh_.corner_uvs.push_back(place.uv < 0 ? -1 : place.uv + index);
    shading_.corner_normals.push_back(place.normal < 0 ? -1 : place.normal + index);
  }

  // Many primitives may have the same material, with a long name.
  int material_of(const Primitive& from) {
    if (!from.material) return -1;
    int& number = material_numbers_[*from.material];
    if (number == unknown) number = materials_.number_of(document_.materials[*from.material]);
    return number;
  }

  static constexpr int unknown = -2;
  static constexpr std::size_t parts_of_face = 16;

  const Document& document_;
  const Object& object_;
  AccessorReader& accessors_;
  int uv_set_;
  const StopRequest& should_stop_;
  StopPoll poll_;
  std::vector<std::size_t> primitives_;  // those with faces
  Mesh mesh_;
  std::vector<double> coordinates_;  // x y z of each vertex
  Shading shading_;
  using Index = std::optional<std::size_t>;
  std::map<std::tuple<std::size_t, Index, Index, std::vector<std::size_t>>, Place>
      places_;  // by accessors
  NamedFaces materials_;
  std::vector<int> material_numbers_;  // of each of the file
};

}  // namespace

Result<Mesh> mesh_of(const Document& document, const Object& object, AccessorReader& accessors,
                     int uv_set, std::span<const std::string> attributes,
                     const StopRequest& should_stop) {
  auto mesh = Merger(document, object, accessors, uv_set, attributes, should_stop).merge();
  if (!mesh) return mesh;
  if (auto applied = to_file_space(object.to_file, *mesh); !applied) return fail(applied.error());
  if (auto checked = check_mesh(*mesh, should_stop); !checked) return fail(checked.error());
  return mesh;
}

}  // namespace pliant::gltf
