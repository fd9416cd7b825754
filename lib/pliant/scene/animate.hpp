#pragma once

#include <span>
#include <string>

#include "pliant/scene/element.hpp"

namespace pliant::xml {

/// Reads an <animate> into the channel that its `attribute` names among `rows`, the rows of the
/// element that contains it. `owner` is the name of the surface or force, for notes. Problems: no
/// such channel, a channel that is already given or animated, all problems of its keys.
void read_animate(const tinyxml2::XMLElement& animate, std::span<Slot* const> rows,
                  const std::string& owner, Findings& findings);

/// The same for a single table.
void read_animate(const tinyxml2::XMLElement& animate, Table& table, const std::string& owner,
                  Findings& findings);

}  // namespace pliant::xml
