#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::exchange {

/// A handle of a segment, away from its end into the segment.
struct Arm {
  double frames = 0;  ///< >= 0
  double value = 0;   ///< at its tip, relative to the segment's end [unit]
};

/// One segment of a curve, with the limits of the curve at its ends. Other than a segment between
/// keys it says nothing of the value exactly at its ends.
struct Segment {
  enum class Kind {
    Constant,  ///< `from` = `to`
    Line,
    Bezier,  ///< shaped by `out` and `in`
    Easing,  ///< `easing`
  };
  Kind kind = Kind::Line;
  double start = 0;  ///< [frame]
  double end = 1;    ///< [frame], > start
  double from = 0;   ///< the limit at `start` [unit]
  double to = 0;     ///< the limit at `end` [unit]
  Arm out = {};
  Arm in = {};
  bool is_cubic_in_time = false;  ///< Bezier: both arms are exactly a third of the segment long
  Interpolation easing = {};
  std::size_t key = 0;  ///< index of the author's key at which it starts, for notes

  double length() const { return end - start; }
};

/// What a curve does on one side of its segments.
struct Beyond {
  enum class Kind { Line, Repeat, RepeatOffset, Mirror };
  Kind kind = Kind::Line;
  double slope = 0;   ///< Line [unit/frame]
  double anchor = 0;  ///< Line: the value that it starts from, at the end of the segments [unit]
  double offset = 0;  ///< RepeatOffset: how much a copy is raised over the one before [unit]
  double count = 0;   ///< copies; infinity: endless
};

/// A curve as segments: automatic tangents are computed, handles corrected, and the copies of an
/// inner loop written out. Nothing of its shape is lost.
struct Segments {
  std::vector<double> frames;     ///< of the keys, strictly increasing, at least one
  std::vector<double> values;     ///< of the curve exactly there [unit]
  std::vector<Segment> segments;  ///< between them: one fewer
  Beyond before;
  Beyond after;
};

Segments segments_of(const Curve<1>& curve);

/// The segments as keys, without what is beyond them. Requires: a segment begins with the value of
/// its key, or is constant.
CurveKeys<1> keys_of(const Segments& segments);

/// The segment as a curve of two keys.
Curve<1> curve_of(const Segment& segment);

/// A Bézier segment whose value is cubic in time, with the slopes `from_slope`, `to_slope` at its
/// ends [unit/frame].
Segment cubic_segment(double start, double end, double from, double to, double from_slope,
                      double to_slope);

/// The slope with which a segment starts or ends [unit/frame]; infinite where it is vertical.
/// Requires: not an easing.
double slope_at_start(const Segment& segment);
double slope_at_end(const Segment& segment);

/// The parts before and after a frame inside a segment. Constants, lines and Béziers keep their
/// shape. An easing cannot be cut: Requires: it is none.
struct Cut {
  Segment left;
  Segment right;
};
Cut cut(const Segment& segment, double frame);

/// The parts of a Bézier segment before and after the place where its time passes slowest, if
/// handles are longer than it: those of the parts are not. Requires: it has an arm longer than
/// itself.
Cut cut_where_slowest(const Segment& segment);

/// The segments with copies on either side written out, so that they reach `first` or `last`, or
/// all copies if there are fewer; beyond them the value is constant. Nullopt: that side stays as it
/// is, which Requires that it has no copies. Requires: the other sides have copies. Errors: more
/// than `most_segments`; copies that rounding puts on one frame.
Result<Segments> with_copies(const Segments& own, std::optional<double> first,
                             std::optional<double> last);

/// The most segments that a curve may become.
inline constexpr std::size_t most_segments = 500'000;

}  // namespace pliant::exchange
