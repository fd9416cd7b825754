#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/elements/read_elements.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/format/path_text.hpp"

namespace pliant::xml {
namespace {

bool is_position(const Slot& row) { return std::holds_alternative<PositionChannel*>(row.place); }

/// The row of the position that `attribute` names, marked as animated; null if there is none, which
/// is a problem.
Slot* find_position(const Element& element, std::span<Slot> rows, Findings& findings) {
  const std::optional<GivenAttribute> given = element.attribute("attribute");
  if (!given || given->is_unknown) return nullptr;  // reported with the other attributes
  const std::string name(trimmed(given->value));
  Slot* row = find(rows, name);
  if (!row || !is_position(*row)) {
    std::vector<std::string_view> positions;
    for (const Slot& candidate : rows)
      if (is_position(candidate)) positions.push_back(candidate.attribute.name);
    const std::string parent = tag(element.parent());
    findings.add_problem(
        given->value_place(),
        value_problem(
            element, "attribute", name,
            row ? fmt::format("is not a position; the positions of {} are: {}", parent,
                              positions.empty() ? "none" : listed(positions))
                : fmt::format("{} has no such position{}", parent, hint(name, positions))));
    return nullptr;
  }
  take_over(element, *given, *row, findings);
  return row;
}

std::optional<Path> make_path(const Element& element, const PathText& text, Findings& findings) {
  std::vector<Value<3>> places;
  for (const Waypoint& waypoint : text.waypoints) places.push_back(waypoint.at);
  auto path = Path::make(std::move(places), text.is_closed);
  if (path) return std::move(*path);
  const Complaint& error = path.error();
  std::size_t waypoint = 0;
  auto child = element.first_child();
  for (; child; child = child->next())
    if (child->name() == Description<Waypoint>::element && waypoint++ == error.index) break;
  if (child)
    findings.add_problem(child->place(),
                         fmt::format("<waypoint> {} {}", error.index + 1, error.message));
  else
    findings.add_problem(element.place(), fmt::format("{} has {} waypoints; {}", tag(element),
                                                      error.index, error.message));
  return std::nullopt;
}

}  // namespace

void read_path(const Element& element, std::span<Slot> rows, const std::string& owner,
               SceneFile& file) {
  const std::size_t problems = file.findings.problem_count();
  Slot* position = find_position(element, rows, file.findings);
  const std::string path_name =
      fmt::format("{}.{}", owner, position ? position->attribute.name : std::string_view("path"));
  PathText text;
  Contents contents = contents_of(text);
  read_contents(element, contents, owner.empty() ? "" : path_name, file);
  std::optional<Path> path;
  if (file.findings.problem_count() == problems) path = make_path(element, text, file.findings);
  if (!position) return;
  position->is_sound = position->is_sound && path.has_value();
  if (path)
    *std::get<PositionChannel*>(position->place) =
        PathMotion{std::move(*path), std::move(text.progress)};
}

}  // namespace pliant::xml
