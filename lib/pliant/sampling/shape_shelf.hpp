#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <vector>

#include "pliant/sampling/rest_shape.hpp"

namespace pliant {

/// Rest shapes that several simulations share, so that a mesh is read, and its grid found, once.
/// Keeps those used last. Never changes a result. Thread-safe.
///
/// Requires: the files of the meshes and maps do not change while it lives.
class ShapeShelf {
 public:
  /// Keeps shapes that take at most so many bytes together, as `ReservedShape` counts them.
  explicit ShapeShelf(std::size_t max_bytes) : max_bytes_(max_bytes) {}

  /// As `make_rest_shape`: a copy of the kept shape of the same surface, or a new one, which is
  /// kept. A mesh made by a program is not kept. Errors: as there; none is kept.
  Result<ReservedShape> make(const Surface& surface, const SceneOrigin& origin,
                             const RunContext& context);

 private:
  struct Kept {
    Surface surface;
    std::shared_ptr<const RestShape> shape;
    std::size_t bytes = 0;
  };

  Kept find(const Surface& surface);
  void keep(Kept kept);

  std::mutex mutex_;
  std::size_t max_bytes_;
  std::vector<Kept> kept_;  // the last used one first
};

}  // namespace pliant
