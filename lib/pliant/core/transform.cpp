#include "pliant/core/transform.hpp"

#include <array>
#include <cmath>

#include "pliant/core/elementary.hpp"
#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

Field product(const Field& rows, const Matrix3d& a) {
  Field image(rows.rows(), 3);
  for (int k = 0; k < 3; ++k) {
    image.col(k) = rows.col(0) * a(k, 0) + rows.col(1) * a(k, 1) + rows.col(2) * a(k, 2);
  }
  return image;
}

Matrix3d rotation_about(int axis, double degrees) {
  const auto [sine, cosine] = sine_cosine_of_degrees(degrees);
  const int second = (axis + 1) % 3;
  const int third = (axis + 2) % 3;
  Matrix3d rotation = Matrix3d::Identity();
  rotation(second, second) = cosine;
  rotation(second, third) = -sine;
  rotation(third, second) = sine;
  rotation(third, third) = cosine;
  return rotation;
}

double determinant(const Matrix3d& a) {
  return a(0, 0) * (a(1, 1) * a(2, 2) - a(1, 2) * a(2, 1)) -
         a(0, 1) * (a(1, 0) * a(2, 2) - a(1, 2) * a(2, 0)) +
         a(0, 2) * (a(1, 0) * a(2, 1) - a(1, 1) * a(2, 0));
}

Matrix3d adjugate_inverse(const Matrix3d& a) {
  const double scale = 1 / determinant(a);
  Matrix3d b;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      // Cofactor of (column, row), by cyclic indices so that the sign is included.
      const int r1 = (column + 1) % 3, r2 = (column + 2) % 3;
      const int c1 = (row + 1) % 3, c2 = (row + 2) % 3;
      b(row, column) = (a(r1, c1) * a(r2, c2) - a(r1, c2) * a(r2, c1)) * scale;
    }
  }
  return b;
}

// Scales each column to about 1 by a power of two, since products of three tiny or huge numbers
// would underflow or overflow. Changes no other bit. Returns the exponents.
std::array<int, 3> scale_columns(Matrix3d& a) {
  std::array<int, 3> exponents{};
  for (int column = 0; column < 3; ++column) {
    std::frexp(a.col(column).cwiseAbs().maxCoeff(), &exponents[column]);
    for (int row = 0; row < 3; ++row)
      a(row, column) = std::ldexp(a(row, column), -exponents[column]);
  }
  return exponents;
}

// Not finite if there is no inverse.
Matrix3d inverse(Matrix3d a) {
  const std::array<int, 3> exponents = scale_columns(a);
  Matrix3d b = adjugate_inverse(a);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      b(row, column) = std::ldexp(b(row, column), -exponents[row]);
    }
  }
  return b;
}

}  // namespace

// Products of 3x3 matrices are written out: then we fix the order of each sum, not the library.
Matrix3d product(const Matrix3d& a, const Matrix3d& b) {
  Matrix3d c;
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      c(row, column) =
          a(row, 0) * b(0, column) + a(row, 1) * b(1, column) + a(row, 2) * b(2, column);
    }
  }
  return c;
}

std::array<int, 3> axes(RotateOrder order) {
  switch (order) {
    case RotateOrder::Xyz:
      return {0, 1, 2};
    case RotateOrder::Xzy:
      return {0, 2, 1};
    case RotateOrder::Yxz:
      return {1, 0, 2};
    case RotateOrder::Yzx:
      return {1, 2, 0};
    case RotateOrder::Zxy:
      return {2, 0, 1};
    case RotateOrder::Zyx:
      return {2, 1, 0};
  }
  return {0, 1, 2};
}

bool Transform::is_invertible() const { return inverse(linear).allFinite(); }

bool Transform::is_mirrored() const {
  Matrix3d scaled = linear;
  scale_columns(scaled);
  return determinant(scaled) < 0;
}

Transform make_transform(const Vector3d& translate, const Vector3d& rotate_degrees,
                         const Vector3d& scale, RotateOrder order) {
  const auto [first, second, third] = axes(order);
  Matrix3d linear = product(rotation_about(third, rotate_degrees[third]),
                            product(rotation_about(second, rotate_degrees[second]),
                                    rotation_about(first, rotate_degrees[first])));
  for (int column = 0; column < 3; ++column) linear.col(column) *= scale[column];
  return {linear, translate};
}

Field to_world(const Transform& transform, const Field& points, Field reuse) {
  const Matrix3d& a = transform.linear;
  reuse.resize(points.rows(), 3);
  for (int k = 0; k < 3; ++k) {
    const auto turned = points.col(0) * a(k, 0) + points.col(1) * a(k, 1) + points.col(2) * a(k, 2);
    reuse.col(k).array() = turned.array() + transform.translation[k];
  }
  return reuse;
}

Matrix3d inverse_linear(const Transform& transform) {
  PLIANT_EXPECTS(transform.is_invertible());
  return inverse(transform.linear);
}

Field vectors_to_world(const Transform& transform, const Field& vectors) {
  return product(vectors, transform.linear);
}

Field vectors_to_object(const Transform& transform, const Field& vectors) {
  return product(vectors, inverse_linear(transform));
}

}  // namespace pliant
