// Random operations on random scenes. Whatever is done: bytes that no edit names stay, values that
// no edit is for stay, and edits can be taken back and made again to the byte.

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "document/random_operation.hpp"
#include "pliant/document/document.hpp"
#include "pliant/scene/channels.hpp"
#include "pliant/scene/checks/channel_check.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/timeline/edit/edit.hpp"
#include "support/catch.hpp"
#include "support/random_scene.hpp"
#include "support/sanitized.hpp"
#include "support/scene_values.hpp"

namespace pliant::testing {
namespace {

/// Whether a changed path belongs to a part that the change names.
bool is_named(const std::string& path, const std::vector<std::string>& parts) {
  return path == "order" || std::ranges::any_of(parts, [&](const std::string& part) {
           const std::string whole = part.starts_with('.') ? "scene" + part : part;
           // One attribute, two values.
           const bool is_wrap = whole.ends_with(".wrap") && path.starts_with(whole);
           return path == whole || is_wrap || path.starts_with(whole + ".");
         });
}

/// The path of something that changed although no part of the change has it; empty: there is none.
std::string stray_change(const SceneValues& before, const SceneValues& after,
                         const Change& change) {
  for (const auto& [one, other] : {std::pair{&before, &after}, std::pair{&after, &before}})
    for (const auto& [path, text] : one->texts()) {
      const auto found = other->texts().find(path);
      const bool is_same = found != other->texts().end() && found->second == text;
      if (!is_same && !is_named(path, change.parts)) return path;
    }
  return "";
}

std::vector<std::string> comments_of(const std::string& text) {
  std::vector<std::string> comments;
  for (std::size_t at = text.find("<!--"); at != std::string::npos; at = text.find("<!--", at)) {
    const std::size_t end = text.find("-->", at) + 3;
    comments.push_back(text.substr(at, end - at));
    at = end;
  }
  std::ranges::sort(comments);
  return comments;
}

/// Whether the operation may delete or copy comments: those in a thing that goes or is copied.
bool keeps_comments(const Operation& operation) {
  return !std::holds_alternative<edit::Set>(operation) &&
         !std::holds_alternative<edit::Reset>(operation) &&
         !std::holds_alternative<edit::SetPart>(operation) &&
         !std::holds_alternative<edit::Freeze>(operation) &&
         !std::holds_alternative<edit::Duplicate>(operation) &&
         !std::holds_alternative<edit::Delete>(operation) &&
         !std::holds_alternative<edit::Group>(operation) &&
         !std::holds_alternative<edit::Ungroup>(operation);
}

std::vector<double> numbers_of(const std::string& text) {
  std::vector<double> numbers;
  const char* at = text.c_str();
  for (char* end = nullptr;; at = end) {
    const double number = std::strtod(at, &end);
    if (end == at) return numbers;
    numbers.push_back(number);
  }
}

/// What the scene says differently from what was set; empty: nothing.
struct ReadBack {
  const Scene& before;
  const Scene& scene;

  const NamedChannel* find(const std::string& path) {
    channels = channels_of(scene);
    const auto found = std::ranges::find(channels, path, &NamedChannel::path);
    return found == channels.end() ? nullptr : &*found;
  }

  std::string value_at(const std::string& path, double frame) {
    const NamedChannel* const channel = find(path);
    if (!channel) return "";
    return std::visit(
        [&](const auto* one) {
          if constexpr (std::is_same_v<decltype(one), const Switch*>)
            return std::string(one->at(frame) ? "true" : "false");
          else
            return SceneValues::text(one->at(frame));
        },
        channel->channel);
  }
  static bool says(const std::string& value, const std::string& text) {
    if (value == "true" || value == "false") return text.find(value) != std::string::npos;
    std::vector<double> wanted = numbers_of(text);
    const std::vector<double> is = numbers_of(value);
    if (wanted.size() == 1 && is.size() == 3) wanted.resize(3, wanted[0]);
    return wanted == is;
  }

  std::string operator()(const edit::Set& set) {
    const NamedChannel* const channel = find(set.path);
    if (!channel) return "";  // no channel, or a component
    if (channel->is_animated()) return "it is animated";
    const std::string value = value_at(set.path, 1);
    return says(value, set.value) ? "" : value;
  }
  std::string operator()(const edit::SetKey& set) {
    const NamedChannel* const channel = find(set.channel);
    if (!set.value || !channel) return "";
    const auto key_in = [&](const auto& keys) -> std::string {
      for (const auto& key : keys)
        if (key.frame == set.frame) return SceneValues::text(key.value);
      return "no such key";
    };
    const bool is_switch = std::holds_alternative<const Switch*>(channel->channel);
    std::string value = std::visit(
        [&](const auto* one) {
          if constexpr (std::is_same_v<decltype(one), const Switch*>)
            return key_in(one->channel().curve().keys().keys);
          else
            return key_in(one->curve().keys().keys);
        },
        channel->channel);
    // A copy in a loop is a key as well.
    if (value == "no such key")
      value = value_at(set.channel, set.frame);
    else if (is_switch)
      value = value == "1" ? "true" : "false";
    return says(value, *set.value) ? "" : value;
  }
  /// The keys of a channel; null: it is constant. Of a switch, those of its numbers.
  template <int D>
  const CurveKeys<D>* keys_of(const std::string& path) {
    const NamedChannel* const channel = find(path);
    if (!channel || !channel->is_animated()) return nullptr;
    if (const auto* const of = std::get_if<const Channel<D>*>(&channel->channel))
      return &(*of)->curve().keys();
    if constexpr (D == 1)
      if (const auto* const of = std::get_if<const Switch*>(&channel->channel))
        return &(*of)->channel().curve().keys();
    return nullptr;
  }
  /// A number stands for three components.
  template <int N, int D>
  static std::string has_same_shape(const Curve<N>& now, const Curve<D>& wanted,
                                    double factor = 1) {
    if (now.keys().keys.size() != wanted.keys().keys.size()) return "other keys";
    const auto is_near = [&](double a, double b) {
      const double of = factor * b;
      // An elastic whose amplitude is just its change has an infinite derivative by that.
      return std::abs(a - of) <= 1e-7 * std::max({1.0, std::abs(a), std::abs(of)});
    };
    for (double frame = -12; frame <= 40; frame += 0.25) {
      const Value<N> a = now.value(frame), left = now.left_value(frame);
      const Value<D> b = wanted.value(frame), old_left = wanted.left_value(frame);
      for (std::size_t c = 0; c < D; ++c) {
        const std::size_t own = std::min<std::size_t>(c, N - 1);
        if (!is_near(a[own], b[c]) || !is_near(left[own], old_left[c]))
          return fmt::format("{} in place of {} at frame {}", a[own], factor * b[c], frame);
      }
    }
    return "";
  }
  std::string operator()(const edit::SetCurve& set) {
    return std::visit(
        [&]<int D>(const CurveKeys<D>& keys) -> std::string {
          const CurveKeys<D>* const now = keys_of<D>(set.channel);
          if constexpr (D == 3) {
            // Keys of a tangent whose components are all the same may be written as numbers.
            const CurveKeys<1>* const numbers = keys_of<1>(set.channel);
            if (numbers)
              return has_same_shape(Curve<1>::make(*numbers).value(), Curve<D>::make(keys).value());
          }
          if (!now) return "no such curve";
          return has_same_shape(Curve<D>::make(*now).value(), Curve<D>::make(keys).value());
        },
        set.keys);
  }
  std::string operator()(const edit::Splice& splice) {
    return std::visit(
        [&]<int D>(const CurveKeys<D>& keys) -> std::string {
          ReadBack old{before, before};
          const CurveKeys<D>* const was = old.keys_of<D>(splice.channel);
          const CurveKeys<D>* const now = keys_of<D>(splice.channel);
          // As of SetCurve.
          if (!now) return D == 3 && keys_of<1>(splice.channel) ? "" : "no such curve";
          const Curve<D> piece = Curve<D>::make(keys).value();
          const Curve<D> curve = was ? Curve<D>::make(*was).value() : piece;
          const auto wanted = pliant::splice(curve, splice.first, splice.last, piece);
          return has_same_shape(Curve<D>::make(*now).value(), wanted.value());
        },
        splice.keys);
  }
  std::string operator()(const edit::Scale& scale) {
    const std::string& path = scale.channels[0];
    const NamedChannel* const channel = find(path);
    const std::vector<NamedChannel> olds = channels_of(before);
    const auto old = std::ranges::find(olds, path, &NamedChannel::path);
    if (!channel || old == olds.end() || channel->channel.index() != old->channel.index())
      return "another channel";
    if (channel->is_animated() != old->is_animated()) return "constant or not";
    const auto compare = [&]<int D>(const Channel<D>& now, const Channel<D>& was) -> std::string {
      if (now.is_animated()) return has_same_shape(now.curve(), was.curve(), scale.factor);
      for (std::size_t c = 0; c < D; ++c)
        if (now.at(1)[c] != scale.factor * was.at(1)[c]) return "another constant";
      return "";
    };
    return std::visit(
        [&]<class One>(const One* one) -> std::string {
          if constexpr (std::is_same_v<One, Switch>)
            return "a switch";
          else
            return compare(*one, *std::get<const One*>(old->channel));
        },
        channel->channel);
  }
  std::string operator()(const edit::SetPart& set) {
    for (const auto& [attribute, text] : set.attributes) {
      const std::string value = value_at(set.surface + "." + attribute, 1);
      if (!says(value, text)) return value;
    }
    return "";
  }
  std::string operator()(const edit::Rename& rename) {
    const SceneValues values(scene);
    return values.texts().contains(rename.name + ".enabled") ? "" : "no such name";
  }
  std::string operator()(const edit::Freeze& freeze) {
    const NamedChannel* const channel = find(freeze.channels[0]);
    return channel && channel->is_animated() ? "it is animated" : "";
  }
  template <class Other>
  std::string operator()(const Other&) {
    return "";
  }

  std::vector<NamedChannel> channels = {};
};

/// How many operations were made.
struct Counts {
  std::map<std::size_t, int> accepted;  // by the alternative of `Operation`
  int refused = 0;
  int scenes = 0;
};

/// Runs operations on the scene of a seed.
void run(unsigned seed, int operations, Counts& counts) {
  Chance chance(seed);
  const std::string first = RandomScene(seed).text();
  CAPTURE(seed, first);
  auto opened = SceneDocument::from_text(first, "random.xml", "");
  if (!opened) {
    CAPTURE(to_lines(opened.error()));
    FAIL("the scene cannot be read");
  }
  SceneDocument& document = *opened;
  ++counts.scenes;
  std::vector<std::string> texts = {first};  // after each edit
  SceneValues values(document.scene());
  for (int k = 0; k < operations; ++k) {
    const Operation operation = RandomOperation(document.scene(), chance).make();
    const std::string before = document.text();
    const Scene scene_before = document.scene();
    const auto change = document.apply({operation});
    CAPTURE(k, described(operation), before);
    if (!change) {
      ++counts.refused;
      if (change.error().message.empty()) FAIL("a refusal says nothing");
      if (document.text() != before) FAIL("a refused operation changed the text");
      continue;
    }
    ++counts.accepted[operation.index()];
    const std::string& after = document.text();
    CAPTURE(after);
    std::string made = before;
    for (const TextEdit& edit : change->edits) {
      if (made.compare(edit.at, edit.removed.size(), edit.removed) != 0)
        FAIL("not the edit's text");
      made.replace(edit.at, edit.removed.size(), edit.inserted);
    }
    if (made != after) FAIL("the edits are not those of the text");
    if (after != before) texts.push_back(after);
    const SceneValues now(document.scene());
    if (const std::string stray = stray_change(values, now, *change); !stray.empty()) {
      CAPTURE(stray);
      FAIL("something else changed");
    }
    if (keeps_comments(operation) && comments_of(before) != comments_of(after))
      FAIL("comments changed");
    ReadBack read_back{scene_before, document.scene()};
    if (const std::string wrong = std::visit(read_back, operation); !wrong.empty()) {
      CAPTURE(wrong);
      FAIL("what is read is not what was set");
    }
    values = now;
    if (k % 16 != 0) continue;
    const auto again = parse_scene(after, "random.xml", "");
    if (!again || !check_channels(*again).empty()) FAIL("the text cannot be read");
    if (SceneValues(*again) != values) FAIL("the text is not the scene");
  }
  const std::string last = document.text();
  for (std::size_t edit = texts.size(); edit-- > 1;) {
    if (document.text() != texts[edit]) FAIL("an edit was not taken back");
    if (!document.undo()) FAIL("an edit cannot be taken back");
  }
  if (document.can_undo() || document.text() != first) FAIL("not the first bytes");
  while (document.can_redo())
    if (!document.redo()) FAIL("an edit cannot be made again");
  if (document.text() != last || SceneValues(document.scene()) != values)
    FAIL("not the last bytes");
}

int count_from_environment(const char* name, int standard) {
  const char* const text = std::getenv(name);
  return text ? std::atoi(text) : standard;
}

TEST_CASE("operations change what they say and nothing else", "[document][random]") {
  Counts counts;
  const int scenes = count_from_environment("PLIANT_RANDOM_SCENES", rounds(60));
  const int first = count_from_environment("PLIANT_RANDOM_SEED", 0);
  for (int seed = first; seed < first + scenes; ++seed) run(seed, 100, counts);
  // No kind of operation is refused always.
  for (std::size_t kind = 0; kind < std::variant_size_v<Operation>; ++kind) {
    CAPTURE(kind, scenes);
    if (scenes >= 60) CHECK(counts.accepted[kind] > 5);
  }
  int accepted = 0;
  for (const auto& [kind, count] : counts.accepted) accepted += count;
  INFO(accepted << " accepted, " << counts.refused << " refused");
  CHECK(accepted > counts.refused);
}

}  // namespace
}  // namespace pliant::testing
