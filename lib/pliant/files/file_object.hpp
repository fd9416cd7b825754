#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "pliant/core/result.hpp"
#include "pliant/core/shortened.hpp"
#include "pliant/files/mesh_objects.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// The largest mesh file, or map of a material, that is read whole. [bytes]
inline constexpr std::size_t largest_mesh_file = std::size_t{4} << 30;

/// The error of reading a file, with its name; Interrupted has none.
Error in_file(Error error, const std::string& file);

/// The first of some names, each in quotes.
std::string listed_names(std::span<const std::string> names);

/// The index of the object that `object` chooses (`find_objects`); if it is empty, of the only one.
/// `meshes` are the names of their meshes, if the format has them. Errors, listing the first ones:
/// there are none; no such object, several of that name, or no name given and several objects.
Result<std::size_t> choose_object(std::span<const std::string_view> names,
                                  std::span<const std::string_view> meshes,
                                  const std::string& object);

/// Sets what chooses each of the objects of a file.
void set_choices(std::span<const std::string_view> meshes, std::vector<FileObject>& objects);

/// What `read` makes of a mesh file; its error with the name of the file, also if memory is short.
template <class Read>
auto about_mesh_file(const std::string& name, const Read& read) -> decltype(read()) {
  try {
    auto made = read();
    if (!made) return fail(in_file(made.error(), name));
    return made;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory, "the mesh does not fit in memory", name);
  }
}

/// Transforms an object to the space of its file. Its faces are turned round if that reflects them,
/// so that they keep their outer sides. Errors: the transform is not affine.
Result<void> to_file_space(const Eigen::Matrix4d& to_file, Mesh& mesh);

/// The positions of vertices whose x, y and z stand one after the other.
Field to_positions(const std::vector<double>& coordinates);

/// Takes (u,v) that are not finite from the corners that have them. Returns how many there were.
int drop_invalid_uvs(Mesh& mesh);

/// What a reader leaves out of a file, counted by kind.
class LeftOut {
 public:
  /// The words for one of a kind and for several, such as `line` and `lines`.
  void add(std::string_view one, std::string_view several, std::int64_t count = 1);

  /// For `Mesh::left_out`: `1 line and 3 points`; empty: nothing.
  std::string text() const;

 private:
  struct Kind {
    std::string one, several;
    std::int64_t count;
  };
  std::vector<Kind> kinds_;
};

/// The words of a kind that several formats have: faces with one or two corners.
inline constexpr std::string_view small_face = "face of fewer than three corners";
inline constexpr std::string_view small_faces = "faces of fewer than three corners";

/// Whether an object with `set_count` sets of (u,v) has the set `uv_set`, counted from 0. Set 0 may
/// be missing: a mesh need not have (u,v). Errors: names the number of sets.
Result<void> check_uv_set(int uv_set, int set_count);

}  // namespace pliant
