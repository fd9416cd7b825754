#include "pliant/mesh/written/nurbs_surface.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include <Eigen/Geometry>

#include "pliant/mesh/grid_mapping.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

class Chance {
 public:
  explicit Chance(unsigned seed) : random_(seed) {}
  double number(double least, double most) {
    return least + (most - least) * static_cast<double>(random_()) / 4294967296.0;
  }
  int count(int least, int most) {
    return least + static_cast<int>(random_() % static_cast<unsigned>(most - least + 1));
  }
  Field field(int rows) {
    Field field(rows, 3);
    for (double& each : field.reshaped()) each = number(-1, 1);
    return field;
  }

 private:
  std::mt19937 random_;
};

// Knots of any multiplicity that the format allows.
std::vector<double> some_knots(const NurbsDirection& direction, Chance& chance) {
  const auto size = static_cast<std::size_t>(direction.count + direction.degree) + 1;
  NurbsNet net{.u = direction, .v = {.count = 3, .degree = 1}};
  net.points = Field::Zero(3 * direction.count, 3);
  do {
    std::vector<double>& knots = net.u.knots;
    knots.clear();
    double knot = chance.number(-3, 3);
    while (knots.size() < size) {
      knots.insert(knots.end(), static_cast<std::size_t>(chance.count(1, direction.degree + 1)),
                   knot);
      knot += chance.number(0.01, 1);
    }
    knots.resize(size);
  } while (!check_net(net));
  return net.u.knots;
}

NurbsNet some_net(Chance& chance) {
  NurbsNet net;
  for (NurbsDirection* direction : {&net.u, &net.v}) {
    direction->count = chance.count(3, 7);
    direction->degree = chance.count(1, std::min(direction->count - 1, 4));
    direction->is_closed = chance.count(0, 2) == 0;
    direction->samples = chance.count(3, 12);
    if (!direction->is_closed && chance.count(0, 3) > 0)
      direction->knots = some_knots(*direction, chance);
  }
  const int count = net.u.count * net.v.count;
  net.points = chance.field(count);
  if (chance.count(0, 1) == 0) {
    for (int k = 0; k < count; ++k) net.weights.push_back(chance.number(0.1, 3));
  }
  return net;
}

// The definition: Cox and de Boor's recursion, with 0/0 = 0.
long double spline(const std::vector<double>& knots, int i, int degree, long double s, int last) {
  if (degree == 0) {
    const bool is_end = i == last && s == knots[i + 1];
    return (knots[i] <= s && s < knots[i + 1]) || is_end ? 1 : 0;
  }
  const auto part = [&](long double over, long double under) {
    return under == 0 ? 0 : over / under;
  };
  return part(s - knots[i], knots[i + degree] - static_cast<long double>(knots[i])) *
             spline(knots, i, degree - 1, s, last) +
         part(knots[i + degree + 1] - s,
              knots[i + degree + 1] - static_cast<long double>(knots[i + 1])) *
             spline(knots, i + 1, degree - 1, s, last);
}

// The values of all splines of a direction at a sample, summed for each control point.
std::vector<long double> splines_at(const NurbsDirection& direction, int sample) {
  const int samples = samples_of(direction), count = direction.count, degree = direction.degree;
  std::vector<double> knots;
  if (direction.is_closed) {
    for (int k = 0; k <= count + 2 * degree; ++k) knots.push_back(k);
  } else {
    knots = knots_of(direction);
  }
  const int last_knot = direction.is_closed ? count + degree : count;
  const long double from = knots[degree], to = knots[last_knot];
  const long double share =
      static_cast<long double>(sample) / (direction.is_closed ? samples : samples - 1);
  const long double s = share == 1 ? to : from + (to - from) * share;
  int last = last_knot - 1;  // the last span that is not empty
  while (knots[last] == knots[last + 1]) --last;
  std::vector<long double> values(static_cast<std::size_t>(count), 0);
  for (int i = 0; i < last_knot; ++i) values[i % count] += spline(knots, i, degree, s, last);
  return values;
}

Eigen::RowVector3d reference(const NurbsNet& net, int k, int l) {
  const auto u = splines_at(net.u, k), v = splines_at(net.v, l);
  long double sum = 0;
  std::array<long double, 3> point = {0, 0, 0};
  for (int j = 0; j < net.v.count; ++j) {
    for (int i = 0; i < net.u.count; ++i) {
      const int node = j * net.u.count + i;
      const long double weight = u[i] * v[j] * (net.weights.empty() ? 1 : net.weights[node]);
      sum += weight;
      for (int axis = 0; axis < 3; ++axis) point[axis] += weight * net.points(node, axis);
    }
  }
  return {double(point[0] / sum), double(point[1] / sum), double(point[2] / sum)};
}

// A cylinder of radius 1 along z, its circle of four quarters of degree 2.
NurbsNet cylinder() {
  const double half = std::sqrt(0.5);
  const std::array<std::array<double, 2>, 9> square = {
      {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}, {1, 0}}};
  NurbsNet net{.u = {.count = 9, .degree = 2, .knots = {0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4}},
               .v = {.count = 3, .degree = 1}};
  net.points.resize(27, 3);
  for (int node = 0; node < 27; ++node) {
    const auto& [x, y] = square[node % 9];
    net.points.row(node) << x, y, node / 9;
    net.weights.push_back(node % 9 % 2 == 0 ? 1 : half);
  }
  return net;
}

double largest_gap(const Field& a, const Field& b) {
  REQUIRE(a.rows() == b.rows());
  return (a - b).cwiseAbs().maxCoeff();
}

}  // namespace

TEST_CASE("a NURBS surface is what its definition says", "[mesh][nurbs]") {
  Chance chance(1);
  for (int round = 0; round < 150; ++round) {
    const NurbsNet net = some_net(chance);
    const NurbsSurface surface = make_nurbs(net);
    const int samples_u = samples_of(net.u), samples_v = samples_of(net.v);
    REQUIRE(surface.mesh.vertex_count() == samples_u * samples_v);
    CAPTURE(round, net.u.count, net.u.degree, net.u.is_closed, net.u.knots);
    // Splines of degree 4 and points within 1: some tens of roundings. A parameter that rounds
    // next to a knot that it lies on changes nothing: the surface is in one piece.
    double worst = 0;
    for (int l = 0; l < samples_v; ++l) {
      for (int k = 0; k < samples_u; ++k) {
        const Eigen::RowVector3d difference =
            surface.mesh.positions.row(l * samples_u + k) - reference(net, k, l);
        worst = std::max(worst, difference.cwiseAbs().maxCoeff());
      }
    }
    CHECK(worst < 1e-12);
  }
}

TEST_CASE("the weights of a NURBS surface add up to 1", "[mesh][nurbs]") {
  Chance chance(2);
  for (int round = 0; round < 50; ++round) {
    const NurbsNet net = some_net(chance);
    const VertexWeights weights = make_nurbs(net).weights;
    const Field ones = weights.apply(Field::Ones(net.points.rows(), 3));
    CHECK(largest_gap(ones, Field::Ones(ones.rows(), 3)) < 1e-15 * 8);
    CHECK(*std::ranges::min_element(weights.weights) > 0);
    CHECK(static_cast<std::int64_t>(weights.weights.size()) <= check_net(net).value().weights);
  }
}

TEST_CASE("a rational quadratic circle is round", "[mesh][nurbs]") {
  NurbsNet net = cylinder();
  net.u.samples = 101;
  const NurbsSurface surface = make_nurbs(net);
  for (int vertex = 0; vertex < surface.mesh.vertex_count(); ++vertex) {
    const auto place = surface.mesh.positions.row(vertex);
    CHECK_THAT(std::hypot(place.x(), place.y()), WithinAbs(1, 1e-14));
  }
  const double half = std::sqrt(0.5);  // in the middle of a quarter
  net.u.samples = 9;
  CHECK_THAT(make_nurbs(net).mesh.positions(1, 0), WithinAbs(half, 1e-15));
}

TEST_CASE("weights may be tiny or huge, and their unit does not matter", "[mesh][nurbs]") {
  NurbsNet net = cylinder();
  const Field before = make_nurbs(net).mesh.positions;
  const double unit = GENERATE(1e-320, 1e-200, 1e300);
  for (double& weight : net.weights) weight *= unit;
  const double accuracy = unit < 1e-300 ? 1e-3 : 1e-14;  // a denormal number has few digits
  CHECK(largest_gap(make_nurbs(net).mesh.positions, before) < accuracy);
  net.weights[10] = 1e308;
  CHECK(make_nurbs(net).mesh.positions.allFinite());
}

TEST_CASE("weights that are all equal count for nothing", "[mesh][nurbs]") {
  Chance chance(8);
  NurbsNet net = some_net(chance);
  net.weights.clear();
  const Field before = make_nurbs(net).mesh.positions;
  // Times a spline less than half, the least number is 0.
  net.weights.assign(static_cast<std::size_t>(net.points.rows()), 5e-324);
  CHECK(make_nurbs(net).mesh.positions == before);
}

TEST_CASE("a clamped net ends in its corners, to the bit", "[mesh][nurbs]") {
  Chance chance(9);
  for (int round = 0; round < 50; ++round) {
    NurbsNet net{.u = {.count = 4, .degree = 2}, .v = {.count = 3, .degree = 1}};
    const double from = chance.number(-8, -4), to = chance.number(0.001, 1);  // to - from rounds
    net.u.knots = {from, from, from, chance.number(from, to), to, to, to};
    net.u.samples = chance.count(2, 90);
    net.points = chance.field(12);
    const NurbsSurface surface = make_nurbs(net);
    const int last = *net.u.samples - 1;
    CHECK(surface.mesh.positions.row(0) == net.points.row(0));
    CHECK(surface.mesh.positions.row(last) == net.points.row(3));
    CHECK(surface.weights.starts[last + 1] == surface.weights.starts[last] + 1);
  }
}

TEST_CASE("a net with one span is a Bezier patch", "[mesh][nurbs]") {
  if (is_sanitized) return;  // a million samples
  Chance chance(3);
  NurbsNet net{.u = {.count = 4, .degree = 3, .samples = 1001},
               .v = {.count = 5, .degree = 4, .samples = 1001}};
  net.points = chance.field(20);
  const Field vertices = make_nurbs(net).mesh.positions;
  // Corners are control points, to the bit; tangents at them are those of the net.
  CHECK(vertices.row(0) == net.points.row(0));
  CHECK(vertices.row(1000) == net.points.row(3));
  CHECK(vertices.row(1000 * 1001) == net.points.row(16));
  CHECK(vertices.row(1001 * 1001 - 1) == net.points.row(19));
  // S(h) - S(0) = h S' + h^2 S''/2, with h = 1e-3 and |S''| <= 3 * 2 * 4 = 24, v: 4 * 3 * 4 = 48.
  CHECK(((vertices.row(1) - vertices.row(0)) * 1000 - 3 * (net.points.row(1) - net.points.row(0)))
            .cwiseAbs()
            .maxCoeff() < 0.013);
  CHECK(
      ((vertices.row(1001) - vertices.row(0)) * 1000 - 4 * (net.points.row(4) - net.points.row(0)))
          .cwiseAbs()
          .maxCoeff() < 0.025);
  // de Casteljau in the middle, along u and then along v.
  const auto middle = [](std::vector<Eigen::RowVector3d> points) {
    for (; points.size() > 1; points.pop_back()) {
      for (std::size_t k = 0; k + 1 < points.size(); ++k)
        points[k] = 0.5 * (points[k] + points[k + 1]);
    }
    return points[0];
  };
  std::vector<Eigen::RowVector3d> across;
  for (int j = 0; j < 5; ++j) {
    std::vector<Eigen::RowVector3d> row;
    for (int i = 0; i < 4; ++i) row.push_back(net.points.row(j * 4 + i));
    across.push_back(middle(row));
  }
  CHECK((vertices.row(500 * 1001 + 500) - middle(across)).cwiseAbs().maxCoeff() < 1e-15);
}

TEST_CASE("inserting a knot leaves the surface as it is", "[mesh][nurbs]") {
  Chance chance(4);
  NurbsNet net{.u = {.count = 6, .degree = 3, .samples = 40},
               .v = {.count = 4, .degree = 2, .samples = 7}};
  net.points = chance.field(24);
  const double knot = GENERATE(0.3, 1.0, 2.9);
  NurbsNet finer = net;
  finer.u.count = 7;
  const std::vector<double> knots = knots_of(net.u);
  finer.u.knots = knots;
  const auto place = std::upper_bound(finer.u.knots.begin(), finer.u.knots.end(), knot);
  const int span = static_cast<int>(place - finer.u.knots.begin()) - 1;
  finer.u.knots.insert(place, knot);
  finer.points.resize(28, 3);
  for (int j = 0; j < 4; ++j) {
    for (int i = 0; i < 7; ++i) {  // Boehm: The NURBS Book, eq. (5.11)
      const double a = i <= span - 3 ? 1
                       : i > span    ? 0
                                     : (knot - knots[i]) / (knots[i + 3] - knots[i]);
      finer.points.row(j * 7 + i).setZero();
      if (a > 0) finer.points.row(j * 7 + i) += a * net.points.row(j * 6 + i);
      if (a < 1) finer.points.row(j * 7 + i) += (1 - a) * net.points.row(j * 6 + i - 1);
    }
  }
  CHECK(largest_gap(make_nurbs(finer).mesh.positions, make_nurbs(net).mesh.positions) < 1e-14);
}

TEST_CASE("a map of the control points maps the surface", "[mesh][nurbs]") {
  Chance chance(5);
  for (int round = 0; round < 20; ++round) {
    NurbsNet net = some_net(chance);
    const Field before = make_nurbs(net).mesh.positions;
    Matrix3d map;
    for (double& each : map.reshaped()) each = chance.number(-1, 1);
    const Eigen::RowVector3d shift(3, -2, 1);
    net.points = ((net.points * map).rowwise() + shift).eval();
    CHECK(largest_gap(make_nurbs(net).mesh.positions, (before * map).rowwise() + shift) <
          1e-14 * 10);
  }
}

TEST_CASE("turning a closed net by a column turns its surface, to the bit", "[mesh][nurbs]") {
  Chance chance(6);
  for (int degree = 1; degree < 5; ++degree) {
    NurbsNet net{.u = {.count = 5, .degree = degree, .is_closed = true},
                 .v = {.count = 6, .degree = 2, .is_closed = true}};
    net.points = chance.field(30);
    for (int k = 0; k < 30; ++k) net.weights.push_back(chance.number(0.5, 2));
    NurbsNet turned = net;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 5; ++i) {
        const int from = (j + 1) % 6 * 5 + (i + 1) % 5;
        turned.points.row(j * 5 + i) = net.points.row(from);
        turned.weights[j * 5 + i] = net.weights[from];
      }
    }
    const Field vertices = make_nurbs(net).mesh.positions;
    const Field others = make_nurbs(turned).mesh.positions;
    REQUIRE(vertices.rows() == 40 * 48);
    bool is_same = true;
    for (int l = 0; l < 48; ++l) {
      for (int k = 0; k < 40; ++k) {
        is_same =
            is_same && others.row(l * 40 + k) == vertices.row((l + 8) % 48 * 40 + (k + 8) % 40);
      }
    }
    CHECK(is_same);
  }
}

TEST_CASE("a net of degree 1 is interpolated linearly", "[mesh][nurbs]") {
  Chance chance(7);
  const bool is_closed = GENERATE(false, true);
  NurbsNet net{.u = {.count = 4, .degree = 1, .is_closed = is_closed},
               .v = {.count = 3, .degree = 1, .samples = 5}};
  net.points = chance.field(12);
  const NurbsSurface surface = make_nurbs(net);
  const int samples = is_closed ? 32 : 25;
  REQUIRE(surface.mesh.vertex_count() == 5 * samples);
  for (int l = 0; l < 5; ++l) {
    for (int k = 0; k < samples; ++k) {
      const int j = std::min(l / 2, 1), i = std::min(k / 8, is_closed ? 3 : 2);
      const double t = l / 2.0 - j, s = k / 8.0 - i;
      const auto at = [&](int column, int row) { return net.points.row(row * 4 + column % 4); };
      const Eigen::RowVector3d expected = (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) +
                                          t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1));
      CHECK((surface.mesh.positions.row(l * samples + k) - expected).norm() < 1e-15);
      // On a control point nothing else has a weight.
      if (l % 2 == 0 && k % 8 == 0) {
        const std::size_t start = surface.weights.starts[l * samples + k];
        CHECK(surface.weights.starts[l * samples + k + 1] == start + 1);
        CHECK(surface.weights.weights[start] == 1);
      }
    }
  }
}

TEST_CASE("an even flat net is a sheet", "[mesh][nurbs]") {
  const GridSheet coarse{.columns = 4, .rows = 3, .width = 3, .depth = 2};
  NurbsNet net{.u = {.count = 4, .degree = 1, .samples = 7},
               .v = {.count = 3, .degree = 1, .samples = 5}};
  net.points = make_mesh(coarse).positions;
  const NurbsSurface surface = make_nurbs(net);
  const Mesh fine = make_mesh({.columns = 7, .rows = 5, .width = 3, .depth = 2});
  CHECK(check_mesh(surface.mesh));
  CHECK(surface.mesh.positions == fine.positions);
  CHECK(surface.mesh.uvs == fine.uvs);
  CHECK(surface.mesh.face_sizes == fine.face_sizes);
  CHECK(surface.mesh.corner_vertices == fine.corner_vertices);
  CHECK(surface.mesh.corner_uvs == fine.corner_uvs);
  CHECK(surface.grid == find_grid(make_mesh(coarse))->grid);
}

TEST_CASE("a closed net is a torus of quads with a seam in its UVs", "[mesh][nurbs]") {
  NurbsNet net{.u = {.count = 6, .degree = 3, .is_closed = true, .samples = 12},
               .v = {.count = 5, .degree = 2, .is_closed = true, .samples = 10}};
  net.points.resize(30, 3);
  for (int node = 0; node < 30; ++node) {
    const double a = 2 * std::numbers::pi * (node % 6) / 6;
    const double b = 2 * std::numbers::pi * (node / 6) / 5;
    net.points.row(node) << (3 + std::cos(b)) * std::cos(a), std::sin(b),
        (3 + std::cos(b)) * std::sin(a);
  }
  const NurbsSurface surface = make_nurbs(net);
  const Mesh& mesh = surface.mesh;
  CHECK(surface.grid == Grid{6, 5, 1.0 / 6, 0.2, true, true});
  CHECK(check_mesh(mesh));
  CHECK(mesh.vertex_count() == 120);
  CHECK(mesh.face_sizes.size() == 120);
  CHECK(mesh.uvs.size() == 13 * 11);
  std::vector<int> uses(120, 0);
  double longest = 0, outward = 0;
  for (std::size_t corner = 0; corner < 480; ++corner) {
    const std::size_t next = corner % 4 == 3 ? corner - 3 : corner + 1;
    const int vertex = mesh.corner_vertices[corner];
    ++uses[vertex];
    // Of no face: do the UVs jump back over the seam.
    const auto& [u, v] = mesh.uvs[mesh.corner_uvs[corner]];
    const auto& [next_u, next_v] = mesh.uvs[mesh.corner_uvs[next]];
    CHECK_THAT(std::abs(next_u - u) * 12 + std::abs(next_v - v) * 10, WithinAbs(1, 1e-14));
    CHECK(u == (u == 1 ? 1 : vertex % 12 / 12.0));
    CHECK((u < 1 || vertex % 12 == 0));
    CHECK((v < 1 || vertex / 12 == 0));
    longest = std::max(
        longest,
        (mesh.positions.row(vertex) - mesh.positions.row(mesh.corner_vertices[next])).norm());
    if (corner % 4 != 0) continue;
    const auto at = [&](std::size_t k) {
      return Vector3d(mesh.positions.row(mesh.corner_vertices[corner + k]).transpose());
    };
    // The turn of a sheet is dS/dt x dS/ds: here away from the ring in the tube.
    Vector3d centre = (at(0) + at(1) + at(2) + at(3)) / 4;
    Vector3d ring(centre.x(), 0, centre.z());
    ring *= 2.3 / ring.norm();
    outward += (at(2) - at(0)).cross(at(3) - at(1)).dot(centre - ring) > 0 ? 1 : -1;
  }
  CHECK(std::ranges::count(uses, 4) == 120);
  CHECK(longest < 2);
  CHECK(outward == 120);
}

TEST_CASE("a net of a high degree is the same surface with fewer weights", "[mesh][nurbs]") {
  Chance chance(5);
  for (const bool is_rational : {false, true}) {
    for (const bool is_closed : {false, true}) {
      NurbsNet net{.u = {.count = 14, .degree = 11, .is_closed = is_closed, .samples = 15},
                   .v = {.count = 13, .degree = 9, .samples = 12}};
      net.points = chance.field(14 * 13);
      for (int k = 0; is_rational && k < 14 * 13; ++k) net.weights.push_back(chance.number(0.1, 3));
      REQUIRE(is_summed_by_directions(net));
      const NurbsSurface surface = make_nurbs(net);
      double worst = 0;
      for (int l = 0; l < 12; ++l) {
        for (int k = 0; k < 15; ++k) {
          const Eigen::RowVector3d difference =
              surface.mesh.positions.row(l * 15 + k) - reference(net, k, l);
          worst = std::max(worst, difference.cwiseAbs().maxCoeff());
        }
      }
      CHECK(worst < 1e-12);
      const std::size_t entries =
          surface.weights.weights.size() + surface.weights.points->weights.size();
      CHECK(static_cast<std::int64_t>(entries) <= check_net(net).value().weights);
      CHECK(entries < 15 * 12 * 12 * 10 / 3);
    }
  }
}
