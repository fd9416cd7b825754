#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/exchange/curve_names.hpp"
#include "pliant/exchange/formats.hpp"
#include "pliant/exchange/maya_units.hpp"
#include "pliant/files/file_object.hpp"
#include "pliant/timeline/tangents.hpp"

namespace pliant::exchange {
namespace {

using Kind = Tangent<1>::Kind;
using Outer = Extrapolation<1>::Kind;

/// The words of a text, with `;`, `{` and `}` as words of their own. Comments begin with # or //.
class WordScanner {
 public:
  WordScanner(std::string_view text, StopPoll& stop) : text_(text), stop_(&stop) {}

  /// The next word, empty at the end, or if it is stopped.
  std::string_view next() {
    constexpr std::size_t parts_of_word = 32, longest_word = std::size_t{1} << 16U;
    skip_blanks();
    word_line_ = line_;
    if (at_ == text_.size() || stop_->after(parts_of_word)) return {};
    const std::size_t begin = at_;
    const char first = text_[at_];
    if (first == ';' || first == '{' || first == '}') {
      ++at_;
    } else if (first == '"') {
      const std::size_t end = std::min(text_.find('"', at_ + 1), text_.size() - 1);
      const std::string_view quoted = text_.substr(begin, end - begin + 1);
      line_ += static_cast<int>(std::count(quoted.begin(), quoted.end(), '\n'));
      at_ = end + 1;
      return quoted;
    } else {
      const std::string_view known = text_.substr(0, std::min(at_ + longest_word, text_.size()));
      at_ = std::min(known.find_first_of(" \t\r\n\v\f;{}", at_), known.size());
    }
    return text_.substr(begin, at_ - begin);
  }

  std::string_view peek() {
    const WordScanner before = *this;
    const std::string_view word = next();
    *this = before;
    return word;
  }

  int line() const { return word_line_; }  ///< of the word before

 private:
  void skip_blanks() {
    while (at_ < text_.size()) {
      const char c = text_[at_];
      if (c == '\n') ++line_;
      if (c == '#' || text_.substr(at_).starts_with("//")) {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (ascii_blanks.find(c) != std::string_view::npos && !stop_->after()) {
        ++at_;
      } else {
        return;
      }
    }
  }

  std::string_view text_;
  StopPoll* stop_;
  std::size_t at_ = 0;
  int line_ = 1;
  int word_line_ = 1;
};

/// A tangent as the file has it.
struct WrittenTangent {
  std::string_view kind;
  double angle = 0;   // [radians]
  double weight = 0;  // length of the handle
};

struct WrittenKey {
  double time = 0;
  double value = 0;
  WrittenTangent in;
  WrittenTangent out;
  int line = 0;
};

struct CurveHead {
  std::string input = "time";
  std::string output = "linear";
  bool is_weighted = false;
  Outer before = Outer::Hold;
  Outer after = Outer::Hold;
  std::string input_unit;
  std::string output_unit;
  double angle_unit = 1;  // of tangents [radians]
};

constexpr std::string_view maya_tangents[] = {"global", "fixed", "linear",   "flat",
                                              "spline", "step",  "stepnext", "slow",
                                              "fast",   "auto",  "clamped",  "plateau"};

class MayaReader {
 public:
  MayaReader(std::string_view text, const CurveReading& reading)
      : stop_(reading.should_stop), words_(text, stop_), reading_(reading) {}

  Result<CurveFile> read() {
    auto read = read_all();
    if (stop_.after(0)) return interrupted();
    if (!read) return fail(read.error());
    return std::move(file_);
  }

 private:
  tl::unexpected<Error> broken(std::string message) const {
    return invalid(std::move(message), words_.line());
  }

  Result<void> read_all() {
    bool has_version = false;
    for (std::string_view word = words_.next(); !word.empty(); word = words_.next()) {
      if (word == ";") continue;
      if (!has_version && word != "animVersion")
        return broken("the file is not a Maya .anim: it does not begin with animVersion");
      if (word == "animVersion") {
        const auto version = number("animVersion");
        if (!version) return fail(version.error());
        has_breakdowns_ = *version >= 1.1;
        has_version = true;
      } else if (word == "mayaVersion") {
        // Tangents of Maya 1 and 2 are in seconds and radians.
        if (words_.peek().starts_with("1.") || words_.peek().starts_with("2."))
          return broken("mayaVersion is before 3, whose angles mean something else; save it again");
        skip_statement();
      } else if (word == "timeUnit") {
        time_unit_ = std::string(words_.next());
        if (!seconds_of(time_unit_))
          return unknown("timeUnit", time_unit_, "such as film, pal, ntsc, 120fps or sec");
        file_.fps = rate_of(time_unit_);
      } else if (word == "angularUnit") {
        angular_unit_ = std::string(words_.next());
        if (!radians_of(angular_unit_))
          return unknown("angularUnit", angular_unit_, "deg, rad, min or sec");
      } else if (word == "linearUnit" ||  // numbers stay as they are
                 word == "startTime" || word == "endTime" || word == "startUnitless" ||
                 word == "endUnitless") {
        skip_statement();
      } else if (word == "anim") {
        if (auto read = read_anim(); !read) return read;
      } else {
        return unknown("keyword", word, "anim or a line of the header");
      }
    }
    if (!has_version) return broken("the file is not a Maya .anim: it has no animVersion");
    return {};
  }

  tl::unexpected<Error> unknown(std::string_view what, std::string_view word,
                                std::string_view rule) const {
    if (word.empty()) return broken(fmt::format("the file ends within {}", what));
    return broken(fmt::format("{} {} is not known; it must be {}", what, in_quotes(word), rule));
  }

  void skip_statement() {
    while (!words_.peek().empty() && words_.peek() != "{" && words_.peek() != "}")
      if (words_.next() == ";") return;
  }

  Result<double> number(std::string_view what) {
    const std::string_view word = words_.next();
    if (word.empty()) return broken(fmt::format("the file ends where {} should be", what));
    const auto number = to_number(word);
    if (!number) return broken(fmt::format("{} {} is not a finite number", what, in_quotes(word)));
    if (std::fabs(*number) > largest_number) {
      return broken(fmt::format("{} {} is too large: its size must not exceed {}", what,
                                in_quotes(word), largest_number));
    }
    return *number;
  }

  Result<bool> flag(std::string_view what) {
    const auto read = number(what);
    if (!read) return fail(read.error());
    if (*read != 0 && *read != 1)
      return broken(fmt::format("{} is {}, but must be 0 or 1", what, *read));
    return *read == 1;
  }

  /// `anim translate.translateX translateX pSphere1 0 1 0;`, the attribute with its leaf and its
  /// node, or the attribute alone, or nothing; then three counts.
  Result<void> read_anim() {
    std::vector<std::string_view> words;
    for (;;) {
      const std::string_view word = words_.peek();
      if (word.empty() || word == "{" || word == "}" || words.size() > 8)
        return broken("an anim line does not end with ;");
      words_.next();
      if (word == ";") break;
      words.push_back(word);
    }
    if (words.size() < 3)
      return broken("an anim line ends with three numbers: row, child, attribute");
    words.resize(words.size() - 3);
    if (words_.peek() != "animData") return {};  // a node without a curve
    words_.next();
    return read_curve(words);
  }

  Result<void> read_curve(const std::vector<std::string_view>& words) {
    const std::string_view attribute = words.empty() ? "curve" : words[0];
    const std::string_view leaf = words.size() > 1 ? words[1] : attribute;
    const std::string node = words.size() > 2 ? std::string(words[2]) + '.' : "";
    FileCurve curve;
    const std::size_t dot = attribute.rfind('.');
    const std::string_view parent = dot == std::string_view::npos ? "" : attribute.substr(0, dot);
    const std::string_view last = leaf.substr(leaf.rfind('.') + 1);  // npos + 1 is 0
    curve.group = node + std::string(attribute);
    if (!last.empty() && !parent.empty() && last.substr(0, last.size() - 1) == parent) {
      const std::size_t letter = std::string_view("XYZ").find(last.back());
      if (letter != std::string_view::npos) {
        curve.component = static_cast<int>(letter);
        curve.group = node + std::string(parent);
      }
    }
    name_curve(curve, names_);
    auto head = read_head(curve.name);
    if (!head) return fail(head.error());
    const auto keys = read_keys(*head);
    if (!keys) return fail(keys.error());
    if (head->input != "time") {
      file_.losses.push_back({curve.name, "is driven by an attribute, not by time: left out"});
      return {};
    }
    return add(std::move(curve), *head, *keys);
  }

  Result<CurveHead> read_head(const std::string& name) {
    CurveHead head;
    const auto radians = radians_of(angular_unit_);
    head.angle_unit = *radians;
    if (words_.next() != "{") return broken(fmt::format("{}: animData has no {{", name));
    for (;;) {
      const std::string word(words_.next());
      if (word == ";") continue;
      if (word.empty()) return broken(fmt::format("the file ends within the animData of {}", name));
      if (word == "keys") {
        if (words_.next() != "{") return broken(fmt::format("{}: keys has no {{", name));
        return head;
      }
      if (word == "weighted") {
        const auto weighted = flag("weighted");
        if (!weighted) return fail(weighted.error());
        head.is_weighted = *weighted;
        continue;
      }
      const std::string value(words_.next());
      if (word == "input") {
        head.input = value;
        if (value != "time" && value != "unitless") return unknown(word, value, "time or unitless");
      } else if (word == "output") {
        head.output = value;
        if (value != "linear" && value != "angular" && value != "unitless" && value != "time")
          return unknown(word, value, "linear, angular, unitless or time");
      } else if (word == "preInfinity" || word == "postInfinity") {
        const auto outer = outer_of(value);
        if (!outer)
          return unknown(word, value, "constant, linear, cycle, cycleRelative or oscillate");
        (word == "preInfinity" ? head.before : head.after) = *outer;
      } else if (word == "inputUnit") {
        head.input_unit = value;
      } else if (word == "outputUnit") {
        head.output_unit = value;
      } else if (word == "tangentAngleUnit") {
        const auto unit = radians_of(value);
        if (!unit) return unknown(word, value, "deg, rad, min or sec");
        head.angle_unit = *unit;
      } else {
        return unknown("keyword", word, "one of animData: input, output, weighted, keys, …");
      }
    }
  }

  static std::optional<Outer> outer_of(std::string_view word) {
    if (word == "constant") return Outer::Hold;
    if (word == "linear") return Outer::LinearOuter;
    if (word == "cycle") return Outer::Repeat;
    if (word == "cycleRelative") return Outer::RepeatOffset;
    if (word == "oscillate") return Outer::Mirror;
    return {};
  }

  Result<std::vector<WrittenKey>> read_keys(const CurveHead& head) {
    std::vector<WrittenKey> keys;
    for (;;) {
      const std::string_view word = words_.peek();
      if (word == ";") {
        words_.next();
        continue;
      }
      if (word == "}") {
        words_.next();
        break;
      }
      if (++key_count_ > most_file_keys)
        return broken(fmt::format("the file has more than {} keys", most_file_keys));
      auto key = read_key(head);
      if (!key) return fail(key.error());
      keys.push_back(*key);
    }
    if (words_.next() != "}") return broken("animData has no } after that of its keys");
    return keys;
  }

  Result<WrittenKey> read_key(const CurveHead& head) {
    WrittenKey key;
    const auto time = number("the time of a key");
    if (!time) return fail(time.error());
    key.line = words_.line();
    const auto value = number("the value of a key");
    if (!value) return fail(value.error());
    key.time = *time;
    key.value = *value;
    for (WrittenTangent* tangent : {&key.in, &key.out}) {
      const std::string_view word = words_.next();
      const auto known = std::find(std::begin(maya_tangents), std::end(maya_tangents), word);
      if (known == std::end(maya_tangents))
        return unknown("tangent", word, fmt::format("{}", fmt::join(maya_tangents, ", ")));
      tangent->kind = *known;
    }
    // Locks and breakdowns matter to the editor only.
    for (const char* what : {"tangentsLocked", "weightsLocked", "breakdown"}) {
      if (!has_breakdowns_ && what[0] == 'b') continue;
      if (auto read = flag(what); !read) return fail(read.error());
    }
    for (WrittenTangent* tangent : {&key.in, &key.out}) {
      if (tangent->kind != "fixed") continue;
      const auto angle = number("the angle of a fixed tangent");
      if (!angle) return fail(angle.error());
      const auto weight = number("the weight of a fixed tangent");
      if (!weight) return fail(weight.error());
      if (*weight < 0)
        return broken(
            fmt::format("the weight {} of a fixed tangent must not be negative", *weight));
      tangent->angle = *angle * head.angle_unit;
      tangent->weight = *weight;
    }
    if (words_.peek() != ";" && words_.peek() != "}")
      return broken(fmt::format("key {} has {} after its tangents; it must end with ;", key.time,
                                in_quotes(words_.peek())));
    return key;
  }

  /// Frames in a unit of the key's times.
  Result<double> frames_in(const CurveHead& head) {
    const std::string& unit = head.input_unit.empty() ? time_unit_ : head.input_unit;
    const auto seconds = seconds_of(unit);
    if (!seconds) return unknown("inputUnit", unit, "such as film, pal, ntsc, 120fps or sec");
    const auto rate = rate_of(unit);
    if (rate && (!file_.fps || *rate == *file_.fps)) return 1.0;  // frames stay frames
    return *seconds * file_.fps.value_or(reading_.fps);
  }

  Result<double> factor_of(const CurveHead& head) const {
    if (head.output != "angular") return 1.0;
    const auto radians = radians_of(head.output_unit.empty() ? angular_unit_ : head.output_unit);
    if (!radians) return unknown("outputUnit", head.output_unit, "deg, rad, min or sec");
    const double degree = *radians_of("deg");
    return *radians == degree ? 1.0 : *radians / degree;
  }

  static constexpr double steepest_maya = 5729577.9485111479;  // of an upright tangent

  Tangent<1> tangent_of(const WrittenTangent& written, const CurveHead& head, bool is_out,
                        double frames, double factor) {
    const double upright = std::numbers::pi / 2;
    if (written.kind == "fixed") {
      const bool is_upright = std::fabs(written.angle) >= upright * (1 - 1e-15);
      if (!head.is_weighted) {
        double slope = std::tan(written.angle);
        if (is_upright) slope = std::copysign(steepest_maya, written.angle);
        return {.kind = Kind::Slope, .slope = {slope * factor / frames}};
      }
      const double reach = is_upright ? 0 : written.weight * std::cos(written.angle) * frames;
      const double rise = written.weight * (is_upright ? std::copysign(1.0, written.angle)
                                                       : std::sin(written.angle));
      return {.kind = Kind::Handle,
              .handle_frames = is_out ? reach : -reach,
              .handle_value = {(is_out ? rise : -rise) * factor}};
    }
    if (written.kind == "step" || written.kind == "stepnext") {
      // The other side of a step: a tangent of no length.
      if (head.is_weighted) return {.kind = Kind::Handle};
      return {.kind = Kind::Flat};
    }
    if (written.kind == "linear" || written.kind == "slow" || written.kind == "fast")
      return {.kind = Kind::Linear};
    if (written.kind == "flat") return {.kind = Kind::Flat};
    if (written.kind == "spline") return {.kind = Kind::Spline};
    if (written.kind == "clamped") return {.kind = Kind::Clamped};
    if (written.kind == "plateau") return {.kind = Kind::Plateau};
    return {.kind = Kind::Auto};
  }

  Result<void> add(FileCurve curve, const CurveHead& head, const std::vector<WrittenKey>& written) {
    const auto frames = frames_in(head);
    if (!frames) return fail(frames.error());
    const auto factor = factor_of(head);
    if (!factor) return fail(factor.error());
    const auto lose = [&](std::string message) {
      file_.losses.push_back({curve.name, std::move(message)});
    };
    bool has_old = false, has_global = false;
    for (const WrittenKey& each : written) {
      Key<1> key{.frame = each.time * *frames, .value = {each.value * *factor}};
      key.in = tangent_of(each.in, head, false, *frames, *factor);
      key.out = tangent_of(each.out, head, true, *frames, *factor);
      if (each.out.kind == "step") key.next.kind = Interpolation::Kind::Step;
      if (each.out.kind == "stepnext") key.next.kind = Interpolation::Kind::StepNext;
      for (const std::string_view kind : {each.in.kind, each.out.kind}) {
        has_old = has_old || kind == "slow" || kind == "fast";
        has_global = has_global || kind == "global";
      }
      curve.keys.keys.push_back(key);
    }
    for (std::size_t k = 0; k + 1 < written.size(); ++k) {
      if (written[k].out.kind == "linear" && written[k + 1].in.kind == "linear")
        curve.keys.keys[k].next.kind = Interpolation::Kind::Linear;
    }
    if (has_old) lose("its tangents slow and fast became straight lines, as Maya shows them");
    if (has_global) lose("its tangents global became auto");
    curve.keys.before.kind = head.before;
    curve.keys.after.kind = head.after;
    if (head.is_weighted) curve.keys.overshoot = Overshoot::KeepStart;
    if (head.output == "angular") curve.unit = CurveUnit::Degrees;
    if (head.output == "linear") curve.unit = CurveUnit::Length;
    if (const auto made = Curve<1>::make(curve.keys, reading_.should_stop); !made) {
      const std::size_t key = made.error().index;
      return fail(error_of(made.error(), curve.name,
                           key < written.size() ? written[key].line : words_.line()));
    }
    open_seam(curve.keys);
    if (jumps_at_seam(curve.keys))
      lose(
          "where its copies meet, Maya has the first value of the next, pliant the last of the one "
          "before");
    file_.curves.push_back(std::move(curve));
    return {};
  }

  /// Maya's automatic tangents at the ends know nothing of copies; pliant's do.
  static void open_seam(CurveKeys<1>& keys) {
    const auto is_copies = [](const Extrapolation<1>& side) {
      return side.kind == Outer::Repeat || side.kind == Outer::RepeatOffset;
    };
    if (!is_copies(keys.before) && !is_copies(keys.after)) return;
    const Slopes slopes =
        timeline::tangent_slopes(keys.keys, Extrapolation<1>{}, Extrapolation<1>{}, 0);
    const auto write = [](Tangent<1>& tangent, double slope) {
      if (tangent.kind == Kind::Handle || tangent.kind == Kind::Slope ||
          tangent.kind == Kind::Flat || tangent.kind == Kind::Linear)
        return;
      tangent.kind = slope == 0 ? Kind::Flat : Kind::Slope;
      tangent.slope = {slope};
    };
    write(keys.keys.front().in, slopes.in.front());
    write(keys.keys.front().out, slopes.out.front());
    write(keys.keys.back().in, slopes.in.back());
    write(keys.keys.back().out, slopes.out.back());
  }

  using Slopes = timeline::Slopes;

  static constexpr double largest_number = 1e30;

  StopPoll stop_;
  WordScanner words_;
  const CurveReading& reading_;
  CurveFile file_;
  CurveNames names_;
  std::string time_unit_ = "film";
  std::string angular_unit_ = "deg";
  bool has_breakdowns_ = true;
  std::size_t key_count_ = 0;
};

}  // namespace

Result<CurveFile> parse_maya(std::string_view text, const CurveReading& reading) {
  return MayaReader(text, reading).read();
}

}  // namespace pliant::exchange
