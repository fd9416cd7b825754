#include "pliant/mesh/drawn_solid.hpp"

#include <initializer_list>
#include <vector>

#include "pliant/core/elementary.hpp"

namespace pliant {
namespace {

// Steps in a quarter of a circle: faces are less than 0.5 % of the radius inside a ball. Round
// edges are smaller than what they belong to.
constexpr int ball_steps = 12;
constexpr int edge_steps = 6;

void add_solid_face(Mesh& mesh, std::initializer_list<int> vertices) {
  mesh.face_sizes.push_back(static_cast<int>(vertices.size()));
  mesh.corner_vertices.insert(mesh.corner_vertices.end(), vertices);
}

struct Vertex {
  Vector3d direction, corner;
};

DrawnSolid finished(Mesh mesh, const std::vector<Vertex>& vertices, const SolidLengths& lengths) {
  DrawnSolid solid{.mesh = std::move(mesh),
                   .directions = Field(static_cast<Eigen::Index>(vertices.size()), 3),
                   .corners = Field(static_cast<Eigen::Index>(vertices.size()), 3)};
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    solid.directions.row(static_cast<Eigen::Index>(k)) = vertices[k].direction;
    solid.corners.row(static_cast<Eigen::Index>(k)) = vertices[k].corner;
  }
  solid.mesh.corner_uvs.assign(solid.mesh.corner_vertices.size(), -1);
  solid.mesh.positions = solid.positions(lengths);
  return solid;
}

// An angle, and the sign of the box's corner there.
struct Ray {
  double degrees = 0;
  double sign_of_first = 0, sign_of_second = 0;
};

// Rings round y from the top to the bottom. Where the box has a length the ball is cut, and its
// parts are moved apart: at the equator if that is along y, and into quarters if along x and z.
struct RoundSolid {
  bool is_cut_y, is_cut_xz;
  int steps;
  std::vector<Vertex> vertices = {};
  Mesh mesh = {};

  std::vector<Ray> turns() const {
    std::vector<Ray> rays;
    for (int quarter = 0; quarter < 4; ++quarter) {
      for (int k = 0; k < steps + (is_cut_xz ? 1 : 0); ++k) {
        const double degrees = 90.0 * quarter + 90.0 * k / steps;
        if (is_cut_xz) {
          rays.push_back(
              {degrees, quarter == 0 || quarter == 3 ? 1. : -1., quarter < 2 ? 1. : -1.});
        } else {
          rays.push_back({degrees});
        }
      }
    }
    return rays;
  }

  // Heights of the rings, without the poles.
  std::vector<Ray> rises() const {
    std::vector<Ray> rays;
    for (int k = 1; k < 2 * steps; ++k) {
      const double degrees = 90 - 90.0 * k / steps;
      const double sign = is_cut_y ? 1 : 0;
      if (k < steps || (k == steps && is_cut_y)) rays.push_back({degrees, sign});
      if (k >= steps) rays.push_back({degrees, k == steps && !is_cut_y ? 0 : -sign});
    }
    return rays;
  }

  void add_vertex(const Ray& turn, const Ray& rise) {
    const auto [sine, cosine] = sine_cosine_of_degrees(turn.degrees);
    const auto [up, out] = sine_cosine_of_degrees(rise.degrees);
    vertices.push_back({{out * cosine, up, out * sine},
                        {turn.sign_of_first, rise.sign_of_first, turn.sign_of_second}});
  }

  // The pole of each ray of a ring: one, or one for each quarter. Returns the first of them.
  int add_poles(const std::vector<Ray>& turns, double degrees) {
    const int first = static_cast<int>(vertices.size());
    const double sign = !is_cut_y ? 0 : degrees > 0 ? 1 : -1;
    for (std::size_t k = 0; k < turns.size(); k += turns.size() / (is_cut_xz ? 4 : 1))
      add_vertex({0, turns[k].sign_of_first, turns[k].sign_of_second}, {degrees, sign});
    return first;
  }

  void make() {
    const std::vector<Ray> around = turns(), heights = rises();
    const int width = static_cast<int>(around.size());
    const int rings = static_cast<int>(heights.size());
    for (const Ray& rise : heights) {
      for (const Ray& turn : around) add_vertex(turn, rise);
    }
    for (int ring = 0; ring + 1 < rings; ++ring) {
      for (int k = 0; k < width; ++k) {
        const int here = ring * width + k, next = ring * width + (k + 1) % width;
        add_solid_face(mesh, {here, next, next + width, here + width});
      }
    }
    const int top = add_poles(around, 90), bottom = add_poles(around, -90);
    const int last = (rings - 1) * width;
    const auto pole_of = [&](int k) { return is_cut_xz ? 4 * k / width : 0; };
    for (int k = 0; k < width; ++k) {
      const int next = (k + 1) % width;
      const int pole = pole_of(k), next_pole = pole_of(next);
      if (pole == next_pole) {
        add_solid_face(mesh, {top + pole, next, k});
        add_solid_face(mesh, {bottom + pole, last + k, last + next});
      } else {
        add_solid_face(mesh, {top + pole, top + next_pole, next, k});
        add_solid_face(mesh, {bottom + next_pole, bottom + pole, last + k, last + next});
      }
    }
    if (!is_cut_xz) return;
    add_solid_face(mesh, {top + 3, top + 2, top + 1, top});
    add_solid_face(mesh, {bottom, bottom + 1, bottom + 2, bottom + 3});
  }
};

DrawnSolid make_round(bool is_cut_y, bool is_cut_xz, int steps, const SolidLengths& lengths) {
  RoundSolid solid{is_cut_y, is_cut_xz, steps};
  solid.make();
  return finished(std::move(solid.mesh), solid.vertices, lengths);
}

}  // namespace

Field DrawnSolid::positions(const SolidLengths& lengths) const {
  Field places(directions.rows(), 3);
  for (int k = 0; k < 3; ++k)
    places.col(k) = directions.col(k) * lengths.radius + corners.col(k) * lengths.half[k];
  return places;
}

DrawnSolid make_ball_mesh(double radius) {
  return make_round(false, false, ball_steps, {.radius = radius});
}

DrawnSolid make_capsule_mesh(const SolidLengths& lengths) {
  return make_round(true, false, ball_steps, lengths);
}

DrawnSolid make_round_box_mesh(const SolidLengths& lengths) {
  return make_round(true, true, edge_steps, lengths);
}

DrawnSolid make_sharp_box_mesh(const Vector3d& half) {
  Mesh mesh;
  std::vector<Vertex> vertices;
  for (int k = 0; k < 8; ++k) {
    const auto sign = [k](int bit) { return (k >> bit & 1) != 0 ? 1. : -1.; };
    vertices.push_back({{0, 0, 0}, {sign(0), sign(1), sign(2)}});
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int far = 1 << axis, one = 1 << (axis + 1) % 3, other = 1 << (axis + 2) % 3;
    add_solid_face(mesh, {0, other, other + one, one});
    add_solid_face(mesh, {far, far + one, far + one + other, far + other});
  }
  for (int corner = 0; corner < 24; ++corner) mesh.corner_normals.push_back(corner / 4);
  return finished(std::move(mesh), vertices, {.half = half});
}

}  // namespace pliant
