#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pliant/core/field.hpp"
#include "pliant/core/result.hpp"

namespace pliant {

struct WrittenSize;

/// A NURBS net along u or along v.
struct NurbsDirection {
  int count = 0;                    ///< control points, >= 3
  int degree = 0;                   ///< 1 to count - 1
  bool is_closed = false;           ///< the first control point follows the last one
  std::vector<double> knots = {};   ///< count + degree + 1, or none: see `knots_of`
  std::optional<int> samples = {};  ///< written vertices; none: see `samples_of`

  friend bool operator==(const NurbsDirection&, const NurbsDirection&) = default;
};

/// A net of control points of a NURBS surface: of columns along u, and rows along v.
struct NurbsNet {
  NurbsDirection u;
  NurbsDirection v;
  Field points = {};  ///< #columns*rows x 3: control point (i,j) is row j*columns + i
  std::vector<double> weights = {};  ///< one > 0 for each control point; none: all are 1

  friend bool operator==(const NurbsNet& a, const NurbsNet& b);
};

/// Its own knots, or the default ones: 0 (degree + 1 times), 1, 2, ..., the last one degree + 1
/// times. Requires: open; 1 <= degree < count.
std::vector<double> knots_of(const NurbsDirection& direction);

/// Its own samples, or 8 for each span: 8 (count - degree) + 1, closed 8 count.
/// Requires: 1 <= degree < count <= 1e8.
int samples_of(const NurbsDirection& direction);

/// Whether the surface of a net is summed along u and then along v, not over all control points of
/// a vertex at once: where these are many, that takes too much memory.
bool is_summed_by_directions(const NurbsNet& net);

/// The size of the surface that a net is written as. Complaints, which name the part as the scene
/// format calls it (columns, degreeU, points, knots.v, …): a member outside of the range of its
/// comment; knots that fall, that span nothing or that lie too far apart, or of which more than
/// `degree` are equal, at the ends more than degree + 1; knots of a closed direction; fewer than 2
/// samples, closed 3; numbers that are not finite; a surface that is larger than `WrittenSize`
/// allows, or has splines of a degree so high that they take too long.
Checked<WrittenSize> check_net(const NurbsNet& net);

}  // namespace pliant
