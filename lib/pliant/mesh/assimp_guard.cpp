#include "pliant/mesh/assimp_guard.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string>

#include <fmt/format.h>
#include <tinyxml2.h>

#include "pliant/core/number.hpp"

namespace pliant {
namespace {

using tinyxml2::XMLElement;

tl::unexpected<Error> broken(std::string message, int line = 0) {
  return fail(ErrorCode::InvalidInput, std::move(message), {}, line);
}

// --- Collada
// --------------------------------------------------------------------------------------

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
      if (std::string_view(at->Name()).ends_with("_array")) {
        array_sizes_.emplace(attribute(*at, "id"), count_of(*at, "count", 0));
      }
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

  std::map<std::string, std::int64_t, std::less<>> array_sizes_;  // by id
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

// --- binary glTF
// ----------------------------------------------------------------------------------

std::uint64_t number_at(std::string_view bytes, std::size_t at) {
  std::uint64_t number = 0;
  for (std::size_t k = 0; k < 4; ++k)
    number |= std::uint64_t{static_cast<unsigned char>(bytes[at + k])} << 8 * k;
  return number;
}

// A header of 12 bytes, then chunks: length, kind, content.
Result<void> check_glb(std::string_view bytes) {
  constexpr std::size_t header = 12, chunk_header = 8;
  if (bytes.size() < header || !bytes.starts_with("glTF")) return broken("the file is no glTF");
  if (number_at(bytes, 8) > bytes.size()) {
    return broken(fmt::format("the file is cut short: it has {} of {} bytes", bytes.size(),
                              number_at(bytes, 8)));
  }
  for (std::size_t at = header; at < bytes.size();) {
    const std::size_t room = bytes.size() - at;
    if (room < chunk_header || number_at(bytes, at) > room - chunk_header)
      return broken(fmt::format("the chunk at byte {} reaches past the end of the file", at));
    at += chunk_header + number_at(bytes, at);
  }
  return {};
}

// --- FBX
// ------------------------------------------------------------------------------------------

// `Layer` and `LayerElementUV` carry a number; the plain `LayerElement` within a layer does not.
bool needs_number(std::string_view name) {
  return name.starts_with("Layer") && name != "LayerElement";
}

tl::unexpected<Error> without_number(std::string_view name) {
  return broken(fmt::format("{} has no number", name.substr(0, 40)));
}

// An FBX file as text: a name, a colon, values, and then maybe a brace.
Result<void> check_fbx_text(std::string_view bytes) {
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
  for (std::size_t at = header; bytes.size() - at > 3 * width;) {
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
  if (ending == "glb") return check_glb(bytes);
  if (ending == "fbx") return check_fbx(bytes);
  return {};
}

}  // namespace pliant
