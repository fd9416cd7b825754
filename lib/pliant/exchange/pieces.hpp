#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant::exchange {

/// A handle of a piece, away from its end into the piece.
struct Arm {
  double frames = 0;  ///< >= 0
  double value = 0;   ///< at its tip, relative to the piece's end [unit]
};

/// One segment of a curve, with the limits of the curve at its ends. Other than a segment between
/// keys it says nothing of the value exactly at its ends.
struct Piece {
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
  bool is_cubic_in_time = false;  ///< Bezier: both arms are exactly a third of the piece long
  Interpolation easing = {};
  std::size_t key = 0;  ///< index of the author's key at which it starts, for notes

  double length() const { return end - start; }
};

/// What a curve does on one side of its pieces.
struct Beyond {
  enum class Kind { Line, Repeat, RepeatOffset, Mirror };
  Kind kind = Kind::Line;
  double slope = 0;   ///< Line [unit/frame]
  double anchor = 0;  ///< Line: the value that it starts from, at the end of the pieces [unit]
  double offset = 0;  ///< RepeatOffset: how much a copy is raised over the one before [unit]
  double count = 0;   ///< copies; infinity: endless
};

/// A curve as pieces: automatic tangents are computed, handles corrected, and the copies of an
/// inner loop written out. Nothing of its shape is lost.
struct Pieces {
  std::vector<double> frames;  ///< of the keys, strictly increasing, at least one
  std::vector<double> values;  ///< of the curve exactly there [unit]
  std::vector<Piece> pieces;   ///< between them: one fewer
  Beyond before;
  Beyond after;
};

Pieces pieces_of(const Curve<1>& curve);

/// The pieces as keys, without what is beyond them. Requires: a piece begins with the value of its
/// key, or is constant.
CurveKeys<1> keys_of(const Pieces& pieces);

/// The piece as a curve of two keys.
Curve<1> curve_of(const Piece& piece);

/// A Bézier piece whose value is cubic in time, with the slopes `from_slope`, `to_slope` at its
/// ends [unit/frame].
Piece cubic_piece(double start, double end, double from, double to, double from_slope,
                  double to_slope);

/// The slope with which a piece starts or ends [unit/frame]; infinite where it is vertical.
/// Requires: not an easing.
double slope_at_start(const Piece& piece);
double slope_at_end(const Piece& piece);

/// The parts before and after a frame inside a piece. Constants, lines and Béziers keep their
/// shape. An easing cannot be cut: Requires: it is none.
struct Cut {
  Piece left;
  Piece right;
};
Cut cut(const Piece& piece, double frame);

/// The parts of a Bézier piece before and after the place where its time passes slowest, if handles
/// are longer than it: those of the parts are not. Requires: it has an arm longer than itself.
Cut cut_where_slowest(const Piece& piece);

/// The pieces with copies on either side written out, so that they reach `first` or `last`, or all
/// copies if there are fewer; beyond them the value is constant. Nullopt: that side stays as it is,
/// which Requires that it has no copies. Requires: the other sides have copies. Errors: more than
/// `most_pieces`; copies that rounding puts on one frame.
Result<Pieces> with_copies(const Pieces& own, std::optional<double> first,
                           std::optional<double> last);

/// The most pieces that a curve may become.
inline constexpr std::size_t most_pieces = 500'000;

}  // namespace pliant::exchange
