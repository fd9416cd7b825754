#include "editor/motion.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/shortened.hpp"
#include "pliant/core/text.hpp"
#include "pliant/scene/channels.hpp"

namespace pliant::editor {
namespace {

// A number of a scene; null: it has no such channel.
const Channel<1>* find_number(const Scene& scene, const std::string& path) {
  const std::vector<NamedChannel> channels = channels_of(scene);
  const auto found = std::ranges::find(channels, path, &NamedChannel::path);
  if (found == channels.end()) return nullptr;
  const auto* const number = std::get_if<const Channel<1>*>(&found->channel);
  return number ? *number : nullptr;
}

SurfaceMotion motion_in(const Preview& preview) {
  SurfaceMotion motion;
  const auto told = [&](double number, std::optional<double>& to, const char* reason) {
    if (std::isfinite(number) && number > 0)
      to = number;
    else if (motion.reason.empty())
      motion.reason = reason;
  };
  if (!preview.frame) {
    motion.reason = "no force reaches a node";
    return motion;
  }
  told(preview.played ? preview.played->peak : preview.static_peak, motion.peak,
       "how far it moves is not known");
  const auto farthest = std::ranges::max_element(preview.regions, {}, &RegionPreview::static_peak);
  if (farthest == preview.regions.end() || !farthest->has_vibration) {
    if (motion.reason.empty()) motion.reason = "its vibrations are not known";
    return motion;
  }
  told(farthest->settling.time, motion.settling, "it does not settle");
  told(farthest->animated.frequency, motion.frequency, "it does not ring");
  return motion;
}

}  // namespace

Result<SurfaceMotion> motion_of(Scene scene, const std::string& surface,
                                const SimulationOptions& options) {
  const auto found = std::ranges::find(scene.surfaces, surface, &Surface::name);
  if (found == scene.surfaces.end())
    return invalid(fmt::format("no surface is named {}", in_quotes(surface)));
  const auto index = static_cast<std::size_t>(found - scene.surfaces.begin());
  if (!found->enabled) return SurfaceMotion{.reason = "it is disabled"};
  // Of the others nothing is asked.
  for (Surface& other : scene.surfaces) other.enabled = other.enabled && other.name == surface;
  const auto simulation = Simulation::make(std::move(scene), options);
  if (!simulation) return fail(simulation.error());
  const auto previews = preview_forces(*simulation, options);
  if (!previews) return fail(previews.error());
  for (const Preview& preview : *previews) {
    if (preview.of == Preview::Of::All && preview.surface == index) return motion_in(preview);
  }
  return SurfaceMotion{.reason = "no force acts on it"};
}

std::vector<Operation> operations_for(const Suggestion& suggestion, const Scene& scene) {
  std::vector<Operation> operations;
  for (const SuggestedValue& value : suggestion.values) {
    const Channel<1>* const wanted = find_number(suggestion.scene, value.path);
    const Channel<1>* const present = find_number(scene, value.path);
    if (!wanted || (present && *wanted == *present)) continue;
    if (wanted->is_animated()) {
      operations.emplace_back(edit::SetCurve{value.path, wanted->curve().keys()});
    } else {
      operations.emplace_back(edit::Set{value.path, edit::to_text(wanted->at(0)[0])});
    }
  }
  return operations;
}

}  // namespace pliant::editor
