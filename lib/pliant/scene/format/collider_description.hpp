#pragma once

#include <string_view>

#include "pliant/scene/format/force_description.hpp"
#include "pliant/scene/format/shape_description.hpp"

namespace pliant {

// What an element says that is stored in several members of a thing; `Of` is the thing, const or
// not.

/// The shape of a collider.
template <class Of>
struct SolidOf {
  Of& collider;
};

template <>
struct Description<Collider> {
  static constexpr std::string_view element = "collider";
  static constexpr std::string_view meaning =
      "A solid that surfaces meet and that no node enters: one shape, and at most one transform.";
  static constexpr bool may_include = true;

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(name_attribute("name for channels and messages"), of.name...);
    row(Attribute{.name = "enabled",
                  .meaning = "a disabled collider selects nothing and stops nothing"},
        of.enabled...);
    row(Attribute{.name = "targets",
                  .meaning = "the surfaces that meet it",
                  .absent = "all surfaces",
                  .syntax = Syntax::Surface},
        of.targets...);
    row(deformation_radius_attribute, of.deformation_radius...);
    row(Attribute{.name = "offset",
                  .meaning = "distance that nodes keep from it, such as half the sheet's thickness",
                  .unit = "length",
                  .range = not_negative},
        of.offset...);
    row(Attribute{.name = "friction",
                  .meaning = "μ: how much of its push resists sliding",
                  .unit = "1",
                  .range = not_negative},
        of.friction...);
    row(Attribute{.name = "stick", .meaning = "what touches it is held, and goes with it"},
        of.stick...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& collider) {
    child(Child{.least = 1, .noun = "shape"}, SolidOf<Of>{collider});
    child(Child{}, collider.transform);
  }
};

template <>
struct Description<SphereChannels> {
  static constexpr std::string_view element = "sphere";
  static constexpr std::string_view meaning = "A ball round the origin.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "radius", .meaning = "radius", .unit = "length", .range = positive},
        of.radius...);
  }
};

template <>
struct Description<CapsuleChannels> {
  static constexpr std::string_view element = "capsule";
  static constexpr std::string_view meaning =
      "What is nearer than its radius to an axis along y, with the origin in its middle.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "radius", .meaning = "radius", .unit = "length", .range = positive},
        of.radius...);
    row(Attribute{.name = "length",
                  .meaning = "length of its axis; 0 makes it a ball",
                  .unit = "length",
                  .range = not_negative},
        of.length...);
  }
};

template <>
struct Description<BoxChannels> {
  static constexpr std::string_view element = "box";
  static constexpr std::string_view meaning = "A box round the origin, of sharp or round edges.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "size",
                  .meaning = "its lengths along x, y and z",
                  .unit = "length",
                  .range = positive},
        of.size...);
    row(Attribute{.name = "round",
                  .meaning = "radius of its edges, within the size: at most half the least length. "
                             "The transform does not scale it",
                  .unit = "length",
                  .range = not_negative},
        of.round...);
  }
};

template <>
struct Description<PlaneChannels> {
  static constexpr std::string_view element = "plane";
  static constexpr std::string_view meaning = "All that is not above y = 0.";

  template <class Row, class... Of>
  static void rows(Row&&, Of&...) {}
};

/// The element is that of a surface's mesh, of whose attributes it has only some.
template <>
struct Description<ClosedMesh> {
  static constexpr std::string_view element = "mesh";
  static constexpr std::string_view meaning = "A polygon mesh from a file.";
  static constexpr std::string_view words[] = {"file", "object", "cache", "cacheStart"};

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    describe(row, of.mesh...);
    describe(row, of.cache...);
  }
};

}  // namespace pliant
