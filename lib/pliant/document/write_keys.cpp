// How an edited curve changes the text of its keys: as little as it can.

#include <algorithm>
#include <bit>
#include <cstdint>
#include <initializer_list>
#include <limits>

#include "pliant/document/editor.hpp"
#include "pliant/scene/curve_text.hpp"
#include "pliant/scene/text.hpp"

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

/// The text of a value, in which numbers that stay are written as they were.
template <int D>
std::string changed_value(std::string_view old, const Value<D>& from, const Value<D>& to,
                          xml::ValueKind kind) {
  const std::vector<std::string_view> words = xml::words_of(old);
  if (words.size() != D || kind == xml::ValueKind::Boolean) return xml::value_text<D>(to, kind);
  std::string text;
  std::size_t copied = 0;
  for (std::size_t c = 0; c < D; ++c) {
    if (has_same_bits(from[c], to[c])) continue;
    const std::size_t at = words[c].data() - old.data();
    text.append(old, copied, at - copied);
    text += to_text(to[c]);
    copied = at + words[c].size();
  }
  return text.append(old, copied);
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

void Editor::set_or_remove(Element element, std::string_view name, const std::string& value) {
  if (value.empty())
    draft_.remove_attribute(element, name);
  else
    draft_.set(element, name, value);
}

/// Changes the attributes of a key that differ.
template <int D>
void Editor::write_key(const KeyedCurve<D>& curve, std::size_t key, const KeyEntry<D>& wanted) {
  const Key<D>& old = curve.keys()[key];
  const Key<D>& now = wanted.key;
  const Element element = curve.elements[key];
  const auto value = [&](std::string_view name) {
    return draft_.value(element, name).value_or("");
  };
  const std::string_view place = xml::place_name(curve.axis);
  if (!has_same_bits(old.frame, now.frame)) draft_.set(element, place, to_text(now.frame));
  if (!has_same_bits<D>(old.value, now.value))
    draft_.set(element, "value",
               changed_value<D>(value("value"), old.value, now.value, curve.kind));
  if (!has_same_bits<D>(old.left, now.left))
    set_or_remove(element, "left",
                  !now.left   ? ""
                  : !old.left ? xml::value_text<D>(*now.left, curve.kind)
                              : changed_value<D>(value("left"), *old.left, *now.left, curve.kind));

  const xml::KeyText<D> was = xml::text_of_key(old, curve.defaults);
  xml::KeyText<D> is = xml::text_of_key(now, curve.defaults);
  if (!has_same_segment(was, is)) {
    const xml::Table table = xml::table_of(is, curve.axis, curve.kind);
    for (const char* const name : {"interpolation", "amplitude", "period", "back", "control"})
      set_or_remove(element, name, text_in(table, name));
  }
  write_sides(curve, key, now);
}

/// Changes the tangents of a key that differ.
template <int D>
void Editor::write_sides(const KeyedCurve<D>& curve, std::size_t key, const Key<D>& wanted) {
  const Key<D>& old = curve.keys()[key];
  const Element element = curve.elements[key];
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
    for (const char* const name : names) set_or_remove(element, name, text_in(table, name));
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
  for (const KeyEntry<D>& entry : wanted)
    if (entry.origin) write_key(curve, *entry.origin, entry);
  // After changes of attributes, elements have the same numbers.
  if (auto done = draft_.commit(); !done) return done;

  const std::vector<bool> stays = staying(curve, wanted);
  std::vector<bool> is_kept(curve.elements.size());
  for (std::size_t k = 0; k < wanted.size(); ++k)
    if (stays[k]) is_kept[*wanted[k].origin] = true;
  Draft::Place place{.parent = curve.animate};
  const Draft::Surroundings around = draft_.inside(place);
  std::vector<std::string> inserted;
  for (std::size_t k = 0; k < wanted.size(); ++k) {
    const auto& [key, origin] = wanted[k];
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

/// Writes what a curve has besides keys, then the keys.
template <int D>
Result<void> Editor::write_curve(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted,
                                 const std::vector<KeyEntry<D>>& keys) {
  const CurveKeys<D>& before = curve.curve.keys();
  xml::AnimateText<D> text{
      .before = wanted.before, .after = wanted.after, .overshoot = wanted.overshoot};
  xml::AnimateText<D> standard;
  const xml::Table table = xml::table_of(text, curve.axis, curve.kind);
  const xml::Table standards = xml::table_of(standard, curve.axis, curve.kind);
  const auto write = [&](const char* name, bool is_same) {
    const std::string value = text_in(table, name);
    if (!is_same)
      set_or_remove(curve.animate, name, value == text_in(standards, name) ? "" : value);
  };
  write("before", before.before == wanted.before);
  write("after", before.after == wanted.after);
  write("overshoot", before.overshoot == wanted.overshoot);
  for (const Element loop : draft_.children(curve.animate, "loop")) {
    if (!wanted.loop) {
      draft_.remove(loop);
    } else if (wanted.loop->from != before.loop->from) {
      draft_.set(loop, "from", to_text(wanted.loop->from));
    }
  }
  if (auto done = draft_.commit(); !done) return done;
  // Without the loop, elements have other numbers.
  KeyedCurve<D> present = curve;
  present.elements = draft_.children(curve.animate, "key");
  return write_keys(present, keys);
}

/// Keys at the frames of old ones are written in their place.
template <int D>
Result<void> Editor::write_curve(const KeyedCurve<D>& curve, const CurveKeys<D>& wanted) {
  std::vector<KeyEntry<D>> entries;
  std::size_t old = 0;
  for (const Key<D>& key : wanted.keys) {
    while (old < curve.keys().size() && curve.keys()[old].frame < key.frame) ++old;
    const bool is_there = old < curve.keys().size() && curve.keys()[old].frame == key.frame;
    entries.push_back({key, is_there ? std::optional(old) : std::nullopt});
  }
  return write_curve(curve, wanted, entries);
}

template Result<void> Editor::write_curve(const KeyedCurve<1>&, const CurveKeys<1>&);
template Result<void> Editor::write_curve(const KeyedCurve<3>&, const CurveKeys<3>&);
template Result<void> Editor::write_curve(const KeyedCurve<1>&, const CurveKeys<1>&,
                                          const std::vector<KeyEntry<1>>&);
template Result<void> Editor::write_curve(const KeyedCurve<3>&, const CurveKeys<3>&,
                                          const std::vector<KeyEntry<3>>&);

}  // namespace pliant::edit
