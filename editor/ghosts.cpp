#include "editor/ghosts.hpp"

#include <algorithm>
#include <utility>

#include "pliant/core/result.hpp"

namespace pliant::editor {
namespace {

using namespace std::chrono_literals;

constexpr auto idle = 30s;  // without a question

}  // namespace

Ghosts::Ghosts(FrameSolver& present, SimulationOptions simulation)
    : present_(present), simulation_(std::move(simulation)) {
  simulation_.threads = 1;
  simulation_.max_memory = present_.lendable() / most;
}

const Ghost* Ghosts::find(std::int64_t take) {
  const auto found = std::ranges::find(ghosts_, take, &Ghost::take);
  if (found == ghosts_.end()) return nullptr;
  found->asked = Clock::now();
  return &*found;
}

const Ghost& Ghosts::begin(std::int64_t take, Scene scene) {
  if (ghosts_.size() >= most) end(std::ranges::min_element(ghosts_, {}, &Ghost::asked)->take);
  present_.lend(true);
  ghosts_.push_back({.take = take,
                     .frames = {scene.start, scene.end},
                     .asked = Clock::now(),
                     .solver = std::make_unique<FrameSolver>(FrameSolver::Options{
                         .simulation = simulation_, .notify = [] {}, .leader = &present_})});
  ghosts_.back().solver->take(Ghost::revision, std::move(scene));
  return ghosts_.back();
}

template <class Ends>
void Ghosts::end_if(const Ends& ends) {
  const auto is_over = [&](const Ghost& ghost) {
    if (!ends(ghost)) return false;
    ghost.solver->refuse(Ghost::revision + 1, {});  // what waits is answered
    return true;
  };
  if (std::erase_if(ghosts_, is_over) > 0 && ghosts_.empty()) present_.lend(false);
}

void Ghosts::end(std::int64_t take) {
  end_if([&](const Ghost& ghost) { return ghost.take == take; });
}

void Ghosts::end_all() {
  end_if([](const Ghost&) { return true; });
}

void Ghosts::end_idle(Clock::time_point now) {
  end_if([&](const Ghost& ghost) { return now - ghost.asked >= idle; });
}

std::shared_ptr<const std::string> Ghosts::shape(const std::string& key) const {
  for (const Ghost& ghost : ghosts_)
    if (auto shape = ghost.solver->shape(key)) return shape;
  return nullptr;
}

}  // namespace pliant::editor
