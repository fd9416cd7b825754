#pragma once

#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/elements/scene_file.hpp"
#include "pliant/scene/format/slot.hpp"
#include "pliant/scene/text/tree.hpp"

namespace pliant::xml {

/// An element that another may contain, and the function that reads it.
struct ChildReader {
  std::string_view name;
  std::function<void(const Element&)> read;
};

/// Reads the attributes of an element into the places of its table. Problems: an attribute that is
/// not in the table, a value that its row rejects, an attribute that is animated too, a required
/// attribute that is absent, unless a misspelt one probably stands for it.
void read_attributes(const Element& element, Table& table, Findings& findings);

/// Reads the content of an element. Problems: an element that is not among `children`, text.
/// Returns whether every child was known: if not, an unknown one may be a required one misspelt.
bool read_children(const Element& element, std::span<const ChildReader> children,
                   Findings& findings);

/// Reads the text of an element, numbers between blanks, into `numbers`. Problems: an element in
/// it, what is not a number. Returns whether there was none.
bool read_numbers(const Element& element, std::vector<double>& numbers, Findings& findings);

/// `<grid>`.
std::string tag(const Element& element);

/// `<grid> width="1,5": not a number`.
std::string value_problem(const Element& element, std::string_view attribute, std::string_view text,
                          std::string_view complaint);

/// The element animates the attribute that it names in `given`. Problem: a file gives or animates
/// it already.
void take_over(const Element& element, const GivenAttribute& given, Slot& row, Findings& findings);

/// Finds the file that an attribute names, relative to the folder of the file that the attribute
/// stands in, and adds it to the scene's meshes; does nothing without a sound attribute. Problem:
/// it is outside the scene's root.
void locate_file(const Element& element, Slot& row, const std::string& owner, std::string& path,
                 SceneFile& file);

/// Records the places of the attributes of a table, and which attributes have problems.
void record(const std::string& name, std::span<const Slot> table, SceneFile& file);

}  // namespace pliant::xml
