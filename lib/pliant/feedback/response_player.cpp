#include "pliant/feedback/response_player.hpp"

#include <algorithm>
#include <utility>

#include "pliant/mesh/written/vertex_weights.hpp"
#include "pliant/plate/swing.hpp"

namespace pliant {
namespace {

constexpr Eigen::Index least_nodes = 3000;  // of smaller surfaces steps take no time
constexpr Eigen::Index most_patterns = 3;   // that a solve is for
constexpr int most_shapes = 120;

}  // namespace

ResponsePlayer::ResponsePlayer(const RestShape& shape, const Surface& surface, MemoryBudget* memory)
    : shape_(shape), surface_(surface), share_(memory) {}

// Takes the load as a sum of the patterns, and what it has beyond them as another one. False: there
// are too many.
bool ResponsePlayer::add_patterns(Patch& patch, const Field& load) {
  constexpr double rounding = 1e-9;
  Eigen::MatrixXd& patterns = patch.patterns;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const Eigen::VectorXd left = load.col(k) - patterns * (patterns.transpose() * load.col(k));
    if (!(left.norm() > rounding * load.norm())) continue;
    if (patterns.cols() == most_patterns) return false;
    patterns.conservativeResize(Eigen::NoChange, patterns.cols() + 1);
    patterns.rightCols(1) = left.normalized();
    patch.space.reset();
  }
  return true;
}

bool ResponsePlayer::is_for_surface() const {
  return shape_.surface && !shape_.factors && !shape_.animation &&
         shape_.rest.rows() >= least_nodes && surface_.solver.integrator != Integrator::Exact;
}

bool ResponsePlayer::has_patches(const BodyInputs& inputs, const StepPlan& plan) const {
  return inputs.stiffness == stiffness_ && inputs.poisson == poisson_ && inputs.goal == goal_ &&
         plan.surface->level_set == level_set_;
}

// The memory of all shapes. False: there is less.
bool ResponsePlayer::reserve() {
  constexpr std::size_t most_numbers = most_shapes + 6 * most_patterns;
  std::size_t bytes = 0;
  for (const Patch& patch : patches_) bytes += patch.nodes.size() * most_numbers * sizeof(double);
  return share_.try_resize(bytes);
}

ResponsePlayer::Patch* ResponsePlayer::patch_of(const Body& body, const BodyInputs& inputs,
                                                const StepPlan& plan, std::size_t k) {
  if (!is_for_surface()) return nullptr;
  const TriangleSelection& selection = *plan.surface;
  if (!selection.patches[k].moves() || !selection.patches[k].is_held()) return nullptr;
  if (!has_patches(inputs, plan)) begin(body, inputs, plan);
  if (!reserve()) return nullptr;
  const auto moves = [](const TrianglePatch& patch) { return patch.moves(); };
  const auto end = selection.patches.begin() + static_cast<std::ptrdiff_t>(k);
  Patch& patch =
      patches_[static_cast<std::size_t>(std::count_if(selection.patches.begin(), end, moves))];
  const Field load = vectors_to_object(inputs.transform, selection.loads[k]);
  const Eigen::Index known = patch.patterns.cols();
  if (!add_patterns(patch, load) || (known > 0 && patch.patterns.cols() > known)) {
    patch.patterns.resize(Eigen::NoChange, 0);
    patch.space.reset();
    add_patterns(patch, load);
  }
  return &patch;
}

Result<ResponseSpace*> ResponsePlayer::space_of(Patch& patch) {
  // Another shift may have been tried since.
  auto plate = patch.plate->vibrating();
  if (!plate) return fail(plate.error());
  if (!patch.space) patch.space.emplace(*std::move(plate), patch.patterns);
  return &*patch.space;
}

void ResponsePlayer::begin(const Body& body, const BodyInputs& inputs, const StepPlan& plan) {
  stiffness_ = inputs.stiffness;
  poisson_ = inputs.poisson;
  goal_ = inputs.goal;
  level_set_ = plan.surface->level_set;
  patches_.clear();
  for (std::size_t k = 0; k < plan.surface->patches.size(); ++k) {
    if (!plan.surface->patches[k].moves()) continue;
    Patch& own = patches_.emplace_back();
    own.nodes = std::move(body.moved_patches(plan, k)[0].nodes);
    own.plate = body.plate_of(inputs, plan, k, 0);
    own.patterns.resize(static_cast<Eigen::Index>(own.nodes.size()), 0);
  }
}

// Takes the loads of the plan, of these inputs. False: they are too many.
Result<bool> ResponsePlayer::add(const BodyInputs& inputs, const StepPlan& plan) {
  const TriangleSelection& selection = *plan.surface;
  std::size_t place = 0;
  for (std::size_t k = 0; k < selection.patches.size(); ++k) {
    if (!selection.patches[k].moves()) continue;
    Patch& patch = patches_[place++];
    Dynamics dynamics = inputs.dynamics;
    if (inputs.asks_for_vibrations()) {
      if (!patch.lambda) {
        const auto lambda = patch.plate->smallest_eigenvalue();
        if (!lambda) return fail(lambda.error());
        patch.lambda = *lambda;
      }
      dynamics = damped_by_ratio(dynamics, *inputs.damping_ratio, *patch.lambda);
    }
    const Field load = vectors_to_object(inputs.transform, selection.loads[k]);
    if (!add_patterns(patch, load)) return false;
    patch.frames.push_back({patch.patterns.transpose() * load, dynamics, plan.steps});
  }
  return true;
}

// Finds what the frames of a patch make of it. False: not with a third of the solves of its steps.
Result<bool> ResponsePlayer::respond(Patch& patch, int steps) {
  patch.parts.clear();
  if (patch.patterns.cols() == 0) return true;  // nothing moves it
  const auto space = space_of(patch);
  if (!space) return fail(space.error());
  for (LoadedFrame& frame : patch.frames)
    frame.load.conservativeResizeLike(Field::Zero(patch.patterns.cols(), 3));
  const Eigen::Index before = (*space)->shape_count();
  const auto most = std::min<Eigen::Index>(most_shapes, patch.patterns.cols() * (steps / 3));
  auto parts = (*space)->play(patch.frames, most);
  if (!parts) return fail(parts.error());
  const auto solves = ((*space)->shape_count() - before) / patch.patterns.cols();
  cost_ += static_cast<double>(solves) * static_cast<double>(patch.nodes.size());
  if (!*parts) return false;
  patch.parts = **std::move(parts);
  return true;
}

Result<std::optional<std::vector<double>>> ResponsePlayer::peaks(
    const Body& body, StepPlan& plan, std::span<const FrameToPlay> frames) {
  using Peaks = std::optional<std::vector<double>>;
  cost_ = 0;
  if (!is_for_surface() || frames.empty()) return Peaks();
  bool has_patterns = false;  // of an animation before
  for (Patch& patch : patches_) {
    has_patterns = has_patterns || patch.patterns.cols() > 0;
    patch.frames.clear();
  }
  int steps = 0;
  for (const auto& [inputs, after] : frames) {
    auto next = body.look_again(inputs, std::exchange(plan, {}));
    if (!next) return fail(next.error());
    plan = *std::move(next);
    if (!plan.is_held() || !plan.solves()) return Peaks();
    if (!has_patches(inputs, plan)) {
      if (steps > 0) return Peaks();
      begin(body, inputs, plan);
    }
    steps += plan.steps.count;
    const auto added = add(inputs, plan);
    if (!added) return fail(added.error());
    if (!*added) {
      patches_.clear();
      level_set_ = {};
      return has_patterns ? peaks(body, plan, frames) : Peaks();
    }
  }
  if (!reserve()) return Peaks();
  for (Patch& patch : patches_) {
    const auto found = respond(patch, steps);
    if (!found) return fail(found.error());
    if (!*found) return Peaks();
  }
  std::vector<double> found;
  Field ways = Field::Zero(shape_.rest.rows(), 3);
  constexpr std::size_t at_once = 16;
  std::vector<std::vector<Field>> of_patches(patches_.size());
  for (std::size_t k = 0; k < frames.size(); ++k) {
    for (std::size_t n = 0; n < patches_.size(); ++n) {
      const Patch& patch = patches_[n];
      if (patch.parts.empty()) continue;  // nothing moves it
      if (k % at_once == 0) {
        const std::span parts(patch.parts);
        of_patches[n] =
            patch.space->displacements(parts.subspan(k, std::min(at_once, parts.size() - k)));
      }
      ways(patch.nodes, Eigen::all) = of_patches[n][k % at_once];
    }
    const Field shown = shape_.weights ? shape_.weights->apply(ways) : ways;
    found.push_back(longest_vector(vectors_to_world(frames[k].after, shown)).length);
  }
  return Peaks(std::move(found));
}

}  // namespace pliant
