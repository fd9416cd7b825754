#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"

namespace pliant::cli {

/// What a page holds of a surface's motion; docs/viewer.md tells how to read it back.
///
/// The displacement from rest of vertex k is `step` times three whole numbers of 16 bits. They are
/// stored as differences from a prediction, low and high bytes apart, so that they pack well.
struct PackedMotion {
  double step = 0;         ///< object space [length]
  double peak = 0;         ///< the largest component of a displacement that there is [length]
  std::string predictors;  ///< #frames bytes: how each frame was predicted
  std::string low;         ///< #frames x 3 x #vertices low bytes: all x of a frame, then y, then z
  std::string high;        ///< the high bytes likewise
};

/// How a number of a frame is guessed from those that are known before it.
namespace prediction {
inline constexpr int nothing = 0;  ///< 0
inline constexpr int same = 1;     ///< what it was a frame before
inline constexpr int even = 2;     ///< on, as from two frames before to one before
inline constexpr int along = 4;    ///< added: the vertex before was missed by as much
}  // namespace prediction

/// Takes a surface frame by frame.
class MotionPacker {
 public:
  /// `rest` is #vertices x 3, object space [length]. `order` has each vertex once: neighbours of
  /// the surface beside each other, as far as it can be.
  MotionPacker(Field rest, std::vector<int> order);

  /// Positions, #vertices x 3, object space. Errors: NotFinite where a coordinate is beyond the
  /// range of float.
  Result<void> add(const Field& positions, int frame);

  PackedMotion pack() const;

  /// Memory for each vertex of a frame, packing included. [bytes]
  static constexpr std::size_t bytes_a_vertex = 3 * (sizeof(float) + 2);

 private:
  using Numbers = std::vector<std::int16_t>;

  std::size_t vertex_count() const { return order_.size(); }
  Numbers quantised(std::size_t frame, double step) const;

  Field rest_;
  std::vector<int> order_;
  std::vector<std::vector<float>> displacements_;  // per frame 3 x #vertices, in `order_`
  double peak_ = 0;
};

}  // namespace pliant::cli
