#include "pliant/mesh/face_names.hpp"

#include <vector>

namespace pliant {

int NamedFaces::number_of(std::string_view name) {
  if (name.empty()) return -1;
  if (const auto known = numbers_.find(name); known != numbers_.end()) return known->second;
  const auto number = static_cast<int>(names_.names.size());
  numbers_.emplace(name, number);
  names_.names.emplace_back(name);
  return number;
}

FaceNames part_of(const FaceNames& all, std::size_t first, std::size_t last) {
  FaceNames part;
  std::vector<int> new_index(all.names.size(), -1);
  for (std::size_t face = first; face < last; ++face) {
    const int index = all.of_faces[face];
    if (index >= 0 && new_index[static_cast<std::size_t>(index)] < 0) {
      new_index[static_cast<std::size_t>(index)] = static_cast<int>(part.names.size());
      part.names.push_back(all.names[static_cast<std::size_t>(index)]);
    }
    part.of_faces.push_back(index < 0 ? -1 : new_index[static_cast<std::size_t>(index)]);
  }
  if (part.names.empty()) part.of_faces.clear();
  return part;
}

}  // namespace pliant
