#include "viewer/telling_frames.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>
#include <set>
#include <utility>

namespace pliant::viewer {

void CourseFollower::add(const Frame& frame, const std::vector<const Field*>& rest) {
  const auto surfaces = frame.surfaces();
  before_.resize(surfaces.size());
  steps_.resize(surfaces.size());
  double farthest = 0;
  double square = 0;
  double turn = 0;  // at the frame before
  for (std::size_t k = 0; k < surfaces.size(); ++k) {
    const SurfaceFrame& surface = surfaces[k];
    farthest = std::max(farthest, surface.told_displacement());
    const Field& at_rest = surface.object_rest().rows() > 0 ? surface.object_rest() : *rest[k];
    Field displacement =
        (surface.object_positions() - at_rest) * surface.transform().linear.transpose();
    if (before_[k].rows() > 0) {
      Field step = displacement - before_[k];
      square += step.squaredNorm();
      if (steps_[k].rows() > 0) turn += steps_[k].cwiseProduct(step).sum();
      steps_[k] = std::move(step);
    }
    before_[k] = std::move(displacement);
  }
  if (!course_.turns.empty()) course_.turns.back() = turn;
  course_.displaced.push_back(farthest);
  course_.steps.push_back(std::sqrt(square));
  course_.turns.push_back(0);
}

std::vector<int> telling_frames(const MotionCourse& course, int most) {
  const std::vector<double>& displaced = course.displaced;
  const int count = static_cast<int>(displaced.size());
  std::vector<int> all(displaced.size());
  std::iota(all.begin(), all.end(), 0);
  if (count <= most) return all;

  const auto peak = std::max_element(displaced.begin(), displaced.end());
  std::set<int> chosen = {0, count - 1, static_cast<int>(peak - displaced.begin())};
  const auto size = [&] { return static_cast<int>(chosen.size()); };
  std::vector<int> marks = {0};
  for (int k = 1; k + 1 < count; ++k) {
    const bool is_peak = displaced[k] > displaced[k - 1] && displaced[k] >= displaced[k + 1];
    if (is_peak || course.turns[k] < 0) marks.push_back(k);
  }
  marks.push_back(count - 1);
  std::vector<double> ways(displaced.size());  // up to each frame
  std::partial_sum(course.steps.begin(), course.steps.end(), ways.begin());
  std::vector<std::pair<double, int>> ranked;  // by the longer of the ways to the marks beside it
  for (std::size_t n = 1; n + 1 < marks.size(); ++n) {
    const double before = ways[marks[n]] - ways[marks[n - 1]];
    const double after = ways[marks[n + 1]] - ways[marks[n]];
    ranked.emplace_back(std::max(before, after), marks[n]);
  }
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  // At least a third of the way between frames that were spread evenly.
  const int apart = std::max(2, count / (3 * most));
  for (const auto& [way, candidate] : ranked) {
    // What is left of a motion that comes to rest is too small to see.
    if (size() >= most || way < ranked.front().first / 1000) break;
    if (std::none_of(chosen.begin(), chosen.end(),
                     [&, at = candidate](int other) { return std::abs(other - at) < apart; }))
      chosen.insert(candidate);
  }
  while (size() < most) {
    auto widest = chosen.begin();
    for (auto left = widest; std::next(left) != chosen.end(); ++left) {
      if (*std::next(left) - *left > *std::next(widest) - *widest) widest = left;
    }
    chosen.insert((*widest + *std::next(widest)) / 2);
  }
  return {chosen.begin(), chosen.end()};
}

}  // namespace pliant::viewer
