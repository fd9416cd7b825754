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
std::optional<CurveError> missing(const Curve<D>& curve, std::size_t key) {
  const std::size_t count = curve.keys().keys.size();
  if (key < count) return std::nullopt;
  return CurveError{key, "there is no key " + std::to_string(key) + "; the curve has keys 0 to " +
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

/// Lengthens the handles beside a key so that the curve does not need the key, if possible.
template <int D>
void join_around(std::size_t key, CurveKeys<D>& keys) {
  constexpr auto bezier = Interpolation::Kind::Bezier;
  if (key == 0 || key + 1 == keys.keys.size() || has_copies(keys)) return;
  Key<D>& before = keys.keys[key - 1];
  Key<D>& after = keys.keys[key + 1];
  if (before.next.kind != bezier || keys.keys[key].next.kind != bezier) return;
  if (!is_written(before.out) || !is_written(after.in) || timeline::has_jump(keys.keys, key)) {
    return;
  }
  const auto compiled = timeline::compile(keys);
  if (!compiled) return;
  const auto handles = timeline::joined(compiled->curve.track, key - 1);
  if (!handles) return;
  before.out = handles->start.as_tangent(true);
  after.in = handles->end.as_tangent(false);
}

}  // namespace

template <int D>
tl::expected<Curve<D>, CurveError> delete_key(const Curve<D>& curve, std::size_t key) {
  if (const auto error = missing(curve, key)) return tl::unexpected(*error);
  CurveKeys<D> keys = curve.keys();
  const double frame = keys.keys[key].frame;
  if (keys.keys.size() == 1) {
    return tl::unexpected(CurveError{
        key, "the key at frame " + timeline::number_text(frame) +
                 " is the only one and cannot be deleted; a curve must have at least one key"});
  }
  if (keys.loop && keys.loop->from == frame) {
    return tl::unexpected(CurveError{key, "the key at frame " + timeline::number_text(frame) +
                                              " cannot be deleted; the loop starts from it"});
  }
  join_around(key, keys);
  keys.keys.erase(keys.keys.begin() + key);
  return Curve<D>::make(std::move(keys));
}

template <int D>
tl::expected<Curve<D>, CurveError> move_key(const Curve<D>& curve, std::size_t key, double frames,
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

template tl::expected<Curve<1>, CurveError> delete_key(const Curve<1>&, std::size_t);
template tl::expected<Curve<3>, CurveError> delete_key(const Curve<3>&, std::size_t);
template tl::expected<Curve<1>, CurveError> move_key(const Curve<1>&, std::size_t, double,
                                                     const Value<1>&);
template tl::expected<Curve<3>, CurveError> move_key(const Curve<3>&, std::size_t, double,
                                                     const Value<3>&);

}  // namespace pliant
