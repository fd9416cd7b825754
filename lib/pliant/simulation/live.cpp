#include "pliant/simulation/live.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/expects.hpp"
#include "pliant/feedback/run_watch.hpp"
#include "pliant/feedback/warning_log.hpp"
#include "pliant/sampling/sampling.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/text/text.hpp"
#include "pliant/simulation/bodies.hpp"
#include "pliant/states/scene_states.hpp"
#include "pliant/timeline/checks.hpp"

namespace pliant {
namespace {

// A value that holds from a frame on.
struct RecordedValue {
  int frame = 0;
  Value<3> value = {};  // of a single number the first
};

// A channel that can be set.
struct Input {
  using Of = std::variant<Channel<1>*, Channel<3>*, Switch*>;

  std::string path;
  Range range;
  Of channel;
  bool changes = false;          // by a curve of the author, which may break a rule at any frame
  bool is_pose = false;          // it says where something is at the end of a step
  const Force* noise = nullptr;  // the noise whose rate it is
  std::vector<RecordedValue> recorded = {};  // in the order of frames
};

template <int D>
Value<D> value_of(std::span<const double> numbers) {
  Value<D> value;
  std::copy_n(numbers.begin(), D, value.begin());
  return value;
}

template <int D>
Key<D> step_key(double frame, const Value<D>& value) {
  return {.frame = frame, .value = value, .next = {.kind = Interpolation::Kind::Step}};
}

// Requires: sound keys.
template <int D>
Curve<D> curve_of(std::vector<Key<D>> keys) {
  auto curve = Curve<D>::make({.keys = std::move(keys)});
  PLIANT_EXPECTS(curve.has_value());
  return *std::move(curve);
}

// A constant rate and a keyed one round differently, so in a live run each rate is keyed from the
// start. Errors: InvalidInput.
Result<void> key_rates(Scene& scene) {
  for (Force& force : scene.forces) {
    auto* const noise = std::get_if<NoiseChannels>(&force.kind);
    if (!noise || noise->rate.is_animated()) continue;
    const Value<1> rate = noise->rate.at(scene.start);
    if (!(std::abs(rate[0]) <= timeline::largest_number)) {
      return fail(scene.origin.located(
          {ErrorCode::InvalidInput,
           fmt::format("{}.rate is {}, but a live run takes at most 1e150", force.name, rate[0])},
          scene.origin.at(force.name, "rate")));
    }
    noise->rate = curve_of<1>({step_key<1>(scene.start, rate)});
  }
  return {};
}

// Requires: sound options.
Result<void> check_to_play_live(const Scene& scene, const SimulationOptions& options) {
  PLIANT_EXPECTS(options.threads >= 1 && is_available(options.solver));
  if (auto sound = check_to_simulate(scene); !sound) return sound;
  for (const Surface& surface : scene.surfaces) {
    if (!surface.solver.loop) continue;
    return fail(scene.origin.located(
        {ErrorCode::InvalidInput,
         fmt::format("{}.loop is {}, but a live run has no cycle: what is set while it plays "
                     "is not known before",
                     surface.name, *surface.solver.loop)},
        scene.origin.at(surface.name, "loop")));
  }
  return {};
}

bool is_of_transform(const std::string&, std::string_view attribute) {
  return attribute == "translate" || attribute == "rotate" || attribute == "scale";
}

std::vector<Input> inputs_that_can_be_set(Scene& scene) {
  std::vector<Input> inputs;
  const auto add_all = [&](auto& thing) {
    for_each_channel(thing, [&](const std::string& name, const Attribute& attribute,
                                auto& channel) {
      inputs.push_back({thing.name + '.' + name, attribute.range, &channel, channel.is_animated()});
    });
  };
  const auto mark = [&](const Input::Of& channel) {
    for (Input& input : inputs) input.is_pose = input.is_pose || input.channel == channel;
  };
  const auto mark_all = [&](auto& part) {
    for_each_channel(part,
                     [&](const std::string&, const Attribute&, auto& channel) { mark(&channel); });
  };
  for (Surface& surface : scene.surfaces) {
    add_all(surface);
    mark_all(surface.transform);
  }
  for (Force& force : scene.forces) {
    const std::size_t first = inputs.size();
    add_all(force);
    auto* const noise = std::get_if<NoiseChannels>(&force.kind);
    for (std::size_t k = first; noise && k < inputs.size(); ++k) {
      if (inputs[k].channel != Input::Of(&noise->rate)) continue;
      inputs[k].noise = &force;
      inputs[k].changes = false;  // any rate keeps the rules
    }
  }
  for (Group& group : scene.groups) add_all(group);
  for (Collider& collider : scene.colliders) {
    add_all(collider);
    mark_all(collider.transform);
    std::visit(mark_all, collider.shape);
    mark(&collider.offset);
  }
  return inputs;
}

// The keys of a channel that was first as authored and was then set: its values at all frames from
// the run's first one on, the one before it too, since inertia reads it.
template <int D>
std::optional<Curve<D>> performed(const Channel<D>& authored, int start,
                                  std::span<const RecordedValue> recorded) {
  std::vector<Key<D>> keys;
  const int first = recorded.front().frame;
  if (authored.is_animated()) {
    for (int frame = start - 1; frame < first; ++frame) {
      keys.push_back(step_key<D>(frame, authored.at(frame)));
    }
  } else if (first > start) {
    keys.push_back(step_key<D>(start, authored.at(start)));
  }
  for (const RecordedValue& one : recorded) {
    keys.push_back(step_key<D>(one.frame, value_of<D>(std::span(one.value))));
  }
  auto curve = Curve<D>::make({.keys = std::move(keys)});
  if (!curve) return {};
  return *std::move(curve);
}

}  // namespace

/// The bodies at the present frame, and the channels that can be set.
class LiveSimulation::Run {
 public:
  Run(Scene scene, const LiveOptions& options)
      : records_(options.records),
        scene_(std::move(scene)),
        authored_(records_ ? scene_ : Scene()),
        sampling_(scene_),
        bodies_(scene_, sampling_, options.simulation),
        inputs_(inputs_that_can_be_set(scene_)),
        first_(first_frame_of_run(scene_)),
        frame_(scene_.start) {
    for (std::size_t k = 0; k < inputs_.size(); ++k) places_.emplace(inputs_[k].path, k);
    const auto is_own = [](const Force& force) {
      return std::holds_alternative<CustomForce>(force.kind);
    };
    may_step_in_part_ = scene_.surfaces.size() > 1 ||
                        std::any_of(scene_.forces.begin(), scene_.forces.end(), is_own);
  }

  Result<void> make_bodies();
  Result<void> play_preroll();
  Result<void> go_to_state(std::string_view state_bytes);
  int frame() const { return frame_; }
  const Scene& scene() const { return scene_; }
  const Bodies& bodies() const { return bodies_; }

  Result<void> set(std::string_view channel, std::span<const double> value);
  Result<void> advance();
  Result<Frame> positions(Frame reuse) { return bodies_.output(frame_, std::move(reuse)); }
  Result<FrameReport> report();
  Force in_world(const Force& force) const {
    return pliant::in_world(scene_, force, frame_, sampling_.carriers());
  }
  Result<Scene> performance() const;
  std::vector<Warning> warnings() const;

 private:
  tl::unexpected<Error> no_channel(std::string_view channel) const;
  std::optional<std::string> rule_of_keys(const Input& input) const;
  void apply(Input& input, std::span<const double> value);
  template <int D>
  void hold(const Input& input, Channel<D>& channel, const Value<D>& value);
  Result<void> check();
  Result<void> step(int frame);

  bool records_;    // before the scenes, which are made by it
  Scene scene_;     // with the present values
  Scene authored_;  // if it records
  SceneSampling sampling_;
  Bodies bodies_;
  std::vector<Input> inputs_;
  std::map<std::string_view, std::size_t> places_;  // in `inputs_`, by path
  int first_;                                       // the frame at which all surfaces are at rest
  int frame_;
  bool is_checked_ = false;        // the present values, at this frame
  bool may_step_in_part_ = false;  // whether a step that fails may have moved a body
  std::vector<BodyState> before_;  // the states before such a step; reused
  std::vector<Warning> warnings_of_scene_;
  WarningLog warnings_;
  RunWatch watch_;
};

Result<void> LiveSimulation::Run::make_bodies() {
  if (auto made = bodies_.make_all(); !made) return made;
  warnings_of_scene_ = warnings_about(bodies_.rest_shapes(), scene_);
  // What is set while it plays moves surfaces, forces and radii.
  std::erase_if(warnings_of_scene_, [](const Warning& warning) {
    using enum Warning::Kind;
    return warning.kind == KeysOutside || warning.kind == Drifts || warning.kind == NeverMoves ||
           warning.kind == RadiusExceeds;
  });
  watch_ = bodies_.watch();
  return {};
}

Result<void> LiveSimulation::Run::play_preroll() {
  for (int frame = first_; frame < scene_.start; ++frame) {
    if (auto stepped = step(frame); !stepped) return stepped;
  }
  return {};
}

Result<void> LiveSimulation::Run::go_to_state(std::string_view state_bytes) {
  SceneStates states(scene_, sampling_, nullptr);
  bodies_.add_to(states);
  auto found = states.read_checkpoint(state_bytes, bodies_.all());
  if (!found) return fail(found.error());
  frame_ = found->frame;
  bodies_.restore(std::move(found->states));
  return {};
}

tl::unexpected<Error> LiveSimulation::Run::no_channel(std::string_view channel) const {
  return invalid(pliant::no_channel(scene_, channel));
}

Result<void> LiveSimulation::Run::set(std::string_view channel, std::span<const double> value) {
  const auto place = places_.find(channel);
  if (place == places_.end()) return no_channel(channel);
  Input& input = inputs_[place->second];
  const auto refuse = [&](std::string_view rule) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} is {}, but {}", input.path, fmt::join(value, " "), rule));
  };
  const std::size_t count = std::holds_alternative<Channel<3>*>(input.channel) ? 3 : 1;
  if (value.size() != count) {
    return refuse(fmt::format("must be {} number{}", count, count == 1 ? "" : "s"));
  }
  for (const double number : value) {
    if (!(std::abs(number) <= timeline::largest_number)) {
      return refuse("must be finite, and at most 1e150 from 0");
    }
  }
  if (const auto rule = input.range.broken_rule(value)) return refuse(*rule);
  if (std::holds_alternative<Switch*>(input.channel) && value[0] != 0 && value[0] != 1) {
    return refuse("must be 0 or 1");
  }
  if (const auto rule = rule_of_keys(input)) return refuse(*rule);
  if (input.noise && !std::get<Channel<1>*>(input.channel)->is_animated())
    return refuse("a rate without keys cannot be set in a run from a state: give it a key");
  // Ahead of the start its time was summed from the value there.
  if (input.noise && frame_ == scene_.start && first_ < frame_)
    return refuse("a rate cannot be set at the first frame, since the preroll began with it");
  apply(input, value);
  input.changes = false;
  is_checked_ = false;
  if (!records_) return {};
  const int from = input.is_pose ? frame_ + 1 : frame_;
  if (!input.recorded.empty() && input.recorded.back().frame == from) input.recorded.pop_back();
  RecordedValue& recorded = input.recorded.emplace_back();
  recorded.frame = from;
  std::copy(value.begin(), value.end(), recorded.value.begin());
  return {};
}

// A pose becomes keys of three frames, two of which it has now.
std::optional<std::string> LiveSimulation::Run::rule_of_keys(const Input& input) const {
  if (!input.is_pose) return {};
  return std::visit(
      [&](const auto* channel) -> std::optional<std::string> {
        if constexpr (!std::is_same_v<decltype(channel), const Switch*>) {
          for (const int frame : {frame_ - 1, frame_}) {
            for (const double number : channel->at(frame)) {
              if (std::abs(number) <= timeline::largest_number) continue;
              return fmt::format("the channel is {} at frame {}, which no key can have", number,
                                 frame);
            }
          }
        }
        return {};
      },
      input.channel);
}

void LiveSimulation::Run::apply(Input& input, std::span<const double> value) {
  if (auto* const number = std::get_if<Channel<1>*>(&input.channel)) {
    hold<1>(input, **number, value_of<1>(value));
  } else if (auto* const vector = std::get_if<Channel<3>*>(&input.channel)) {
    hold<3>(input, **vector, value_of<3>(value));
  } else {
    *std::get<Switch*>(input.channel) = Switch(value[0] != 0);
  }
}

template <int D>
void LiveSimulation::Run::hold(const Input& input, Channel<D>& channel, const Value<D>& value) {
  if (input.is_pose) {
    // Inertia reads three frames.
    channel =
        curve_of<D>({step_key<D>(frame_ - 1, channel.at(frame_ - 1)),
                     step_key<D>(frame_, channel.at(frame_)), step_key<D>(frame_ + 1, value)});
  } else if (input.noise) {
    // The time of the noise is summed with the rates that were valid, then with the new one.
    const auto place = static_cast<std::size_t>(input.noise - scene_.forces.data());
    if constexpr (D == 1) {
      const auto rate_at = [&](int earlier) { return channel.at(earlier)[0]; };
      if (NoiseClock* const clock = sampling_.clock(place); clock && frame_ > scene_.start) {
        clock->sum(frame_, rate_at);
      }
    }
    channel = curve_of<D>({step_key<D>(frame_, value)});
  } else {
    channel = value;
  }
}

// The rules of single channels and those between them; of transforms those of the next frame too,
// since once that is the present frame, no value can be set for it.
Result<void> LiveSimulation::Run::check() {
  if (is_checked_) return {};
  std::vector<Error> errors = check_channels_at(scene_, frame_);
  if (errors.empty()) errors = check_channels_at(scene_, frame_ + 1, is_of_transform);
  if (errors.empty()) errors = bodies_.check_maps(frame_);
  if (!errors.empty()) return fail(as_one(std::move(errors), scene_.origin.file));
  is_checked_ = true;
  return {};
}

Result<FrameReport> LiveSimulation::Run::report() {
  if (auto sound = check(); !sound) return fail(sound.error());
  return bodies_.report(frame_, ReportDetail::Counts);
}

Result<void> LiveSimulation::Run::advance() {
  if (frame_ >= largest_frame) {
    return fail(ErrorCode::InvalidInput, fmt::format("frame {} is the last one", frame_));
  }
  if (records_ && frame_ - scene_.start + 1 >= max_frames) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("a recorded scene has at most {} frames", max_frames));
  }
  if (auto sound = check(); !sound) return sound;
  // If one body fails, the others may have stepped, and after an invalid result of a custom force
  // even that body has.
  if (may_step_in_part_) before_ = bodies_.states(std::move(before_));
  const auto take_back = [&] {
    if (may_step_in_part_) bodies_.restore(before_);
  };
  Result<void> stepped;
  try {
    stepped = step(frame_);
  } catch (...) {  // from a custom force
    take_back();
    throw;
  }
  if (!stepped) {
    take_back();
    return stepped;
  }
  ++frame_;
  is_checked_ = std::none_of(inputs_.begin(), inputs_.end(),
                             [](const Input& input) { return input.changes; });
  return {};
}

Result<void> LiveSimulation::Run::step(int frame) {
  bodies_.step(frame, nullptr, {});
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    if (auto done = bodies_.outcome(k); !done) return done;
  }
  for (std::size_t k = 0; k < bodies_.size(); ++k) {
    const Bodies::Step& step = bodies_.last_step(k);
    if (!step.is_solved_now) continue;
    add_facts(warnings_, scene_.surfaces[k], frame, step.inputs, step.facts);
    add_contacts(warnings_, scene_, scene_.surfaces[k], frame, bodies_.all()[k]->state().contacts);
    bodies_.look(watch_, k, frame, warnings_);
  }
  return {};
}

std::vector<Warning> LiveSimulation::Run::warnings() const {
  std::vector<Warning> warnings = warnings_of_scene_;
  for (Warning& warning : warnings_.warnings(scene_, false)) warnings.push_back(std::move(warning));
  return warnings;
}

Result<Scene> LiveSimulation::Run::performance() const {
  PLIANT_EXPECTS(records_);
  std::vector<Error> errors = check_channels_at(scene_, frame_);
  if (!errors.empty()) return fail(as_one(std::move(errors), scene_.origin.file));
  Scene scene = authored_;
  scene.end = frame_;
  const std::vector<Input> authored = inputs_that_can_be_set(scene);
  for (std::size_t k = 0; k < authored.size(); ++k) {
    const std::vector<RecordedValue>& recorded = inputs_[k].recorded;
    if (recorded.empty()) continue;
    const auto replace = [&]<int D>(const Channel<D>& of, auto& channel) {
      auto curve = performed<D>(of, first_, recorded);
      if (!curve) return false;
      channel = *std::move(curve);
      return true;
    };
    const auto replace_any = [&](auto* channel) {
      if constexpr (std::is_same_v<decltype(channel), Switch*>) {
        return replace(channel->channel(), *channel);
      } else {
        return replace(*channel, *channel);
      }
    };
    if (!std::visit(replace_any, authored[k].channel)) {
      return fail(
          ErrorCode::InvalidInput,
          fmt::format("{} has a value beyond 1e150, which no key can have", authored[k].path));
    }
  }
  return scene;
}

Result<LiveSimulation> LiveSimulation::make(Scene scene, const LiveOptions& options) {
  if (auto sound = check_to_play_live(scene, options.simulation); !sound)
    return fail(sound.error());
  if (auto keyed = key_rates(scene); !keyed) return fail(keyed.error());
  auto run = std::make_unique<Run>(std::move(scene), options);
  auto made = run->make_bodies();
  if (made) made = run->play_preroll();
  if (!made) return fail(made.error());
  return LiveSimulation(std::move(run));
}

Result<LiveSimulation> LiveSimulation::from_state(Scene scene, std::string_view state_bytes,
                                                  const LiveOptions& options) {
  if (auto sound = check_to_play_live(scene, options.simulation); !sound)
    return fail(sound.error());
  auto run = std::make_unique<Run>(std::move(scene), options);
  auto made = run->make_bodies();
  if (made) made = run->go_to_state(state_bytes);
  if (!made) return fail(made.error());
  return LiveSimulation(std::move(run));
}

LiveSimulation::LiveSimulation(std::unique_ptr<Run> run) : run_(std::move(run)) {}
LiveSimulation::LiveSimulation(LiveSimulation&&) noexcept = default;
LiveSimulation& LiveSimulation::operator=(LiveSimulation&&) noexcept = default;
LiveSimulation::~LiveSimulation() = default;

int LiveSimulation::frame() const { return run_->frame(); }

Result<void> LiveSimulation::set(std::string_view channel, std::span<const double> value) {
  return run_->set(channel, value);
}

Result<void> LiveSimulation::set(std::string_view channel, double value) {
  return run_->set(channel, std::span(&value, 1));
}

Result<void> LiveSimulation::set(std::string_view channel, const Value<3>& value) {
  return run_->set(channel, std::span(value));
}

Result<void> LiveSimulation::advance() { return run_->advance(); }

Result<Frame> LiveSimulation::positions(Frame reuse) { return run_->positions(std::move(reuse)); }

Result<FrameReport> LiveSimulation::report() { return run_->report(); }

Force LiveSimulation::in_world(const Force& force) const { return run_->in_world(force); }

Result<Scene> LiveSimulation::performance() const { return run_->performance(); }

const Scene& LiveSimulation::scene() const { return run_->scene(); }

std::vector<Warning> LiveSimulation::warnings() const { return run_->warnings(); }

std::span<const RestShape> LiveSimulation::rest_shapes() const {
  return run_->bodies().rest_shapes();
}

}  // namespace pliant
