#include "pliant/scene/scene.hpp"

#include <iterator>

namespace pliant {

std::string_view kind_of(const Force& force) {
  constexpr std::string_view kinds[] = {"point",  "radial", "line",    "uniform",
                                        "vortex", "noise",  "inertia", "custom"};
  static_assert(std::size(kinds) == std::variant_size_v<decltype(Force::shape)>);
  return kinds[force.shape.index()];
}

int SceneOrigin::line_of(const std::string& name, const std::string& attribute) const {
  if (!attribute.empty())
    if (const auto found = lines.find(name + '.' + attribute); found != lines.end())
      return found->second;
  const auto found = lines.find(name);
  return found != lines.end() ? found->second : 0;
}

}  // namespace pliant
