#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "pliant/scene/format/description.hpp"
#include "pliant/scene/format/slot.hpp"

namespace pliant::xml {

struct Contents;

/// Elements of one or several kinds in the place that they have in another element. Each function
/// gives the contents of a thing, which is stored where the thing around it is.
struct Kinds {
  std::vector<std::string_view> names;
  /// Adds a thing with default values, of one of the kinds; if there can be only one, in place of
  /// that.
  std::function<Contents(std::string_view name)> add = {};
  std::function<void()> drop = {};  ///< removes the thing that was added last
  /// Calls `visit` for each thing that is there, in the order of a file.
  std::function<void(const std::function<void(Contents&)>& visit)> for_each = {};
};

/// The place of some elements in the contents of another one.
struct ChildPlace {
  Child row;
  Kinds kinds;
  std::shared_ptr<Contents> part = {};  ///< of a thing that is always there; null: it may be absent
  TextPlace first = {};                 ///< the first such element of a file; unknown: none
};

/// What an element of a file says, with the places where a thing stores it.
struct Contents {
  std::string_view element = {};
  std::string_view meaning = {};  ///< for people
  bool may_include = false;       ///< an <include> or a <define> may stand in it
  Table attributes = {};
  std::vector<ChildPlace> children = {};
  std::optional<Curve<1>>* falloff = nullptr;         ///< of its <falloff>
  std::optional<Numbers> text = {};                   ///< what its text is; null: it has none
  std::function<std::vector<double>()> numbers = {};  ///< its text, if there is one
  /// Stores its text, or complains.
  std::function<Checked<void>(std::vector<double>)> take_numbers = {};
  const std::string* driver = nullptr;  ///< of a surface, the one that it follows; may be empty
  std::shared_ptr<void> unused = {};    ///< places of attributes that its thing does not have

  /// The slots that an <animate> in it may name: its own, and those of its parts.
  std::vector<Slot*> channels();
  bool has_channels();         ///< an <animate> may stand in it
  bool has_positions() const;  ///< a <path> may stand in it
};

/// The contents of a thing, which must outlive them and stay where it is.
template <class T>
Contents contents_of(T&& thing);

Contents contents_of(Surface& surface);
Contents contents_of(Force& force);
Contents contents_of(ClosedMesh& mesh);
Contents contents_of(PointsOf of);
Contents contents_of(WeightsOf of);
Contents contents_of(NetOf<Surface> of);

Kinds kinds_of(const ShapeOf<Surface>& of);
Kinds kinds_of(const SolidOf<Collider>& of);
Kinds kinds_of(const KnotsOf& of);
Kinds kinds_of(const ActingIn<Scene>& of);
Kinds kinds_of(const MembersOf<Scene>& of);

/// The element of a surface's shape; empty: it is of a program, and has none.
std::string_view shape_of(const Surface& surface);

/// One shape of each kind, with its defaults, in the order of the format.
std::vector<Collider> solid_kinds();

/// One force of each kind that has an element, with its defaults, in the order of the format.
std::vector<Force> force_kinds();

/// Makes the contents of a thing from its description.
class ContentsMaker {
 public:
  explicit ContentsMaker(Contents& made) : made_(made) {}

  template <class T>
  void operator()(const Child& row, T&& member) {
    using Member = std::remove_cvref_t<T>;
    if constexpr (std::is_same_v<Member, std::optional<Curve<1>>>) {
      made_.falloff = &member;
    } else if constexpr (requires { kinds_of(member); }) {
      made_.children.push_back({row, kinds_of(member)});
    } else if constexpr (requires { member.emplace_back(); }) {
      made_.children.push_back({row, list(member)});
    } else {
      made_.children.push_back({row, {.names = {Description<Member>::element}}});
      made_.children.back().part = std::make_shared<Contents>(contents_of(member));
    }
  }

 private:
  template <class T>
  static Kinds list(std::vector<T>& things) {
    return {.names = {Description<T>::element},
            .add = [&things](std::string_view) { return contents_of(things.emplace_back()); },
            .drop = [&things] { things.pop_back(); },
            .for_each =
                [&things](const auto& visit) {
                  for (T& thing : things) {
                    Contents contents = contents_of(thing);
                    visit(contents);
                  }
                }};
  }

  Contents& made_;
};

/// What the description says of the element itself.
template <class Of>
Contents empty_contents() {
  Contents made{.element = Of::element, .meaning = Of::meaning};
  if constexpr (requires { Of::may_include; }) made.may_include = Of::may_include;
  if constexpr (requires { Of::text; }) made.text = Of::text;
  return made;
}

template <class T>
Contents contents_of(T&& thing) {
  using Of = Description<std::remove_cvref_t<T>>;
  Contents made = empty_contents<Of>();
  made.attributes = table_of(thing);
  ContentsMaker maker(made);
  if constexpr (requires { Of::children(maker, thing); }) Of::children(maker, thing);
  return made;
}

}  // namespace pliant::xml
