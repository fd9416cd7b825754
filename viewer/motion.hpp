#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "viewer/arrays.hpp"

namespace pliant::viewer {

/// A surface's motion as a page stores it; docs/viewer.md describes how to decode it.
///
/// The displacement of vertex k from rest is `step` times three integers of 16 bits. They are
/// stored as differences from a prediction, low and high bytes separately, so that they compress
/// well.
struct PackedMotion {
  double step = 0;         ///< object space [length]
  double peak = 0;         ///< the largest absolute component of any displacement [length]
  std::string predictors;  ///< #frames bytes: how each frame was predicted
  std::string low;         ///< #frames x 3 x #vertices low bytes: all x of a frame, then y, then z
  std::string high;        ///< the high bytes likewise
};

/// As a head has it: its step, and the places of its arrays, which are added.
Json to_json(const PackedMotion& motion, Arrays& arrays);

/// Prediction of a number of a frame from earlier numbers.
namespace prediction {
inline constexpr int nothing = 0;  ///< 0
inline constexpr int same = 1;     ///< the number of the frame before
inline constexpr int even = 2;     ///< linear extrapolation from the two frames before
inline constexpr int along = 4;    ///< added to one of these: plus the error at the vertex before
}  // namespace prediction

/// Packs a surface frame by frame.
class MotionPacker {
 public:
  /// `rest` is #vertices x 3, object space [length]. `order` contains each vertex once, with
  /// neighbours on the surface next to each other as far as possible.
  MotionPacker(Field rest, std::vector<int> order);

  /// Positions, #vertices x 3, object space. Errors: NotFinite if a coordinate is outside the range
  /// of float.
  Result<void> add(const Field& positions, int frame);

  /// Errors: Interrupted.
  Result<PackedMotion> pack(const StopRequest& should_stop = {}) const;

  /// Memory per vertex and frame, including packing. [bytes]
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

}  // namespace pliant::viewer
