#include "curves.hpp"

#include <array>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include "arrays.hpp"
#include "call.hpp"
#include "errors.hpp"
#include "pliant/core/shortened.hpp"
#include "pliant/scene/format/key_text.hpp"
#include "pliant/timeline/edit/bake_keys.hpp"
#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/simplify.hpp"

namespace pliant::python {
namespace {

constexpr auto axis = xml::KeyAxis::Frame;

template <int D>
constexpr auto value_kind = D == 1 ? xml::ValueKind::Number : xml::ValueKind::Vector;

/// `work(should_stop)` without the GIL; Ctrl-C stops it.
template <class Work>
auto stoppable(Work&& work) {
  return run_once([&](const StopRequest& should_stop) {
    return Result<decltype(work(should_stop))>(work(should_stop));
  });
}

// -- Values
// ----------------------------------------------------------------------------------------

template <int D>
Value<D> value_of(const py::handle& value, const char* what) {
  if constexpr (D == 1) {
    if (PyFloat_CheckExact(value.ptr()) != 0) return {PyFloat_AS_DOUBLE(value.ptr())};
    return {class_named("number")(what, value).template cast<double>()};
  } else {
    return class_named("vector")(what, value, D).template cast<Value<D>>();
  }
}

template <class T>
std::optional<T> optional_of(const py::handle& value) {
  if (value.is_none()) return std::nullopt;
  return value.cast<T>();
}

/// Raises InvalidInput for a key or for what is around them.
[[noreturn]] void refuse_at(const std::string& where, std::string message) {
  raise(where, Complaint{.message = std::move(message)});
}

/// Reads a word of the scene format into the slot of that name. `where` and `what` are what it is
/// of.
void read_word(xml::Table& table, const char* name, const std::string& word,
               const std::string& where, const char* what) {
  xml::Slot& slot = *xml::find(table, name);
  if (const auto read = slot.read(word); !read)
    refuse_at(where, fmt::format("{} {}: {}", what, in_quotes(word), read.error().message));
}

/// The text of a slot.
std::string slot_text(xml::Table table, const char* name) { return xml::find(table, name)->text; }

// -- Keys: Python to C++
// ---------------------------------------------------------------------------

std::string title_of(std::size_t index, double frame) {
  return fmt::format("key {} at frame {}", index, frame);
}

template <int D>
std::optional<Tangent<D>> tangent_of(xml::Table& table, xml::KeyText<D>& text,
                                     const py::handle& value, const std::string& where,
                                     const char* what) {
  if (value.is_none()) return std::nullopt;
  if (py::isinstance<py::str>(value)) {
    const auto word = text_of(value);
    if (word == "auto") return Tangent<D>{};
    text.tangent.reset();
    read_word(table, "tangent", word, where, what);
    return text.tangent;
  }
  return Tangent<D>{.kind = Tangent<D>::Kind::Slope, .slope = value_of<D>(value, what)};
}

template <int D>
Tangent<D> handle_of(const std::vector<double>& numbers, const std::string& where,
                     const char* what) {
  if (numbers.size() != 1 + D)
    refuse_at(where, fmt::format("{} must have {} numbers: frames, then the value", what, 1 + D));
  Tangent<D> tangent{.kind = Tangent<D>::Kind::Handle, .handle_frames = numbers[0]};
  for (int c = 0; c < D; ++c) tangent.handle_value[c] = numbers[1 + c];
  return tangent;
}

/// Whether a key is a `Key`; else it is a pair. Raises TypeError.
bool is_key(const py::handle& object) {
  if (py::isinstance(object, class_named("Key"))) return true;
  if (!py::isinstance<py::sequence>(object) || py::isinstance<py::str>(object) ||
      py::len(object) != 2)
    throw py::type_error("a key must be a Key or (frame, value), not " +
                         std::string(py::repr(object)));
  return false;
}

/// How a key leaves for the next one. Raises InvalidInput where the format refuses it.
Interpolation interpolation_of(const py::handle& key, xml::Table& table,
                               const std::optional<Interpolation>& read, const std::string& where) {
  Interpolation next;
  if (const auto word = text_of(key.attr("interpolation")); word != "bezier") {
    read_word(table, "interpolation", word, where, "interpolation");
    next = *read;
  }
  const bool is_easing = next.kind == Interpolation::Kind::Easing;
  const bool is_elastic = is_easing && next.ease == Ease::Elastic;
  const auto take = [&](const char* name, bool applies, const char* what, auto& to) {
    using T = std::remove_reference_t<decltype(to)>;
    const py::object value = key.attr(name);
    if (value.is_none()) return false;
    if (!applies)
      refuse_at(where, fmt::format("{} applies only to the interpolation {}", name, what));
    to = value.cast<T>();
    return true;
  };
  take("amplitude", is_elastic, "elasticIn, elasticOut and elasticInOut", next.amplitude);
  take("period", is_elastic, "elasticIn, elasticOut and elasticInOut", next.period);
  take("back", is_easing && next.ease == Ease::Back, "backIn, backOut and backInOut", next.back);
  const bool is_cubic = next.kind == Interpolation::Kind::CubicBezier;
  if (!take("control", is_cubic, "cubicBezier", next.control) && is_cubic)
    refuse_at(where, "interpolation \"cubicBezier\" needs control=(x1, y1, x2, y2)");
  return next;
}

py::object got(const py::handle& object, const char* name) { return object.attr(name); }

template <int D>
Key<D> key_of(const py::handle& object, std::size_t index) {
  constexpr auto of_value = "the value of a key, as of the others,";
  if (!is_key(object)) {
    const auto pair = py::reinterpret_borrow<py::sequence>(object);
    return {.frame = value_of<1>(pair[0], "frame")[0], .value = value_of<D>(pair[1], of_value)};
  }
  Key<D> key{.frame = got(object, "frame").cast<double>(),
             .value = value_of<D>(got(object, "value"), of_value)};
  const std::string where = title_of(index, key.frame);
  xml::KeyText<D> text;
  xml::Table table = xml::table_of(text, axis, value_kind<D>);
  key.next = interpolation_of(object, table, text.interpolation, where);
  const auto both = tangent_of(table, text, got(object, "tangent"), where, "tangent");
  const auto side = [&](const char* word, const char* length, const char* handle) {
    Tangent<D> tangent = *tangent_of(table, text, got(object, word), where, word);
    const bool is_given = tangent != Tangent<D>{};
    const auto own_length = optional_of<double>(got(object, length));
    const auto own_handle = optional_of<std::vector<double>>(got(object, handle));
    const auto exclude = [&](bool is_first, const char* first, bool is_second, const char* second) {
      if (is_first && is_second)
        refuse_at(where, fmt::format("has both {} and {}; remove one of them", first, second));
    };
    exclude(both.has_value(), "tangent", is_given, word);
    exclude(both.has_value(), "tangent", own_handle.has_value(), handle);
    exclude(is_given, word, own_handle.has_value(), handle);
    exclude(own_length.has_value(), length, own_handle.has_value(), handle);
    if (own_handle) return handle_of<D>(*own_handle, where, handle);
    if (both) tangent = *both;
    tangent.length = own_length;
    return tangent;
  };
  key.in = side("in_tangent", "in_length", "in_handle");
  key.out = side("out_tangent", "out_length", "out_handle");
  if (const py::object left = got(object, "left"); !left.is_none())
    key.left = value_of<D>(left, "left");
  return key;
}

template <int D>
CurveKeys<D> curve_keys_of(const py::sequence& keys, const std::string& before,
                           const std::string& after, const std::string& overshoot,
                           const py::object& loop) {
  CurveKeys<D> curve;
  for (const py::handle key : keys) curve.keys.push_back(key_of<D>(key, curve.keys.size()));
  xml::AnimateText<D> text;
  xml::Table table = xml::table_of(text, axis, value_kind<D>);
  read_word(table, "before", before, "curve", "before");
  read_word(table, "after", after, "curve", "after");
  read_word(table, "overshoot", overshoot, "curve", "overshoot");
  curve.before = text.before;
  curve.after = text.after;
  curve.overshoot = text.overshoot;
  if (!loop.is_none()) {
    if (!py::isinstance(loop, class_named("Loop")))
      throw py::type_error("loop must be a Loop or None, not " + std::string(py::repr(loop)));
    const py::object offset = loop.attr("offset");
    Loop<D> own{.from = loop.attr("from_").cast<double>(),
                .to = loop.attr("to").cast<double>(),
                .before = loop.attr("before").cast<int>(),
                .after = loop.attr("after").cast<int>()};
    if (!offset.equal(py::int_(0))) own.offset = value_of<D>(offset, "offset");
    curve.loop = own;
  }
  return curve;
}

template <int D>
AnyCurve compiled(const CurveKeys<D>& keys) {
  auto curve =
      stoppable([&](const StopRequest& should_stop) { return Curve<D>::make(keys, should_stop); });
  if (curve) return AnyCurve{*std::move(curve)};
  const std::size_t index = curve.error().index;
  raise(index < keys.keys.size() ? title_of(index, keys.keys[index].frame) : std::string("curve"),
        curve.error());
}

AnyCurve curve_of(const py::sequence& keys, const std::string& before, const std::string& after,
                  const std::string& overshoot, const py::object& loop) {
  if (keys.size() == 0) return compiled(CurveKeys<1>{});
  const py::object first = keys[0];
  const py::object value =
      is_key(first) ? got(first, "value")
                    : class_named("value")("value", py::reinterpret_borrow<py::sequence>(first)[1]);
  if (py::isinstance<py::tuple>(value))
    return compiled(curve_keys_of<3>(keys, before, after, overshoot, loop));
  return compiled(curve_keys_of<1>(keys, before, after, overshoot, loop));
}

// -- Keys: C++ to Python
// ---------------------------------------------------------------------------

template <int D>
py::object tangent_object(const Tangent<D>& tangent) {
  using Kind = typename Tangent<D>::Kind;
  if (tangent.kind == Kind::Slope) return value_object<D>(tangent.slope);
  if (tangent.kind == Kind::Auto || tangent.kind == Kind::Handle) return py::str("auto");
  xml::KeyText<D> text{.tangent = tangent};
  return py::str(slot_text(xml::table_of(text, axis, value_kind<D>), "tangent"));
}

template <int D>
py::object handle_object(const Tangent<D>& tangent) {
  if (tangent.kind != Tangent<D>::Kind::Handle) return py::none();
  py::list numbers;
  numbers.append(tangent.handle_frames);
  for (const double number : tangent.handle_value) numbers.append(number);
  return py::tuple(numbers);
}

template <int D>
py::object key_object(const Key<D>& key) {
  using Kind = typename Tangent<D>::Kind;
  std::string word = "bezier";
  if (key.next.kind != Interpolation::Kind::Bezier) {
    xml::KeyText<D> text{.interpolation = key.next};
    word = slot_text(xml::table_of(text, axis, value_kind<D>), "interpolation");
  }
  const auto length = [](const Tangent<D>& tangent) {
    return tangent.kind == Kind::Handle ? std::nullopt : tangent.length;
  };
  using py::literals::operator""_a;
  const Ease* const ease = key.next.kind == Interpolation::Kind::Easing ? &key.next.ease : nullptr;
  const auto if_eased = [&](Ease by, const std::optional<double>& number) {
    return ease != nullptr && *ease == by ? number : std::nullopt;
  };
  const bool has_control = key.next.kind == Interpolation::Kind::CubicBezier;
  return class_named("Key")(
      key.frame, value_object<D>(key.value), "interpolation"_a = word,
      "in_tangent"_a = tangent_object(key.in), "out_tangent"_a = tangent_object(key.out),
      "in_length"_a = length(key.in), "out_length"_a = length(key.out),
      "in_handle"_a = handle_object(key.in), "out_handle"_a = handle_object(key.out),
      "left"_a = key.left ? value_object<D>(*key.left) : py::object(py::none()),
      "amplitude"_a = if_eased(Ease::Elastic, key.next.amplitude),
      "period"_a = if_eased(Ease::Elastic, key.next.period),
      "back"_a = if_eased(Ease::Back, key.next.back),
      "control"_a =
          has_control ? py::object(py::tuple(py::cast(key.next.control))) : py::object(py::none()));
}

template <int D>
std::string side_text(const CurveKeys<D>& keys, const char* name) {
  xml::AnimateText<D> text{.before = keys.before, .after = keys.after, .overshoot = keys.overshoot};
  return slot_text(xml::table_of(text, axis, value_kind<D>), name);
}

template <int D>
py::object loop_object(const std::optional<Loop<D>>& loop) {
  if (!loop) return py::none();
  const bool is_still = loop->offset == Value<D>{};
  return class_named("Loop")(
      loop->from, loop->to, py::arg("before") = loop->before, py::arg("after") = loop->after,
      py::arg("offset") = is_still ? py::object(py::int_(0)) : value_object<D>(loop->offset));
}

// -- Adjustments, as a pickle has them: the kind and the number of each component
// ------------------

using Adjusting = std::vector<std::pair<int, double>>;

template <class Channel>
std::optional<Adjusting> adjusting_of(const Channel& channel) {
  if (channel.adjustments() == nullptr) return std::nullopt;
  Adjusting adjusting;
  for (const Adjustment& each : *channel.adjustments())
    adjusting.emplace_back(static_cast<int>(each.kind), each.number);
  return adjusting;
}

template <std::size_t D>
std::array<Adjustment, D> adjustments_of(const Adjusting& adjusting) {
  std::array<Adjustment, D> adjustments;
  if (adjusting.size() != D) throw py::value_error("adjustments are of another dimension");
  for (std::size_t c = 0; c < D; ++c)
    adjustments[c] = {static_cast<Adjustment::Kind>(adjusting[c].first), adjusting[c].second};
  return adjustments;
}

// -- Evaluation
// ------------------------------------------------------------------------------------

/// Calls `of` with the curve of either dimension.
template <class F>
decltype(auto) with(const AnyCurve& curve, F&& of) {
  return std::visit(std::forward<F>(of), curve.curve);
}

template <int D>
constexpr int dimension_of(const Curve<D>&) {
  return D;
}

template <int D>
using Evaluate = Value<D> (Curve<D>::*)(double) const;

/// The values at a frame or at an array of frames.
template <int D>
py::object evaluated(const Curve<D>& curve, Evaluate<D> evaluate, const py::object& frames) {
  const auto array = frames_of(frames);
  const std::span<const double> at(array.data(), static_cast<std::size_t>(array.size()));
  const bool is_one = array.ndim() == 0;
  std::vector<py::ssize_t> shape;
  if (!is_one) shape.push_back(array.size());
  if (D > 1) shape.push_back(D);
  if (is_one && D == 1) return py::float_((curve.*evaluate)(at[0])[0]);
  py::array_t<double> result(shape);
  double* to = result.mutable_data();
  constexpr std::size_t parts_of_value = 16;
  run_once([&](const StopRequest& should_stop) -> Result<void> {
    StopPoll poll(should_stop);
    for (const double frame : at) {
      if (poll.after(parts_of_value)) return interrupted();
      for (const double number : (curve.*evaluate)(frame)) *to++ = number;
    }
    return {};
  });
  return result;
}

template <int D>
Value<D> rise_of(const py::object& rise) {
  return value_of<D>(rise, "rise");
}

/// The result of an edit.
template <int D>
AnyCurve edited(Checked<Curve<D>> curve) {
  if (!curve) raise("curve", curve.error());
  return AnyCurve{*std::move(curve)};
}

template <int D>
Value<D> spread(const py::object& value, const char* what) {
  if (D == 3 && !py::isinstance<py::sequence>(value) && !py::hasattr(value, "shape"))
    return Scaling<D>::filled(value_of<1>(value, what)[0]);
  return value_of<D>(value, what);
}

Interpolation::Kind baked_kind(const std::string& word) {
  if (word == "linear") return Interpolation::Kind::Linear;
  if (word == "bezier") return Interpolation::Kind::Bezier;
  throw py::value_error("interpolation \"" + word + "\": allowed: linear, bezier");
}

// A switch steps: keys of 0 and 1, whose default interpolation becomes steps. What shapes the
// motion between two values shapes nothing then, and a scene file has none of it.
AnyCurve stepped(const AnyCurve& curve) {
  const auto* const own = std::get_if<Curve<1>>(&curve.curve);
  if (own == nullptr) throw py::value_error("a switch needs a curve of one number");
  CurveKeys<1> keys = own->keys();
  keys.overshoot = {};
  for (Key<1>& key : keys.keys) {
    if (key.value[0] != 0 && key.value[0] != 1)
      throw py::value_error(fmt::format(
          "a switch has keys of 0 and 1 only; the one at frame {} is {}", key.frame, key.value[0]));
    const Interpolation::Kind kind =
        key.next.kind == Interpolation::Kind::Bezier ? Interpolation::Kind::Step : key.next.kind;
    if (kind != Interpolation::Kind::Step && kind != Interpolation::Kind::StepNext)
      throw py::value_error(fmt::format("a switch steps; the key at frame {} does not", key.frame));
    key.next = {.kind = kind};
    key.in = key.out = {};
  }
  return compiled(keys);
}

py::object keys_object(const AnyCurve& curve) {
  return with(curve, [](const auto& own) {
    py::list keys;
    for (const auto& key : own.keys().keys) keys.append(key_object(key));
    return py::object(py::tuple(keys));
  });
}

std::string side_of(const AnyCurve& curve, const char* name) {
  return with(curve, [&](const auto& own) { return side_text(own.keys(), name); });
}

py::object loop_of(const AnyCurve& curve) {
  return with(curve, [](const auto& own) { return loop_object(own.keys().loop); });
}

void add_curve(Module& module) {
  using py::arg;
  using py::kw_only;
  Class<AnyCurve> curve(
      module, "Curve", py::module_local(),
      R"(A curve over the frames, of numbers or of vectors: `keys` are `Key`s or `(frame, value)`.

Immutable, and compiled at once. Before and after its keys it does what `before` and `after` say:
hold, linear, linearOuter, "slope 2", repeat, repeatOffset, mirror, or "repeat 3" with a count.
`overshoot` is limit, keepStart, contain or error. Raises InvalidInput naming the key.)");
  curve.def(py::init(&curve_of), arg("keys"), kw_only(), arg("before") = "hold",
            arg("after") = "hold", arg("overshoot") = "limit", arg("loop") = py::none());
  curve.def_property_readonly("keys", &keys_object, "The `Key`s, a tuple.");
  curve.def_property_readonly(
      "before", [](const AnyCurve& own) { return side_of(own, "before"); },
      "What the curve does before its keys.");
  curve.def_property_readonly(
      "after", [](const AnyCurve& own) { return side_of(own, "after"); },
      "What the curve does after its keys.");
  curve.def_property_readonly(
      "overshoot", [](const AnyCurve& own) { return side_of(own, "overshoot"); },
      "How tangents that would make time run backwards are corrected.");
  curve.def_property_readonly("loop", &loop_of, "The inner `Loop`, or None.");
  curve.def_property_readonly(
      "dimension",
      [](const AnyCurve& own) { return with(own, [](const auto& c) { return dimension_of(c); }); },
      "1: numbers; 3: vectors.");
  curve.def_property_readonly(
      "notes",
      [](const AnyCurve& own) {
        return with(own, [](const auto& c) {
          py::list notes;
          for (const CurveNote& note : c.notes())
            notes.append(py::make_tuple(note.key, note.message));
          return py::tuple(notes);
        });
      },
      "What the rules changed: pairs (key index, message).");
  curve.def_property_readonly(
      "handles",
      [](const AnyCurve& own) {
        return with(own, []<int D>(const Curve<D>& c) {
          py::list handles;
          for (const KeyHandle<D>& handle : c.handles())
            handles.append(class_named("Handle")(handle.key_frame,
                                                 value_object<D>(handle.key_value), handle.frame,
                                                 value_object<D>(handle.value)));
          return py::tuple(handles);
        });
      },
      "The handles of its Bézier segments: `key_frame, key_value, frame, value`.");
  const auto add_evaluation = [&](const char* name, auto one, auto three, const char* meaning) {
    curve.def(
        name,
        [one, three](const AnyCurve& own, const py::object& frames) {
          if (const auto* const number = std::get_if<Curve<1>>(&own.curve))
            return evaluated<1>(*number, one, frames);
          return evaluated<3>(std::get<Curve<3>>(own.curve), three, frames);
        },
        arg("frames"), meaning);
  };
  add_evaluation("__call__", &Curve<1>::value, &Curve<3>::value,
                 "The value at a frame, or (n,) or (n, 3) at an array of frames [unit].");
  add_evaluation("left_value", &Curve<1>::left_value, &Curve<3>::left_value,
                 "The limit from the left, as `curve(frames)` [unit].");
  add_evaluation("velocity", &Curve<1>::velocity, &Curve<3>::velocity,
                 "The slope to the right, as `curve(frames)` [unit/frame].");
  add_evaluation("left_velocity", &Curve<1>::left_velocity, &Curve<3>::left_velocity,
                 "The slope to the left, as `curve(frames)` [unit/frame].");
  curve.def(
      "range",
      [](const AnyCurve& own, double first, double last) {
        frames_of(py::make_tuple(first, last));
        return with(own, [&]<int D>(const Curve<D>& c) {
          const auto range = c.range(first, last);
          return py::make_tuple(value_object<D>(range.low), value_object<D>(range.high));
        });
      },
      arg("first"), arg("last"), "The least and the greatest value over [first, last] [unit].");
  const auto add_edit = [&](const char* name, auto edit, const char* meaning, const auto&... args) {
    curve.def(name, edit, args..., meaning);
  };
  add_edit(
      "insert_key",
      [](const AnyCurve& own, double frame) {
        return with(own, [&](const auto& c) { return edited(insert_key(c, frame)); });
      },
      "The same curve with one more key.", arg("frame"));
  add_edit(
      "delete_keys",
      [](const AnyCurve& own, const std::vector<std::size_t>& indices) {
        return with(own, [&](const auto& c) { return edited(delete_keys(c, indices)); });
      },
      "The curve without the keys of these indices, increasing.", arg("indices"));
  add_edit(
      "move_key",
      [](const AnyCurve& own, std::size_t index, double frames, const py::object& rise) {
        return with(own, [&]<int D>(const Curve<D>& c) {
          return edited(move_key(c, index, frames, rise_of<D>(rise)));
        });
      },
      "The curve with one key later by `frames` and higher by `rise`.", arg("index"), arg("frames"),
      arg("rise"));
  add_edit(
      "moved",
      [](const AnyCurve& own, double frames, const py::object& rise) {
        return with(own, [&]<int D>(const Curve<D>& c) {
          return edited(move_keys(c, frames, rise_of<D>(rise)));
        });
      },
      "The curve later by `frames` and higher by `rise`.", arg("frames"), arg("rise"));
  add_edit(
      "scaled",
      [](const AnyCurve& own, double frame, double time_factor, const py::object& value,
         const py::object& value_factor) {
        return with(own, [&]<int D>(const Curve<D>& c) {
          return edited(
              scale(c, Scaling<D>{.frame = frame,
                                  .time_factor = time_factor,
                                  .value = spread<D>(value, "value"),
                                  .value_factor = spread<D>(value_factor, "value_factor")}));
        });
      },
      "The curve stretched in time about `frame` and in value about `value`.", kw_only(),
      arg("frame") = 0.0, arg("time_factor") = 1.0, arg("value") = 0.0, arg("value_factor") = 1.0);
  add_edit(
      "reversed",
      [](const AnyCurve& own, double pivot) {
        return with(own, [&](const auto& c) { return edited(reverse(c, pivot)); });
      },
      "The curve run backwards: f(2 pivot - t).", arg("pivot"));
  add_edit(
      "baked",
      [](const AnyCurve& own, double first, double last, double step, const std::string& word) {
        const Interpolation::Kind next = baked_kind(word);
        return with(own, [&](const auto& c) {
          auto keys = stoppable([&](const StopRequest& should_stop) {
            return bake_keys(c, first, last, step, next, should_stop);
          });
          if (!keys) raise("curve", keys.error());
          return compiled(*keys);
        });
      },
      "A key every `step` frames with the values of the curve.", arg("first"), arg("last"),
      arg("step") = 1.0, kw_only(), arg("interpolation") = "bezier");
  add_edit(
      "simplified",
      [](const AnyCurve& own, double first, double last, double max_error) {
        return with(own, [&](const auto& c) {
          auto result = stoppable([&](const StopRequest& should_stop) {
            return simplify(c, first, last, max_error, should_stop);
          });
          if (!result) raise("curve", result.error());
          return py::make_tuple(compiled(result->keys), result->error);
        });
      },
      "Fewer keys for nearly the same curve, and the largest deviation [unit].", arg("first"),
      arg("last"), arg("max_error"));
  curve.def("_stepped", &stepped);
  curve.def("__eq__", [](const AnyCurve& a, const py::object& b) -> py::object {
    if (!py::isinstance<AnyCurve>(b)) return py::reinterpret_borrow<py::object>(Py_NotImplemented);
    return py::bool_(a == b.cast<AnyCurve&>());
  });
  curve.def("__hash__", [](const AnyCurve& own) {
    return with(own, []<int D>(const Curve<D>& c) {
      return py::hash(py::make_tuple(D, c.keys().keys.size(), c.keys().keys.front().frame,
                                     c.keys().keys.back().frame));
    });
  });
  curve.def("__repr__", [](const AnyCurve& own) {
    return with(own, []<int D>(const Curve<D>& c) {
      const auto& keys = c.keys().keys;
      return fmt::format("<pliant.Curve of {} {}, frames {} to {}>", keys.size(),
                         keys.size() == 1 ? "key" : "keys", keys.front().frame, keys.back().frame);
    });
  });
  curve.def("__copy__", [](const AnyCurve& own) { return own; });
  curve.def("__deepcopy__", [](const AnyCurve& own, const py::dict&) { return own; });
  curve.def("_adjusted", [](const AnyCurve& own, const Adjusting& adjusting) {
    return with(own, [&]<int D>(const Curve<D>& c) {
      return AnyCurve{c.unadjusted().adjusted(adjustments_of<D>(adjusting))};
    });
  });
  curve.def("__reduce__", [](const AnyCurve& own) {
    return with(own, []<int D>(const Curve<D>& c) {
      const AnyCurve plain{c.unadjusted()};
      return py::make_tuple(
          class_named("make_curve"),
          py::make_tuple(keys_object(plain), side_of(plain, "before"), side_of(plain, "after"),
                         side_of(plain, "overshoot"), loop_of(plain), adjusting_of(c)));
    });
  });
}

PathPosition path_of(const std::vector<Value<3>>& waypoints, bool is_closed,
                     const py::object& progress) {
  auto path = Path::make(waypoints, is_closed);
  if (!path) raise(fmt::format("waypoint {}", path.error().index), path.error());
  PathMotion motion{*std::move(path)};
  if (py::isinstance<AnyCurve>(progress)) {
    const auto* const curve = std::get_if<Curve<1>>(&progress.cast<AnyCurve&>().curve);
    if (curve == nullptr) throw py::value_error("progress must be a number or a curve of numbers");
    motion.progress = *curve;
  } else {
    motion.progress = value_of<1>(progress, "progress");
  }
  return {PositionChannel(std::move(motion))};
}

void add_path(Module& module) {
  using py::arg;
  Class<PathPosition> path(
      module, "Path", py::module_local(),
      R"(A position that follows a smooth path through `waypoints`, (n, 3) [length].

`progress` is the share of its length, a number or a `Curve`. Immutable. Raises InvalidInput naming
the waypoint.)");
  const auto motion = [](const PathPosition& own) -> const PathMotion& {
    return *own.position.path();
  };
  path.def(py::init([](const py::object& waypoints, bool closed, const py::object& progress) {
             const Field points = field_of(waypoints, "waypoints");
             std::vector<Value<3>> places;
             for (Eigen::Index k = 0; k < points.rows(); ++k)
               places.push_back({points(k, 0), points(k, 1), points(k, 2)});
             return path_of(places, closed, progress);
           }),
           arg("waypoints"), py::kw_only(), arg("closed") = false, arg("progress") = 0.0);
  path.def_property_readonly(
      "waypoints",
      [motion](const PathPosition& own) {
        const auto& places = motion(own).path.waypoints();
        py::array_t<double> array({static_cast<py::ssize_t>(places.size()), py::ssize_t{3}});
        std::copy_n(places.front().data(), 3 * places.size(), array.mutable_data());
        return view_of(array);
      },
      "(n, 3), read-only [length].");
  path.def_property_readonly(
      "closed", [motion](const PathPosition& own) { return motion(own).path.is_closed(); },
      "Whether it goes back to its first waypoint.");
  path.def_property_readonly(
      "progress",
      [motion](const PathPosition& own) -> py::object {
        const Channel<1>& progress = motion(own).progress;
        if (progress.is_animated()) return py::cast(AnyCurve{progress.curve()});
        return py::float_(progress.at(0)[0]);
      },
      "The share of its length, a number or a `Curve`.");
  path.def_property_readonly(
      "length", [motion](const PathPosition& own) { return motion(own).path.length(); },
      "Its length [length].");
  path.def(
      "at",
      [motion](const PathPosition& own, double progress) {
        return value_object<3>(motion(own).path.at(progress));
      },
      arg("progress"), "The point after this share of its length [length].");
  path.def("__eq__", [](const PathPosition& a, const py::object& b) -> py::object {
    if (!py::isinstance<PathPosition>(b))
      return py::reinterpret_borrow<py::object>(Py_NotImplemented);
    return py::bool_(a == b.cast<PathPosition&>());
  });
  path.def("__hash__", [motion](const PathPosition& own) {
    return py::hash(py::make_tuple(motion(own).path.waypoints().size(), motion(own).path.length()));
  });
  path.def("__repr__", [motion](const PathPosition& own) {
    return fmt::format("<pliant.Path of {} waypoints>", motion(own).path.waypoints().size());
  });
  path.def("__copy__", [](const PathPosition& own) { return own; });
  path.def("__deepcopy__", [](const PathPosition& own, const py::dict&) { return own; });
  path.def("_adjusted", [motion](const PathPosition& own, const Adjusting& adjusting) {
    PositionChannel position(motion(own));
    position.adjust(adjustments_of<3>(adjusting));
    return PathPosition{std::move(position)};
  });
  path.def("__reduce__", [](const py::object& own) {
    return py::make_tuple(
        class_named("make_path"),
        py::make_tuple(own.attr("waypoints"), own.attr("closed"), own.attr("progress"),
                       adjusting_of(own.cast<PathPosition&>().position)));
  });
}

}  // namespace

void add_curves(Module& module) {
  add_curve(module);
  add_path(module);
}

}  // namespace pliant::python
