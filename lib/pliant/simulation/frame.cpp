#include "pliant/simulation/frame.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/result.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant {

SurfaceFrame::SurfaceFrame(std::string name, Field object_positions, const Transform& transform,
                           double peak_displacement)
    : name_(std::move(name)),
      object_positions_(std::move(object_positions)),
      transform_(transform),
      peak_displacement_(peak_displacement) {}

Field SurfaceFrame::positions(Field reuse) const {
  return to_world(transform_, object_positions_, std::move(reuse));
}

double SurfaceFrame::told_displacement() const {
  if (peak_displacement_ == 0) return 0;
  constexpr double rounding = 1e-12;
  const Vector3d sides =
      object_positions_.colwise().maxCoeff() - object_positions_.colwise().minCoeff();
  const double size = (transform_.linear.cwiseAbs() * sides).maxCoeff();
  return peak_displacement_ < rounding * size ? 0 : peak_displacement_;
}

Frame::Frame(int number, std::vector<SurfaceFrame> surfaces)
    : number_(number), surfaces_(std::move(surfaces)) {}

std::span<const SurfaceFrame> Frame::surfaces() const { return surfaces_; }

const SurfaceFrame* Frame::find_surface(std::string_view name) const {
  const auto found =
      std::find_if(surfaces_.begin(), surfaces_.end(),
                   [&](const SurfaceFrame& surface) { return surface.name() == name; });
  return found == surfaces_.end() ? nullptr : &*found;
}

const SurfaceFrame& Frame::surface(std::string_view name) const {
  const SurfaceFrame* const found = find_surface(name);
  PLIANT_EXPECTS_OR(found, no_surface_text(name));
  return *found;
}

std::string Frame::no_surface_text(std::string_view name) const {
  constexpr std::size_t most_listed = 24;
  std::vector<std::string_view> names;
  for (const SurfaceFrame& surface : surfaces_) names.push_back(surface.name());
  const auto near = xml::nearest_word(name, names);
  const bool are_all = names.size() <= most_listed;
  if (!are_all) names.resize(most_listed);
  return fmt::format("the frame has no surface \"{}\"; {}it has: {}{}", printable(name),
                     near ? fmt::format("did you mean \"{}\"? ", *near) : "",
                     names.empty() ? "none" : xml::listed(names), are_all ? "" : ", …");
}

}  // namespace pliant
