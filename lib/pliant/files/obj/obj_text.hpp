#pragma once

#include <string>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/files/byte_sink.hpp"
#include "pliant/mesh/mesh.hpp"

namespace pliant {

/// A mesh as Wavefront OBJ: positions as the shortest text that parses to the same double, texture
/// coordinates and faces as in the source, names of object, groups and materials. Smooth surfaces
/// have `s 1`; others have `vn` too, and `s off` for flat faces.
class ObjText {
 public:
  /// Of a mesh, which must outlive it. Errors: Interrupted.
  static Result<ObjText> make(const Mesh& mesh, const StopRequest& should_stop = {});

  /// The mesh with its vertices at `positions`. Errors: those of the sink; Interrupted.
  Result<void> write(const Field& positions, const ByteSink& sink,
                     const StopRequest& should_stop = {}) const;

 private:
  explicit ObjText(const Mesh& mesh) : mesh_(mesh) {}

  const Mesh& mesh_;
  // Everything but positions and normals is the same in every frame.
  std::string head_;
  std::string topology_;
};

}  // namespace pliant
