#include "pliant/mesh/assimp_guard.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/core/number.hpp"

namespace pliant {
namespace {

using tinyxml2::XMLElement;

tl::unexpected<Error> broken(std::string message, int line = 0) {
  return fail(ErrorCode::InvalidInput, std::move(message), {}, line);
}

// assimp follows what is nested by calling itself, to the end of the stack.
constexpr std::size_t deepest = 200;

tl::unexpected<Error> too_deep() {
  return broken(fmt::format("the file nests its parts more than {} deep", deepest));
}

// How deep the brackets of a text go that has `"` around its strings.
Result<void> check_depth(std::string_view text, std::string_view opening, std::string_view closing,
                         bool has_escapes) {
  std::size_t depth = 0;
  bool is_quoted = false;
  for (std::size_t k = 0; k < text.size(); ++k) {
    const char c = text[k];
    if (is_quoted && has_escapes && c == '\\') {
      ++k;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (!is_quoted && opening.find(c) != std::string_view::npos) {
      if (++depth > deepest) return too_deep();
    } else if (!is_quoted && depth > 0 && closing.find(c) != std::string_view::npos) {
      --depth;
    }
  }
  return {};
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
    for (const XMLElement* at = &root; at; at = after(*at, root)) {
      const std::string_view name = at->Name();
      if (name.ends_with("_array"))
        array_sizes_.emplace(attribute(*at, "id"), count_of(*at, "count", 0));
      if (name == "node") nodes_.emplace(attribute(*at, "id"), at);
      if (name == "visual_scene") scenes_.push_back(at);
    }
    for (const XMLElement* scene : scenes_) {
      if (auto checked = check_nodes(*scene, 0); !checked) return checked;
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

  // Walks the nodes below as assimp does, which puts a copy in place of each <instance_node>.
  Result<void> check_nodes(const XMLElement& node, std::size_t depth) {
    if (depth > deepest) return too_deep();
    if (--nodes_left_ < 0)
      return broken(fmt::format("the file's instances make more than {} nodes", most_nodes));
    for (const XMLElement* child = node.FirstChildElement(); child;
         child = child->NextSiblingElement()) {
      const XMLElement* next = std::string_view(child->Name()) == "node" ? child : nullptr;
      if (std::string_view(child->Name()) == "instance_node") {
        std::string_view url = attribute(*child, "url");
        if (url.starts_with('#')) url.remove_prefix(1);
        const auto target = nodes_.find(url);
        if (target != nodes_.end()) next = target->second;
      }
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
  std::map<std::string, const XMLElement*, std::less<>> nodes_;   // by id
  std::vector<const XMLElement*> scenes_;
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

// Brackets within brackets, and nodes within nodes. A node stands in one list of children at most:
// assimp, which copies a node into each list, would need time without end.
Result<void> check_json(std::string_view text) {
  if (auto checked = check_depth(text, "[{", "]}", true); !checked) return checked;
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

// --- FBX ---

// `Layer` and `LayerElementUV` carry a number; the plain `LayerElement` within a layer does not.
bool needs_number(std::string_view name) {
  return name.starts_with("Layer") && name != "LayerElement";
}

tl::unexpected<Error> without_number(std::string_view name) {
  return broken(fmt::format("{} has no number", name.substr(0, 40)));
}

// An FBX file as text: a name, a colon, values, and then maybe a brace.
Result<void> check_fbx_text(std::string_view bytes) {
  if (auto checked = check_depth(bytes, "{", "}", false); !checked) return checked;
  const std::string_view key = "Layer";
  for (std::size_t at = bytes.find(key); at != std::string_view::npos; at = bytes.find(key, at)) {
    const std::size_t end = std::min(bytes.find_first_of(": \t\r\n\",{}", at), bytes.size());
    const std::string_view name = bytes.substr(at, end - at);
    at = end;
    const std::size_t colon = bytes.find_first_not_of(" \t\r\n", end);
    if (!needs_number(name) || colon == std::string_view::npos || bytes[colon] != ':') continue;
    const std::size_t value = bytes.find_first_not_of(" \t\r\n", colon + 1);
    if (value != std::string_view::npos && bytes[value] == '{') return without_number(name);
  }
  return {};
}

// The nodes of a binary FBX file: where the node ends, count and size of its values, in 4 bytes
// each (8 from version 7.5 on), length of its name in 1; name, values, nodes within. The heads are
// taken one after the other, whichever node they are in. What does not fit, assimp finds.
Result<void> check_fbx_binary(std::string_view bytes) {
  constexpr std::size_t header = 27, version_at = 23;
  if (bytes.size() < header) return {};
  const std::size_t width = number_at(bytes, version_at) >= 7500 ? 8 : 4;
  std::vector<std::uint64_t> ends;  // of the nodes that we are within
  for (std::size_t at = header; bytes.size() - at > 3 * width;) {
    while (!ends.empty() && ends.back() <= at) ends.pop_back();
    if (const std::uint64_t end = number_at(bytes, at); end > at) ends.push_back(end);
    if (ends.size() > deepest) return too_deep();
    const std::uint64_t value_count = number_at(bytes, at + width);
    const std::uint64_t value_size = number_at(bytes, at + 2 * width);
    const std::size_t name_size = static_cast<unsigned char>(bytes[at + 3 * width]);
    at += 3 * width + 1;
    if (name_size > bytes.size() - at || value_size > bytes.size() - at - name_size) return {};
    const std::string_view name = bytes.substr(at, name_size);
    if (value_count == 0 && needs_number(name)) return without_number(name);
    at += name_size + value_size;
  }
  return {};
}

Result<void> check_fbx(std::string_view bytes) {
  return bytes.starts_with("Kaydara FBX Binary") ? check_fbx_binary(bytes) : check_fbx_text(bytes);
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
