// How an edited curve changes the text of its keys: as little as it can.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/document/editor.hpp"
#include "pliant/scene/elements/curve_text.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::edit {
namespace {

bool has_same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

template <int D>
bool has_same_bits(const Value<D>& a, const Value<D>& b) {
  return std::ranges::equal(a, b, [](double x, double y) { return has_same_bits(x, y); });
}

template <int D>
bool has_same_bits(const std::optional<Value<D>>& a, const std::optional<Value<D>>& b) {
  if (!a || !b) return a.has_value() == b.has_value();
  return has_same_bits<D>(*a, *b);
}

/// Whether two words say the same; a number may be written in several ways.
bool is_same_word(std::string_view a, std::string_view b) {
  if (a == b) return true;
  const auto one = to_number(a), other = to_number(b);
  return one && other && has_same_bits(*one, *other);
}

/// The text of a row of the table of something.
std::string text_in(const xml::Table& table, std::string_view name) {
  const auto found =
      std::ranges::find_if(table, [&](const xml::Slot& row) { return row.attribute.name == name; });
  return found != table.end() ? found->text : "";
}

/// Whether the segments after two keys are the same.
template <int D>
bool has_same_segment(const xml::KeyText<D>& a, const xml::KeyText<D>& b) {
  const auto word = [](const xml::KeyText<D>& key) {
    return key.interpolation.value_or(Interpolation{});
  };
  return a.interpolation.has_value() == b.interpolation.has_value() &&
         xml::has_same_word(word(a), word(b)) && a.amplitude == b.amplitude &&
         a.period == b.period && a.back == b.back && a.control == b.control;
}

/// Which keys stay where they stand in the text: those that do not pass others. Keys that are the
/// same as before never do.
template <int D>
std::vector<bool> staying(const KeyedCurve<D>& curve, const std::vector<KeyEntry<D>>& wanted) {
  const std::size_t count = wanted.size();
  const auto is_same = [&](const KeyEntry<D>& entry) {
    return entry.origin && entry.key == curve.keys()[*entry.origin];
  };
  std::vector<std::size_t> bound(count, std::numeric_limits<std::size_t>::max());
  for (std::size_t k = count; k-- > 1;)
    bound[k - 1] = is_same(wanted[k]) ? *wanted[k].origin : bound[k];
  std::vector<bool> stays(count);
  std::optional<std::size_t> last;
  for (std::size_t k = 0; k < count; ++k) {
    const auto& origin = wanted[k].origin;
    stays[k] = origin && (!last || *origin > *last) && *origin < bound[k];
    if (stays[k]) last = origin;
  }
  return stays;
}

}  // namespace

std::string changed_words(std::string_view old, std::string_view now) {
  const std::vector<std::string_view> words = xml::words_of(old), wanted = xml::words_of(now);
  if (words.size() != wanted.size()) return std::string(now);
  std::string text;
  std::size_t copied = 0;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (is_same_word(words[k], wanted[k])) continue;
    const std::size_t at = words[k].data() - old.data();
    text.append(old, copied, at - copied);
    text += wanted[k];
    copied = at + words[k].size();
  }
  return text.append(old, copied);
}

void Editor::set_or_remove(ElementIndex element, std::string_view name, const std::string& value) {
  if (value.empty())
    draft_.remove_attribute(element, name);
  else
    draft_.set(element, name, value);
}

/// Changes an attribute of a curve, or removes it if there is no value.
void Editor::rewrite(ElementIndex element, std::string_view name, const std::string& value) {
  const auto old = draft_.value(element, name);
  if (!old && value.empty()) return;
  if (old && !replaces_computed_ && computed_.empty() && old->find('$') != std::string::npos)
    computed_ = fmt::format("line {}: <{}> {}=\"{}\"", draft_.line_of(element),
                            draft_.name(element), name, *old);
  set_or_remove(element, name, changed_words(old.value_or(""), value));
}

/// Makes the changes, unless one is of a value with `$`.
Result<void> Editor::commit_rewritten(const std::string& channel) {
  if (computed_.empty()) return draft_.commit();
  return draft_.refuse(
      fmt::format("{}: the value with $ in {} would have to change; change what it stands for, or "
                  "set a number in its place first",
                  channel, computed_));
}

/// Whether one side of a key has the tangent of its <animate>.
bool Editor::is_inherited(ElementIndex key, Side side) const {
  const auto has = [&](std::string_view name) { return draft_.attribute(key, name) != nullptr; };
  if (has("tangent")) return false;
  return side == Side::In ? !has("in") && !has("inHandle") : !has("out") && !has("outHandle");
}

/// Changes the attributes of a key that differ.
template <int D>
void Editor::write_key(const KeyedCurve<D>& curve, std::size_t key, const KeyEntry<D>& wanted) {
  const Key<D>& old = curve.keys()[key];
  const Key<D>& now = wanted.key;
  const ElementIndex element = curve.elements[key];
  const std::string_view place = xml::place_name(curve.axis);
  if (!has_same_bits(old.frame, now.frame)) rewrite(element, place, to_text(now.frame));
  if (!has_same_bits<D>(old.value, now.value))
    rewrite(element, "value", xml::value_text<D>(now.value, curve.kind));
  if (!has_same_bits<D>(old.left, now.left))
    rewrite(element, "left", now.left ? xml::value_text<D>(*now.left, curve.kind) : "");

  const xml::KeyText<D> was = xml::text_of_key(old, curve.defaults);
  xml::KeyText<D> is = xml::text_of_key(now, curve.defaults);
  if (!has_same_segment(was, is)) {
    const xml::Table table = xml::table_of(is, curve.axis, curve.kind);
    for (const char* const name : {"interpolation", "amplitude", "period", "back", "control"})
      rewrite(element, name, text_in(table, name));
  }
  write_sides(curve, key, now);
}

/// Changes the tangents of a key that differ.
template <int D>
void Editor::write_sides(const KeyedCurve<D>& curve, std::size_t key, const Key<D>& wanted) {
  Key<D> old = curve.keys()[key];
  const ElementIndex element = curve.elements[key];
  // The slope of the <animate> may have another value already.
  const Tangent<D>& standard = curve.defaults.tangent;
  if (standard.kind == Tangent<D>::Kind::Slope) {
    if (is_inherited(element, Side::In)) old.in.slope = standard.slope;
    if (is_inherited(element, Side::Out)) old.out.slope = standard.slope;
  }
  const bool has_in = xml::plain(old.in) != xml::plain(wanted.in);
  const bool has_out = xml::plain(old.out) != xml::plain(wanted.out);
  if (!has_in && !has_out) return;
  // Sides that share an attribute are written apart, unless both have the same tangent again.
  Key<D> sides = wanted;
  if (!has_in) sides.in = old.in;
  if (!has_out) sides.out = old.out;
  xml::KeyText<D> text = xml::text_of_key(sides, curve.defaults);
  const xml::Table table = xml::table_of(text, curve.axis, curve.kind);
  const bool is_shared = draft_.attribute(element, "tangent") != nullptr || text.tangent;
  const auto write = [&](std::initializer_list<const char*> names) {
    for (const char* const name : names) rewrite(element, name, text_in(table, name));
  };
  if (is_shared) write({"tangent"});
  if (is_shared || has_in) write({"in"});
  if (is_shared || has_out) write({"out"});
  if (has_in) write({"inLength", "inHandle"});
  if (has_out) write({"outLength", "outHandle"});
}

template <int D>
Result<void> Editor::write_keys(const KeyedCurve<D>& curve,
                                const std::vector<KeyEntry<D>>& wanted) {
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    if (is_stopped(draft_.should_stop(), k)) return interrupted();
    if (wanted[k].origin) write_key(curve, *wanted[k].origin, wanted[k]);
  }
  // After changes of attributes, elements have the same numbers.
  if (auto done = commit_rewritten(curve.channel); !done) return done;

  const std::vector<bool> stays = staying(curve, wanted);
  std::vector<bool> is_kept(curve.elements.size());
  for (std::size_t k = 0; k < wanted.size(); ++k)
    if (stays[k]) is_kept[*wanted[k].origin] = true;
  Draft::Place place{.parent = curve.animate};
  const Draft::Surroundings around = draft_.inside(place);
  std::vector<std::string> inserted;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const auto& [key, origin] = wanted[k];
    if (is_stopped(draft_.should_stop(), k)) return interrupted();
    if (stays[k]) {
      draft_.insert(std::exchange(inserted, {}), place);
      place.after = curve.elements[*origin];
    } else if (origin) {
      inserted.emplace_back(draft_.whole(curve.elements[*origin]));
    } else {
      inserted.push_back(xml::text_of(xml::key_element(key, curve.defaults, curve.axis, curve.kind),
                                      around.layout, around.is_inline ? "" : around.margin));
    }
  }
  draft_.insert(inserted, place);
  for (std::size_t k = 0; k < curve.elements.size(); ++k)
    if (!is_kept[k]) draft_.remove(curve.elements[k]);
  parts_.insert(curve.channel);
  return draft_.commit();
}

/// Writes the attributes of the <animate>. `curve` gets its new default tangent.
template <int D>
void Editor::write_animate(KeyedCurve<D>& curve, const CurveKeys<D>& wanted,
                           const std::vector<KeyEntry<D>>& keys) {
  const CurveKeys<D>& before = curve.curve.keys();
  xml::AnimateText<D> text{
      .before = wanted.before, .after = wanted.after, .overshoot = wanted.overshoot};
  xml::AnimateText<D> standard;
  const xml::Table table = xml::table_of(text, curve.axis, curve.kind);
  const xml::Table standards = xml::table_of(standard, curve.axis, curve.kind);
  const auto write = [&](const char* name, bool is_same) {
    const std::string value = text_in(table, name);
    if (!is_same) rewrite(curve.animate, name, value == text_in(standards, name) ? "" : value);
  };
  write("before", before.before == wanted.before);
  write("after", before.after == wanted.after);
  write("overshoot", before.overshoot == wanted.overshoot);

  // A slope that all keys without one get, if they have the same again.
  Tangent<D>& slope = curve.defaults.tangent;
  if (slope.kind != Tangent<D>::Kind::Slope) return;
  std::optional<Value<D>> common;
  for (const KeyEntry<D>& entry : keys) {
    if (!entry.origin) continue;
    for (const Side side : {Side::In, Side::Out}) {
      if (!is_inherited(curve.elements[*entry.origin], side)) continue;
      const Tangent<D>& now = side == Side::In ? entry.key.in : entry.key.out;
      if (now.kind != slope.kind || (common && *common != now.slope)) return;
      common = now.slope;
    }
  }
  if (!common || *common == slope.slope) return;
  slope.slope = *common;
  rewrite(curve.animate, "tangent", xml::value_text<D>(*common, curve.kind));
}

/// Writes the <loop>.
template <int D>
Result<void> Editor::write_loop(const KeyedCurve<D>& curve, const std::optional<Loop<D>>& wanted) {
  const std::optional<Loop<D>>& before = curve.curve.keys().loop;
  if (wanted == before) return {};
  const std::vector<ElementIndex> present = draft_.children(curve.animate, "loop");
  if (!wanted) {
    for (const ElementIndex loop : present) draft_.remove(loop);
  } else if (!before || present.empty()) {
    draft_.insert(xml::loop_element(*wanted, curve.kind),
                  {.parent = curve.animate, .after = draft_.children(curve.animate).back()});
  } else {
    Loop<D> old = *before, now = *wanted;
    const xml::Table olds = xml::table_of(old, curve.kind);
    for (const xml::Slot& row : xml::table_of(now, curve.kind))
      if (row.text != text_in(olds, row.attribute.name))
        rewrite(present.front(), row.attribute.name, row.text);
  }
  return commit_rewritten(curve.channel);
}

/// Writes what a curve has besides keys, then the keys.
template <int D>
Result<void> Editor::write_curve(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted,
                                 const std::vector<KeyEntry<D>>& keys) {
  KeyedCurve<D> present = curve;
  write_animate(present, wanted, keys);
  if (auto done = commit_rewritten(curve.channel); !done) return done;
  if (auto done = write_loop(curve, wanted.loop); !done) return done;
  // With or without the loop, elements have other numbers.
  present.elements = draft_.children(curve.animate, "key");
  return write_keys(present, keys);
}

template <int D>
std::vector<KeyEntry<D>> entries_of(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted) {
  std::vector<KeyEntry<D>> entries;
  std::size_t old = 0;
  for (const Key<D>& key : wanted.keys) {
    while (old < curve.keys().size() && curve.keys()[old].frame < key.frame) ++old;
    const bool is_there = old < curve.keys().size() && curve.keys()[old].frame == key.frame;
    entries.push_back({key, is_there ? std::optional(old) : std::nullopt});
  }
  return entries;
}

template <int D>
Result<void> Editor::write_curve(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted) {
  return write_curve(curve, wanted, entries_of(curve, wanted));
}

template std::vector<KeyEntry<1>> entries_of(const KeyedCurve<1>&, const CurveKeys<1>&);
template std::vector<KeyEntry<3>> entries_of(const KeyedCurve<3>&, const CurveKeys<3>&);

template Result<void> Editor::write_curve(const KeyedCurve<1>&, const CurveKeys<1>&);
template Result<void> Editor::write_curve(const KeyedCurve<3>&, const CurveKeys<3>&);
template Result<void> Editor::write_curve(const KeyedCurve<1>&, const CurveKeys<1>&,
                                          const std::vector<KeyEntry<1>>&);
template Result<void> Editor::write_curve(const KeyedCurve<3>&, const CurveKeys<3>&,
                                          const std::vector<KeyEntry<3>>&);

}  // namespace pliant::edit
