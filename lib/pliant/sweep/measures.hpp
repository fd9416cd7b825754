#pragma once

#include <memory>

#include "pliant/core/field.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/core/result.hpp"
#include "pliant/simulation/frame.hpp"
#include "pliant/simulation/simulation.hpp"

namespace pliant {

/// Numbers of an animation over the n vertices of all surfaces and the m frames asked for, s to e.
/// x(f) is a vertex at frame f, r at rest (of an animated shape, at that frame), object space;
/// T = 1/fps.
struct Measures {
  double peak = 0;     ///< max |x(f) - r| [length]
  int peak_frame = 0;  ///< the first frame that reaches it
  double final = 0;    ///< max |x(e) - r| [length]
  double rms = 0;      ///< sqrt(sum over f and vertices of |x(f) - r|^2 / (m n)) [length]
  double speed = 0;    ///< max |x(f) - x(f-1)| / T, f > s; 0 for one frame [length/s]
  double energy = 0;   ///< max over f > s of sum |x(f) - x(f-1)|^2 / (2 n T^2); 0 for one frame:
                       ///< kinetic energy per mass [length^2/s^2]
  /// The first frame after which no vertex moves more than peak/1000 from one frame to the next;
  /// s if the peak is 0.
  int settle = 0;
  /// XXH3 of positions in world space: for each frame, each surface, its vertices x 3 as
  /// little-endian doubles.
  Hash hash = {};

  friend bool operator==(const Measures&, const Measures&) = default;
};

/// Takes the measures of a simulation's frames, one after the other.
class Measurer {
 public:
  /// Requires: the simulation outlives it.
  explicit Measurer(const Simulation& simulation);
  Measurer(Measurer&&) noexcept;
  Measurer& operator=(Measurer&&) = delete;
  ~Measurer();

  /// The next frame. Requires: the one after the last.
  void add(const Frame& frame);

  /// Those of the frames so far. Errors: NotFinite, naming the measure: it is too large for a
  /// double. Requires: there was a frame.
  Result<Measures> measures() const;

 private:
  class Totals;
  std::unique_ptr<Totals> totals_;
};

}  // namespace pliant
