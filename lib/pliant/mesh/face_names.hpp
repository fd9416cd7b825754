#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>

#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Gathers the names of faces while a file is read. Internal to mesh.
class NamedFaces {
 public:
  /// The number of a name, each counted once; -1 for an empty one.
  int number_of(std::string_view name);

  void add_faces(int number, std::size_t count = 1) {
    names_.of_faces.resize(names_.of_faces.size() + count, number);
  }

  const FaceNames& names() const { return names_; }

 private:
  FaceNames names_;
  std::map<std::string, int, std::less<>> numbers_;  // names can make a hash table slow
};

/// The names of the faces `first` to `last` - 1, in the order of their first use; nothing if none
/// of them has a name. Requires: there is a number for each face up to `last`.
FaceNames part_of(const FaceNames& all, std::size_t first, std::size_t last);

}  // namespace pliant
