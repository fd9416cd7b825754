#include "pliant/mesh/written/nurbs_surface.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
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
void evaluate(std::span<const double> knots, double s, std::span<double> splines, StopPoll& poll) {
  const std::size_t degree = knots.size() / 2;
  splines[0] = 1;
  for (std::size_t p = 1; p <= degree && !poll.after(p); ++p) {
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

SampledSplines sampled_open(const NurbsDirection& direction, int samples, StopPoll& poll) {
  const std::vector<double> knots = knots_of(direction);
  const auto degree = static_cast<std::size_t>(direction.degree);
  const auto count = static_cast<std::size_t>(direction.count);
  const double from = knots[degree], to = knots[count];
  SampledSplines splines{degree + 1, {}, {}};
  splines.first.resize(static_cast<std::size_t>(samples));
  splines.values.resize(static_cast<std::size_t>(samples) * splines.order);
  for (int k = 0; k < samples && !poll.after(8); ++k) {
    // Only the division rounds where the knots are small integers, so that samples lie on knots.
    const double s = k == samples - 1 ? to : std::min(to, from + (to - from) * k / (samples - 1));
    const auto after =
        std::upper_bound(knots.begin() + direction.degree, knots.begin() + direction.count + 1, s);
    auto span = static_cast<std::size_t>(after - knots.begin()) - 1;
    while (span == count || knots[span] == knots[span + 1]) --span;  // the last one holds its end
    splines.first[k] = static_cast<int>(span - degree);
    evaluate(std::span(knots).subspan(span + 1 - degree, 2 * degree), s,
             std::span(splines.values).subspan(k * splines.order, splines.order), poll);
  }
  return splines;
}

SampledSplines sampled_closed(const NurbsDirection& direction, int samples, StopPoll& poll) {
  // All spans are alike: the parameter is counted from the start of its span. So the surface of a
  // net that is turned by a column is the same to the bit.
  const int degree = direction.degree;
  std::vector<double> knots;
  for (int k = 1 - degree; k <= degree; ++k) knots.push_back(k);
  SampledSplines splines{static_cast<std::size_t>(degree) + 1, {}, {}};
  splines.first.resize(static_cast<std::size_t>(samples));
  splines.values.resize(static_cast<std::size_t>(samples) * splines.order);
  for (int k = 0; k < samples && !poll.after(8); ++k) {
    const std::int64_t place = std::int64_t{direction.count} * k;
    splines.first[k] = static_cast<int>(place / samples);
    evaluate(knots, static_cast<double>(place % samples) / samples,
             std::span(splines.values).subspan(k * splines.order, splines.order), poll);
  }
  return splines;
}

// Unfinished if it is stopped.
SampledSplines sampled(const NurbsDirection& direction, StopPoll& poll) {
  const int samples = samples_of(direction);
  return direction.is_closed ? sampled_closed(direction, samples, poll)
                             : sampled_open(direction, samples, poll);
}

// Appends the entries of one vertex to a map: `entries_at(add)` calls add(number, share, weight)
// for each share that is not 0 of a control point of that weight. Their sum becomes 1. Returns the
// sum before that, in units of the largest weight here, which only keeps tiny ones from becoming 0
// together, and that weight.
template <class EntriesAt>
std::pair<double, double> append_vertex(VertexWeights& map, const EntriesAt& entries_at) {
  const std::size_t start = map.nodes.size();
  double most = 0;
  entries_at([&](int, double, double weight) { most = std::max(most, weight); });
  double sum = 0;
  entries_at([&](int number, double share, double weight) {
    map.nodes.push_back(number);
    map.weights.push_back(share * (weight / most));
    sum += map.weights.back();
  });
  for (std::size_t entry = start; entry < map.nodes.size(); ++entry) map.weights[entry] /= sum;
  map.starts.push_back(map.nodes.size());
  return {sum, most};
}

class WeightsMaker {
 public:
  // Unfinished if it is stopped.
  WeightsMaker(const NurbsNet& net, StopPoll& poll)
      : net_(net), poll_(poll), along_u_(sampled(net.u, poll)), along_v_(sampled(net.v, poll)) {}

  VertexWeights make() && {
    if (poll_.after(0)) return {};
    return is_summed_by_directions(net_) ? by_directions() : at_once();
  }

 private:
  VertexWeights at_once() const {
    VertexWeights map;
    const std::size_t vertex_count = along_u_.first.size() * along_v_.first.size();
    const std::size_t points = along_u_.order * along_v_.order;
    reserve(map, vertex_count, points);
    for (int l = 0; l < samples_v(); ++l) {
      for (int k = 0; k < samples_u() && !poll_.after(points); ++k) {
        append_vertex(map, [&](const auto& add) {
          each_spline(along_v_, l, net_.v.count, [&](int j, double of_v) {
            each_spline(along_u_, k, net_.u.count, [&](int i, double of_u) {
              if (of_u * of_v == 0) return;
              const int node = j * net_.u.count + i;
              add(node, of_u * of_v, weight_of(node));
            });
          });
        });
      }
    }
    return map;
  }

  // A point for each sample of u in each row of the net, and vertices of these points.
  VertexWeights by_directions() const {
    auto points = std::make_shared<VertexWeights>();
    const std::size_t point_count = along_u_.first.size() * static_cast<std::size_t>(net_.v.count);
    reserve(*points, point_count, along_u_.order);
    std::vector<std::pair<double, double>> point_weights;  // each a product
    point_weights.reserve(point_count);
    for (int j = 0; j < net_.v.count; ++j) {
      for (int k = 0; k < samples_u() && !poll_.after(along_u_.order); ++k) {
        point_weights.push_back(append_vertex(*points, [&](const auto& add) {
          each_spline(along_u_, k, net_.u.count, [&](int i, double of_u) {
            const int node = j * net_.u.count + i;
            if (of_u != 0) add(node, of_u, weight_of(node));
          });
        }));
      }
    }
    VertexWeights map;
    if (poll_.after(0)) return map;
    reserve(map, along_u_.first.size() * along_v_.first.size(), along_v_.order);
    for (int l = 0; l < samples_v(); ++l) {
      for (int k = 0; k < samples_u() && !poll_.after(along_v_.order); ++k) {
        append_vertex(map, [&](const auto& add) {
          each_spline(along_v_, l, net_.v.count, [&](int j, double of_v) {
            const int point = j * samples_u() + k;
            const auto& [sum, most] = point_weights[static_cast<std::size_t>(point)];
            if (of_v * sum != 0) add(point, of_v * sum, most);
          });
        });
      }
    }
    map.points = std::move(points);
    return map;
  }

  static void reserve(VertexWeights& map, std::size_t vertices, std::size_t entries) {
    map.starts.reserve(vertices + 1);
    map.nodes.reserve(vertices * entries);
    map.weights.reserve(vertices * entries);
  }

  // Calls f(number, value) for the splines at a sample, in their order.
  template <class F>
  static void each_spline(const SampledSplines& along, int sample, int count, const F& f) {
    const std::span<const double> splines = along.of(sample);
    for (std::size_t k = 0; k < splines.size(); ++k)
      f(static_cast<int>((along.first[sample] + k) % count), splines[k]);
  }

  int samples_u() const { return static_cast<int>(along_u_.first.size()); }
  int samples_v() const { return static_cast<int>(along_v_.first.size()); }
  double weight_of(int node) const { return net_.weights.empty() ? 1 : net_.weights[node]; }

  const NurbsNet& net_;
  StopPoll& poll_;
  SampledSplines along_u_, along_v_;
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
void add_quads(const NurbsNet& net, Mesh& mesh, StopPoll& poll) {
  const int samples_u = samples_of(net.u), samples_v = samples_of(net.v);
  const int quads_u = net.u.is_closed ? samples_u : samples_u - 1;
  const int quads_v = net.v.is_closed ? samples_v : samples_v - 1;
  for (int l = 0; l <= quads_v; ++l) {
    for (int k = 0; k <= quads_u && !poll.after(2); ++k)
      mesh.uvs.push_back({static_cast<double>(k) / quads_u, static_cast<double>(l) / quads_v});
  }
  const auto quad_count = static_cast<std::size_t>(quads_u) * static_cast<std::size_t>(quads_v);
  mesh.face_sizes.assign(quad_count, 4);
  mesh.corner_vertices.reserve(4 * quad_count);
  mesh.corner_uvs.reserve(4 * quad_count);
  const auto add_corner = [&](int k, int l) {
    if (poll.after(2)) return;
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

NurbsSurface make_nurbs(const NurbsNet& net) { return *make_nurbs(net, {}); }

Result<NurbsSurface> make_nurbs(const NurbsNet& net, const StopRequest& should_stop) {
  PLIANT_EXPECTS(check_net(net).has_value());
  StopPoll poll(should_stop);
  NurbsSurface surface;
  surface.grid = {net.u.count,    net.v.count,     spacing(net.u),
                  spacing(net.v), net.u.is_closed, net.v.is_closed};
  surface.weights = WeightsMaker(net, poll).make();
  if (poll.after(0)) return interrupted();
  auto positions = surface.weights.apply(net.points, {}, should_stop);
  if (!positions) return fail(positions.error());
  surface.mesh.positions = *std::move(positions);
  add_quads(net, surface.mesh, poll);
  if (poll.after(0)) return interrupted();
  return surface;
}

}  // namespace pliant
