#pragma once

#include <functional>
#include <string>
#include <string_view>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// Receives the bytes of a file, piece by piece.
using ByteSink = std::function<Result<void>(std::string_view)>;

/// A mesh as Wavefront OBJ: positions as the shortest text that parses to the same double, texture
/// coordinates and faces as in the source, names of object, groups and materials. Smooth surfaces
/// have `s 1`; others have `vn` too, and `s off` for flat faces.
class ObjText {
 public:
  explicit ObjText(const Mesh& mesh);  ///< must outlive it

  /// The mesh with its vertices at `positions`. Errors: those of the sink.
  Result<void> write(const Field& positions, const ByteSink& sink);

 private:
  const Mesh& mesh_;
  // Everything but positions and normals is the same in every frame.
  std::string head_;
  std::string topology_;
  std::string vertices_;
};

}  // namespace pliant
