#include "pliant/scene/elements/write_contents.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/scene/elements/curve_text.hpp"
#include "pliant/scene/format/path_text.hpp"

namespace pliant::xml {
namespace {

// Of the work for each, see StopPoll.
constexpr std::size_t parts_of_element = 4096, parts_of_number = 64;

template <int D>
std::int64_t copied_keys_of(const CurveKeys<D>& keys) {
  if (!keys.loop) return 0;
  const Loop<D>& loop = *keys.loop;
  const auto repeated = std::ranges::count_if(
      keys.keys, [&](const Key<D>& key) { return key.frame >= loop.from && key.frame < loop.to; });
  return repeated * (std::int64_t{loop.before} + loop.after);
}

class ContentsWriter {
 public:
  ContentsWriter(const std::vector<ElementFormat>& formats, std::filesystem::path folder,
                 const StopRequest& should_stop)
      : formats_(formats),
        folder_(std::move(folder)),
        should_stop_(should_stop),
        poll_(should_stop) {}

  ElementText write(Contents& contents);

  std::int64_t copied_keys() const { return copied_keys_; }

 private:
  void write_attributes(const Contents& contents, ElementText& element) const;
  void write_numbers(const Contents& contents, ElementText& element);
  void write_children(Contents& contents, ElementText& element);
  void write_curves(const Contents& contents, ElementText& element);
  void write_path(std::string_view attribute, const PathMotion& motion, ElementText& element);
  template <int D>
  void write_curve(std::string_view attribute, const Channel<D>& channel, ValueKind kind,
                   ElementText& element) {
    if (!channel.is_animated()) return;
    element.children.push_back(
        curve_element(attribute, channel.curve().keys(), kind, should_stop_));
    copied_keys_ += copied_keys_of(channel.curve().keys());
  }

  const std::vector<ElementFormat>& formats_;
  std::filesystem::path folder_;
  const StopRequest& should_stop_;
  StopPoll poll_;
  std::int64_t copied_keys_ = 0;
};

ElementText ContentsWriter::write(Contents& contents) {
  ElementText element{.name = std::string(contents.element)};
  if (poll_.after(parts_of_element)) return element;
  write_attributes(contents, element);
  if (contents.numbers) write_numbers(contents, element);
  // A <path> has its waypoints before the keys of its progress.
  const bool is_path = contents.element == Description<PathText>::element;
  if (!is_path) write_curves(contents, element);
  write_children(contents, element);
  if (is_path) write_curves(contents, element);
  return element;
}

/// The attributes that are not their default, and those that are required.
void ContentsWriter::write_attributes(const Contents& contents, ElementText& element) const {
  const ElementFormat& format = *find_format(formats_, contents.element);
  for (std::size_t k = 0; k < contents.attributes.size(); ++k) {
    const Slot& slot = contents.attributes[k];
    const bool is_needed = slot.attribute.need == Need::Required ||
                           slot.attribute.syntax == Syntax::Version ||
                           slot.text != format.attributes[k].text;
    if (!is_needed || slot.text.empty() || !slot.excluded.empty()) continue;
    const bool is_file = slot.attribute.syntax == Syntax::Path && !folder_.empty();
    element.attributes.emplace_back(
        slot.attribute.name,
        with_doubled_dollars(is_file ? path_from(folder_, slot.text) : slot.text));
  }
}

void ContentsWriter::write_numbers(const Contents& contents, ElementText& element) {
  const std::vector<double> numbers = contents.numbers();
  const std::size_t on_a_line = contents.text->together;
  for (std::size_t k = 0; k < numbers.size() && !poll_.after(parts_of_number); ++k) {
    const bool begins_line = on_a_line != 0 && k % on_a_line == 0;
    fmt::format_to(std::back_inserter(element.text), "{}{}",
                   k == 0        ? ""
                   : begins_line ? "\n"
                                 : " ",
                   numbers[k]);
  }
}

void ContentsWriter::write_children(Contents& contents, ElementText& element) {
  for (ChildPlace& place : contents.children) {
    if (contents.driver && !contents.driver->empty() && !place.row.is_of_driven) continue;
    if (!place.part) {
      place.kinds.for_each([&](Contents& child) { element.children.push_back(write(child)); });
      continue;
    }
    // A part in which everything is the default is left out.
    ElementText part = write(*place.part);
    const bool is_empty = part.attributes.empty() && part.children.empty() && part.text.empty();
    if (!is_empty || place.row.least > 0) element.children.push_back(std::move(part));
  }
}

void ContentsWriter::write_curves(const Contents& contents, ElementText& element) {
  for (const Slot& slot : contents.attributes) {
    if (!slot.excluded.empty()) continue;
    const std::string_view name = slot.attribute.name;
    const auto write = [&]<class T>(const T& place) {
      if constexpr (std::is_same_v<T, Channel<1>*>) {
        write_curve(name, *place, ValueKind::Number, element);
      } else if constexpr (std::is_same_v<T, Channel<3>*>) {
        write_curve(name, *place, ValueKind::Vector, element);
      } else if constexpr (std::is_same_v<T, std::optional<Channel<1>>*>) {
        if (*place) write_curve(name, **place, ValueKind::Number, element);
      } else if constexpr (std::is_same_v<T, std::optional<Channel<3>>*>) {
        if (*place) write_curve(name, **place, ValueKind::Vector, element);
      } else if constexpr (std::is_same_v<T, Switch*>) {
        write_curve(name, place->channel(), ValueKind::Boolean, element);
      } else if constexpr (std::is_same_v<T, TangentChannel*>) {
        if (auto* const one = std::get_if<Channel<1>>(place))
          write_curve(name, *one, ValueKind::Number, element);
        else
          write_curve(name, std::get<Channel<3>>(*place), ValueKind::Vector, element);
      } else if constexpr (std::is_same_v<T, PositionChannel*>) {
        if (place->path())
          write_path(name, *place->path(), element);
        else
          write_curve(name, *place->channel(), ValueKind::Vector, element);
      }
    };
    std::visit(write, slot.place);
  }
  if (!contents.falloff || !*contents.falloff) return;
  element.children.push_back(
      curve_element("", (*contents.falloff)->keys(), ValueKind::Number, should_stop_));
}

void ContentsWriter::write_path(std::string_view attribute, const PathMotion& motion,
                                ElementText& element) {
  PathText text{motion.progress, motion.path.is_closed()};
  for (const Value<3>& place : motion.path.waypoints()) text.waypoints.push_back({place});
  Contents contents = contents_of(text);
  ElementText path = write(contents);
  path.attributes.emplace(path.attributes.begin(), "attribute", attribute);
  element.children.push_back(std::move(path));
}

}  // namespace

WrittenElement write_contents(Contents contents, const std::vector<ElementFormat>& formats,
                              const std::filesystem::path& folder, const StopRequest& should_stop) {
  ContentsWriter writer(formats, folder, should_stop);
  ElementText element = writer.write(contents);
  return {std::move(element), writer.copied_keys()};
}

}  // namespace pliant::xml
