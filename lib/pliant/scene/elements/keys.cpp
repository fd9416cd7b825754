#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/elements/read_elements.hpp"

namespace pliant::xml {
namespace {

bool is_given(Table& table, std::string_view name) {
  const Slot* row = find(table, name);
  return row != nullptr && row->at.is_known();
}

bool is_sound(Table& table, std::string_view name) {
  const Slot* row = find(table, name);
  return row != nullptr && row->is_sound;
}

/// Reads one <animate> or <falloff>: first its attributes, then its children in their order.
template <int D>
class CurveReader {
 public:
  CurveReader(const Element& animate, KeyAxis axis, ValueKind kind, std::string channel,
              Findings& findings)
      : animate_(animate),
        axis_(axis),
        kind_(kind),
        channel_(std::move(channel)),
        findings_(findings) {}

  std::optional<Curve<D>> read();

 private:
  void read_defaults();
  void read_key(const Element& element);
  void read_loop(const Element& element);

  Interpolation interpolation_of(const Element& element);
  Tangent<D> side_of(const Element& element, bool is_in);
  void check_frame(const Element& element);
  void check_stepping(const Element& element, Table& table, const Interpolation& interpolation);
  void check_last_control(bool has_segment);
  void check_loop();

  const Element& animate_;
  KeyAxis axis_;
  ValueKind kind_;
  std::string channel_;
  Findings& findings_;

  AnimateText<D> defaults_;
  CurveKeys<D> curve_;
  std::vector<TextPlace> key_places_;
  bool has_too_many_ = false;
  TextPlace loop_place_;
  TextPlace uncontrolled_;          // the last key if it inherits cubicBezier and has no control
  std::optional<double> previous_;  // frame of the key before, if it was readable
  TextPlace previous_place_;

  // The current key. Its table refers to it, and both are reused for every key.
  KeyText<D> key_;
  Table key_table_;
};

template <int D>
std::optional<Curve<D>> CurveReader<D>::read() {
  const std::size_t problems_before = findings_.problem_count();
  read_defaults();
  key_table_ = table_of(key_, axis_, kind_);
  std::vector<ChildReader> children = {
      {"key", [&](const Element& element) { read_key(element); }},
  };
  if (axis_ == KeyAxis::Frame)
    children.push_back({"loop", [&](const Element& element) { read_loop(element); }});
  const bool all_known = read_children(animate_, children, findings_);
  if (findings_.is_over(0)) return std::nullopt;
  if (curve_.keys.empty() && all_known)
    findings_.add_problem(
        animate_.place(),
        fmt::format("{} has no keys: at least one <key> is required", tag(animate_)));
  check_last_control(curve_.loop.has_value());
  if (findings_.problem_count() == problems_before) check_loop();
  if (findings_.problem_count() != problems_before) return std::nullopt;

  Checked<Curve<D>> curve = Curve<D>::make(std::move(curve_), findings_.should_stop());
  const auto place_of = [&](std::size_t key) {
    return key < key_places_.size() ? key_places_[key] : animate_.place();
  };
  if (!curve && curve.error().kind == Complaint::Kind::Interrupted) {
    findings_.stop();
    return std::nullopt;
  }
  if (!curve) {
    findings_.add_problem(place_of(curve.error().index),
                          fmt::format("{}: {}", channel_, curve.error().message));
    return std::nullopt;
  }
  for (const CurveNote& note : curve->notes())
    findings_.add_note(
        place_of(note.key),
        fmt::format("{}: key {}: {}", channel_, curve->keys().keys[note.key].frame, note.message));
  return std::move(*curve);
}

template <int D>
void CurveReader<D>::read_defaults() {
  if (kind_ == ValueKind::Boolean) defaults_.interpolation.kind = Interpolation::Kind::Step;
  Table table = table_of(defaults_, axis_, kind_);
  read_attributes(animate_, table, findings_);
  check_stepping(animate_, table, defaults_.interpolation);
  curve_.before = defaults_.before;
  curve_.after = defaults_.after;
  curve_.overshoot = defaults_.overshoot;
}

template <int D>
void CurveReader<D>::read_key(const Element& element) {
  constexpr std::size_t most_keys = 1'000'000;
  if (curve_.keys.size() >= most_keys) {
    if (std::exchange(has_too_many_, true)) return;
    return findings_.add_problem(element.place(),
                                 fmt::format("{} has more than {} keys", tag(animate_), most_keys));
  }
  check_last_control(true);
  key_ = {};
  for (Slot& row : key_table_) {
    row.at = {};
    row.is_sound = true;
  }
  read_attributes(element, key_table_, findings_);
  read_children(element, {}, findings_);
  check_frame(element);

  Key<D> key{.frame = key_.frame, .value = key_.value, .left = key_.left};
  key.next = interpolation_of(element);
  check_stepping(element, key_table_, key.next);
  key.in = side_of(element, true);
  key.out = side_of(element, false);
  curve_.keys.push_back(std::move(key));
  key_places_.push_back(element.place());
}

template <int D>
void CurveReader<D>::check_frame(const Element& element) {
  const std::string_view name = place_name(axis_);
  if (!is_sound(key_table_, name)) {
    previous_.reset();
    return;
  }
  const TextPlace place = element.attribute(name)->whole_place();
  const auto title = [&] { return findings_.sources().title_of(previous_place_, place); };
  if (previous_ && key_.frame == *previous_)
    findings_.add_problem(place, fmt::format("{} {} {} repeats the key of {}", tag(element), name,
                                             key_.frame, title()));
  else if (previous_ && key_.frame < *previous_)
    findings_.add_problem(
        place, fmt::format("{} {} {} is not after {} {} of {}: keys must be in increasing order",
                           tag(element), name, key_.frame, name, *previous_, title()));
  previous_ = key_.frame;
  previous_place_ = place;
}

/// A boolean channel steps: attributes that shape the motion between two values are a problem.
template <int D>
void CurveReader<D>::check_stepping(const Element& element, Table& table,
                                    const Interpolation& interpolation) {
  if (kind_ != ValueKind::Boolean) return;
  constexpr std::string_view shaping[] = {
      "tangent", "in",        "out",    "inLength", "outLength", "inHandle", "outHandle",
      "control", "amplitude", "period", "back",     "overshoot", "offset"};
  for (const std::string_view name : shaping)
    if (is_given(table, name))
      findings_.add_problem(find(table, name)->at,
                            fmt::format("{} {}: a boolean channel steps, so {} is not allowed",
                                        tag(element), name, name));
  const bool is_step = interpolation.kind == Interpolation::Kind::Step ||
                       interpolation.kind == Interpolation::Kind::StepNext;
  if (!is_step && is_given(table, "interpolation"))
    findings_.add_problem(
        find(table, "interpolation")->at,
        fmt::format("{} interpolation: a boolean channel steps; allowed: step, stepNext",
                    tag(element)));
}

/// The segment that starts at the key: its own interpolation or the default, with its parameters.
template <int D>
Interpolation CurveReader<D>::interpolation_of(const Element& element) {
  Interpolation next = key_.interpolation.value_or(defaults_.interpolation);
  next.amplitude = key_.amplitude;
  next.period = key_.period;
  next.back = key_.back;
  if (key_.control) next.control = *key_.control;
  if (kind_ == ValueKind::Boolean || !is_sound(key_table_, "interpolation")) return next;

  const bool is_easing = next.kind == Interpolation::Kind::Easing;
  const auto require = [&](std::string_view name, bool applies, std::string_view what) {
    if (is_given(key_table_, name) && !applies)
      findings_.add_problem(
          find(key_table_, name)->at,
          fmt::format("{} {} applies only to the interpolation {}", tag(element), name, what));
  };
  const bool is_elastic = is_easing && next.ease == Ease::Elastic;
  require("amplitude", is_elastic, "elasticIn, elasticOut and elasticInOut");
  require("period", is_elastic, "elasticIn, elasticOut and elasticInOut");
  require("back", is_easing && next.ease == Ease::Back, "backIn, backOut and backInOut");
  const bool is_cubic = next.kind == Interpolation::Kind::CubicBezier;
  require("control", is_cubic, "cubicBezier");

  if (is_cubic && !key_.control && is_sound(key_table_, "control")) {
    if (key_.interpolation)
      findings_.add_problem(
          element.place(),
          fmt::format("{} interpolation=\"cubicBezier\" needs control=\"x1 y1 x2 y2\"",
                      tag(element)));
    else
      uncontrolled_ = element.place();
  }
  return next;
}

/// A key that inherits cubicBezier needs a control if a segment starts at it. None starts at the
/// last key, unless an inner loop copies it.
template <int D>
void CurveReader<D>::check_last_control(bool has_segment) {
  if (uncontrolled_.is_known() && has_segment)
    findings_.add_problem(
        uncontrolled_,
        "<key> inherits interpolation=\"cubicBezier\" and needs control=\"x1 y1 x2 y2\"");
  uncontrolled_ = {};
}

/// One side of the key: its own tangent, otherwise that for both sides, otherwise the default.
template <int D>
Tangent<D> CurveReader<D>::side_of(const Element& element, bool is_in) {
  const std::string_view name = is_in ? "in" : "out";
  const std::string_view length_name = is_in ? "inLength" : "outLength";
  const std::string_view handle_name = is_in ? "inHandle" : "outHandle";
  const auto exclude = [&](std::string_view first, std::string_view second) {
    if (is_given(key_table_, first) && is_given(key_table_, second))
      findings_.add_problem(
          find(key_table_, second)->at,
          fmt::format("{} has both {} and {}; remove one of them", tag(element), first, second));
  };
  exclude("tangent", name);
  exclude("tangent", handle_name);
  exclude(name, handle_name);
  exclude(length_name, handle_name);

  if (const auto& handle = is_in ? key_.in_handle : key_.out_handle)
    return {.kind = Tangent<D>::Kind::Handle,
            .handle_frames = handle->frames,
            .handle_value = handle->value};
  const auto& own = is_in ? key_.in : key_.out;
  Tangent<D> side = own ? *own : key_.tangent.value_or(defaults_.tangent);
  side.length = is_in ? key_.in_length : key_.out_length;
  return side;
}

template <int D>
void CurveReader<D>::read_loop(const Element& element) {
  Loop<D> loop;
  Table table = table_of(loop, kind_);
  read_attributes(element, table, findings_);
  read_children(element, {}, findings_);
  if (curve_.loop)
    return findings_.add_problem(
        element.place(), fmt::format("{} has a second <loop>; the first is at {}", tag(animate_),
                                     findings_.sources().title_of(loop_place_, element.place())));
  check_stepping(element, table, {});
  curve_.loop = loop;
  loop_place_ = element.place();
}

/// Checks the curve's rules for a loop again, to report problems at the loop's line instead of a
/// key's. Requires: all keys were read without a problem.
template <int D>
void CurveReader<D>::check_loop() {
  if (!curve_.loop) return;
  const Loop<D>& loop = *curve_.loop;
  if (!(loop.to > loop.from))
    return findings_.add_problem(
        loop_place_,
        fmt::format("<loop> to=\"{}\": must be after from=\"{}\"", loop.to, loop.from));
  const auto at = [](const Key<D>& key, double frame) { return key.frame < frame; };
  const auto first = std::lower_bound(curve_.keys.begin(), curve_.keys.end(), loop.from, at);
  if (first == curve_.keys.end() || first->frame != loop.from)
    return findings_.add_problem(
        loop_place_, fmt::format("<loop> from=\"{}\": there is no key at that frame", loop.from));
  const auto last = std::lower_bound(first, curve_.keys.end(), loop.to, at);
  const std::int64_t copied = (last - first) * (std::int64_t{loop.before} + loop.after);
  constexpr std::int64_t most = Findings::most_copied_keys;
  if (copied > most)
    return findings_.add_problem(
        loop_place_,
        fmt::format("<loop> makes {} copied keys; at most {} are allowed", copied, most));
  const std::int64_t before = findings_.copied_keys();
  findings_.count_copied_keys(copied);
  if (before > most && copied > 0) return findings_.add_consequence();
  if (before + copied > most && copied > 0)
    findings_.add_problem(
        loop_place_, fmt::format("<loop> makes {} copied keys, and those before it {}; at most {} "
                                 "are allowed in a scene",
                                 copied, before, most));
}

}  // namespace

template <int D>
std::optional<Curve<D>> read_curve(const Element& animate, KeyAxis axis, ValueKind kind,
                                   const std::string& channel, Findings& findings) {
  return CurveReader<D>(animate, axis, kind, channel, findings).read();
}

template std::optional<Curve<1>> read_curve<1>(const Element&, KeyAxis, ValueKind,
                                               const std::string&, Findings&);
template std::optional<Curve<3>> read_curve<3>(const Element&, KeyAxis, ValueKind,
                                               const std::string&, Findings&);

}  // namespace pliant::xml
