#include "pliant/feedback/suggestion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/expects.hpp"
#include "pliant/feedback/motion_search.hpp"
#include "pliant/feedback/peak_search.hpp"
#include "pliant/feedback/scaled_channel.hpp"
#include "pliant/feedback/suggestion_subject.hpp"
#include "pliant/feedback/surface_previewer.hpp"

namespace pliant {
namespace {

constexpr int most_plays = 24;  // in all
constexpr int most_plays_of_a_round = 12;
constexpr int most_rounds = 4;
constexpr const char* not_held = "nothing holds it, so it has no place to settle";
constexpr double good_miss = 2e-3;  // more rounds do not help beyond rounding

Result<void> check_goals(const MotionGoals& goals) {
  if (!goals.peak && !goals.settling && !goals.frequency) {
    return invalid("no goal is given: a peak, a time to settle or a frequency is required");
  }
  const auto check = [](std::string_view what, std::optional<double> goal) -> Result<void> {
    if (!goal || (*goal > 0 && *goal < 1e100)) return {};
    return invalid(
        fmt::format("{} {}: must be a number greater than 0 and less than 1e100", what, *goal));
  };
  for (const auto& [what, goal] :
       {std::pair{"the peak", goals.peak}, std::pair{"the time to settle", goals.settling},
        std::pair{"the frequency", goals.frequency}}) {
    if (auto sound = check(what, goal); !sound) return sound;
  }
  return {};
}

// Changes a scene until its preview meets the goals.
class Suggester {
 public:
  Suggester(const Scene& scene, std::span<const RestShape> rest_shapes, const MotionGoals& goals,
            Subject subject, const RunContext& context)
      : original_(scene),
        scene_(scene),
        shape_(rest_shapes[subject.surface]),
        goals_(goals),
        subject_(std::move(subject)),
        previewer_(scene_, scene_.surfaces[subject_.surface], shape_, searched_nodes, context) {}

  Result<Suggestion> suggest() {
    now_.emplace(new_case());
    if (auto looked = previewer_.look(*now_); !looked) return fail(looked.error());
    for (const std::size_t force : now_->acting.forces()) {
      if (is_ever_enabled(now_->acting, force)) subject_.forces.push_back(force);
    }
    // With other goals the animation of the scene as it is tells nothing of the one that is wanted.
    const bool is_peak_alone = goals_.peak && !goals_.settling && !goals_.frequency;
    if (is_peak_alone || (goals_.peak && now_->preview.static_peak == 0)) {
      if (auto played = play(*now_); !played) return fail(played.error());
    }
    const Preview before = now_->preview;
    magnitudes_ = magnitudes();
    if (goals_.peak) {
      if (auto started = start_with_one(); !started) return fail(started.error());
    }
    Suggestion best;
    for (int round = 0; round < most_rounds; ++round) {
      settling_miss_ = frequency_miss_ = peak_miss_ = {};
      if (goals_.settling || goals_.frequency) {
        if (auto chosen = choose_material(); !chosen) return fail(chosen.error());
      }
      if (goals_.peak) {
        if (auto chosen = choose_magnitudes(); !chosen) return fail(chosen.error());
      }
      if (auto looked = look(); !looked) return fail(looked.error());
      if (goals_.peak) {
        if (auto played = play(*now_); !played) return fail(played.error());
      }
      Suggestion one = told(*now_);
      if (round == 0 || worst_miss(one) < worst_miss(best)) best = std::move(one);
      if (worst_miss(best) <= good_miss || is_explained()) break;
      if (plays_ + 2 > most_plays) break;  // a round has two at least
    }
    best.before = before;
    return best;
  }

 private:
  const Surface& surface() const { return scene_.surfaces[subject_.surface]; }
  MaterialChannels& material() { return scene_.surfaces[subject_.surface].material; }
  const MaterialChannels& first_material() const {
    return original_.surfaces[subject_.surface].material;
  }
  static const Channel<1>& damping_of(const MaterialChannels& material) {
    return material.damping_ratio ? *material.damping_ratio : material.damping;
  }

  PreviewCase new_case() const {
    auto cases = cases_of(scene_, shape_, subject_.surface);
    const auto found = std::find_if(cases.begin(), cases.end(), [&](const PreviewCase& one) {
      return one.preview.of == subject_.of && one.preview.index == subject_.index;
    });
    PLIANT_EXPECTS(found != cases.end());
    return std::move(*found);
  }

  // Previews the present scene, if it is not that of the preview.
  Result<void> look() {
    if (is_seen_) return {};
    PreviewCase next = new_case();
    auto looked =
        changes_in_proportion() ? previewer_.look_again(next, *now_) : previewer_.look(next);
    if (!looked) return looked;
    now_.emplace(std::move(next));
    is_seen_ = true;
    return {};
  }

  // Whether one factor is all that can happen to the loads: density changes those of inertia only.
  bool changes_in_proportion() const {
    const auto is_inertia = [&](std::size_t force) {
      return std::holds_alternative<InertiaChannels>(scene_.forces[force].kind);
    };
    const auto count = std::ranges::count_if(subject_.forces, is_inertia);
    const bool is_mixed = count > 0 && static_cast<std::size_t>(count) < subject_.forces.size();
    return !is_mixed || !goals_.frequency;
  }

  // The scene was changed by more than a factor of its magnitudes.
  void forget() {
    played_.clear();
    is_seen_ = false;
  }

  // Plays the present scene, unless it was.
  Result<void> play(PreviewCase& one) {
    const auto known = std::ranges::find(played_, factor_, &Played::factor);
    if (known != played_.end()) {
      one.preview.played = known->peak;
      one.open_cycle = known->open_cycle;
      return {};
    }
    if (const auto peak = peak_in_proportion(one)) {
      one.preview.played = peak;
      return {};
    }
    ++plays_;
    double nodes_left = std::numeric_limits<double>::infinity();
    if (auto played = previewer_.play(one, nodes_left); !played) return played;
    played_.push_back({factor_, one.preview.played, one.open_cycle, constants()});
    return {};
  }

  // The magnitudes; empty: one has keys.
  std::vector<double> constants() const {
    std::vector<double> all;
    for (const std::size_t force : subject_.forces) {
      const Channel<1>& magnitude = scene_.forces[force].magnitude;
      if (magnitude.is_animated()) return {};
      all.push_back(magnitude.at(0)[0]);
    }
    return all;
  }

  // Where nothing but a factor of all loads differs from an animation that was played, so does the
  // peak. Rounded keys do not all have the same factor.
  std::optional<PlayedPeak> peak_in_proportion(const PreviewCase& one) const {
    const std::vector<double> now = constants();
    if (now.empty() || !previewer_.plays_in_proportion(one)) return {};
    for (const Played& known : played_) {
      if (!known.peak || known.constants.empty()) continue;
      const auto largest = std::ranges::max_element(
          now, [](double a, double b) { return std::abs(a) < std::abs(b); });
      const double then = known.constants[static_cast<std::size_t>(largest - now.begin())];
      const double factor = then != 0 ? *largest / then : 0;
      const auto has_factor = [&](double a, double b) {
        return std::abs(a - factor * b) <= 1e-12 * std::abs(*largest);
      };
      const double peak = std::abs(factor) * known.peak->peak;
      if (factor > 0 && std::ranges::equal(now, known.constants, has_factor) &&
          !previewer_.is_hidden_by_rounding(std::min(peak, known.peak->peak)))
        return PlayedPeak{peak, known.peak->frame};
    }
    return {};
  }

  bool is_ever_enabled(const ActingForces& acting, std::size_t force) const {
    for (int frame = first_solved_frame(scene_, surface()); frame <= scene_.end; ++frame) {
      if (is_solved_at(scene_, surface(), frame) && acting.is_enabled(force, frame)) return true;
    }
    return false;
  }

  // If nothing moves, the response to 1 is examined, of the forces with a constant 0 that push.
  Result<void> start_with_one() {
    const auto is_resting = [&](std::size_t force) {
      const Channel<1>& magnitude = scene_.forces[force].magnitude;
      return !magnitude.is_animated() && magnitude.at(0)[0] == 0;
    };
    const Preview& before = now_->preview;
    if (before.static_peak > 0 || (before.played && before.played->peak > 0)) return {};
    // Of what is too large for a preview, only the magnitudes tell whether it moves.
    if (!before.is_solved && !std::ranges::all_of(subject_.forces, is_resting)) return {};
    std::vector<std::size_t> pushing;
    for (const std::size_t force : subject_.forces) {
      if (!is_resting(force)) continue;
      scene_.forces[force].magnitude = 1.0;
      PreviewCase one = new_case();
      if (auto looked = previewer_.look(one); !looked) return looked;
      if (!one.preview.is_solved || one.preview.static_peak > 0) pushing.push_back(force);
      scene_.forces[force].magnitude = 0.0;
    }
    if (pushing.empty()) return {};
    for (const std::size_t force : pushing) scene_.forces[force].magnitude = 1.0;
    magnitudes_ = magnitudes();
    forget();
    now_.emplace(new_case());
    is_seen_ = true;
    return previewer_.look(*now_);
  }

  std::vector<Channel<1>> magnitudes() const {
    std::vector<Channel<1>> all;
    for (const std::size_t force : subject_.forces) all.push_back(scene_.forces[force].magnitude);
    return all;
  }

  // The magnitudes at the beginning, times a factor.
  Result<void> set_magnitudes(double factor) {
    factor_ = factor;
    is_seen_ = false;
    for (std::size_t k = 0; k < subject_.forces.size(); ++k) {
      auto magnitude =
          factor == 1 ? Result<Channel<1>>(magnitudes_[k]) : scaled(magnitudes_[k], factor);
      if (!magnitude) return fail(magnitude.error());
      scene_.forces[subject_.forces[k]].magnitude = *std::move(magnitude);
    }
    return {};
  }

  static bool shows_motion(const RegionPreview& region) {
    return region.has_vibration || region.animated.frequency > 0;
  }

  // The region whose peak is that of all.
  static std::size_t region_of(const PreviewCase& one) {
    const auto& regions = one.preview.regions;
    const auto most = std::max_element(regions.begin(), regions.end(),
                                       [](const RegionPreview& a, const RegionPreview& b) {
                                         if (shows_motion(a) != shows_motion(b))
                                           return shows_motion(b);
                                         return a.static_peak < b.static_peak;
                                       });
    return static_cast<std::size_t>(most - regions.begin());
  }

  // Why the motion of the case is not known.
  Miss no_motion(const PreviewCase& one) const {
    const Preview& preview = one.preview;
    if (!preview.frame || !preview.is_solvable) return nothing_moves(one);
    if (preview.is_held && !preview.is_solved)
      return {Obstacle::TooLarge, "it has too many nodes for a preview"};
    if (one.motions[region_of(one)]) return {};
    if (!preview.is_held) return {Obstacle::NotHeld, not_held};
    return {Obstacle::TooLarge, "it has too many nodes for its vibrations, or no weight"};
  }

  Miss nothing_moves(const PreviewCase& one) const {
    const Preview& preview = one.preview;
    const auto miss = [](std::string reason) {
      return Miss{Obstacle::NothingMoves, std::move(reason)};
    };
    if (subject_.forces.empty()) return miss("no force is enabled at any frame");
    if (preview.gap) {
      return miss(
          fmt::format("it selects nothing: at frame {}, when it is nearest, a vertex is {:.4g} "
                      "away, and deformationRadius is {:.4g}",
                      preview.gap->frame, preview.gap->to_vertex, preview.gap->deformation_radius));
    }
    if (!preview.frame) {
      return miss("the forces select nothing at any frame; pliant info tells how near they come");
    }
    if (!preview.is_solvable) return miss("no node of what is selected can move");
    if (preview.static_peak > 0) return miss("the animation ends before anything moves");
    if (!preview.is_solved && preview.is_held) {
      return Miss{Obstacle::TooLarge, "it has too many nodes for a preview"};
    }
    const auto is_zero = [&](std::size_t force) {
      return farthest_value(original_.forces[force].magnitude) == 0;
    };
    if (std::all_of(subject_.forces.begin(), subject_.forces.end(), is_zero))
      return miss("the keys of every magnitude are all 0, so they cannot be scaled");
    return miss("the forces push no node that can move");
  }

  // Density and damping for the motion of the present scene.
  Result<void> choose_material() {
    if (auto looked = look(); !looked) return looked;
    const PreviewCase& one = *now_;
    const Miss none = no_motion(one);
    if (none.obstacle != Obstacle::None) {
      settling_miss_ = frequency_miss_ = none;
      return {};
    }
    const int frame = *one.preview.frame;
    const Material now{material().density.at(frame)[0], damping_of(material()).at(frame)[0]};
    const bool settles = one.preview.is_held;
    const MaterialFound found =
        find_material(*one.motions[region_of(one)], now, settles ? goals_.settling : std::nullopt,
                      goals_.frequency);
    settling_miss_ = settles ? found.settling : Miss{Obstacle::NotHeld, not_held};
    frequency_miss_ = found.frequency;
    const MaterialChannels& first = first_material();
    if (goals_.frequency && found.material.density != now.density) {
      auto density = with_value(first.density, frame, found.material.density);
      if (density) {
        material().density = *std::move(density);
        forget();
      } else {
        frequency_miss_ = {Obstacle::NoInertia, no_factor("density", frame)};
      }
    }
    if (!goals_.settling || found.material.damping == now.damping) return {};
    auto damping = with_value(damping_of(first), frame, found.material.damping);
    const bool has_ratio = first.damping_ratio.has_value();
    if (damping) {
      forget();
      (has_ratio ? *material().damping_ratio : material().damping) = *std::move(damping);
    } else {
      settling_miss_ = {Obstacle::NoDamping,
                        no_factor(has_ratio ? "dampingRatio" : "damping", frame)};
    }
    return {};
  }

  // The channel with a value at a frame: of keys, all times one factor. Null: there is no such one.
  static std::optional<Channel<1>> with_value(const Channel<1>& channel, int frame, double value) {
    if (!channel.is_animated()) return rounded(value);
    const double present = channel.at(frame)[0];
    if (!(present > 0 && value > 0)) return {};
    auto changed = scaled(channel, value / present);
    return changed ? std::optional(*std::move(changed)) : std::nullopt;
  }

  std::string no_factor(std::string_view channel, int frame) const {
    return fmt::format("{}.{} has keys, which no factor brings to what is needed at frame {}",
                       surface().name, channel, frame);
  }

  // Magnitudes for the peak, from those of the present scene on.
  Result<void> choose_magnitudes() {
    if (subject_.forces.empty()) {
      if (previewer_.meets_colliders())
        peak_miss_ = {Obstacle::MovesAnyway, "only colliders move it, which no magnitude changes"};
      return {};
    }
    const double first = factor_;
    bool is_open = false;
    const auto peak_at = [&](double factor) -> Result<double> {
      if (auto set = set_magnitudes(first * factor); !set) return fail(set.error());
      PreviewCase one = new_case();
      if (auto played = play(one); !played) return fail(played.error());
      is_open = !one.preview.played;
      return is_open ? 0 : one.preview.played->peak;
    };
    const auto found = find_factor(
        *goals_.peak, std::clamp(most_plays - plays_ - 1, 1, most_plays_of_a_round), peak_at);
    if (!found) return fail(found.error());
    peak_miss_ = miss_of(*found);
    if (is_open || found->obstacle == Obstacle::NothingMoves) {  // also if they began with 1
      if (!is_open) {
        for (const std::size_t force : subject_.forces)
          scene_.forces[force].magnitude = original_.forces[force].magnitude;
        magnitudes_ = magnitudes();
        forget();
      }
      return set_magnitudes(first);
    }
    return set_magnitudes(first * found->factor);
  }

  Miss miss_of(const FactorFound& found) const {
    switch (found.obstacle) {
      case Obstacle::LeavesReach:
        return {found.obstacle,
                fmt::format(
                    "{}the surface moves out of the reach of its forces: {}; measure=\"rest\" "
                    "keeps pushing",
                    previewer_.meets_colliders() ? "colliders hold it back, or " : "",
                    found.other_peak == 0 ? "more magnitude does not move it further"
                                          : fmt::format("its peak jumps from {:.4g} to {:.4g}",
                                                        std::min(found.peak, found.other_peak),
                                                        std::max(found.peak, found.other_peak)))};
      case Obstacle::MovesAnyway:
        return {found.obstacle, "it moves so far without these forces"};
      case Obstacle::NotFound:
        return {found.obstacle, fmt::format("not found in {} plays of the animation", plays_)};
      default:
        return {found.obstacle, ""};
    }
  }

  bool is_explained() const {
    return settling_miss_.obstacle != Obstacle::None ||
           frequency_miss_.obstacle != Obstacle::None || peak_miss_.obstacle != Obstacle::None;
  }

  static double worst_miss(const Suggestion& one) {
    double worst = 0;
    for (const auto& goal : {one.peak, one.settling, one.frequency}) {
      if (goal) worst = std::max(worst, goal->miss());
    }
    return worst;
  }

  static GoalResult result_of(double wanted, std::optional<double> found, Miss miss) {
    GoalResult result{.wanted = wanted, .found = found.value_or(0), .is_known = found.has_value()};
    if (result.miss() <= goal_tolerance) return result;
    result.obstacle = miss.obstacle;
    result.reason = std::move(miss.reason);
    return result;
  }

  // The suggestion that the present scene is, with its preview.
  Suggestion told(const PreviewCase& after) {
    const Preview& preview = after.preview;
    Suggestion one;
    one.scene = scene_;
    one.region = region_of(after);
    const RegionPreview* const region =
        one.region < preview.regions.size() ? &preview.regions[one.region] : nullptr;
    if (goals_.peak) {
      std::optional<double> peak;
      if (preview.played) peak = preview.played->peak;
      if (!peak) peak_miss_ = {Obstacle::NoCycle, after.open_cycle};
      if (peak && *peak == 0) peak_miss_ = nothing_moves(after);
      one.peak = result_of(*goals_.peak, peak, peak_miss_);
    }
    if (goals_.settling) {
      one.settling = result_of(
          *goals_.settling,
          region && region->has_vibration ? std::optional(region->settling.time) : std::nullopt,
          settling_miss_);
    }
    if (goals_.frequency) {
      one.frequency = result_of(*goals_.frequency,
                                region && (region->has_vibration || shows_motion(*region))
                                    ? std::optional(region->animated.frequency)
                                    : std::nullopt,
                                frequency_miss_);
    }
    add_values(one);
    one.after = preview;
    return one;
  }

  void add_values(Suggestion& one) const {
    const auto add = [&](std::string path, const Channel<1>& before, const Channel<1>& after) {
      if (farthest_value(before) == 0 && farthest_value(after) == 0) return;
      one.values.push_back({std::move(path), farthest_value(before), farthest_value(after),
                            after.is_animated() ? after.curve().keys().keys.size() : 0});
    };
    if (goals_.peak) {
      for (const std::size_t k : subject_.forces) {
        const Force& force = scene_.forces[k];
        add(force.name + ".magnitude", original_.forces[k].magnitude, force.magnitude);
        note_other_surfaces(one, k);
      }
    }
    const MaterialChannels& first = first_material();
    const MaterialChannels& now = surface().material;
    if (goals_.settling) {
      add(surface().name + (first.damping_ratio ? ".dampingRatio" : ".damping"), damping_of(first),
          damping_of(now));
    }
    if (goals_.frequency) add(surface().name + ".density", first.density, now.density);
  }

  // A magnitude is the same on all surfaces.
  void note_other_surfaces(Suggestion& one, std::size_t k) const {
    const Force& force = original_.forces[k];
    const double before = farthest_value(force.magnitude);
    const double after = farthest_value(scene_.forces[k].magnitude);
    if (before == after) return;
    std::vector<std::string> others;
    for (const Surface& other : original_.surfaces) {
      if (&other == &original_.surfaces[subject_.surface] || !other.enabled || other.is_driven())
        continue;
      if (targets(force, group_of(original_, force), other.name)) others.push_back(other.name);
    }
    if (others.empty()) return;
    one.notes.push_back(fmt::format("{} acts on {} too", force.name, fmt::join(others, ", ")));
  }

  const Scene& original_;
  Scene scene_;  // the previewer refers to it
  const RestShape& shape_;
  const MotionGoals& goals_;
  Subject subject_;
  SurfacePreviewer previewer_;
  std::optional<PreviewCase> now_;      // of the present scene, or of an earlier one
  bool is_seen_ = true;                 // whether of the present one
  std::vector<Channel<1>> magnitudes_;  // of the subject's forces at the beginning
  double factor_ = 1;                   // of them now
  struct Played {
    double factor;
    std::optional<PlayedPeak> peak;
    std::string open_cycle;
    std::vector<double> constants;  // the magnitudes; empty: one has keys
  };
  std::vector<Played> played_;  // with the present density and damping
  int plays_ = 0;
  Miss settling_miss_, frequency_miss_, peak_miss_;
};

}  // namespace

std::string_view name_of(Obstacle obstacle) {
  switch (obstacle) {
    case Obstacle::NothingMoves:
      return "nothingMoves";
    case Obstacle::LeavesReach:
      return "leavesReach";
    case Obstacle::MovesAnyway:
      return "movesAnyway";
    case Obstacle::StepsDamp:
      return "stepsDamp";
    case Obstacle::StepsTooLong:
      return "stepsTooLong";
    case Obstacle::Overdamped:
      return "overdamped";
    case Obstacle::TooSoon:
      return "tooSoon";
    case Obstacle::BetweenSwings:
      return "betweenSwings";
    case Obstacle::FrameRate:
      return "frameRate";
    case Obstacle::NoInertia:
      return "noInertia";
    case Obstacle::NoDamping:
      return "noDamping";
    case Obstacle::NotHeld:
      return "notHeld";
    case Obstacle::TooLarge:
      return "tooLarge";
    case Obstacle::NoCycle:
      return "noCycle";
    case Obstacle::NotFound:
      return "notFound";
    case Obstacle::None:
      break;
  }
  return "none";
}

double GoalResult::miss() const {
  return is_known ? std::abs(found / wanted - 1) : std::numeric_limits<double>::infinity();
}

bool Suggestion::meets_goals() const {
  const auto is_met = [](const std::optional<GoalResult>& goal) {
    return !goal || goal->miss() <= goal_tolerance;
  };
  return is_met(peak) && is_met(settling) && is_met(frequency);
}

Result<Suggestion> suggest_material(const Scene& scene, std::span<const RestShape> rest_shapes,
                                    const MotionGoals& goals, const RunContext& context) {
  PLIANT_EXPECTS(rest_shapes.size() == scene.surfaces.size());
  if (auto sound = check_goals(goals); !sound) return fail(sound.error());
  auto subject = find_subject(scene, rest_shapes, goals);
  if (!subject) return fail(subject.error());
  return Suggester(scene, rest_shapes, goals, *std::move(subject), context).suggest();
}

}  // namespace pliant
