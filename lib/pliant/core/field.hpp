#pragma once

#include <cmath>

#include <Eigen/Core>

namespace pliant {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// One vector per node or vertex: #rows x 3, each component contiguous.
using Field = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Whether two fields have the same rows, of whatever count.
bool are_equal(const Field& a, const Field& b);

/// The length of a row of a field. A fixed order of its terms.
inline double length_of(const Eigen::RowVector3d& a) {
  return std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
}

/// The product of two vectors. A fixed order of its terms.
inline double dot_of(const Vector3d& a, const Vector3d& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// The vector across two others, by the right-hand rule. A fixed order of its terms.
inline Vector3d cross_of(const Vector3d& a, const Vector3d& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// The longest vector of a field.
struct LongestVector {
  double length = 0;     ///< finite if the vector is, whatever its square is
  Eigen::Index row = 0;  ///< the first of equal ones
};

/// Requires: a row.
LongestVector longest_vector(const Field& field);

}  // namespace pliant
