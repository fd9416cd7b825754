#pragma once

#include <span>
#include <string>

#include "pliant/scene/reading/element.hpp"
#include "pliant/scene/reading/scene_file.hpp"

namespace pliant {
namespace xml {

/// The attributes of a <path>.
struct PathText {
  Channel<1> progress = 0;
  bool is_closed = false;
};

/// A <waypoint>.
struct Waypoint {
  Value<3> at = {};
};

/// Reads a <path> into the position that its `attribute` names among `rows`, the rows of the
/// element that contains it. `owner` is the name of the force or group. Problems: no such position,
/// one that is already given, animated or on a path, all problems of its waypoints and its
/// progress.
void read_path(const Element& element, std::span<Slot> rows, const std::string& owner,
               SceneFile& file);

}  // namespace xml

template <>
struct Description<xml::PathText> {
  static constexpr std::string_view element = "path";

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
};

template <>
struct Description<xml::Waypoint> {
  static constexpr std::string_view element = "waypoint";

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
