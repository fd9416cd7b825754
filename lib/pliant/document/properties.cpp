#include "pliant/document/properties.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/core/text.hpp"
#include "pliant/document/operation.hpp"
#include "pliant/scene/format/contents.hpp"
#include "pliant/scene/format/key_text.hpp"
#include "pliant/scene/format/path_text.hpp"
#include "pliant/scene/text/element_text.hpp"
#include "pliant/scene/text/markup.hpp"
#include "pliant/scene/text/source_map.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant {
namespace {

using OrderedJson = nlohmann::ordered_json;
using xml::Contents;
using xml::Slot;

/// What keys an attribute has.
struct Keyed {
  int components = 0;  ///< of a key; 0: it has none
  bool is_animated = false;
};

struct KeyedOf {
  template <int D>
  Keyed operator()(const Channel<D>& channel) const {
    return {D, channel.is_animated()};
  }
  template <int D>
  Keyed operator()(Channel<D>* place) const {
    return (*this)(*place);
  }
  template <int D>
  Keyed operator()(std::optional<Channel<D>>* place) const {
    return {D, *place && (*place)->is_animated()};
  }
  Keyed operator()(PositionChannel* place) const {
    return {3, place->path() || place->channel()->is_animated()};
  }
  Keyed operator()(TangentChannel* place) const { return std::visit(*this, *place); }
  Keyed operator()(Switch* place) const { return (*this)(place->channel()); }
  template <class Other>
  Keyed operator()(const Other&) const {
    return {};
  }
};

const std::string* name_in(const Contents& contents) {
  for (const Slot& slot : contents.attributes)
    if (slot.attribute.syntax == Syntax::Name) return std::get<std::string*>(slot.place);
  return nullptr;
}

class PropertiesWriter {
 public:
  PropertiesWriter(const SceneDocument& document, const StopRequest& should_stop)
      : scene_(document.scene()),
        sources_(*document.scene().origin.sources),
        folder_(document.folder()),
        should_stop_(should_stop),
        poll_(should_stop) {}

  Result<std::string> write();

 private:
  struct Object {
    TextPlace place;
    std::string json;
  };
  /// A text, scanned.
  struct Text {
    xml::Markup markup;
    std::string file;  // as seen from the document's folder
  };
  /// An object while its attributes are told.
  struct Owner {
    std::string name;  // empty: the scene
    TextPlace place;
    OrderedJson attributes = OrderedJson::array();
  };

  void tell(Contents& contents, const std::string& group);
  void tell_attributes(const Contents& contents, bool is_part, Owner& owner);
  void tell_path(const std::string& path, const PathMotion& motion, Owner& owner);
  void tell_attribute(const Slot& slot, Keyed keyed, const std::string& path,
                      std::string_view element, int part_text, Owner& owner);
  std::string value_of(const Slot& slot, const std::optional<std::string>& written) const;
  int text_of_part(const Contents& part, const Owner& owner);
  const Text& scanned(int text);
  std::uint32_t element_at(const TextPlace& place);

  Scene scene_;
  const SourceMap& sources_;
  std::string folder_;
  const StopRequest& should_stop_;
  StopPoll poll_;
  std::map<int, Text> texts_;
  std::vector<Object> objects_;
  bool is_interrupted_ = false;
};

/// That of a text that was read as a part of the scene.
const PropertiesWriter::Text& PropertiesWriter::scanned(int text) {
  const auto known = texts_.find(text);
  if (known != texts_.end()) return known->second;
  const std::string& file = sources_.sources()[static_cast<std::size_t>(text)].file;
  auto markup = xml::markup_of(sources_.text(text), file, should_stop_);
  is_interrupted_ = is_interrupted_ || !markup;
  return texts_
      .emplace(text, Text{markup ? *std::move(markup) : xml::Markup(), path_from(folder_, file)})
      .first->second;
}

/// The element whose name stands there.
std::uint32_t PropertiesWriter::element_at(const TextPlace& place) {
  const auto& elements = scanned(place.text).markup.elements;
  const auto found = std::ranges::lower_bound(
      elements, place.range.begin, {}, [](const xml::ElementPlace& one) { return one.name.begin; });
  return static_cast<std::uint32_t>(found - elements.begin());
}

/// The text in which a part stands if it cannot be changed in that of its object; otherwise 0.
int PropertiesWriter::text_of_part(const Contents& part, const Owner& owner) {
  if (owner.place.text != 0) return owner.place.text;
  const xml::Markup& markup = scanned(0).markup;
  if (is_interrupted_) return 0;
  const std::string_view text = sources_.text(0);
  const std::uint32_t object = element_at(owner.place);
  for (std::size_t child = object + std::size_t{1}; child < markup.after(object);
       child = markup.after(child))
    if (markup.elements[child].name.of(text) == part.element) return 0;
  for (const Slot& slot : part.attributes) {
    const std::string attribute(slot.attribute.name);
    if (scene_.origin.gives(owner.name, attribute))
      if (const int there = scene_.origin.at(owner.name, attribute).text; there > 0) return there;
  }
  return 0;
}

/// `written`: what the document's own text has; null: nothing.
std::string PropertiesWriter::value_of(const Slot& slot,
                                       const std::optional<std::string>& written) const {
  if (written && written->find('$') == std::string::npos) {
    if (std::holds_alternative<std::string*>(slot.place)) return *written;
    const std::vector<std::string_view> words = xml::words_of(*written);
    if (words.size() == xml::words_of(slot.text).size())
      return fmt::format("{}", fmt::join(words, " "));
  }
  const bool is_file = slot.attribute.syntax == Syntax::Path && !slot.text.empty();
  return edit::literal_text(is_file && !folder_.empty() ? path_from(folder_, slot.text)
                                                        : slot.text);
}

void PropertiesWriter::tell_attribute(const Slot& slot, Keyed keyed, const std::string& path,
                                      std::string_view element, int part_text, Owner& owner) {
  const std::string attribute(slot.attribute.name);
  TextPlace place;
  if (scene_.origin.gives(path, attribute)) place = scene_.origin.at(path, attribute);
  const bool is_given = place.is_known() || keyed.is_animated;
  std::optional<std::string> written;
  if (place.is_known() && !keyed.is_animated)
    written = xml::decoded(place.range.of(sources_.text(place.text)));
  const bool has_dollar = written && written->find('$') != std::string::npos;
  const int text = place.text > 0 ? place.text : part_text;
  // Member by member: a list in braces would be copied.
  OrderedJson json;
  json["name"] = attribute;
  json["element"] = element;
  json["path"] = fmt::format("{}.{}", path.empty() ? Description<Scene>::element : path, attribute);
  json["value"] =
      keyed.is_animated ? std::string() : value_of(slot, place.text == 0 ? written : std::nullopt);
  json["given"] = is_given;
  json["components"] = keyed.components;
  json["animated"] = keyed.is_animated;
  if (has_dollar) json["written"] = *written;
  if (!slot.excluded.empty()) json["excluded"] = slot.excluded;
  if (text > 0) json["file"] = scanned(text).file;
  owner.attributes.push_back(std::move(json));
}

/// What moves a position along a path.
void PropertiesWriter::tell_path(const std::string& path, const PathMotion& motion, Owner& owner) {
  xml::PathText text{motion.progress, motion.path.is_closed()};
  const Contents contents = xml::contents_of(text);
  for (const Slot& slot : contents.attributes)
    if (slot.attribute.syntax != Syntax::Position)
      tell_attribute(slot, std::visit(KeyedOf(), slot.place), path, contents.element,
                     std::max(owner.place.text, 0), owner);
}

void PropertiesWriter::tell_attributes(const Contents& contents, bool is_part, Owner& owner) {
  const int text = is_part ? text_of_part(contents, owner) : std::max(owner.place.text, 0);
  for (const Slot& slot : contents.attributes) {
    const Attribute& row = slot.attribute;
    if (row.need == Need::Later || row.syntax == Syntax::Name || row.syntax == Syntax::Version)
      continue;
    Keyed keyed = std::visit(KeyedOf(), slot.place);
    if (row.name == Description<xml::FalloffText>::element)
      keyed.is_animated = contents.falloff && *contents.falloff;
    tell_attribute(slot, keyed, owner.name, contents.element, text, owner);
    if (const auto* const position = std::get_if<PositionChannel*>(&slot.place))
      if (const PathMotion* const motion = (*position)->path())
        tell_path(fmt::format("{}.{}", owner.name, row.name), *motion, owner);
  }
}

/// Tells an object, and those in it.
void PropertiesWriter::tell(Contents& contents, const std::string& group) {
  constexpr std::size_t parts_of_object = 1U << 14U;
  if (is_interrupted_ || (is_interrupted_ = poll_.after(parts_of_object))) return;
  const std::string* const name = name_in(contents);
  Owner owner{.name = name ? *name : std::string(), .place = {}};
  owner.place = scene_.origin.at(owner.name);
  OrderedJson json{{"name", name ? *name : std::string(Description<Scene>::element)},
                   {"kind", contents.element}};
  tell_attributes(contents, false, owner);
  for (xml::ChildPlace& child : contents.children) {
    if (contents.driver && !contents.driver->empty() && !child.row.is_of_driven) continue;
    if (child.part) {
      tell_attributes(*child.part, true, owner);
    } else if (!child.row.noun.empty()) {
      child.kinds.for_each([&](Contents& shape) {
        json["shape"] = shape.element;
        tell_attributes(shape, true, owner);
      });
    } else {
      child.kinds.for_each([&](Contents& one) {
        if (name_in(one)) tell(one, owner.name);
      });
    }
  }
  if (!group.empty()) json["group"] = group;
  const Text& text = scanned(owner.place.text);
  if (is_interrupted_) return;
  if (owner.place.text > 0) json["file"] = text.file;
  const TextRange whole = text.markup.elements[element_at(owner.place)].whole();
  const auto& source = sources_.sources()[static_cast<std::size_t>(owner.place.text)];
  json["lines"] = {source.text->line_at(whole.begin), source.text->line_at(whole.end)};
  json["attributes"] = std::move(owner.attributes);
  objects_.push_back(
      {owner.place, json.dump(-1, ' ', false, OrderedJson::error_handler_t::replace)});
}

Result<std::string> PropertiesWriter::write() {
  Contents contents = xml::contents_of(scene_);
  tell(contents, "");
  if (is_interrupted_) return interrupted();
  std::ranges::sort(objects_, [&](const Object& a, const Object& b) {
    if (a.place.text == b.place.text) return a.place.range.begin < b.place.range.begin;
    return sources_.is_before(a.place, b.place);
  });
  std::string all;
  for (const Object& object : objects_) {
    all += all.empty() ? '[' : ',';
    all += object.json;
  }
  return all + ']';
}

}  // namespace

Result<std::string> properties_json(const SceneDocument& document, const StopRequest& should_stop) {
  return PropertiesWriter(document, should_stop).write();
}

}  // namespace pliant
