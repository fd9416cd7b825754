#pragma once

#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/files/caches/point_cache.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

struct RestShape;
struct ReservedShape;

/// A rest shape at three frames, #rows x 3, object space [length].
struct ShapeFrames {
  std::shared_ptr<const Field> before, now, after;  ///< null: it is not animated
};

/// Frames that come again and again, before them too.
struct ShapeCycle {
  int start = 0;
  int length = 1;  ///< >= 1
};

/// A rest shape that a cache animates: R at each frame. Between two samples it is linear, outside
/// them held; in a cycle it is read at the cycle's frames only. Keeps a few samples in memory.
/// Thread-safe. docs/model.md, "Animated shapes".
class AnimatedShape {
 public:
  /// Requires: the cache has as many vertices as the mesh, and `frames` are those of its samples.
  AnimatedShape(PointCache cache, std::vector<double> frames, const RestShape& shape,
                std::optional<ShapeCycle> cycle = {});

  /// R of all vertices at a frame. Errors: Unreadable; InvalidInput, naming the sample and the
  /// vertex: a number is not finite, or vertices of one node of a grid are apart.
  Result<std::shared_ptr<const Field>> vertices_at(int frame) const;

  /// R of the nodes, each that of its lowest vertex. Errors: as `vertices_at`.
  Result<std::shared_ptr<const Field>> nodes_at(int frame) const;

  /// R of the nodes at a frame and at its neighbours. At the ends of the samples the neighbour
  /// outside mirrors the other, so that a body enters and leaves them at its speed; in a cycle it
  /// is the frame of the cycle.
  Result<ShapeFrames> frames_around(int frame) const;

  /// R as what stands still: for errors that the caller reports. #nodes x 3
  std::shared_ptr<const Field> at_rest() const { return at_rest_; }

  /// Reads the samples from `first` to `last`. Errors: as `vertices_at`; Interrupted.
  Result<void> check(int first, int last, const RunContext& context) const;

  double first_frame() const { return frames_.front(); }  ///< of the samples
  double last_frame() const { return frames_.back(); }
  int sample_count() const { return cache_.sample_count(); }

  /// What all of it takes besides its cache. [bytes]
  static std::size_t bytes(std::size_t vertex_count, int sample_count);

 private:
  using Shared = std::shared_ptr<const Field>;

  // Fields by number, the last ones used.
  class FieldCache {
   public:
    Shared find(int number);
    void keep(int number, Shared field);

   private:
    struct Entry {
      int number;
      Shared field;
    };
    std::vector<Entry> entries_;  // the last used one first
  };

  int frame_of_cycle(int frame) const;
  Result<Shared> sample(int number) const;
  Result<Shared> vertices(int frame) const;
  Result<Shared> nodes(int frame) const;
  Result<void> check_sample(int number, const Field& positions) const;

  PointCache cache_;
  std::vector<double> frames_;  // of the samples, ascending
  int first_index_;             // first vertex number in messages
  std::vector<int> nodes_;      // #vertices: the node of each of a grid; empty: not a grid
  std::vector<int> lowest_;     // #nodes: the lowest vertex
  bool is_same_ = false;        // nodes are vertices
  Shared at_rest_;
  std::optional<ShapeCycle> cycle_;
  mutable std::mutex mutex_;  // of what follows
  mutable FieldCache samples_, vertices_, node_shapes_;
};

/// What a cache moves, and when.
struct CacheUse {
  std::string title = {};  ///< of what has the shape: `surface "sheet"`
  std::string name = {};   ///< of that
  ShapeCache cache = {};
  FrameSpan used = {};  ///< the frames at which it is read
  std::optional<ShapeCycle> cycle = {};
  std::size_t bytes = 0;  ///< that the shape takes besides if it moves
};

/// Opens a cache for a shape, checks the samples of the frames, and reserves the memory for it.
/// Errors: as below.
Result<void> animate(RestShape& shape, MemoryShare& memory, const CacheUse& use, const Scene& scene,
                     const RunContext& context);

/// Opens the cache of an animated surface for its shape, checks the samples of the scene's frames,
/// and reserves the memory for it. Errors, with the line of the attribute: those of `PointCache`
/// and `AnimatedShape`; another number of vertices than the mesh; OutOfMemory; Interrupted.
Result<void> animate(ReservedShape& made, const Surface& surface, const Scene& scene,
                     const RunContext& context = {});

}  // namespace pliant
