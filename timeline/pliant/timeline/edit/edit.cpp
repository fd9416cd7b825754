#include "pliant/timeline/edit/edit.hpp"

#include <cmath>
#include <initializer_list>
#include <optional>
#include <string>
#include <utility>

#include "pliant/timeline/compile.hpp"
#include "pliant/timeline/edit/split.hpp"
#include "pliant/timeline/key_polyline.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant {

namespace {

template <int D>
std::optional<Complaint> missing(const Curve<D>& curve, std::size_t key) {
  const std::size_t count = curve.keys().keys.size();
  if (key < count) return std::nullopt;
  return Complaint{key, "there is no key " + std::to_string(key) + "; the curve has keys 0 to " +
                            std::to_string(count - 1)};
}

template <int D>
bool has_copies(const CurveKeys<D>& keys) {
  return keys.loop && (keys.loop->before > 0 || keys.loop->after > 0);
}

/// Whether a tangent is given completely, so that it does not depend on its segment.
template <int D>
bool is_written(const Tangent<D>& tangent) {
  using Kind = typename Tangent<D>::Kind;
  if (tangent.kind == Kind::Handle) return true;
  return tangent.length && (tangent.kind == Kind::Slope || tangent.kind == Kind::Flat);
}

/// Whether the segments around a key may be the halves of one.
template <int D>
bool may_join(const Key<D>& before, const Key<D>& key, const Key<D>& after) {
  constexpr auto bezier = Interpolation::Kind::Bezier;
  return before.next.kind == bezier && key.next.kind == bezier && is_written(before.out) &&
         is_written(after.in);
}

/// Lengthens the handles beside a key so that the curve does not need the key, if possible.
/// Requires: it may be.
template <int D>
void join_around(std::size_t key, CurveKeys<D>& keys) {
  if (has_copies(keys) || timeline::has_jump(keys.keys, key)) return;
  const auto compiled = timeline::compile(keys);
  if (!compiled) return;
  const auto handles = timeline::joined(compiled->curve.track, key - 1);
  if (!handles) return;
  keys.keys[key - 1].out = handles->start.as_tangent(true);
  keys.keys[key + 1].in = handles->end.as_tangent(false);
}

}  // namespace

template <int D>
Checked<Curve<D>> delete_keys(const Curve<D>& curve, const std::vector<std::size_t>& keys) {
  CurveKeys<D> fewer = curve.keys();
  for (const std::size_t key : keys) {
    if (const auto error = missing(curve, key)) return tl::unexpected(*error);
    const double frame = fewer.keys[key].frame;
    if (keys.size() == fewer.keys.size()) {
      return tl::unexpected(
          Complaint{key, "the key at frame " + timeline::number_text(frame) +
                             (keys.size() == 1 ? " is the only one and" : " and all others") +
                             " cannot be deleted; a curve must have at least one key"});
    }
    if (fewer.loop && fewer.loop->from == frame) {
      return tl::unexpected(Complaint{key, "the key at frame " + timeline::number_text(frame) +
                                               " cannot be deleted; the loop starts from it"});
    }
  }
  std::vector<bool> is_deleted(fewer.keys.size());
  for (const std::size_t key : keys) is_deleted[key] = true;
  std::vector<Key<D>> old = std::exchange(fewer.keys, {});
  for (std::size_t key = 0; key < old.size(); ++key) {
    if (!is_deleted[key]) {
      fewer.keys.push_back(old[key]);
      continue;
    }
    if (fewer.keys.empty() || key + 1 == old.size() ||
        !may_join(fewer.keys.back(), old[key], old[key + 1])) {
      continue;
    }
    // Its neighbours are those that are there when it is its turn.
    const std::size_t place = fewer.keys.size();
    CurveKeys<D> present = fewer;
    present.keys.insert(present.keys.end(), old.begin() + key, old.end());
    join_around(place, present);
    fewer.keys.back() = present.keys[place - 1];
    old[key + 1] = present.keys[place + 1];
  }
  return Curve<D>::make(std::move(fewer));
}

template <int D>
Checked<Curve<D>> delete_key(const Curve<D>& curve, std::size_t key) {
  return delete_keys(curve, {key});
}

template <int D>
Checked<Curve<D>> move_key(const Curve<D>& curve, std::size_t key, double frames,
                           const Rise<D>& rise) {
  if (const auto error = missing(curve, key)) return tl::unexpected(*error);
  CurveKeys<D> keys = curve.keys();
  Key<D>& moved = keys.keys[key];
  const bool starts_loop = keys.loop && keys.loop->from == moved.frame;
  moved.frame += frames;
  if (starts_loop) keys.loop->from = moved.frame;
  for (int c = 0; c < D; ++c) {
    moved.value[c] += rise[c];
    if (moved.left) (*moved.left)[c] += rise[c];
  }
  return Curve<D>::make(std::move(keys));  // checks that the numbers are finite
}

template Checked<Curve<1>> delete_keys(const Curve<1>&, const std::vector<std::size_t>&);
template Checked<Curve<3>> delete_keys(const Curve<3>&, const std::vector<std::size_t>&);
template Checked<Curve<1>> delete_key(const Curve<1>&, std::size_t);
template Checked<Curve<3>> delete_key(const Curve<3>&, std::size_t);
template Checked<Curve<1>> move_key(const Curve<1>&, std::size_t, double, const Value<1>&);
template Checked<Curve<3>> move_key(const Curve<3>&, std::size_t, double, const Value<3>&);

}  // namespace pliant
