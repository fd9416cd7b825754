#include <algorithm>
#include <iterator>
#include <numbers>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/elementary.hpp"
#include "pliant/core/expects.hpp"
#include "pliant/exchange/blender_words.hpp"
#include "pliant/exchange/convert.hpp"
#include "pliant/exchange/curve_names.hpp"
#include "pliant/exchange/fit.hpp"
#include "pliant/exchange/formats.hpp"
#include "pliant/exchange/segments.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/files/json/json_reader.hpp"

namespace pliant::exchange {
namespace {

// Blender's elastic, if it falls by less than its amplitude: its phase is turned round. Source:
// BLI_easing_elastic_ease_in and the others, easing.c.
class TurnedElastic {
 public:
  explicit TurnedElastic(const Segment& segment)
      : start_(segment.start),
        length_(segment.length()),
        from_(segment.from),
        change_(segment.to - segment.from),
        side_(segment.easing.side),
        amplitude_(*segment.easing.amplitude),
        period_(segment.easing.period.value_or(0)) {
    if (period_ == 0) period_ = length_ * (side_ == EaseSide::InOut ? 0.45 : 0.3);
    shift_ = period_ / (2 * std::numbers::pi) * asin_of(change_ / amplitude_);
  }

  double value(double frame) const {
    const double u = (frame - start_) / length_;
    if (u <= 0) return from_;
    if (u >= 1) return from_ + change_;
    if (side_ == EaseSide::In) return from_ - wave(u - 1);
    if (side_ == EaseSide::Out) return from_ + change_ + wave(-u);
    const double t = 2 * u - 1;
    return t < 0 ? from_ - wave(t) / 2 : from_ + change_ + wave(-t) / 2;
  }

 private:
  double wave(double t) const {
    return amplitude_ * exp_of(10 * std::numbers::ln2 * t) *
           sin_of((t * length_ - shift_) * 2 * std::numbers::pi / period_);
  }

  double start_, length_, from_, change_;
  EaseSide side_;
  double amplitude_, period_, shift_ = 0;
};

using InterpolationKind = Interpolation::Kind;
using Side = Extrapolation<1>::Kind;

template <std::size_t N>
std::optional<std::size_t> index_of(const std::string_view (&words)[N], std::string_view word) {
  const auto found = std::find(std::begin(words), std::end(words), word);
  if (found == std::end(words)) return {};
  return static_cast<std::size_t>(found - std::begin(words));
}

struct FKey {
  double frame = 0;
  double value = 0;
  std::array<double, 2> left{};  // of the tip
  std::array<double, 2> right{};
  Interpolation next;
};

struct FSide {
  std::size_t mode = 0;  // in `blender_cycles`
  std::uint64_t count = 0;
};

class BlenderReader : private JsonReader {
 public:
  BlenderReader(Json& root, const CurveReading& reading)
      : JsonReader(root, reading.should_stop), reading_(reading) {}

  Result<CurveFile> read() {
    const Json* const format = root_.is_object() ? member(root_, "format") : nullptr;
    if (!format || *format != "blender-curves") {
      return invalid(
          "the file does not have curves of Blender: its format is not \"blender-curves\"; write "
          "it "
          "with script/blender_curves.py");
    }
    if (const auto version = required_whole(root_, "version"); version != 1)
      refuse("version", fmt::format("is {}, but must be 1", version));
    if (const auto fps = number(root_, "fps")) {
      if (*fps > 0)
        file_.fps = *fps;
      else
        refuse("fps", fmt::format("is {}, but must be greater than 0", *fps));
    }
    each(root_, "curves", [&](Json& json) { read_curve(json); });
    if (fault_) return fault();
    return std::move(file_);
  }

 private:
  std::optional<double> number(Json& parent, const char* key) {
    const Json* const json = member(parent, key);
    if (!json || json->is_null()) return {};
    if (!json->is_number()) {
      refuse(key, "is not a number");
      return {};
    }
    return bounded(json->get<double>(), key);
  }

  double bounded(double number, const char* key) {
    if (std::fabs(number) <= largest_number) return number;
    refuse(key, fmt::format("is {}, but its size must not exceed {}", number, largest_number));
    return 0;
  }

  std::array<double, 2> point(Json& parent, const char* key) {
    const auto values = numbers(parent, key, 2);
    if (!values) {
      refuse(key, "is missing");
      return {};
    }
    return {bounded((*values)[0], key), bounded((*values)[1], key)};
  }

  template <std::size_t N>
  std::optional<std::size_t> word(Json& parent, const char* key,
                                  const std::string_view (&words)[N]) {
    const auto given = text(parent, key);
    if (!given) return {};
    auto index = index_of(words, *given);
    if (!index) {
      refuse(key, fmt::format("is {}, but must be one of {}", in_quotes(*given),
                              fmt::join(words, ", ")));
    }
    return index;
  }

  void read_curve(Json& json) {
    FileCurve curve;
    const std::string owner = text(json, "owner").value_or("");
    curve.group = text(json, "data_path").value_or("");
    if (curve.group.empty()) refuse("data_path", "is missing");
    if (!owner.empty()) curve.group = owner + '.' + curve.group;
    if (Json* const index = member(json, "index"); index && !index->is_null()) {
      const std::uint64_t number = whole(json, "index").value_or(0);
      if (number < 3)
        curve.component = static_cast<int>(number);
      else
        curve.group += fmt::format("[{}]", number);
    }
    constexpr std::string_view units[] = {"NONE", "LENGTH", "ROTATION"};
    const auto unit = word(json, "unit", units).value_or(0);
    curve.unit = unit == 1 ? CurveUnit::Length : unit == 2 ? CurveUnit::Degrees : CurveUnit::Number;
    factor_ = unit == 2 ? 180 / std::numbers::pi : 1;
    constexpr std::string_view extrapolations[] = {"CONSTANT", "LINEAR"};
    const bool is_linear = word(json, "extrapolation", extrapolations).value_or(0) == 1;
    const Json* const discrete = member(json, "discrete");
    is_discrete_ = discrete && *discrete == true;

    keys_.clear();
    each(json, "keys", [&](Json& key) { read_key(key); });
    FSide before, after;
    if (Json* const cycles = part(json, "cycles")) {
      within("cycles", [&] {
        before = {word(*cycles, "before", blender_cycles).value_or(0),
                  whole(*cycles, "before_count").value_or(0)};
        after = {word(*cycles, "after", blender_cycles).value_or(0),
                 whole(*cycles, "after_count").value_or(0)};
      });
    }
    if (fault_) return;
    name_curve(curve, names_);
    name_ = curve.name;
    if (Json* const modifiers = member(json, "modifiers"); modifiers && modifiers->is_array()) {
      for (const Json& each : *modifiers) {
        const auto* const kind = each.get_ptr<const std::string*>();
        if (kind) lose(fmt::format("its modifier {} was left out", in_quotes(*kind)));
      }
    }
    if (keys_.empty()) return lose("has no keys: left out");
    add(std::move(curve), is_linear, before, after);
  }

  void lose(std::string message, bool is_exact = false) {
    file_.losses.push_back({name_, std::move(message), is_exact});
  }

  /// False: a fault.
  bool count_keys(std::size_t more) {
    key_count_ += more;
    if (key_count_ > most_file_keys)
      refuse("", fmt::format("is one of more than {} keys", most_file_keys));
    return key_count_ <= most_file_keys;
  }

  void read_key(Json& json) {
    if (!count_keys(1)) return;
    FKey key;
    const auto co = point(json, "co");
    key.frame = co[0];
    key.value = co[1] * factor_;
    key.left = key.right = {key.frame, key.value};
    for (auto* const tip : {&key.left, &key.right}) {
      const char* const name = tip == &key.left ? "left" : "right";
      if (!member(json, name)) continue;
      const auto written = point(json, name);
      *tip = {written[0], written[1] * factor_};
    }
    read_interpolation(json, key);
    keys_.push_back(key);
  }

  void read_interpolation(Json& json, FKey& key) {
    constexpr std::string_view plain[] = {"CONSTANT", "LINEAR", "BEZIER"};
    constexpr std::string_view sides[] = {"EASE_IN", "EASE_OUT", "EASE_IN_OUT", "AUTO"};
    const std::string name = text(json, "interpolation").value_or("BEZIER");
    const auto side = word(json, "easing", sides).value_or(3);
    if (is_discrete_) {
      key.next.kind = InterpolationKind::Step;
    } else if (const auto kind = index_of(plain, name)) {
      constexpr InterpolationKind kinds[] = {InterpolationKind::Step, InterpolationKind::Linear,
                                             InterpolationKind::Bezier};
      key.next.kind = kinds[*kind];
    } else if (const auto ease = index_of(blender_eases, name)) {
      key.next.kind = InterpolationKind::Easing;
      key.next.ease = static_cast<Ease>(*ease);
      const bool is_springy = key.next.ease == Ease::Back || key.next.ease == Ease::Bounce ||
                              key.next.ease == Ease::Elastic;
      key.next.side = side < 3     ? static_cast<EaseSide>(side)
                      : is_springy ? EaseSide::Out
                                   : EaseSide::In;
      if (key.next.ease == Ease::Back) key.next.back = number(json, "back");
      if (key.next.ease == Ease::Elastic) {
        key.next.amplitude = number(json, "amplitude").value_or(0) * factor_;
        key.next.period = number(json, "period");
      }
    } else {
      refuse("interpolation", fmt::format("is {}, but must be one of {}, {}", in_quotes(name),
                                          fmt::join(plain, ", "), fmt::join(blender_eases, ", ")));
    }
  }

  /// What Blender does when keys were edited: tips on the wrong side change places, or keep their
  /// height above the key. Source: sort_time_fcurve, fcurve.c.
  static void put_right(FKey& key) {
    if (key.left[0] > key.frame && key.right[0] < key.frame) std::swap(key.left, key.right);
    key.left[0] = std::min(key.left[0], key.frame);
    key.right[0] = std::max(key.right[0], key.frame);
  }

  void add(FileCurve curve, bool is_linear, const FSide& before, const FSide& after) {
    CurveKeys<1>& keys = curve.keys;
    keys.overshoot = Overshoot::Contain;
    std::size_t joined = 0;
    for (FKey& from : keys_) {
      put_right(from);
      Key<1> key{.frame = from.frame, .value = {from.value}, .next = from.next};
      key.in = {.kind = Tangent<1>::Kind::Handle,
                .handle_frames = from.left[0] - from.frame,
                .handle_value = {from.left[1] - from.value}};
      key.out = {.kind = Tangent<1>::Kind::Handle,
                 .handle_frames = from.right[0] - from.frame,
                 .handle_value = {from.right[1] - from.value}};
      if (!keys.keys.empty() && keys.keys.back().frame == key.frame) {
        ++joined;  // a jump
        Key<1>& last = keys.keys.back();
        if (!last.left) last.left = last.value;
        last.value = key.value;
        last.out = key.out;
        last.next = key.next;
        continue;
      }
      keys.keys.push_back(key);
    }
    if (joined > 0) lose(fmt::format("{} frames have several keys: they became jumps", joined));
    set_outside(keys, is_linear);
    if (!made(keys)) return;
    replace_turned_elastics(keys);
    if (fault_) return;
    const bool has_copies = keys.keys.size() > 1;
    if (has_copies && !add_cycles(keys, before, after)) return;
    if (!made(keys)) return;
    if (!count_keys(keys.keys.size() - std::min(keys.keys.size(), keys_.size()))) return;
    file_.curves.push_back(std::move(curve));
  }

  /// Null: a fault.
  std::optional<Curve<1>> made(const CurveKeys<1>& keys) {
    auto curve = Curve<1>::make(keys, reading_.should_stop);
    if (curve) return *std::move(curve);
    if (curve.error().kind == Complaint::Kind::Interrupted)
      end();
    else
      refuse("keys", fmt::format("are not a curve: {}", curve.error().message));
    return {};
  }

  /// Source: fcurve_eval_keyframes_extrapolate, fcurve.c.
  static void set_outside(CurveKeys<1>& keys, bool is_linear) {
    if (!is_linear) return;
    const auto side = [&](bool is_before) -> Extrapolation<1> {
      const std::size_t last = keys.keys.size() - 1;
      const Key<1>& end = keys.keys[is_before ? 0 : last];
      if (end.next.kind == InterpolationKind::Step) return {};
      if (end.next.kind != InterpolationKind::Linear) return {.kind = Side::LinearOuter};
      if (last == 0) return {};
      const Key<1>& near = keys.keys[is_before ? 1 : last - 1];
      return {.kind = Side::Slope,
              .slope = {(near.value[0] - end.value[0]) / (near.frame - end.frame)}};
    };
    keys.before = side(true);
    keys.after = side(false);
  }

  void replace_turned_elastics(CurveKeys<1>& keys) {
    std::vector<Key<1>> result;
    std::size_t count = 0;
    double deviation = 0;
    for (std::size_t k = 0; k < keys.keys.size(); ++k) {
      result.push_back(keys.keys[k]);
      if (last_in_) result.back().in = *std::exchange(last_in_, std::nullopt);
      if (k + 1 == keys.keys.size()) break;
      const Key<1>& next = keys.keys[k + 1];
      const double to = next.left ? (*next.left)[0] : next.value[0];
      if (keys.keys[k].next.kind != InterpolationKind::Easing ||
          has_blender_easing(keys.keys[k].next, to - keys.keys[k].value[0]))
        continue;
      ++count;
      deviation = std::max(deviation, add_turned_elastic(keys.keys[k], next, to, result));
      if (fault_) return;
    }
    if (count == 0) return;
    lose(fmt::format(
        "{} elastic easing{} of Blender, which fall{} by less than {} amplitude, became "
        "{} keys, within {:.2g}",
        count, count == 1 ? "" : "s", count == 1 ? "s" : "", count == 1 ? "its" : "their",
        result.size() - keys.keys.size(), deviation));
    keys.keys = std::move(result);
  }

  double add_turned_elastic(const Key<1>& key, const Key<1>& next, double to,
                            std::vector<Key<1>>& result) {
    const TurnedElastic elastic({.kind = Segment::Kind::Easing,
                                 .start = key.frame,
                                 .end = next.frame,
                                 .from = key.value[0],
                                 .to = to,
                                 .easing = key.next});
    const double length = next.frame - key.frame;
    const auto slope = [&](double frame, double step) {
      const double here = elastic.value(frame);
      return Value<1>{
          (4 * (elastic.value(frame + step) - here) - (elastic.value(frame + 2 * step) - here)) /
          (2 * step)};
    };
    const SmoothFunction<1> function{[&](double frame) { return Value<1>{elastic.value(frame)}; },
                                     [&](double frame) { return slope(frame, 1e-5 * length); },
                                     [&](double frame) { return slope(frame, -1e-5 * length); }};
    // An elastic swings beyond both its values by its amplitude.
    const double range = std::fabs(to - key.value[0]) + *key.next.amplitude;
    const double middle = key.frame + length / 2;
    double deviation = 0;
    result.back().next = {};
    for (const bool is_first : {true, false}) {
      Fitter<1> fitter(function, reading_.tolerance * range, 1e-4, most_fitted,
                       reading_.should_stop);
      const Fit<1> fit = is_first ? fitter.fit(key.frame, middle) : fitter.fit(middle, next.frame);
      if (fit.is_stopped) {
        end();
        return 0;
      }
      if (!fit.is_complete || result.size() > most_fitted) {
        refuse("keys",
               fmt::format("have an elastic that would become more than {} keys", most_fitted));
        return 0;
      }
      deviation = std::max(deviation, fit.deviation);
      for (const FittedCubic<1>& cubic : fit.cubics) {
        const auto tangent = [](double each) {
          return Tangent<1>{.kind = Tangent<1>::Kind::Slope, .slope = {each}};
        };
        result.back().out = tangent(cubic.from_slope[0]);
        if (cubic.end < next.frame) {
          result.push_back(
              {.frame = cubic.end, .value = cubic.to, .in = tangent(cubic.to_slope[0])});
        } else {
          last_in_ = tangent(cubic.to_slope[0]);
        }
      }
    }
    return deviation;
  }

  /// Source: fcm_cycles_time, fmodifier.c. Beyond the last copy Blender has what it has without
  /// copies. False: a fault.
  bool add_cycles(CurveKeys<1>& keys, const FSide& before, const FSide& after) {
    if (before.mode == 0 && after.mode == 0) return true;
    const auto curve = made(keys);
    if (!curve) return false;
    const auto holds = [&](const FSide& side, const Value<1>& slope) {
      if (side.count == 0) return true;
      if (slope[0] != 0) return false;
      return blender_cycles[side.mode] == "REPEAT" ||
             (blender_cycles[side.mode] == "MIRROR" && side.count % 2 == 0);
    };
    const bool keeps_before = holds(before, curve->left_velocity(keys.keys.front().frame));
    const bool keeps_after = holds(after, curve->velocity(keys.keys.back().frame));
    const bool writes = (before.mode != 0 && !keeps_before) || (after.mode != 0 && !keeps_after);
    const CurveKeys<1> plain = keys;
    for (const bool is_before : {true, false}) {
      const FSide& side = is_before ? before : after;
      if (side.mode == 0) continue;
      constexpr Side kinds[] = {Side::Hold, Side::Repeat, Side::RepeatOffset, Side::Mirror};
      Extrapolation<1>& own = is_before ? keys.before : keys.after;
      own = {.kind = kinds[side.mode]};
      if (side.count > 0) own.count = static_cast<double>(side.count);
    }
    if (!writes) return true;
    // An endless side beside one that is written out cannot stay: it would repeat the copies.
    if ((before.mode != 0 && before.count == 0) || (after.mode != 0 && after.count == 0)) {
      lose("its copies end otherwise than in Blender on the side where they are counted");
      return true;
    }
    return write_cycles(keys, plain, before.mode != 0, after.mode != 0);
  }

  bool write_cycles(CurveKeys<1>& keys, const CurveKeys<1>& plain, bool has_before,
                    bool has_after) {
    const auto curve = made(keys), without = made(plain);
    if (!curve || !without) return false;
    auto segments =
        with_copies(segments_of(*curve), has_before ? std::optional(-1e9) : std::nullopt,
                    has_after ? std::optional(1e9) : std::nullopt);
    if (!segments) {
      refuse("cycles", "has too many copies: " + segments.error().message);
      return false;
    }
    const std::size_t count = segments->frames.size() - plain.keys.size();
    if (has_before) {
      const double end = segments->frames.front();
      segments->frames.insert(segments->frames.begin(), end - 1);
      add_segment(*segments, *without, end - 1, end, segments->segments.begin());
      segments->values.insert(segments->values.begin(), segments->segments.front().from);
    }
    if (has_after) {
      const double end = segments->frames.back();
      segments->frames.push_back(end + 1);
      add_segment(*segments, *without, end, end + 1, segments->segments.end());
      const bool is_line = segments->segments.back().kind == Segment::Kind::Line;
      if (is_line && segments->segments.back().from != segments->values.back()) {
        // A line cannot begin with another value than that of its key.
        segments->values.back() = segments->segments.back().from;
        lose(fmt::format("on frame {}, the last of its copies, it has the value beside it", end));
      }
      segments->values.push_back(segments->segments.back().to);
    }
    segments->before = {.anchor = segments->values.front()};
    segments->after = {.anchor = segments->values.back()};
    // A copy that begins with another value than the one before ends with jumps off its key.
    const Abilities abilities{.has_step_next = true,
                              .has_left_values = true,
                              .has_easing = [](const Segment&) { return true; }};
    auto converted = convert(*std::move(segments), abilities, 0, {}, reading_.should_stop);
    if (!converted && converted.error().code == ErrorCode::Interrupted) {
      end();
      return false;
    }
    if (!converted) {
      refuse("cycles", converted.error().message);
      return false;
    }
    for (Loss& loss : converted->losses) lose(std::move(loss.message), loss.is_exact);
    keys.keys = keys_of(converted->segments).keys;
    keys.before = without_copies(*without, plain, true);
    keys.after = without_copies(*without, plain, false);
    keys.overshoot = Overshoot::Limit;
    lose(fmt::format("its copies, which end otherwise in pliant, became {} keys", count), true);
    return true;
  }

  static void add_segment(Segments& segments, const Curve<1>& without, double start, double end,
                          std::vector<Segment>::iterator at) {
    Segment segment{
        .start = start, .end = end, .from = without.value(start)[0], .to = without.value(end)[0]};
    if (segment.from == segment.to) segment.kind = Segment::Kind::Constant;
    segments.segments.insert(at, segment);
  }

  static Extrapolation<1> without_copies(const Curve<1>& without, const CurveKeys<1>& plain,
                                         bool is_before) {
    const auto& keys = plain.keys;
    const Value<1> slope =
        is_before ? without.left_velocity(keys.front().frame) : without.velocity(keys.back().frame);
    if (slope[0] == 0) return {};
    return {.kind = Side::Slope, .slope = slope};
  }

  static constexpr double largest_number = 1e30;

  const CurveReading& reading_;
  CurveFile file_;
  CurveNames names_;
  std::string name_;
  double factor_ = 1;
  bool is_discrete_ = false;
  std::vector<FKey> keys_;
  std::optional<Tangent<1>> last_in_;  // of the key after an elastic that became keys
  std::size_t key_count_ = 0;
};

}  // namespace

bool has_blender_easing(const Interpolation& easing, double change) {
  return easing.ease != Ease::Elastic || change > 0 || !easing.amplitude ||
         !(*easing.amplitude > -change);
}

Result<CurveFile> parse_blender(std::string_view text, const CurveReading& reading) {
  auto root = parse_json(text, "JSON", reading.should_stop);
  if (!root) return fail(root.error());
  return BlenderReader(*root, reading).read();
}

}  // namespace pliant::exchange
