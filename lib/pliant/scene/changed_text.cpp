#include "pliant/scene/changed_text.hpp"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/markup.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/scene/text.hpp"

namespace pliant {

using namespace xml;

namespace {

// The number of a channel with that path; null: there is none.
const Channel<1>* channel_named(const std::vector<NamedChannel>& channels, std::string_view path) {
  const auto found = std::find_if(channels.begin(), channels.end(),
                                  [&](const NamedChannel& one) { return one.path == path; });
  if (found == channels.end()) return nullptr;
  const auto* const number = std::get_if<const Channel<1>*>(&found->channel);
  return number ? *number : nullptr;
}

bool are_equal(const Channel<1>& a, const Channel<1>& b) {
  if (a.is_animated() != b.is_animated()) return false;
  return a.is_animated() ? a.curve().keys() == b.curve().keys() : a.at(0) == b.at(0);
}

// Replaces values in a text by the places of its attributes.
class ValueWriter {
 public:
  ValueWriter(std::string_view text, Markup markup) : text_(text), markup_(std::move(markup)) {}

  // False: there is no such element, or a curve where the text has none.
  bool write(std::string_view path, const Channel<1>& channel) {
    const std::size_t dot = path.rfind('.');
    const auto owner = element_named(path.substr(0, dot));
    if (!owner) return false;
    const std::string_view name = path.substr(dot + 1);
    const bool is_surface = name_of(*owner) == "surface";
    const auto holder = is_surface ? child(*owner, "material") : owner;
    if (channel.is_animated()) {
      auto animate = holder ? animate_of(*holder, name) : std::nullopt;
      if (!animate) animate = animate_of(*owner, name);
      return animate && write_curve(*animate, channel.curve().keys());
    }
    const double number = channel.at(0)[0];
    if (holder) return write_constant(*holder, name, number);
    return insert_material(*owner, fmt::format(" {}=\"{}\"", name, number));
  }

  std::string result() {
    std::stable_sort(changes_.begin(), changes_.end(), [](const Change& a, const Change& b) {
      return a.range.begin < b.range.begin;
    });
    std::string result;
    std::size_t end = 0;
    for (const Change& change : changes_) {
      result += text_.substr(end, change.range.begin - end);
      result += change.text;
      end = change.range.end;
    }
    return result += text_.substr(end);
  }

 private:
  using Element = std::size_t;

  struct Change {
    TextRange range;
    std::string text;
  };

  void replace(TextRange range, std::string text) { changes_.push_back({range, std::move(text)}); }

  std::string_view name_of(Element element) const {
    return markup_.elements[element].name.of(text_);
  }

  std::vector<Element> children(Element parent, std::string_view name) const {
    std::vector<Element> all;
    for (Element each = parent + 1; each < markup_.elements.size(); ++each) {
      if (markup_.elements[each].name.begin > markup_.elements[parent].end) break;
      if (markup_.elements[each].parent == parent && name_of(each) == name) all.push_back(each);
    }
    return all;
  }

  std::optional<Element> child(Element parent, std::string_view name) const {
    const auto all = children(parent, name);
    return all.empty() ? std::nullopt : std::optional(all.front());
  }

  const AttributePlace* attribute(Element element, std::string_view name) const {
    const auto all = markup_.attributes_of(element);
    const auto found = std::find_if(all.begin(), all.end(), [&](const AttributePlace& one) {
      return one.name.of(text_) == name;
    });
    return found == all.end() ? nullptr : &*found;
  }

  // Surfaces, forces and groups, and the forces in these.
  std::optional<Element> element_named(std::string_view name) const {
    for (Element each = 1; each < markup_.elements.size(); ++each) {
      const std::uint32_t parent = markup_.elements[each].parent;
      const bool is_thing =
          parent == 0 || (name_of(parent) == "group" && markup_.elements[parent].parent == 0);
      const AttributePlace* const given = is_thing ? attribute(each, "name") : nullptr;
      if (given && trimmed(given->value.of(text_)) == name) return each;
    }
    return {};
  }

  std::optional<Element> animate_of(Element element, std::string_view name) const {
    for (const Element each : children(element, "animate")) {
      const AttributePlace* const of = attribute(each, "attribute");
      if (of && trimmed(of->value.of(text_)) == name) return each;
    }
    return {};
  }

  bool write_constant(Element element, std::string_view name, double number) {
    if (const AttributePlace* const given = attribute(element, name)) {
      write_last_word(*given, number);
      return true;
    }
    // Laid out as the last attribute is.
    const auto all = markup_.attributes_of(element);
    const ElementPlace& place = markup_.elements[element];
    std::string before = " ";
    std::uint32_t at = place.name.end;
    if (!all.empty()) {
      at = all.back().whole().end;
      std::uint32_t begin = all.back().name.begin;
      while (begin > 0 && blanks.find(text_[begin - 1]) != blanks.npos) --begin;
      before = text_.substr(begin, all.back().name.begin - begin);
    }
    replace({at, at}, fmt::format("{}{}=\"{}\"", before, name, number));
    return true;
  }

  // Behind the surface's shape, on a line of its own if that has one. A further attribute joins the
  // first one.
  bool insert_material(Element surface, const std::string& attribute) {
    if (const auto inserted = materials_.find(surface); inserted != materials_.end()) {
      std::string& text = changes_[inserted->second].text;
      text.insert(text.size() - 2, attribute);
      return true;
    }
    for (const std::string_view shape : {"grid", "mesh", "nurbs", "subdivision"}) {
      const auto element = child(surface, shape);
      if (!element) continue;
      const TextRange whole = markup_.elements[*element].whole();
      std::uint32_t begin = whole.begin;
      while (begin > 0 && (text_[begin - 1] == ' ' || text_[begin - 1] == '\t')) --begin;
      std::string before;
      if (begin > 0 && text_[begin - 1] == '\n') {
        const bool has_return = begin > 1 && text_[begin - 2] == '\r';
        before = has_return ? "\r\n" : "\n";
        before += text_.substr(begin, whole.begin - begin);
      }
      materials_.emplace(surface, changes_.size());
      replace({whole.end, whole.end}, fmt::format("{}<material{}/>", before, attribute));
      return true;
    }
    return false;
  }

  // Replaces the last word of an attribute, such as the value of a handle.
  void write_last_word(const AttributePlace& place, double number) {
    const std::string_view value = trimmed(place.value.of(text_));
    const auto words = words_of(value);
    if (words.empty() || to_number(words.back()) == number) return;
    const auto begin = static_cast<std::uint32_t>(words.back().data() - text_.data());
    replace({begin, begin + static_cast<std::uint32_t>(words.back().size())},
            fmt::format("{}", number));
  }

  void write_number(Element element, std::string_view name, double number) {
    if (const AttributePlace* const place = attribute(element, name))
      write_last_word(*place, number);
  }

  // A tangent that is a slope.
  void write_slope(Element element, std::string_view name, const Tangent<1>& tangent) {
    if (tangent.kind == Tangent<1>::Kind::Slope) write_number(element, name, tangent.slope[0]);
  }

  void write_key(Element element, const Key<1>& key) {
    write_number(element, "value", key.value[0]);
    if (key.left) write_number(element, "left", (*key.left)[0]);
    if (key.next.amplitude) write_number(element, "amplitude", *key.next.amplitude);
    write_slope(element, "in", key.in);
    write_slope(element, "out", key.out);
    if (!attribute(element, "in") && !attribute(element, "out"))
      write_slope(element, "tangent", key.in);
    write_number(element, "inHandle", key.in.handle_value[0]);
    write_number(element, "outHandle", key.out.handle_value[0]);
  }

  bool write_curve(Element animate, const CurveKeys<1>& keys) {
    const auto elements = children(animate, "key");
    if (elements.size() != keys.keys.size()) return false;
    std::optional<Tangent<1>> inherited;
    for (std::size_t k = 0; k < elements.size(); ++k) {
      const Element element = elements[k];
      write_key(element, keys.keys[k]);
      if (attribute(element, "tangent")) continue;
      const bool has_in = attribute(element, "in") || attribute(element, "inHandle");
      const bool has_out = attribute(element, "out") || attribute(element, "outHandle");
      if (!has_in) inherited = keys.keys[k].in;
      if (!has_out) inherited = keys.keys[k].out;
    }
    if (inherited) write_slope(animate, "tangent", *inherited);
    using Kind = Extrapolation<1>::Kind;
    if (keys.before.kind == Kind::Slope) write_number(animate, "before", keys.before.slope[0]);
    if (keys.after.kind == Kind::Slope) write_number(animate, "after", keys.after.slope[0]);
    if (const auto loop = child(animate, "loop"); loop && keys.loop)
      write_number(*loop, "offset", keys.loop->offset[0]);
    return true;
  }

  std::string_view text_;
  Markup markup_;
  std::vector<Change> changes_;
  std::map<Element, std::size_t> materials_;  // inserted ones: of which surface, as which change
};

}  // namespace

Result<std::string> changed_text(std::string_view text, const Scene& changed,
                                 std::span<const std::string> paths, const std::string& file,
                                 const std::string& folder, const std::string& root) {
  Findings findings(file);
  auto markup = scan_markup(text, findings);
  if (!markup) return fail(findings.to_error());
  const auto refuse = [&](const std::string& path) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} cannot be changed in this file; change it by hand", path), file);
  };
  const std::vector<NamedChannel> wanted = channels_of(changed);
  ValueWriter writer(text, *std::move(markup));
  for (const std::string& path : paths) {
    const Channel<1>* const channel = channel_named(wanted, path);
    if (!channel || !writer.write(path, *channel)) return refuse(path);
  }
  std::string result = writer.result();
  const auto read = parse_scene(result, file, folder, root);
  if (!read) return fail(read.error());
  const std::vector<NamedChannel> reached = channels_of(*read);
  for (const std::string& path : paths) {
    const Channel<1>* const channel = channel_named(reached, path);
    if (!channel || !are_equal(*channel, *channel_named(wanted, path))) return refuse(path);
  }
  return result;
}

}  // namespace pliant
