#include "pliant/mesh/assimp_guard.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/core/number.hpp"
#include "pliant/mesh/assimp_guard_fbx.hpp"
#include "pliant/mesh/nesting.hpp"

namespace pliant {
namespace {

using tinyxml2::XMLElement;

tl::unexpected<Error> broken(std::string message, int line = 0) {
  return fail(ErrorCode::InvalidInput, std::move(message), {}, line);
}

// --- Collada ---

std::string_view attribute(const XMLElement& element, const char* name) {
  const char* text = element.Attribute(name);
  return text ? text : "";
}

// A whole number >= 0; -1: it is none.
std::int64_t count_of(const XMLElement& element, const char* name, std::int64_t standard) {
  if (!element.Attribute(name)) return standard;
  return to_integer(attribute(element, name)).value_or(-1);
}

bool is_index_list(std::string_view name) {
  return name == "p" || name == "h" || name == "ph" || name == "v" || name == "vcount";
}

class ColladaCheck {
 public:
  Result<void> run(const XMLElement& root) {
    std::vector<const XMLElement*> parts;  // that may be the root of the file's scene
    std::set<std::string_view> roots;      // "#" and id
    for (const XMLElement* at = &root; at; at = after(*at, root)) {
      const std::string_view name = at->Name();
      if (name.ends_with("_array"))
        array_sizes_.emplace(attribute(*at, "id"), count_of(*at, "count", 0));
      if (name == "visual_scene" || (name == "node" && is_in_library(*at))) {
        library_.insert_or_assign(attribute(*at, "id"), at);
        parts.push_back(at);
      }
      if (name == "instance_visual_scene") roots.insert(attribute(*at, "url"));
    }
    for (const XMLElement* part : parts) {
      if (!roots.contains(fmt::format("#{}", attribute(*part, "id")))) continue;
      scene_nodes_.clear();
      add_names(*part);
      if (auto checked = check_nodes(*part, 0); !checked) return checked;
    }
    for (const XMLElement* at = &root; at; at = after(*at, root)) {
      if (auto checked = check(*at); !checked) return checked;
    }
    return {};
  }

 private:
  // The element behind `at` in the order of the file; null at the end.
  static const XMLElement* after(const XMLElement& at, const XMLElement& root) {
    if (const XMLElement* child = at.FirstChildElement()) return child;
    const XMLElement* up = &at;
    while (up != &root && !up->NextSiblingElement()) up = up->Parent()->ToElement();
    return up == &root ? nullptr : up->NextSiblingElement();
  }

  static bool is_in_library(const XMLElement& node) {
    const XMLElement* parent = node.Parent()->ToElement();
    return parent && std::string_view(parent->Name()) == "library_nodes";
  }

  void add_names(const XMLElement& node) {
    const bool is_scene = std::string_view(node.Name()) == "visual_scene";
    const bool has_name = node.Attribute("name") != nullptr;
    scene_nodes_.emplace(is_scene && !has_name ? "Scene" : attribute(node, "name"), &node);
    scene_nodes_.emplace(attribute(node, "id"), &node);
    for (const XMLElement* child = node.FirstChildElement("node"); child;
         child = child->NextSiblingElement("node"))
      add_names(*child);
  }

  // What assimp takes an <instance_node> for: the last part of the libraries that has the id, or
  // the first part of the scene that has the name or id, which may be empty. Null: nothing.
  const XMLElement* target_of(const XMLElement& instance) const {
    std::string_view url = attribute(instance, "url");
    if (!url.starts_with('#')) return nullptr;
    url.remove_prefix(1);
    if (const auto part = library_.find(url); part != library_.end()) return part->second;
    const auto part = scene_nodes_.find(url);
    return part == scene_nodes_.end() ? nullptr : part->second;
  }

  // Walks the nodes below as assimp does, which puts a copy in place of each <instance_node>.
  Result<void> check_nodes(const XMLElement& node, std::size_t depth) {
    if (depth > deepest_nesting) return too_deep();
    if (--nodes_left_ < 0)
      return broken(fmt::format("the file's instances make more than {} nodes", most_nodes));
    for (const XMLElement* child = node.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const XMLElement* next = std::string_view(child->Name()) == "node" ? child : nullptr;
      if (std::string_view(child->Name()) == "instance_node") next = target_of(*child);
      if (!next) continue;
      if (auto checked = check_nodes(*next, depth + 1); !checked) return checked;
    }
    return {};
  }

  Result<void> check(const XMLElement& element) const {
    const std::string_view name = element.Name();
    if (name == "accessor") return check_accessor(element);
    if (is_index_list(name) && element.GetText()) return check_indices(element);
    return {};
  }

  Result<void> check_accessor(const XMLElement& accessor) const {
    const std::int64_t count = count_of(accessor, "count", 0);
    const std::int64_t stride = count_of(accessor, "stride", 1);
    const std::int64_t offset = count_of(accessor, "offset", 0);
    std::string_view source = attribute(accessor, "source");
    if (source.starts_with('#')) source.remove_prefix(1);
    const auto array = array_sizes_.find(source);
    const std::int64_t size = array == array_sizes_.end() ? 0 : array->second;
    if (count < 0 || stride < 1 || offset < 0)
      return broken("<accessor> has a count, stride or offset that is no whole number",
                    accessor.GetLineNum());
    if (count > 0 && offset + count * stride > size) {
      return broken(fmt::format("<accessor> reads {} numbers of \"{}\", which has {}",
                                offset + count * stride, source.substr(0, 40), size),
                    accessor.GetLineNum());
    }
    std::int64_t params = 0;
    for (const XMLElement* param = accessor.FirstChildElement("param"); param;
         param = param->NextSiblingElement("param"))
      ++params;
    if (params > stride && count > 0) {
      return broken(fmt::format("<accessor> has {} parameters, but a stride of {}", params, stride),
                    accessor.GetLineNum());
    }
    return {};
  }

  static Result<void> check_indices(const XMLElement& list) {
    const std::string_view text = list.GetText();
    if (text.find_first_not_of("0123456789+- \t\r\n") == std::string_view::npos) return {};
    return broken(fmt::format("<{}> holds something other than whole numbers", list.Name()),
                  list.GetLineNum());
  }

  static constexpr std::int64_t most_nodes = 1'000'000;

  std::map<std::string, std::int64_t, std::less<>> array_sizes_;  // by id
  std::map<std::string_view, const XMLElement*> library_;         // by id
  std::map<std::string_view, const XMLElement*> scene_nodes_;     // by name and id
  std::int64_t nodes_left_ = most_nodes;
};

Result<void> check_collada(std::string_view bytes) {
  tinyxml2::XMLDocument document;
  if (document.Parse(bytes.data(), bytes.size()) != tinyxml2::XML_SUCCESS) {
    return broken(fmt::format("the file is no sound XML ({})",
                              tinyxml2::XMLDocument::ErrorIDToName(document.ErrorID())),
                  document.ErrorLineNum());
  }
  const XMLElement* root = document.RootElement();
  return root ? ColladaCheck().run(*root) : broken("the file is empty");
}

// --- glTF ---

std::uint64_t number_at(std::string_view bytes, std::size_t at) {
  std::uint64_t number = 0;
  for (std::size_t k = 0; k < 4; ++k)
    number |= std::uint64_t{static_cast<unsigned char>(bytes[at + k])} << 8 * k;
  return number;
}

Result<void> check_brackets(std::string_view text) {
  std::size_t depth = 0;
  bool is_quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (is_quoted && c == '\\') {
      ++k;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && (c == '[' || c == '{')) {
      if (++depth > deepest_nesting) return too_deep();
    } else if (!is_quoted && (c == ']' || c == '}') && depth > 0) {
      --depth;
    }
  }
  return {};
}

// Brackets within brackets, and nodes within nodes. A node stands in one list of children at most:
// assimp, which copies a node into each list, would need time without end.
Result<void> check_json(std::string_view text) {
  if (auto checked = check_brackets(text); !checked) return checked;
  constexpr std::size_t most_lists = 2000;  // each may lie within the one before
  constexpr std::string_view key = "\"children\"", digits = "0123456789";
  std::set<int> children;
  std::size_t lists = 0;
  for (std::size_t at = text.find(key); at != std::string_view::npos; at = text.find(key, at)) {
    at = std::min(text.find_first_not_of(": \t\r\n", at + key.size()), text.size());
    if (at == text.size() || text[at] != '[') continue;
    if (++lists > most_lists)
      return broken(fmt::format("the file has more than {} nodes with children", most_lists));
    const std::size_t end = std::min(text.find(']', at), text.size());
    while (at < end) {
      const std::size_t first = std::min(text.find_first_of(digits, at), end);
      at = std::min(text.find_first_not_of(digits, first), end);
      const auto child = to_integer(text.substr(first, at - first));
      if (child && !children.insert(*child).second)
        return broken(fmt::format("node {} of the file is a child twice", *child));
    }
  }
  return {};
}

// A header of 12 bytes, then chunks: length, kind, content.
Result<void> check_glb(std::string_view bytes) {
  constexpr std::size_t header = 12, chunk_header = 8;
  if (bytes.size() < header || !bytes.starts_with("glTF")) return broken("the file is no glTF");
  if (number_at(bytes, 8) > bytes.size()) {
    return broken(fmt::format("the file is cut short: it has {} of {} bytes", bytes.size(),
                              number_at(bytes, 8)));
  }
  if (bytes.size() > header + chunk_header) {
    const auto text = bytes.substr(header + chunk_header, number_at(bytes, header));
    if (auto checked = check_json(text); !checked) return checked;
  }
  for (std::size_t at = header; at < bytes.size();) {
    const std::size_t room = bytes.size() - at;
    if (room < chunk_header || number_at(bytes, at) > room - chunk_header)
      return broken(fmt::format("the chunk at byte {} reaches past the end of the file", at));
    at += chunk_header + number_at(bytes, at);
  }
  return {};
}

}  // namespace

Result<void> check_for_assimp(std::string_view bytes, std::string_view ending) {
  if (ending == "dae") return check_collada(bytes);
  if (ending == "gltf") return check_json(bytes);
  if (ending == "glb") return check_glb(bytes);
  if (ending == "fbx") return check_fbx(bytes);
  return {};
}

}  // namespace pliant
