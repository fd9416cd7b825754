#include "pliant/feedback/preview_body.hpp"

#include <algorithm>
#include <limits>
#include <numeric>
#include <utility>
#include <variant>

#include "pliant/body/cycle.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/mesh/written/vertex_weights.hpp"
#include "pliant/region/closed_boxes.hpp"
#include "pliant/region/placed_nodes.hpp"
#include "pliant/region/triangles/level_set.hpp"

namespace pliant {

namespace {

constexpr int solves_with_contact = 10;  // in a step, about

}  // namespace

PreviewBody::PreviewBody(const RestShape& shape, const Surface& surface, double frame_seconds,
                         bool with_swings, RunContext context)
    : shape_(shape),
      surface_(surface),
      frame_seconds_(frame_seconds),
      with_swings_(with_swings),
      context_(std::move(context)),
      share_(context_.memory),
      response_(shape_, surface_, context_.memory) {}

Result<std::unique_ptr<Body>> PreviewBody::make(Reference reference) const {
  BodySettings settings = body_settings(surface_, shape_.grid.has_value());
  settings.reference = reference;
  return make_body(shape_, settings, SolverChoice::Auto, context_);
}

Result<void> PreviewBody::reserve() {
  if (real_) return {};
  // A field has three numbers per node; a body keeps five fields of all nodes, and four of the
  // solved ones.
  const bool has_two = surface_.solver.reference != Reference::Rest;
  const std::size_t bytes =
      static_cast<std::size_t>(node_count()) * 9 * 3 * sizeof(double) * (has_two ? 2 : 1);
  if (!share_.try_resize(bytes)) {
    return fail(ErrorCode::OutOfMemory, "previewing its forces " + share_.complaint(bytes));
  }
  auto real = make(surface_.solver.reference);
  if (!real) return fail(real.error());
  if (has_two) {
    auto plain = make(Reference::Rest);
    if (!plain) return fail(plain.error());
    plain_ = *std::move(plain);
  }
  real_ = *std::move(real);
  return {};
}

Result<void> PreviewBody::check_faults() const {
  std::string fault = faults_->first();
  if (fault.empty()) return {};
  return fail(ErrorCode::NotFinite, std::move(fault));
}

Result<const StepPlan*> PreviewBody::look(const BodyInputs& inputs, bool is_plain) {
  PLIANT_EXPECTS(real_ != nullptr);
  if (context_.is_stopped()) return interrupted();
  body(is_plain).reset();
  if (auto planned = plan(inputs, is_plain); !planned) return fail(planned.error());
  return &plan_;
}

Result<void> PreviewBody::plan(const BodyInputs& inputs, bool is_plain) {
  auto next = body(is_plain).look_again(inputs, std::exchange(plan_, {}));
  if (auto sound = check_faults(); !sound) return sound;
  if (!next) return fail(next.error());
  plan_ = *std::move(next);
  return {};
}

Result<void> PreviewBody::settle(BodyInputs inputs, bool is_plain) {
  PLIANT_EXPECTS(real_ != nullptr);
  inputs.dynamics = {0, 0};
  inputs.damping_ratio = {};
  inputs.dt = inputs.frame_length;
  begin(is_plain);
  is_at_rest_ = false;
  auto stepped = step(std::move(inputs));
  if (!stepped) return fail(stepped.error());
  return {};
}

void PreviewBody::begin(bool is_plain) {
  Body& now = body(is_plain);
  now.reset();
  current_ = &now;
  is_plain_ = is_plain;
  // Exact steps remember the loads before, also those that are 0.
  const bool remembers = surface_.solver.integrator == Integrator::Exact;
  is_at_rest_ = !remembers && (is_plain || pliant::is_plain(surface_));
}

Result<double> PreviewBody::step(BodyInputs inputs) {
  if (is_plain_) inputs.tangents = {};
  const bool is_still = is_at_rest_;
  is_at_rest_ = is_at_rest_ && inputs.colliders.empty() &&
                std::all_of(inputs.forces.begin(), inputs.forces.end(),
                            [](const SampledForce& force) { return force.magnitude == 0; });
  if (is_at_rest_) return 0.0;
  if (is_still && inputs.colliders.empty()) {
    if (auto planned = plan(inputs, is_plain_); !planned) return fail(planned.error());
    if (has_no_load(plan_)) {
      is_at_rest_ = true;
      return least_cost();
    }
  }
  const auto stepped = body(is_plain_).step(inputs);
  if (auto sound = check_faults(); !sound) return fail(sound.error());
  if (!stepped) return fail(stepped.error());
  const StepPlan& plan = body(is_plain_).last_step();
  // Exact ones are divided further.
  const int solves = plan.steps.count * (plan.steps.are_exact() ? 24 : 1) *
                     (inputs.colliders.empty() ? 1 : solves_with_contact);
  return least_cost() + static_cast<double>(plan.unknown_count()) * solves;
}

Result<std::optional<std::vector<double>>> PreviewBody::response_peaks(
    std::span<const FrameToPlay> frames) {
  auto peaks = response_.peaks(body(is_plain_), plan_, frames);
  if (auto sound = check_faults(); !sound) return fail(sound.error());
  return peaks;
}

Result<void> PreviewBody::begin_cycle(int frames, const std::function<Result<void>(int)>& advance) {
  is_at_rest_ = false;
  auto found = find_cycle(body(is_plain_), {.frames = frames,
                                            .frame_time = frame_seconds_,
                                            .memory = context_.memory,
                                            .advance = advance});
  if (!found) return fail(found.error());
  cycle_ = *std::move(found);
  return_to_cycle();
  return {};
}

void PreviewBody::return_to_cycle() { body(is_plain_).restore(cycle_); }

Field PreviewBody::displacements(std::span<const int> nodes) const {
  Field ways(static_cast<Eigen::Index>(nodes.size()), 3);
  for (std::size_t k = 0; k < nodes.size(); ++k) {
    ways.row(static_cast<Eigen::Index>(k)) =
        current_->state().positions.row(nodes[k]) - current_->rest().row(nodes[k]);
  }
  return ways;
}

PreviewBody::Peak PreviewBody::peak(const Transform& transform) const {
  const Field ways = vectors_to_world(transform, current_->state().positions - current_->rest());
  const LongestVector longest = longest_vector(ways);
  return {longest.length, ways.row(longest.row).transpose(), static_cast<int>(longest.row)};
}

Vector3d PreviewBody::displacement(const Transform& transform, int node) const {
  return transform.linear *
         (current_->state().positions.row(node) - current_->rest().row(node)).transpose();
}

double PreviewBody::shown_peak(const Transform& transform) const {
  if (!shape_.weights) return peak(transform).size;
  const Field ways = shape_.weights->apply(current_->state().positions - current_->rest());
  return longest_vector(vectors_to_world(transform, ways)).length;
}

std::pair<double, double> PreviewBody::distances(const BodyInputs& inputs,
                                                 const SampledForce& force) const {
  const Field nodes = to_world(inputs.transform, inputs.shape ? *inputs.shape : shape_.rest);
  std::vector<int> all(static_cast<std::size_t>(nodes.rows()));
  std::iota(all.begin(), all.end(), 0);
  double nearest = std::numeric_limits<double>::infinity();
  for (const double each : PlacedNodes(nodes).distances(all, force.kind))
    nearest = std::min(nearest, each);
  const Vector3d middle =
      0.5 * (nodes.colwise().minCoeff() + nodes.colwise().maxCoeff()).transpose();
  return {nearest, distance(force.kind, middle)};
}

std::vector<std::size_t> PreviewBody::selecting(const BodyInputs& inputs,
                                                const StepPlan& plan) const {
  if (plan.is_whole) return {};
  if (plan.surface) return deepest_at_nodes(inputs, plan.surface->level_set);
  // A box inside another one adds nothing.
  std::vector<std::size_t> found;
  const std::vector<ForceSelection>& forces = plan.selection.forces;
  for (std::size_t k = 0; k < forces.size(); ++k) {
    const Box& box = forces[k].deformation;
    const bool is_inside = box.is_empty() || std::ranges::any_of(found, [&](std::size_t other) {
                             return holds(plan.selection.grid, forces[other].deformation, box);
                           });
    if (!is_inside) found.push_back(k);
  }
  return found;
}

// Of each node of a level set the first force that makes it what it is there.
std::vector<std::size_t> PreviewBody::deepest_at_nodes(const BodyInputs& inputs,
                                                       const LevelSet& level_set) const {
  const PlacedNodes nodes(inputs.shape ? *inputs.shape : shape_.rest, inputs.transform);
  std::vector<double> most(level_set.nodes.size(), -std::numeric_limits<double>::infinity());
  std::vector<std::size_t> found(level_set.nodes.size(), 0);
  std::vector<double> depths;
  for (std::size_t k = 0; k < inputs.forces.size(); ++k) {
    if (!inputs.selectors.empty() && inputs.selectors[k] != static_cast<int>(k)) continue;
    const SampledForce& force = inputs.forces[k];
    depths =
        depths_of(nodes, level_set.nodes, force.kind, force.deformation_radius, std::move(depths));
    for (std::size_t n = 0; n < depths.size(); ++n) {
      if (!(depths[n] > most[n])) continue;
      most[n] = depths[n];
      found[n] = k;
    }
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

SingleForces::SingleForces(const BodyInputs& inputs, std::vector<std::size_t> selecting)
    : inputs_(inputs), none_(inputs), selecting_(std::move(selecting)) {
  none_.forces.clear();
  none_.selectors.clear();
}

BodyInputs SingleForces::of(std::size_t k) const {
  std::vector<std::size_t> kept = selecting_;
  const auto place_of = [&](std::size_t force) {
    const auto found = std::find(kept.begin(), kept.end(), force);
    const auto place = static_cast<std::size_t>(found - kept.begin());
    if (found == kept.end()) kept.push_back(force);
    return place;
  };
  const std::size_t own = place_of(k);
  const std::size_t selector =
      inputs_.selectors.empty() ? own : place_of(static_cast<std::size_t>(inputs_.selectors[k]));
  BodyInputs alone = none_;
  for (const std::size_t force : kept) {
    alone.selectors.push_back(static_cast<int>(alone.forces.size()));
    alone.forces.push_back(inputs_.forces[force]);
    if (force != k) alone.forces.back().magnitude = 0;
  }
  alone.selectors[own] = static_cast<int>(selector);
  return alone;
}

bool is_plain(const Surface& surface) {
  const auto& [su0, su1, sv0, sv1] = surface.tangents;
  const auto is_zero = [](const TangentChannel& tangent) {
    return std::visit(
        [](const auto& one) { return !one.is_animated() && one.at(0) == decltype(one.at(0)){}; },
        tangent);
  };
  return surface.solver.reference == Reference::Rest && is_zero(su0) && is_zero(su1) &&
         is_zero(sv0) && is_zero(sv1);
}

bool has_no_load(const StepPlan& plan) {
  return plan.surface &&
         std::ranges::all_of(plan.surface->loads, [](const Field& load) { return load.isZero(0); });
}

std::vector<RegionPreview> regions_of(const StepPlan& plan) {
  std::vector<RegionPreview> regions;
  for (const Region& selected : plan.selection.regions) {
    RegionPreview& region = regions.emplace_back();
    region.region = selected;
    region.is_solvable = selected.is_solved();
  }
  if (!plan.surface) return regions;
  for (const TrianglePatch& patch : plan.surface->patches) {
    RegionPreview& region = regions.emplace_back();
    region.counts = patch.counts(plan.surface->level_set);
    region.is_solvable = patch.moves();
  }
  return regions;
}

}  // namespace pliant
