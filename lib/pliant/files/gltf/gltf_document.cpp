#include "pliant/files/gltf/gltf_document.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Geometry>
#include <fmt/format.h>

#include "pliant/files/file_object.hpp"
#include "pliant/files/json/json_reader.hpp"

namespace pliant::gltf {
namespace {

// Whether an extension affects looks, or other parts of a scene than its meshes: these are the same
// without it. Not those that compress, replace or place them.
bool concerns_looks(std::string_view extension) {
  constexpr std::size_t longest = 100;  // of those that are told
  const std::size_t vendor = extension.find('_');
  if (vendor == std::string_view::npos || extension.size() > longest) return false;
  const std::string_view name = extension.substr(vendor + 1);
  for (const std::string_view kind :
       {"materials_", "material_", "texture_", "image_", "lights_", "light_", "xmp", "audio"}) {
    if (name.starts_with(kind)) return true;
  }
  for (const std::string_view known :
       {"KHR_animation_pointer", "KHR_node_visibility", "KHR_node_selectability",
        "KHR_node_hoverability", "KHR_interactivity", "KHR_physics_rigid_bodies", "MSFT_lod",
        "MSFT_packing_normalRoughnessMetallic", "MSFT_packing_occlusionRoughnessMetallic",
        "EXT_mesh_features", "EXT_structural_metadata", "EXT_feature_metadata",
        "CESIUM_primitive_outline", "FB_geometry_metadata", "VRMC_vrm", "VRMC_springBone",
        "VRMC_node_constraint"}) {
    if (extension == known) return true;
  }
  return false;
}

bool is_read(std::string_view extension) { return extension == "KHR_mesh_quantization"; }

class DocumentReader : private JsonReader {
 public:
  DocumentReader(Json& root, const StopRequest& should_stop) : JsonReader(root, should_stop) {}

  Result<Document> read(Subject subject) {
    if (auto checked = check_asset(); !checked) return fail(checked.error());
    check_extensions();
    if (list_size("buffers") > most_buffers)
      refuse("buffers", fmt::format("has more than {} elements", most_buffers));
    list("buffers", document_.buffers, [&](Json& json) { return read_buffer(json); });
    list("bufferViews", document_.views, [&](Json& json) { return read_view(json); });
    list("accessors", document_.accessors, [&](Json& json) { return read_accessor(json); });
    list("materials", document_.materials,
         [&](Json& json) { return text(json, "name").value_or(""); });
    list("meshes", document_.meshes, [&](Json& json) { return read_mesh(json); });
    list("nodes", document_.nodes, [&](Json& json) { return read_node(json); });
    if (subject == Subject::Meshes) {
      read_roots();
    } else {
      list("animations", document_.animations, [&](Json& json) { return read_animation(json); });
    }
    if (fault_) return fault();
    return std::move(document_);
  }

 private:
  // The objects in a list of the root.
  template <class Item, class Read>
  void list(const char* key, std::vector<Item>& items, const Read& read) {
    each(root_, key, [&](Json& json) { items.push_back(read(json)); });
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
        const bool is_version =
            number && number->find_first_not_of("0123456789.") == std::string::npos;
        return invalid(fmt::format("asset.{} is {}; only glTF 2.0 is supported", key,
                                   is_version ? in_quotes(*number) : "no version"));
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
      if (concerns_looks(*name)) {
        document_.looks.push_back(*name);
      } else if (!is_read(*name)) {
        return refuse(
            "extensionsRequired",
            fmt::format("names {}, which is not supported; export without it", in_quotes(*name)));
      }
    }
  }

  // The path of the current element if it has no name.
  std::string name_or_place(Json& json) {
    std::string name = text(json, "name").value_or("");
    if (name.size() > longest_name)
      refuse("name",
             fmt::format("has {} bytes, but at most {} are read", name.size(), longest_name));
    return name.empty() ? place() : name;
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
    for (const std::uint64_t number : wholes(parent, key))
      nodes.push_back(checked_index(number, key, "nodes").value_or(0));
    return nodes;
  }

  template <int count>
  std::optional<Eigen::Vector<double, count>> vector(Json& parent, const char* key) {
    const auto values = numbers(parent, key, count);
    if (!values) return {};
    return Eigen::Map<const Eigen::Vector<double, count>>(values->data());
  }

  Node read_node(Json& json) {
    return {name_or_place(json), read_transform(json), index(json, "mesh", "meshes"),
            node_list(json, "children")};
  }

  // A matrix by columns, or T R S.
  Eigen::Matrix4d read_transform(Json& json) {
    const auto matrix = vector<16>(json, "matrix");
    const auto translation = vector<3>(json, "translation");
    const auto rotation = vector<4>(json, "rotation");
    const auto scale = vector<3>(json, "scale");
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

  // The roots of the scene that the file names, or of its first one; without a scene all nodes that
  // are no children.
  void read_roots() {
    const auto shown = index(root_, "scene", "scenes");
    std::size_t number = 0;
    each(root_, "scenes", [&](Json& scene) {
      auto nodes = node_list(scene, "nodes");
      if (number++ == shown.value_or(0)) document_.roots = std::move(nodes);
    });
    if (number > 0) return;
    std::vector<bool> is_child(document_.nodes.size());
    for (const Node& node : document_.nodes)
      for (const std::size_t child : node.children) is_child[child] = true;
    for (std::size_t k = 0; k < is_child.size(); ++k)
      if (!is_child[k]) document_.roots.push_back(k);
  }

  Animation read_animation(Json& json) {
    Animation animation{name_or_place(json)};
    each(json, "samplers",
         [&](Json& sampler) { animation.samplers.push_back(read_sampler(sampler)); });
    each(json, "channels",
         [&](Json& channel) { animation.channels.push_back(read_channel(channel, animation)); });
    // Extras may be anything.
    Json* const extras = member(json, "extras");
    const Json* const frame =
        extras && extras->is_object() ? member(*extras, "pliantFirstFrame") : nullptr;
    if (frame && frame->is_number()) animation.first_frame = frame->get<double>();
    return animation;
  }

  AnimationSampler read_sampler(Json& json) {
    AnimationSampler sampler{required_index(json, "input", "accessors"),
                             required_index(json, "output", "accessors")};
    const std::string word = text(json, "interpolation").value_or("LINEAR");
    if (word == "STEP") {
      sampler.interpolation = KeyedInterpolation::Step;
    } else if (word == "CUBICSPLINE") {
      sampler.interpolation = KeyedInterpolation::CubicSpline;
    } else if (word != "LINEAR") {
      refuse("interpolation",
             fmt::format("is {}, but must be STEP, LINEAR or CUBICSPLINE", in_quotes(word)));
    }
    return sampler;
  }

  AnimationChannel read_channel(Json& json, const Animation& animation) {
    AnimationChannel channel;
    const std::uint64_t sampler = required_whole(json, "sampler");
    if (sampler >= animation.samplers.size()) {
      refuse("sampler", fmt::format("is {}, but the animation has {} samplers", sampler,
                                    animation.samplers.size()));
    }
    channel.sampler = static_cast<std::size_t>(sampler);
    Json* const target = part(json, "target");
    if (!target) {
      refuse("target", "is missing");
      return channel;
    }
    within("target", [&] {
      channel.node = index(*target, "node", "nodes");
      channel.path = text(*target, "path").value_or("");
    });
    return channel;
  }

  Document document_;
};

}  // namespace

Result<Document> read_document(std::string_view json, Subject subject,
                               const StopRequest& should_stop) {
  auto root = parse_json(json, "glTF", should_stop);
  if (!root) return fail(root.error());
  return DocumentReader(*root, should_stop).read(subject);
}

}  // namespace pliant::gltf
