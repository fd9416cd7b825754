#include "pliant/feedback/preview.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/feedback/surface_previewer.hpp"

namespace pliant {
Result<std::vector<Preview>> preview_forces(const Scene& scene,
                                            std::span<const RestShape> rest_shapes,
                                            const RunContext& context) {
  PLIANT_EXPECTS(rest_shapes.size() == scene.surfaces.size());
  std::vector<std::vector<PreviewCase>> cases;
  std::size_t count = 0;
  for (std::size_t k = 0; k < scene.surfaces.size(); ++k) {
    cases.emplace_back();
    if (!scene.surfaces[k].enabled || scene.surfaces[k].is_driven()) continue;
    for (PreviewCase& one : cases_of(scene, rest_shapes[k], k)) {
      if (has_frames(one, scene)) cases[k].push_back(std::move(one));
    }
    count += cases[k].size();
  }
  double nodes_left = played_nodes;
  const double surfaces = static_cast<double>(scene.surfaces.size());
  std::vector<Preview> previews;
  for (std::size_t k = 0; k < cases.size(); ++k) {
    if (cases[k].empty()) continue;
    SurfacePreviewer previewer(scene, scene.surfaces[k], rest_shapes[k],
                               searched_nodes / static_cast<double>(count), context);
    for (PreviewCase& one : cases[k]) {
      if (auto looked = previewer.look(one); !looked) return fail(looked.error());
    }
    // Each surface has its part of the steps; unused steps are for the next ones. `All` is played
    // first, since that is the animation.
    double part = nodes_left / (surfaces - static_cast<double>(k));
    nodes_left -= part;
    std::vector<PreviewCase*> order = {&cases[k].back()};
    for (std::size_t one = 0; one + 1 < cases[k].size(); ++one) order.push_back(&cases[k][one]);
    for (PreviewCase* const one : order) {
      if (auto played = previewer.play(*one, part); !played) return fail(played.error());
    }
    nodes_left += std::max(0.0, part);
    for (PreviewCase& one : cases[k]) previews.push_back(std::move(one.preview));
  }
  return previews;
}

}  // namespace pliant
