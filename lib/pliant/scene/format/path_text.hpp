#pragma once

#include <vector>

#include "pliant/scene/format/attribute.hpp"
#include "pliant/timeline/channel.hpp"
#include "pliant/timeline/key.hpp"

namespace pliant {
namespace xml {

/// A <waypoint>.
struct Waypoint {
  Value<3> at = {};
};

/// What a <path> says.
struct PathText {
  Channel<1> progress = 0;
  bool is_closed = false;
  std::vector<Waypoint> waypoints = {};
};

}  // namespace xml

template <>
struct Description<xml::PathText> {
  static constexpr std::string_view element = "path";
  static constexpr std::string_view meaning = "A smooth curve on which a position moves.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "attribute",
                  .meaning = "`center`, or `from` or `to` of a line",
                  .need = Need::Required,
                  .syntax = Syntax::Position});
    row(progress_attribute, of.progress...);
    row(Attribute{.name = "closed", .meaning = "`true`: the path returns to the first waypoint"},
        of.is_closed...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& path) {
    child(Child{.least = 3, .most = unlimited}, path.waypoints);
  }
};

template <>
struct Description<xml::Waypoint> {
  static constexpr std::string_view element = "waypoint";
  static constexpr std::string_view meaning = "A point of the path.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "at",
                  .meaning = "a point on the path",
                  .unit = "length",
                  .need = Need::Required},
        of.at...);
  }
};

}  // namespace pliant
