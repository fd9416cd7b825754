#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/attribute.hpp"
#include "pliant/scene/scene_file.hpp"

namespace tinyxml2 {
class XMLElement;
}

namespace pliant::xml {

using Table = std::vector<Attribute>;

/// An element that may stand in another, and what is done with it.
struct Child {
  std::string_view name;
  std::function<void(const tinyxml2::XMLElement&)> read;  ///< empty: a later version reads it
};

/// Reads the attributes of an element into the places of its table. Problems: one that the table
/// does not know, a value that its row refuses, one that is animated too, a required one that is
/// absent, unless a misspelt one was meant for it.
void read_attributes(const tinyxml2::XMLElement& element, Table& table, Findings& findings);

/// Reads what stands between an element's tags. Problems: an element that is not among `children`,
/// text. Returns whether every child was known: if not, a required one may be a misspelt one.
bool read_children(const tinyxml2::XMLElement& element, std::span<const Child> children,
                   Findings& findings);

/// The row of that name, or null.
Attribute* find(std::span<Attribute> table, std::string_view name);

/// `<grid>`.
std::string tag(const tinyxml2::XMLElement& element);

/// `<grid> width="1,5": not a number`.
std::string value_problem(const tinyxml2::XMLElement& element, std::string_view attribute,
                          std::string_view text, std::string_view complaint);

/// Writes down where what an element's table holds stands in the file, and what is not sound.
void record(const std::string& name, std::span<const Attribute> table, SceneFile& file);

/// The same for what may have targets, a force or a group, once it is read: also where it stands
/// and which surfaces it names. Requires: the table has "targets".
void record_acting(const tinyxml2::XMLElement& element, const std::string& name,
                   const std::vector<std::string>& targets, Table& table, SceneFile& file);

}  // namespace pliant::xml
