#include "pliant/scene/format/format.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include "pliant/scene/format/contents.hpp"
#include "pliant/scene/format/key_text.hpp"
#include "pliant/scene/format/path_text.hpp"
#include "pliant/scene/format/sharing_text.hpp"

namespace pliant {

using namespace xml;

namespace {

/// The formats of a table's rows. They do not refer to the table's places.
std::vector<AttributeFormat> formats_of(const Table& table) {
  std::vector<AttributeFormat> formats;
  for (const Slot& row : table) formats.push_back(format_of(row));
  return formats;
}

template <class Part>
ElementFormat curve_element(KeyAxis axis) {
  Part part;
  const Contents contents = empty_contents<Description<Part>>();
  return {.name = contents.element,
          .meaning = contents.meaning,
          .attributes = formats_of(table_of(part, axis, ValueKind::Number))};
}

class FormatMaker {
 public:
  std::vector<ElementFormat> make(const Contents& root);

 private:
  void add(const Contents& contents, std::string_view parent);
  void add(ElementFormat format, std::vector<std::string_view> parents) {
    format.parents = std::move(parents);
    formats_.push_back(std::move(format));
  }
  /// The elements for which `is` holds.
  template <class Is>
  std::vector<std::string_view> names(const Is& is) const {
    std::vector<std::string_view> found;
    for (const ElementFormat& each : formats_)
      if (std::invoke(is, each)) found.push_back(each.name);
    return found;
  }
  void add_curves();
  void add_includes();

  std::vector<ElementFormat> formats_;
  std::vector<std::string_view> with_falloff_;
};

void FormatMaker::add(const Contents& contents, std::string_view parent) {
  const auto known = std::ranges::find(formats_, contents.element, &ElementFormat::name);
  if (known != formats_.end()) return known->parents.push_back(parent);
  const std::size_t own = formats_.size();
  formats_.push_back({.name = contents.element,
                      .meaning = contents.meaning,
                      .attributes = formats_of(contents.attributes),
                      .may_include = contents.may_include,
                      .text = contents.text});
  if (!parent.empty()) formats_.back().parents.push_back(parent);
  if (contents.falloff) with_falloff_.push_back(contents.element);
  for (const ChildPlace& child : contents.children) {
    const bool is_part = child.part != nullptr;
    formats_[own].children.push_back({child.kinds.names, child.row, is_part});
    for (const std::string_view name : child.kinds.names)
      add(is_part ? *child.part : child.kinds.add(name), contents.element);
  }
}

/// Whether an <animate> may stand in an element: it has channels, or its parts have.
bool is_animated(const std::vector<ElementFormat>& formats, const ElementFormat& element) {
  return std::ranges::any_of(element.attributes, &AttributeFormat::is_keyable) ||
         std::ranges::any_of(element.children, [&](const ChildFormat& child) {
           return child.is_part && is_animated(formats, *find_format(formats, child.names.front()));
         });
}

/// <path>, <falloff> and <animate>, in the elements that have what they move, and what is in them.
void FormatMaker::add_curves() {
  const auto allow = [&](const std::vector<std::string_view>& parents, std::string_view child,
                         const Child& row) {
    for (ElementFormat& each : formats_)
      if (std::ranges::find(parents, each.name) != parents.end())
        each.children.push_back({{child}, row});
  };
  const auto moved = names([](const ElementFormat& each) {
    return std::ranges::any_of(each.attributes, &AttributeFormat::is_position);
  });
  if (!moved.empty()) {
    PathText path;
    add(contents_of(path), "");
    std::ranges::find(formats_, Description<PathText>::element, &ElementFormat::name)->parents =
        moved;
  }
  const auto animated =
      names([&](const ElementFormat& each) { return is_animated(formats_, each); });
  allow(animated, Description<AnimateText<1>>::element, {.most = unlimited});
  allow(moved, Description<PathText>::element, {.most = unlimited});
  allow(with_falloff_, Description<FalloffText>::element, {});
  const ChildFormat keys{{Description<KeyText<1>>::element}, {.least = 1, .most = unlimited}};
  std::vector<std::string_view> keyed;
  if (!with_falloff_.empty()) {
    ElementFormat falloff = curve_element<FalloffText>(KeyAxis::Falloff);
    falloff.children = {keys};
    keyed.push_back(falloff.name);
    add(std::move(falloff), with_falloff_);
  }
  if (!animated.empty()) {
    ElementFormat animate = curve_element<AnimateText<1>>(KeyAxis::Frame);
    animate.children = {keys, {{Description<Loop<1>>::element}, {}}};
    keyed.insert(keyed.begin(), animate.name);
    add(std::move(animate), animated);
  }
  if (keyed.empty()) return;
  // <key> is placed by `frame` in an <animate>, by `at` in a <falloff>.
  ElementFormat key = curve_element<KeyText<1>>(KeyAxis::Frame);
  KeyText<1> part;
  key.attributes.insert(key.attributes.begin() + 1,
                        format_of(table_of(part, KeyAxis::Falloff, ValueKind::Number).front()));
  add(std::move(key), keyed);
  if (animated.empty()) return;
  Loop<1> loop;
  const Contents contents = empty_contents<Description<Loop<1>>>();
  add({.name = contents.element,
       .meaning = contents.meaning,
       .attributes = formats_of(table_of(loop, ValueKind::Number))},
      {Description<AnimateText<1>>::element});
}

void FormatMaker::add_includes() {
  std::vector<std::string_view> parents = names(&ElementFormat::may_include);
  if (parents.empty()) return;
  IncludeText include;
  DefineText define;
  add(contents_of(include), "");
  formats_.back().parents = parents;
  parents.push_back(formats_.back().name);
  add(contents_of(define), "");
  formats_.back().parents = std::move(parents);
}

std::vector<ElementFormat> FormatMaker::make(const Contents& root) {
  add(root, "");
  add_curves();
  add_includes();
  return std::move(formats_);
}

}  // namespace

std::vector<ElementFormat> formats_of(const Contents& root) { return FormatMaker().make(root); }

const std::vector<ElementFormat>& scene_format() {
  static const std::vector<ElementFormat> formats = [] {
    Scene scene;
    return formats_of(contents_of(scene));
  }();
  return formats;
}

const ElementFormat* find_format(const std::vector<ElementFormat>& formats, std::string_view name) {
  const auto found = std::ranges::find(formats, name, &ElementFormat::name);
  return found != formats.end() ? &*found : nullptr;
}

std::vector<std::string_view> including_elements() {
  std::vector<std::string_view> names;
  for (const ElementFormat& each : scene_format())
    if (each.may_include) names.push_back(each.name);
  return names;
}

}  // namespace pliant
