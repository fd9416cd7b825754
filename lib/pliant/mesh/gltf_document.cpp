#include "pliant/mesh/gltf_document.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/mesh/file_object.hpp"

namespace pliant::gltf {
namespace {

using Json = nlohmann::json;

// Checked before parsing: each value needs about a hundred bytes, even if it is written in two.
Result<void> check_size(std::string_view json) {
  std::size_t depth = 0, values = 1;
  bool is_quoted = false;
  for (std::size_t k = 0; k < json.size(); ++k) {
    const char c = json[k];
    if (is_quoted && c == '\\') {
      ++k;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && (c == '[' || c == '{')) {
      ++values;
      if (++depth > deepest_json)
        return invalid(fmt::format("the file's JSON is nested more than {} deep", deepest_json));
    } else if (!is_quoted && (c == ']' || c == '}') && depth > 0) {
      --depth;
    } else if (!is_quoted && c == ',') {
      ++values;
    }
  }
  if (values <= most_json_values) return {};
  return invalid(fmt::format("the file's JSON has more than {} values", most_json_values));
}

// The parser's own messages quote the text, which may be that of any file.
Result<Json> parse(std::string_view text) {
  const auto line_at = [&](std::size_t byte) {
    const std::string_view before = text.substr(0, byte);
    return static_cast<int>(1 + std::count(before.begin(), before.end(), '\n'));
  };
  if (auto checked = check_size(text); !checked) return fail(checked.error());
  try {
    return Json::parse(text);
  } catch (const Json::parse_error& error) {
    return invalid("the file is not glTF: it is not valid JSON from here on",
                   line_at(error.byte > 0 ? error.byte - 1 : 0));
  } catch (const Json::exception&) {
    return invalid("the file is not glTF: its JSON has a number that is too large");
  }
}

// Extensions that affect appearance or other parts of a scene: the mesh is the same without them.
bool is_known(std::string_view extension) {
  for (const std::string_view known :
       {"KHR_mesh_quantization", "KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif",
        "KHR_lights_punctual", "KHR_xmp", "KHR_xmp_json_ld"}) {
    if (extension == known) return true;
  }
  return extension.starts_with("KHR_materials_");
}

/// Reads values from the JSON. The first error is kept, and values read after it are meaningless.
class DocumentReader {
 public:
  explicit DocumentReader(Json& root) : root_(root) {}

  Result<Document> read() {
    if (auto checked = check_asset(); !checked) return fail(checked.error());
    check_extensions();
    if (list_size("buffers") > most_buffers)
      refuse("buffers", fmt::format("has more than {} elements", most_buffers));
    each(root_, "buffers", [&](Json& json) { document_.buffers.push_back(read_buffer(json)); });
    each(root_, "bufferViews", [&](Json& json) { document_.views.push_back(read_view(json)); });
    each(root_, "accessors",
         [&](Json& json) { document_.accessors.push_back(read_accessor(json)); });
    each(root_, "materials",
         [&](Json& json) { document_.materials.push_back(text(json, "name").value_or("")); });
    each(root_, "meshes", [&](Json& json) { document_.meshes.push_back(read_mesh(json)); });
    each(root_, "nodes", [&](Json& json) { document_.nodes.push_back(read_node(json)); });
    read_roots();
    if (fault_) return invalid(*std::move(fault_));
    return std::move(document_);
  }

 private:
  // The path to the current value: `meshes[2].primitives[0]`.
  struct Step {
    const char* key;
    std::optional<std::size_t> index;  // in a list
  };

  std::string place() const {
    std::string text;
    for (const auto& [key, index] : place_) {
      text += fmt::format("{}{}", text.empty() ? "" : ".", key);
      if (index) text += fmt::format("[{}]", *index);
    }
    return text;
  }

  void refuse(std::string_view key, std::string_view rule) {
    if (fault_) return;
    const std::string at = place();
    fault_ = fmt::format("{}{}{} {}", at, at.empty() || key.empty() ? "" : ".", key, rule);
  }

  Result<void> check_asset() {
    Json* const asset = root_.is_object() ? member(root_, "asset") : nullptr;
    const Json* const version = asset && asset->is_object() ? member(*asset, "version") : nullptr;
    if (!version || !version->is_string())
      return invalid("the file is not glTF: it has no asset.version");
    for (const char* key : {"version", "minVersion"}) {
      const Json* const written = member(*asset, key);
      if (!written) continue;
      const auto* const number = written->get_ptr<const std::string*>();
      if (!number || !number->starts_with("2.") || (key[0] == 'm' && *number != "2.0")) {
        return invalid(fmt::format("asset.{} is {}; only glTF 2.0 is supported", key,
                                   number ? in_quotes(*number) : "not text"));
      }
    }
    return {};
  }

  void check_extensions() {
    const Json* const required = member(root_, "extensionsRequired");
    if (!required) return;
    if (!required->is_array()) return refuse("extensionsRequired", "is not a list");
    for (const Json& each : *required) {
      const auto* const name = each.get_ptr<const std::string*>();
      if (!name) return refuse("extensionsRequired", "has an element that is not a name");
      if (!is_known(*name)) {
        return refuse(
            "extensionsRequired",
            fmt::format("names {}, which is not supported; export without it", in_quotes(*name)));
      }
    }
  }

  static Json* member(Json& object, const char* key) {
    const auto found = object.find(key);
    return found == object.end() ? nullptr : &*found;
  }

  // Calls `read` for the objects in a list that may be missing.
  template <class Read>
  void each(Json& parent, const char* key, const Read& read) {
    Json* const list = member(parent, key);
    if (!list) return;
    if (!list->is_array()) return refuse(key, "is not a list");
    for (std::size_t k = 0; k < list->size() && !fault_; ++k) {
      place_.push_back({key, k});
      Json& element = (*list)[k];
      if (element.is_object())
        read(element);
      else
        refuse("", "is not an object");
      place_.pop_back();
    }
  }

  template <class Read>
  void within(const char* key, const Read& read) {
    place_.push_back({key, {}});
    read();
    place_.pop_back();
  }

  std::size_t list_size(const char* key) {
    const Json* const list = member(root_, key);
    return list && list->is_array() ? list->size() : 0;
  }

  std::optional<std::string> text(Json& parent, const char* key) {
    Json* const json = member(parent, key);
    if (!json) return {};
    if (auto* const written = json->get_ptr<std::string*>()) return std::move(*written);
    refuse(key, "is not text");
    return {};
  }

  // The path of the current element if it has no name.
  std::string name_or_place(Json& json) {
    std::string name = text(json, "name").value_or("");
    return name.empty() ? place() : name;
  }

  static std::optional<std::uint64_t> to_whole(const Json& json) {
    return json.is_number_unsigned() ? std::optional(json.get<std::uint64_t>()) : std::nullopt;
  }

  std::optional<std::uint64_t> whole(Json& parent, const char* key) {
    const Json* const json = member(parent, key);
    if (!json) return {};
    const auto number = to_whole(*json);
    if (!number) refuse(key, "is not a whole number of at least 0");
    return number;
  }

  std::uint64_t required_whole(Json& parent, const char* key) {
    if (!member(parent, key)) refuse(key, "is missing");
    return whole(parent, key).value_or(0);
  }

  // An index into one of the document's lists.
  std::optional<std::size_t> index(Json& parent, const char* key, const char* list) {
    const auto number = whole(parent, key);
    if (!number) return {};
    return checked_index(*number, key, list);
  }

  std::optional<std::size_t> checked_index(std::uint64_t number, const char* key,
                                           const char* list) {
    const std::size_t size = list_size(list);
    if (number < size) return static_cast<std::size_t>(number);
    refuse(key, size == 0 ? fmt::format("is {}, but the file has no {}", number, list)
                          : fmt::format("is {}, but the file's {} are numbered from 0 to {}",
                                        number, list, size - 1));
    return {};
  }

  std::size_t required_index(Json& parent, const char* key, const char* list) {
    if (!member(parent, key)) refuse(key, "is missing");
    return index(parent, key, list).value_or(0);
  }

  // An object that may be missing.
  Json* part(Json& parent, const char* key) {
    Json* const json = member(parent, key);
    if (!json || json->is_object()) return json;
    refuse(key, "is not an object");
    return nullptr;
  }

  Buffer read_buffer(Json& json) { return {required_whole(json, "byteLength"), text(json, "uri")}; }

  BufferView read_view(Json& json) {
    BufferView view{required_index(json, "buffer", "buffers"),
                    whole(json, "byteOffset").value_or(0), required_whole(json, "byteLength"),
                    whole(json, "byteStride").value_or(0)};
    constexpr std::uint64_t least = 4, most = 252;
    if (member(json, "byteStride") && (view.stride < least || view.stride > most))
      refuse("byteStride",
             fmt::format("is {}, but must be from {} to {}", view.stride, least, most));
    return view;
  }

  Accessor read_accessor(Json& json) {
    Accessor accessor;
    accessor.view = index(json, "bufferView", "bufferViews");
    accessor.offset = whole(json, "byteOffset").value_or(0);
    accessor.component_type = required_whole(json, "componentType");
    accessor.count = required_whole(json, "count");
    if (!member(json, "type")) refuse("type", "is missing");
    accessor.type = text(json, "type").value_or("");
    if (const Json* const normalized = member(json, "normalized")) {
      if (!normalized->is_boolean()) refuse("normalized", "is neither true nor false");
      accessor.is_normalized = *normalized == true;
    }
    if (Json* const sparse = part(json, "sparse"))
      within("sparse", [&] { accessor.sparse = read_sparse(*sparse); });
    return accessor;
  }

  Sparse read_sparse(Json& json) {
    Sparse sparse;
    sparse.count = required_whole(json, "count");
    Json* const indices = part(json, "indices");
    Json* const values = part(json, "values");
    if (!indices || !values) {
      refuse("", "lacks its indices or its values");
      return sparse;
    }
    for (Json* const each : {indices, values})
      if (!member(*each, "bufferView")) refuse("", "has no bufferView");
    within("indices", [&] {
      sparse.index_view = required_index(*indices, "bufferView", "bufferViews");
      sparse.index_offset = whole(*indices, "byteOffset").value_or(0);
      sparse.index_type = required_whole(*indices, "componentType");
    });
    within("values", [&] {
      sparse.value_view = required_index(*values, "bufferView", "bufferViews");
      sparse.value_offset = whole(*values, "byteOffset").value_or(0);
    });
    return sparse;
  }

  MeshEntry read_mesh(Json& json) {
    MeshEntry mesh{name_or_place(json)};
    each(json, "primitives",
         [&](Json& primitive) { mesh.primitives.push_back(read_primitive(primitive)); });
    return mesh;
  }

  Primitive read_primitive(Json& json) {
    Primitive primitive;
    primitive.mode = whole(json, "mode").value_or(primitive.mode);
    if (primitive.mode > 6)
      refuse("mode", fmt::format("is {}, but must be from 0 to 6", primitive.mode));
    primitive.indices = index(json, "indices", "accessors");
    primitive.material = index(json, "material", "materials");
    Json* const attributes = part(json, "attributes");
    if (!attributes) {
      refuse("attributes", "is missing");
      return primitive;
    }
    primitive.positions = index(*attributes, "POSITION", "accessors");
    primitive.normals = index(*attributes, "NORMAL", "accessors");
    for (std::size_t set = 0; set < primitive.uvs.size(); ++set) {
      const std::string key = fmt::format("TEXCOORD_{}", set);
      primitive.uvs[set] = index(*attributes, key.c_str(), "accessors");
    }
    // One that is out of range only matters to who asks for it: then it is missing.
    for (const auto& [name, value] : attributes->items()) {
      const auto number = to_whole(value);
      if (name.starts_with('_') && number && *number < list_size("accessors"))
        primitive.customs.emplace_back(name, static_cast<std::size_t>(*number));
    }
    return primitive;
  }

  std::vector<std::size_t> node_list(Json& parent, const char* key) {
    std::vector<std::size_t> nodes;
    const Json* const list = member(parent, key);
    if (!list) return nodes;
    if (!list->is_array()) refuse(key, "is not a list");
    for (std::size_t k = 0; k < list->size() && !fault_; ++k) {
      const auto number = to_whole((*list)[k]);
      if (!number) refuse(key, "has an element that is not a whole number of at least 0");
      if (number) nodes.push_back(checked_index(*number, key, "nodes").value_or(0));
    }
    return nodes;
  }

  // `count` numbers; nullopt: the member is missing.
  template <int count>
  std::optional<Eigen::Vector<double, count>> numbers(Json& parent, const char* key) {
    const Json* const list = member(parent, key);
    if (!list) return {};
    Eigen::Vector<double, count> values = Eigen::Vector<double, count>::Zero();
    bool is_sound = list->is_array() && list->size() == count;
    for (int k = 0; is_sound && k < count; ++k) {
      const Json& number = (*list)[static_cast<std::size_t>(k)];
      is_sound = number.is_number();
      if (is_sound) values[k] = number.get<double>();
    }
    if (!is_sound) refuse(key, fmt::format("is not a list of {} numbers", count));
    return values;
  }

  Node read_node(Json& json) {
    return {name_or_place(json), read_transform(json), index(json, "mesh", "meshes"),
            node_list(json, "children")};
  }

  // A matrix by columns, or T R S.
  Eigen::Matrix4d read_transform(Json& json) {
    const auto matrix = numbers<16>(json, "matrix");
    const auto translation = numbers<3>(json, "translation");
    const auto rotation = numbers<4>(json, "rotation");
    const auto scale = numbers<3>(json, "scale");
    if (matrix) {
      if (translation || rotation || scale)
        refuse("matrix", "is given together with a translation, rotation or scale");
      return matrix->reshaped(4, 4);
    }
    Eigen::Affine3d transform = Eigen::Affine3d::Identity();
    if (translation) transform.translate(*translation);
    if (rotation) {
      const double size = rotation->norm();
      if (!(size > 0 && std::isfinite(size)))
        refuse("rotation", "is a quaternion whose length is 0 or not finite");
      const Eigen::Vector4d unit = *rotation / size;
      transform.rotate(Eigen::Quaterniond(unit[3], unit[0], unit[1], unit[2]));
    }
    if (scale) transform.scale(*scale);
    return transform.matrix();
  }

  // The roots of the scene that the file names, or of its first one.
  void read_roots() {
    const auto shown = index(root_, "scene", "scenes");
    std::size_t number = 0;
    each(root_, "scenes", [&](Json& scene) {
      auto nodes = node_list(scene, "nodes");
      if (number++ == shown.value_or(0)) document_.roots = std::move(nodes);
    });
    if (number == 0) refuse("scenes", "is missing: the file has no scene");
  }

  Json& root_;
  Document document_;
  std::vector<Step> place_;
  std::optional<std::string> fault_;
};

}  // namespace

Result<Document> read_document(std::string_view json) {
  auto root = parse(json);
  if (!root) return fail(root.error());
  return DocumentReader(*root).read();
}

}  // namespace pliant::gltf
