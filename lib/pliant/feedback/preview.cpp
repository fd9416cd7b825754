#include "pliant/feedback/preview.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/feedback/surface_previewer.hpp"

namespace pliant {
namespace {

// Whether all forces together are the single force of the first case, so that one preview is both.
bool is_single(const std::vector<PreviewCase>& cases, const Surface& surface) {
  return cases.size() == 2 && cases.front().preview.of == Preview::Of::Force &&
         cases.back().preview.of == Preview::Of::All &&
         cases.front().acting.acts_as(cases.back().acting) && is_plain(surface);
}

// The preview of all forces, of which there is one.
Preview together(const Preview& alone) {
  Preview all = alone;
  all.of = Preview::Of::All;
  all.index = 0;
  all.largest_magnitude = all.magnitude = 0;
  all.largest_magnitude_frame = 0;
  all.gap.reset();
  if (all.static_peak > 0) all.shares = {{alone.index, 1}};
  return all;
}

// The case of all forces on a surface, if they act at some frame.
std::optional<PreviewCase> find_case(const Scene& scene, const RestShape& shape,
                                     std::size_t surface) {
  if (!scene.surfaces[surface].enabled || scene.surfaces[surface].is_driven()) return {};
  auto cases = cases_of(scene, shape, surface);
  PreviewCase* const all = find_together(cases);
  if (!all || !has_frames(*all, scene)) return {};
  return std::move(*all);
}

}  // namespace

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
    const bool is_one = is_single(cases[k], scene.surfaces[k]);
    if (is_one) cases[k].pop_back();
    for (PreviewCase& one : cases[k]) {
      if (auto looked = previewer.look(one); !looked) return fail(looked.error());
    }
    // Each surface has its part of the steps; unused steps are for the next ones. `All` is played
    // first, since that is the animation. A cycle is not: that may take a thousand rounds.
    double part = nodes_left / (surfaces - static_cast<double>(k));
    nodes_left -= part;
    std::vector<PreviewCase*> order = {&cases[k].back()};
    for (std::size_t one = 0; one + 1 < cases[k].size(); ++one) order.push_back(&cases[k][one]);
    for (PreviewCase* const one : order) {
      if (scene.surfaces[k].solver.loop) break;
      if (auto played = previewer.play(*one, part); !played) return fail(played.error());
    }
    nodes_left += std::max(0.0, part);
    for (PreviewCase& one : cases[k]) previews.push_back(std::move(one.preview));
    if (is_one) previews.push_back(together(previews.back()));
  }
  return previews;
}

Result<std::optional<Preview>> preview_slowest(const Scene& scene, const RestShape& shape,
                                               std::size_t surface, const RunContext& context) {
  auto all = find_case(scene, shape, surface);
  if (!all) return std::optional<Preview>();
  SurfacePreviewer previewer(scene, scene.surfaces[surface], shape, searched_nodes, context,
                             PreviewDepth::Slowest);
  if (auto looked = previewer.look(*all); !looked) return fail(looked.error());
  return std::optional(std::move(all->preview));
}

Result<PlayedPeak> play_forces(const Scene& scene, const RestShape& shape, std::size_t surface,
                               double until, const RunContext& context) {
  auto all = find_case(scene, shape, surface);
  if (!all) return PlayedPeak{0, scene.start};
  SurfacePreviewer previewer(scene, scene.surfaces[surface], shape, searched_nodes, context);
  double nodes_left = std::numeric_limits<double>::infinity();
  if (auto played = previewer.play(*all, nodes_left, until); !played) return fail(played.error());
  if (!all->preview.played) return fail(ErrorCode::SolverFailed, all->open_cycle);
  return *all->preview.played;
}

}  // namespace pliant
