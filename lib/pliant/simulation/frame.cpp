#include "pliant/simulation/frame.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant {

SurfaceFrame::SurfaceFrame(std::string name, Field object_positions, const Transform& transform,
                           double peak_displacement)
    : name_(std::move(name)),
      object_positions_(std::move(object_positions)),
      transform_(transform),
      peak_displacement_(peak_displacement) {}

Frame::Frame(int number, std::vector<SurfaceFrame> surfaces)
    : number_(number), surfaces_(std::move(surfaces)) {}

const SurfaceFrame* Frame::find_surface(std::string_view name) const {
  const auto found =
      std::find_if(surfaces_.begin(), surfaces_.end(),
                   [&](const SurfaceFrame& surface) { return surface.name() == name; });
  return found == surfaces_.end() ? nullptr : &*found;
}

const SurfaceFrame& Frame::surface(std::string_view name) const {
  const SurfaceFrame* const found = find_surface(name);
  PLIANT_EXPECTS(found);
  return *found;
}

}  // namespace pliant
