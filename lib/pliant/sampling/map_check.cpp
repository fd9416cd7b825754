#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "pliant/body/triangle_body.hpp"
#include "pliant/mesh/triangles/triangle_surface.hpp"
#include "pliant/sampling/material_maps.hpp"
#include "pliant/scene/format/description.hpp"

namespace pliant {
namespace {

// A node, or a triangle of a surface.
struct MapPlace {
  bool is_triangle = false;
  int number = 0;
};

// The factors of all channels at a place.
struct PlaceFactors {
  MapPlace place;
  double density = 1, damping = 1, b = 1, c = 1, d = 1, yield = 1, hardening = 1, goal = 1;
};

// Finds the places that decide: those with the least and the largest factor of each channel, and of
// c / sqrt(b d). As all nodes have one value of a channel, no other place can break a rule first.
class DecidingPlaces {
 public:
  explicit DecidingPlaces(const RestShape& shape) {
    const NodeFactors& factors = *shape.factors;
    for (int node = 0; node < static_cast<int>(shape.rest.rows()); ++node) {
      look_at({{false, node},
               factor_at(factors.density, node),
               factor_at(factors.damping, node),
               factor_at(factors.b, node),
               factor_at(factors.c, node),
               factor_at(factors.d, node),
               factor_at(factors.yield, node),
               factor_at(factors.hardening, node),
               factor_at(factors.goal, node)});
    }
    if (!shape.surface) return;
    const TriangleSurface& surface = *shape.surface;
    const std::vector<double> b = means_on_triangles(surface, factors.b);
    const std::vector<double> c = means_on_triangles(surface, factors.c);
    const std::vector<double> d = means_on_triangles(surface, factors.d);
    const std::vector<double> yield = means_on_triangles(surface, factors.yield);
    const std::vector<double> hardening = means_on_triangles(surface, factors.hardening);
    for (int k = 0; k < static_cast<int>(surface.triangles.size()); ++k)
      look_at({{true, k},
               1,
               1,
               factor_at(b, k),
               factor_at(c, k),
               factor_at(d, k),
               factor_at(yield, k),
               factor_at(hardening, k)});
  }

  // Each by the number that it has the least or the largest of.
  std::vector<PlaceFactors> all() const {
    std::vector<PlaceFactors> places;
    for (const Extreme& extreme : extremes_) {
      places.push_back(extreme.least);
      places.push_back(extreme.most);
    }
    return places;
  }

 private:
  struct Extreme {
    double low = std::numeric_limits<double>::infinity();
    double high = -std::numeric_limits<double>::infinity();
    PlaceFactors least = {}, most = {};
  };

  void look_at(const PlaceFactors& at) {
    const double ratio = at.b > 0 && at.d > 0 ? at.c / std::sqrt(at.b * at.d) : 1;
    const double numbers[] = {at.density, at.damping,   at.b,    at.c, at.d,
                              at.yield,   at.hardening, at.goal, ratio};
    for (std::size_t k = 0; k < std::size(numbers); ++k) {
      Extreme& extreme = extremes_[k];
      if (numbers[k] < extreme.low) extreme.low = numbers[k], extreme.least = at;
      if (numbers[k] > extreme.high) extreme.high = numbers[k], extreme.most = at;
    }
  }

  std::array<Extreme, 9> extremes_;
};

class MapChecker {
 public:
  MapChecker(const Scene& scene, const Surface& surface, const RestShape& shape)
      : scene_(scene), surface_(surface), shape_(shape), places_(DecidingPlaces(shape).all()) {}

  std::vector<Error> check(int first, int last) {
    const auto& [density, damping, damping_ratio, b, c, d, yield, hardening, poisson, goal] =
        surface_.material;
    bool is_animated = yield && yield->is_animated();
    for (const Channel<1>* channel : {&density, &damping, &b, &c, &d, &hardening, &poisson, &goal})
      is_animated = is_animated || channel->is_animated();
    is_animated_ = is_animated;
    for (int frame = first; frame <= (is_animated ? last : first); ++frame) check_frame(frame);
    return std::move(errors_);
  }

 private:
  void check_frame(int frame) {
    const MaterialChannels& material = surface_.material;
    const double density = material.density.at(frame)[0], damping = material.damping.at(frame)[0];
    const double b = material.b.at(frame)[0], c = material.c.at(frame)[0];
    const double d = material.d.at(frame)[0], poisson = material.poisson.at(frame)[0];
    const auto [rho, eta] =
        acting_dynamics({density, material.damping_ratio ? density : damping}, &*shape_.factors);
    const bool is_static = rho == 0 && eta == 0;
    for (const PlaceFactors& at : places_) {
      check_range(MapChannel::Density, frame, at, density * at.density, false);
      check_range(MapChannel::Damping, frame, at, damping * at.damping, false);
      check_range(MapChannel::Goal, frame, at, material.goal.at(frame)[0] * at.goal, false);
      const bool is_sound = check_range(MapChannel::B, frame, at, b * at.b, true) &&
                            check_range(MapChannel::D, frame, at, d * at.d, true);
      if (is_sound && shape_.factors->have_stiffness())
        check_coupling(frame, at, {b * at.b, c * at.c, d * at.d}, poisson);
      if (!material.yield) continue;
      check_range(MapChannel::Yield, frame, at, material.yield->at(frame)[0] * at.yield, true);
      check_range(MapChannel::Hardening, frame, at, material.hardening.at(frame)[0] * at.hardening,
                  is_static);
    }
    check_integrator(frame, density);
  }

  // Whether it is within its range.
  bool check_range(MapChannel channel, int frame, const PlaceFactors& at, double value,
                   bool is_positive) {
    if (std::isfinite(value) && (is_positive ? value > 0 : value >= 0)) return true;
    complain(channel, frame,
             fmt::format("is {:.12g} at {} by its map, but {}{}", value, named(at.place),
                         !std::isfinite(value) ? "must be finite"
                         : is_positive         ? "must be greater than 0"
                                               : "must be at least 0",
                         range_hint(channel)));
    return false;
  }

  std::string range_hint(MapChannel channel) const {
    const auto map = std::ranges::find(surface_.maps, channel, &MaterialMap::channel);
    if (map == surface_.maps.end()) return {};
    const std::vector<MapSummary> all = map_summaries_of(shape_);
    const auto summary = std::ranges::find(all, channel, &MapSummary::channel);
    const std::string told = summary == all.end() ? "" : outside_unit_range(*map, *summary);
    return told.empty() ? "" : "; " + told;
  }

  // Requires: b, d > 0.
  void check_coupling(int frame, const PlaceFactors& at, const Stiffness& stiffness,
                      double poisson) {
    const double twice_root = -stiffness.least_c();
    const std::string where =
        fmt::format("at {}, where b = {} and d = {}", named(at.place), stiffness.b, stiffness.d);
    if (!std::isfinite(stiffness.c) || !stiffness.is_elliptic()) {
      complain(MapChannel::C, frame,
               fmt::format("is {} {}, but must be greater than -2 sqrt(b d) = {}; otherwise the "
                           "plate has no stable shape",
                           stiffness.c, where, stiffness.least_c()));
    } else if (!(std::abs(poisson) < 1) || !(stiffness.c > poisson * twice_root)) {
      complain("poisson", frame,
               fmt::format("is {}, but with a map of b, c or d it must be between -1 and 1, and "
                           "c = {} {} must be greater than 2 poisson sqrt(b d) = {}; a smaller "
                           "poisson helps",
                           poisson, stiffness.c, where, poisson * twice_root));
    }
  }

  void check_integrator(int frame, double density) {
    if (surface_.solver.integrator == Integrator::BackwardEuler || !(density > 0)) return;
    const std::vector<double>& factors = shape_.factors->density;
    const auto is_zero = [](double factor) { return factor == 0; };
    const auto zeros = std::ranges::count_if(factors, is_zero);
    if (zeros == 0 || zeros == static_cast<std::ptrdiff_t>(factors.size())) return;
    const auto first = std::ranges::find_if(factors, is_zero) - factors.begin();
    const auto word = integrator_words[static_cast<std::size_t>(surface_.solver.integrator)];
    complain(
        MapChannel::Density, frame,
        fmt::format("is 0 at {} by its map, but integrator=\"{}\" needs a density at all nodes "
                    "or at none",
                    named({false, static_cast<int>(first)}), word));
  }

  std::string named(const MapPlace& place) const {
    if (place.is_triangle) return fmt::format("triangle {}", place.number);
    if (!shape_.grid) return fmt::format("node {}", place.number);
    return fmt::format("node ({}, {})", place.number % shape_.grid->columns,
                       place.number / shape_.grid->columns);
  }

  void complain(MapChannel channel, int frame, const std::string& complaint) {
    complain(map_channel_words[static_cast<std::size_t>(channel)], frame, complaint);
  }
  void complain(std::string_view channel, int frame, const std::string& complaint) {
    if (!told_.insert(std::string(channel)).second) return;
    const std::string when = is_animated_ ? fmt::format(" at frame {}", frame) : "";
    std::vector<std::string> parts = {std::string(channel)};
    for (const MaterialMap& map : surface_.maps) parts.push_back(name_of(map.channel));
    errors_.push_back(scene_.origin.located(
        {.code = ErrorCode::InvalidInput,
         .message = fmt::format("{}.{}{} {}", surface_.name, channel, when, complaint)},
        place_of(channel, parts)));
  }

  // Of the map that changes the channel; else of the last of all that may have caused it.
  TextPlace place_of(std::string_view channel, const std::vector<std::string>& parts) const {
    const std::string own = "map." + std::string(channel);
    if (scene_.origin.gives(surface_.name, own)) return scene_.origin.at(surface_.name, own);
    return scene_.origin.last_of(surface_.name, parts);
  }

  const Scene& scene_;
  const Surface& surface_;
  const RestShape& shape_;
  std::vector<PlaceFactors> places_;
  bool is_animated_ = false;
  std::set<std::string> told_;  // channels
  std::vector<Error> errors_;
};

}  // namespace

std::vector<Error> check_maps(const Scene& scene, const Surface& surface, const RestShape& shape) {
  if (!shape.factors) return {};
  const FrameSpan frames = sampled_frames(scene, surface);
  return MapChecker(scene, surface, shape).check(frames.first, frames.last);
}

std::vector<Error> check_maps_at(const Scene& scene, const Surface& surface, const RestShape& shape,
                                 int frame) {
  if (!shape.factors) return {};
  return MapChecker(scene, surface, shape).check(frame, frame);
}

}  // namespace pliant
