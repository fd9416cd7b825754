#include "pliant/scene/scene.hpp"

namespace pliant {

int SceneOrigin::line_of(const std::string& name, const std::string& attribute) const {
  if (!attribute.empty())
    if (const auto found = lines.find(name + '.' + attribute); found != lines.end())
      return found->second;
  const auto found = lines.find(name);
  return found != lines.end() ? found->second : 0;
}

}  // namespace pliant
