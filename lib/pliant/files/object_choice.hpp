#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace pliant {

/// The objects of a file that a text chooses.
struct ObjectMatch {
  std::size_t count = 0;
  std::size_t first = 0;  ///< the first of them
};

/// The objects of a file that `object` chooses: all if it is empty; else those of that name; else
/// those whose mesh has that name; else for `NAME#2` the second one of that name (or of that name
/// of its mesh, if none has it), and for `#3` the third one of the file. `meshes` is empty for a
/// format that does not name them. Internal to mesh; part of its program `mesh/reader` too.
ObjectMatch find_objects(std::span<const std::string_view> names,
                         std::span<const std::string_view> meshes, std::string_view object);

}  // namespace pliant
