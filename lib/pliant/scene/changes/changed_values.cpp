#include "pliant/scene/changes/changed_values.hpp"

#include <algorithm>

#include "pliant/scene/format/resolve.hpp"

namespace pliant {

std::optional<std::size_t> ChangedValues::add(const SceneChange& change) {
  const std::size_t number = count_++;
  const auto path = xml::split_path(change.path);
  // One that is no path is another value than all others.
  const std::string title = path ? path->title() : change.path;
  const std::string part = path ? path->part : "";
  const bool is_of_path = path && path->is_of_path();
  const bool is_whole = part.empty(), is_set = change.kind == SceneChange::Kind::Set;
  Firsts& firsts = attributes_[title];
  std::size_t& same = firsts.parts.try_emplace(part, none).first->second;
  std::size_t found = std::min(same, is_of_path ? firsts.whole_set : firsts.whole);
  if (is_whole) found = std::min(found, firsts.any[0]);
  if (is_whole && is_set) found = std::min(found, firsts.any[1]);
  const auto note = [&](std::size_t& first) { first = std::min(first, number); };
  note(same);
  note(firsts.any[is_of_path ? 1 : 0]);
  if (is_whole) note(firsts.whole);
  if (is_whole && is_set) note(firsts.whole_set);
  return found == none ? std::nullopt : std::optional(found);
}

}  // namespace pliant
