#include "pliant/mesh/nurbs_surface.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// The B-splines that are not 0 at each sample of a direction.
struct SampledSplines {
  std::size_t order = 0;       // degree + 1
  std::vector<int> first;      // #samples: the first spline; the others follow, modulo the count
  std::vector<double> values;  // #samples * order

  std::span<const double> of(int sample) const {
    return std::span(values).subspan(static_cast<std::size_t>(sample) * order, order);
  }
};

// The splines of the span between the two knots in the middle, at s within it. `knots` are the
// `degree` ones up to the span and the `degree` ones after it. A2.2: no denominator is 0, because
// the span is not empty.
void evaluate(std::span<const double> knots, double s, std::span<double> splines) {
  const std::size_t degree = knots.size() / 2;
  splines[0] = 1;
  for (std::size_t p = 1; p <= degree; ++p) {
    double saved = 0;
    for (std::size_t r = 0; r < p; ++r) {
      const double right = knots[degree + r] - s;
      const double left = s - knots[degree + r - p];
      const double part = splines[r] / (right + left);
      splines[r] = saved + right * part;
      saved = left * part;
    }
    splines[p] = saved;
  }
}

SampledSplines sampled_open(const NurbsDirection& direction, int samples) {
  const std::vector<double> knots = knots_of(direction);
  const auto degree = static_cast<std::size_t>(direction.degree);
  const auto count = static_cast<std::size_t>(direction.count);
  const double from = knots[degree], to = knots[count];
  SampledSplines splines{degree + 1, {}, {}};
  splines.first.resize(static_cast<std::size_t>(samples));
  splines.values.resize(static_cast<std::size_t>(samples) * splines.order);
  for (int k = 0; k < samples; ++k) {
    // Only the division rounds where the knots are small integers, so that samples lie on knots.
    const double s = k == samples - 1 ? to : std::min(to, from + (to - from) * k / (samples - 1));
    const auto after =
        std::upper_bound(knots.begin() + direction.degree, knots.begin() + direction.count + 1, s);
    auto span = static_cast<std::size_t>(after - knots.begin()) - 1;
    while (span == count || knots[span] == knots[span + 1]) --span;  // the last one holds its end
    splines.first[k] = static_cast<int>(span - degree);
    evaluate(std::span(knots).subspan(span + 1 - degree, 2 * degree), s,
             std::span(splines.values).subspan(k * splines.order, splines.order));
  }
  return splines;
}

SampledSplines sampled_closed(const NurbsDirection& direction, int samples) {
  // All spans are alike: the parameter is counted from the start of its span. So the surface of a
  // net that is turned by a column is the same to the bit.
  const int degree = direction.degree;
  std::vector<double> knots;
  for (int k = 1 - degree; k <= degree; ++k) knots.push_back(k);
  SampledSplines splines{static_cast<std::size_t>(degree) + 1, {}, {}};
  splines.first.resize(static_cast<std::size_t>(samples));
  splines.values.resize(static_cast<std::size_t>(samples) * splines.order);
  for (int k = 0; k < samples; ++k) {
    const std::int64_t place = std::int64_t{direction.count} * k;
    splines.first[k] = static_cast<int>(place / samples);
    evaluate(knots, static_cast<double>(place % samples) / samples,
             std::span(splines.values).subspan(k * splines.order, splines.order));
  }
  return splines;
}

SampledSplines sampled(const NurbsDirection& direction) {
  const int samples = samples_of(direction);
  return direction.is_closed ? sampled_closed(direction, samples)
                             : sampled_open(direction, samples);
}

class WeightsMaker {
 public:
  explicit WeightsMaker(const NurbsNet& net)
      : net_(net), along_u_(sampled(net.u)), along_v_(sampled(net.v)) {}

  VertexWeights make() && {
    const std::size_t vertex_count = along_u_.first.size() * along_v_.first.size();
    weights_.starts.reserve(vertex_count + 1);
    weights_.nodes.reserve(vertex_count * along_u_.order * along_v_.order);
    weights_.weights.reserve(vertex_count * along_u_.order * along_v_.order);
    for (std::size_t l = 0; l < along_v_.first.size(); ++l) {
      for (std::size_t k = 0; k < along_u_.first.size(); ++k)
        add_vertex(static_cast<int>(k), static_cast<int>(l));
    }
    return std::move(weights_);
  }

 private:
  void add_vertex(int k, int l) {
    const std::span<const double> splines_u = along_u_.of(k), splines_v = along_v_.of(l);
    const std::size_t start = weights_.nodes.size();
    double most = 0;
    for (std::size_t b = 0; b < splines_v.size(); ++b) {
      const int j = static_cast<int>((along_v_.first[l] + b) % net_.v.count);
      for (std::size_t a = 0; a < splines_u.size(); ++a) {
        const double product = splines_u[a] * splines_v[b];
        if (product == 0) continue;
        const int i = static_cast<int>((along_u_.first[k] + a) % net_.u.count);
        weights_.nodes.push_back(j * net_.u.count + i);
        weights_.weights.push_back(product);
        most = std::max(most, weight_of(weights_.nodes.back()));
      }
    }
    // In units of the largest weight here, which only keeps tiny ones from becoming 0 together.
    double sum = 0;
    for (std::size_t entry = start; entry < weights_.nodes.size(); ++entry) {
      weights_.weights[entry] *= weight_of(weights_.nodes[entry]) / most;
      sum += weights_.weights[entry];
    }
    for (std::size_t entry = start; entry < weights_.nodes.size(); ++entry)
      weights_.weights[entry] /= sum;
    weights_.starts.push_back(weights_.nodes.size());
  }

  double weight_of(int node) const { return net_.weights.empty() ? 1 : net_.weights[node]; }

  const NurbsNet& net_;
  SampledSplines along_u_, along_v_;
  VertexWeights weights_;
};

double spacing(const NurbsDirection& direction) {
  return 1.0 / (direction.is_closed ? direction.count : direction.count - 1);
}

// Calls `add_corner(k, l)` for the corners of each quad, turned like those of a `GridSheet`.
template <class AddCorner>
void for_each_quad(int quads_u, int quads_v, const AddCorner& add_corner) {
  for (int l = 0; l < quads_v; ++l) {
    for (int k = 0; k < quads_u; ++k) {
      add_corner(k, l);
      add_corner(k, l + 1);
      add_corner(k + 1, l + 1);
      add_corner(k + 1, l);
    }
  }
}

// Quads between all samples; their last column joins the first samples where u is closed.
void add_quads(const NurbsNet& net, Mesh& mesh) {
  const int samples_u = samples_of(net.u), samples_v = samples_of(net.v);
  const int quads_u = net.u.is_closed ? samples_u : samples_u - 1;
  const int quads_v = net.v.is_closed ? samples_v : samples_v - 1;
  for (int l = 0; l <= quads_v; ++l) {
    for (int k = 0; k <= quads_u; ++k)
      mesh.uvs.push_back({static_cast<double>(k) / quads_u, static_cast<double>(l) / quads_v});
  }
  const auto quad_count = static_cast<std::size_t>(quads_u) * static_cast<std::size_t>(quads_v);
  mesh.face_sizes.assign(quad_count, 4);
  mesh.corner_vertices.reserve(4 * quad_count);
  mesh.corner_uvs.reserve(4 * quad_count);
  const auto add_corner = [&](int k, int l) {
    mesh.corner_vertices.push_back(l % samples_v * samples_u + k % samples_u);
    mesh.corner_uvs.push_back(l * (quads_u + 1) + k);
  };
  for_each_quad(quads_u, quads_v, add_corner);
}

}  // namespace

Mesh control_mesh(const NurbsNet& net) {
  Mesh mesh;
  mesh.positions = net.points;
  for_each_quad(net.u.is_closed ? net.u.count : net.u.count - 1,
                net.v.is_closed ? net.v.count : net.v.count - 1, [&](int i, int j) {
                  mesh.corner_vertices.push_back(j % net.v.count * net.u.count + i % net.u.count);
                });
  mesh.face_sizes.assign(mesh.corner_vertices.size() / 4, 4);
  mesh.corner_uvs.assign(mesh.corner_vertices.size(), -1);
  return mesh;
}

NurbsSurface make_nurbs(const NurbsNet& net) {
  PLIANT_EXPECTS(check_net(net).has_value());
  NurbsSurface surface;
  surface.grid = {net.u.count,    net.v.count,     spacing(net.u),
                  spacing(net.v), net.u.is_closed, net.v.is_closed};
  surface.weights = WeightsMaker(net).make();
  surface.mesh.positions = surface.weights.apply(net.points);
  add_quads(net, surface.mesh);
  return surface;
}

}  // namespace pliant
