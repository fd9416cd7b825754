#include "pliant/mesh/written/nurbs_net.hpp"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "pliant/mesh/written/vertex_weights.hpp"

namespace pliant {
namespace {

// What the scene format calls a direction's count, and the direction.
struct DirectionNames {
  const char* count;
  char along;      // of knots
  char attribute;  // of degreeU, samplesU
};

using NetCheck = Checked<void>;

tl::unexpected<Complaint> wrong(std::string part, std::string message) {
  return tl::unexpected(Complaint{.message = std::move(message), .part = std::move(part)});
}

constexpr DirectionNames names_u = {"columns", 'u', 'U'};
constexpr DirectionNames names_v = {"rows", 'v', 'V'};

NetCheck check_knots(const NurbsDirection& direction, const DirectionNames& names) {
  const std::vector<double>& knots = direction.knots;
  const auto degree = static_cast<std::size_t>(direction.degree);
  const auto count = static_cast<std::size_t>(direction.count);
  const std::string part = fmt::format("knots.{}", names.along);
  const std::string thing = fmt::format("knots along=\"{}\"", names.along);
  if (knots.empty()) return {};
  if (direction.is_closed) {
    return wrong(part,
                 fmt::format("{}: a net that wrap closes along {} has none", thing, names.along));
  }
  if (knots.size() != count + degree + 1) {
    return wrong(
        part, fmt::format("{}: there are {} numbers, but {} + degree{} + 1 = {} are needed", thing,
                          knots.size(), names.count, names.attribute, count + degree + 1));
  }
  for (std::size_t k = 0; k < knots.size(); ++k) {
    if (!std::isfinite(knots[k]))
      return wrong(part, fmt::format("{}: number {} is not finite", thing, k + 1));
    if (k > 0 && knots[k] < knots[k - 1]) {
      return wrong(part, fmt::format("{}: number {}, {}, is less than the one before it, {}", thing,
                                     k + 1, knots[k], knots[k - 1]));
    }
  }
  // Parameters are multiples of a part of the range.
  if (!std::isfinite((knots.back() - knots.front()) * double{WrittenSize::most_vertices})) {
    return wrong(
        part, fmt::format("{}: {} and {} lie too far apart", thing, knots.front(), knots.back()));
  }
  std::size_t equal = 1;
  for (std::size_t k = 1; k <= knots.size(); ++k, ++equal) {
    if (k < knots.size() && knots[k] == knots[k - 1]) continue;
    const bool is_end = k == equal || k == knots.size();
    if (equal > degree + (is_end ? 1 : 0)) {
      return wrong(part, fmt::format("{}: {} occurs {} times, but {} is the most {}", thing,
                                     knots[k - 1], equal, is_end ? degree + 1 : degree,
                                     is_end ? "at an end" : "between the ends"));
    }
    equal = 0;
  }
  if (!(knots[degree] < knots[count])) {
    return wrong(part,
                 fmt::format("{}: the surface lies between numbers {} and {}, which are both {}",
                             thing, degree + 1, count + 1, knots[degree]));
  }
  return {};
}

NetCheck check_direction(const NurbsDirection& direction, const DirectionNames& names) {
  if (direction.count < 3 || direction.count > WrittenSize::most_vertices) {
    return wrong(names.count, fmt::format("{} is {}, but must be from 3 to {}", names.count,
                                          direction.count, WrittenSize::most_vertices));
  }
  if (direction.degree < 1 || direction.degree >= direction.count) {
    return wrong(fmt::format("degree{}", names.attribute),
                 fmt::format("degree{} is {}, but must be from 1 to {} - 1 = {}", names.attribute,
                             direction.degree, names.count, direction.count - 1));
  }
  const int least = direction.is_closed ? 3 : 2;
  if (direction.samples && *direction.samples < least) {
    return wrong(fmt::format("samples{}", names.attribute),
                 fmt::format("samples{} is {}, but must be at least {}", names.attribute,
                             *direction.samples, least));
  }
  return check_knots(direction, names);
}

// Making the splines at a sample takes the square of their number.
NetCheck check_splines(const NurbsDirection& direction, const DirectionNames& names) {
  constexpr double most_steps = 2e9;
  const double splines = direction.degree + 1.0;
  if (samples_of(direction) * splines * splines <= most_steps) return {};
  return wrong(fmt::format("degree{}", names.attribute),
               fmt::format("degree{0} is {1}, with {2} vertices along {3}: vertices x (degree{0} + "
                           "1)^2 must be at most {4:.0f}; set samples{0} or lower degree{0}",
                           names.attribute, direction.degree, samples_of(direction), names.along,
                           most_steps));
}

// Entries of the weights, in double precision, where no product overflows.
double entry_count(const NurbsNet& net) {
  const double u = samples_of(net.u), v = samples_of(net.v);
  const double along_u = net.u.degree + 1.0, along_v = net.v.degree + 1.0;
  if (!is_summed_by_directions(net)) return u * along_u * v * along_v;
  return u * net.v.count * along_u + u * v * along_v;
}

Checked<WrittenSize> written_size(const NurbsNet& net) {
  const std::int64_t u = samples_of(net.u), v = samples_of(net.v);
  if (u * v > WrittenSize::most_vertices) {
    return wrong("samplesU",
                 fmt::format("{} x {} vertices would be written, but {} is the most; set "
                             "samplesU and samplesV",
                             u, v, WrittenSize::most_vertices));
  }
  if (auto checked = check_splines(net.u, names_u); !checked)
    return tl::unexpected(checked.error());
  if (auto checked = check_splines(net.v, names_v); !checked)
    return tl::unexpected(checked.error());
  const double weights = entry_count(net);
  if (weights > double{WrittenSize::most_weights}) {
    return wrong("samplesU",
                 fmt::format("{} x {} vertices of {} x {} control points each would be written, "
                             "but {} control points are the most; set samplesU and samplesV",
                             u, v, net.u.degree + 1, net.v.degree + 1, WrittenSize::most_weights));
  }
  return WrittenSize{
      .vertices = u * v,
      .faces = (net.u.is_closed ? u : u - 1) * (net.v.is_closed ? v : v - 1),
      .weights = static_cast<std::int64_t>(weights),
  };
}

}  // namespace

bool operator==(const NurbsNet& a, const NurbsNet& b) {
  const auto& [u, v, points, weights] = b;  // a new member has to be added here
  return a.u == u && a.v == v && are_equal(a.points, points) && a.weights == weights;
}

std::vector<double> knots_of(const NurbsDirection& direction) {
  if (!direction.knots.empty()) return direction.knots;
  const int degree = direction.degree, spans = direction.count - degree;
  std::vector<double> knots(static_cast<std::size_t>(degree), 0);
  for (int k = 0; k <= spans; ++k) knots.push_back(k);
  knots.insert(knots.end(), static_cast<std::size_t>(degree), spans);
  return knots;
}

int samples_of(const NurbsDirection& direction) {
  if (direction.samples) return *direction.samples;
  return direction.is_closed ? 8 * direction.count : 8 * (direction.count - direction.degree) + 1;
}

bool is_summed_by_directions(const NurbsNet& net) {
  constexpr double most_points = 64;  // those of degree 7
  return (net.u.degree + 1.0) * (net.v.degree + 1.0) > most_points;
}

Checked<WrittenSize> check_net(const NurbsNet& net) {
  if (auto checked = check_direction(net.u, names_u); !checked)
    return tl::unexpected(checked.error());
  if (auto checked = check_direction(net.v, names_v); !checked)
    return tl::unexpected(checked.error());
  const std::int64_t count = std::int64_t{net.u.count} * net.v.count;
  if (count > WrittenSize::most_vertices) {
    return wrong("columns", fmt::format("columns x rows is {}, but {} is the most", count,
                                        WrittenSize::most_vertices));
  }
  if (net.points.rows() != count) {
    return wrong("points", fmt::format("there are {} points, but columns x rows = {} are needed",
                                       net.points.rows(), count));
  }
  for (Eigen::Index k = 0; k < net.points.rows(); ++k) {
    if (!net.points.row(k).allFinite())
      return wrong("points", fmt::format("point {} has a coordinate that is not finite", k + 1));
  }
  if (!net.weights.empty() && static_cast<std::int64_t>(net.weights.size()) != count) {
    return wrong("weights", fmt::format("there are {} weights, but columns x rows = {} are needed",
                                        net.weights.size(), count));
  }
  for (std::size_t k = 0; k < net.weights.size(); ++k) {
    if (!(net.weights[k] > 0) || !std::isfinite(net.weights[k])) {
      return wrong("weights", fmt::format("weight {} is {}, but must be > 0 and finite", k + 1,
                                          net.weights[k]));
    }
  }
  return written_size(net);
}

}  // namespace pliant
