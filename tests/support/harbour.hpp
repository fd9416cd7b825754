#pragma once

#include <string>
#include <vector>

#include "pliant/scene/format/description.hpp"

// A format that the library does not know, with an element of each sort: a named thing in a list,
// a part of it, elements in the part that differ in an attribute, and one that is keyed.
namespace pliant {
namespace testing {

enum class Side { Port, Starboard };
inline constexpr std::string_view side_words[] = {"port", "starboard"};

struct Sail {
  Side side = Side::Port;
  double area = 10;
};

struct Rig {
  Channel<1> tension = 1;
  int masts = 1;
  std::vector<Sail> sails = {};
};

struct Boat {
  std::string name = {};
  Rig rig = {};
};

struct Harbour {
  std::vector<Boat> boats = {};
};

}  // namespace testing

template <>
struct Description<testing::Sail> {
  static constexpr std::string_view element = "sail";
  static constexpr std::string_view meaning = "What the wind fills.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "side", .words = testing::side_words, .need = Need::Required},
        of.side...);
    row(Attribute{.name = "area", .meaning = "its area", .unit = "m²", .range = positive},
        of.area...);
  }
};

template <>
struct Description<testing::Rig> {
  static constexpr std::string_view element = "rig";
  static constexpr std::string_view meaning = "What carries the sails.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(Attribute{.name = "tension", .range = not_negative}, of.tension...);
    row(Attribute{.name = "masts", .range = {.least = 1, .most = 7}}, of.masts...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& rig) {
    child(Child{.most = unlimited, .unique_by = "side"}, rig.sails);
  }
};

template <>
struct Description<testing::Boat> {
  static constexpr std::string_view element = "boat";
  static constexpr std::string_view meaning = "A boat.";

  template <class Row, class... Of>
  static void rows(Row&& row, Of&... of) {
    row(name_attribute("its name"), of.name...);
  }

  template <class Visit, class Of>
  static void children(Visit&& child, Of& boat) {
    child(Child{}, boat.rig);
  }
};

template <>
struct Description<testing::Harbour> {
  static constexpr std::string_view element = "harbour";
  static constexpr std::string_view meaning = "Where boats lie.";

  template <class Row, class... Of>
  static void rows(Row&&, Of&...) {}

  template <class Visit, class Of>
  static void children(Visit&& child, Of& harbour) {
    child(Child{.most = unlimited}, harbour.boats);
  }
};

}  // namespace pliant
