#include "pliant/scene/format/format_json.hpp"

#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "pliant/scene/format/format.hpp"
#include "pliant/scene/format/key_text.hpp"

namespace pliant {
namespace {

using Json = nlohmann::ordered_json;

void add(Json& json, const char* name, std::string_view text) {
  if (!text.empty()) json[name] = text;
}

void add(Json& json, const Range& range) {
  if (std::isfinite(range.least)) json["least"] = range.least;
  if (std::isfinite(range.most)) json["most"] = range.most;
  if (range.excludes_least) json["excludesLeast"] = true;
  if (range.excludes_zero) json["excludesZero"] = true;
}

/// The words that a value may have, or begin with.
std::vector<std::string> words_in(const AttributeFormat& attribute) {
  if (attribute.type == "tangent") return xml::tangent_words();
  if (attribute.type == "interpolation") return xml::interpolation_words();
  if (attribute.type != "extrapolation") return {attribute.words.begin(), attribute.words.end()};
  xml::ExtrapolationWords words = xml::extrapolation_words();
  for (const auto& more : {words.loops, words.slopes})
    words.plain.insert(words.plain.end(), more.begin(), more.end());
  return words.plain;
}

Json json_of(const AttributeFormat& attribute) {
  Json json{{"name", attribute.name},
            {"type", attribute.type},
            {"meaning", attribute.meaning},
            {"keyable", attribute.is_keyable},
            {"required", attribute.need == Need::Required}};
  add(json, "unit", attribute.unit);
  add(json, "range", attribute.range);
  add(json, attribute.limits);
  if (attribute.need != Need::Required) add(json, "default", attribute.standard);
  if (const auto words = words_in(attribute); !words.empty()) json["words"] = words;
  if (attribute.is_position) json["position"] = true;
  if (attribute.names_surfaces) json["surfaces"] = true;
  return json;
}

Json json_of(const ChildFormat& child) {
  Json json{{"names", child.names}, {"least", child.row.least}, {"part", child.is_part}};
  if (child.row.most != unlimited) json["most"] = child.row.most;
  add(json, "noun", child.row.noun);
  return json;
}

Json json_of(const ElementFormat& element) {
  Json json{{"name", element.name},        {"meaning", element.meaning},
            {"parents", element.parents},  {"mayInclude", element.may_include},
            {"attributes", Json::array()}, {"children", Json::array()}};
  for (const AttributeFormat& attribute : element.attributes)
    if (attribute.need != Need::Later) json["attributes"].push_back(json_of(attribute));
  for (const ChildFormat& child : element.children) json["children"].push_back(json_of(child));
  if (element.text) {
    json["text"] = {{"meaning", element.text->meaning}};
    add(json["text"], element.text->range);
  }
  return json;
}

}  // namespace

std::string scene_format_json() {
  Json elements = Json::array();
  for (const ElementFormat& element : scene_format()) elements.push_back(json_of(element));
  return Json{{"elements", std::move(elements)}}.dump();
}

}  // namespace pliant
