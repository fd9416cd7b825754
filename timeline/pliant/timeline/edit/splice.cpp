#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "pliant/timeline/edit/edit.hpp"
#include "pliant/timeline/edit/frames.hpp"
#include "pliant/timeline/edit/preserve.hpp"
#include "pliant/timeline/loop.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant {

namespace timeline {

namespace {

/// Keys without a loop, and the slopes that they must keep.
template <int D>
struct Shaped {
  CurveKeys<D> keys;
  Shape<D> shape;
};

template <int D>
Checked<Shaped<D>> shaped(const CurveKeys<D>& author) {
  auto keys = without_loop(author);
  if (!keys) return tl::unexpected(keys.error());
  auto shape = shape_of(*keys);
  if (!shape) return tl::unexpected(shape.error());
  return Shaped<D>{*std::move(keys), *std::move(shape)};
}

template <int D>
CurveKeys<D> with_corrections(CurveKeys<D> keys, Overshoot policy) {
  write_corrections(keys, policy);
  return keys;
}

/// Puts a piece into keys.
template <int D>
class Splicing {
 public:
  /// `keys`: those of the curve, of which [begin, end) give way.
  Splicing(Shaped<D> keys, std::size_t begin, std::size_t end, Shaped<D> piece)
      : keys_(std::move(keys)), begin_(begin), end_(end), piece_(std::move(piece)) {}

  Shaped<D> spliced() {
    share_overshoot();
    // What shapes only the segments that join the pieces.
    piece_.shape.keys.front().in.reset();
    piece_.shape.keys.back().out.reset();
    if (has_before()) keys_.shape.keys[begin_ - 1].out.reset();
    if (has_after()) keys_.shape.keys[end_].in.reset();
    if (!has_before()) keys_.shape.before.reset();
    if (!has_after()) keys_.shape.after.reset();
    replace(keys_.keys.keys, piece_.keys.keys);
    replace(keys_.shape.keys, piece_.shape.keys);
    return std::move(keys_);
  }

 private:
  bool has_before() const { return begin_ > 0; }
  bool has_after() const { return end_ < keys_.keys.keys.size(); }

  /// Writes corrections of overshooting tangents, as far as another rule would make others.
  void share_overshoot() {
    CurveKeys<D>& keys = keys_.keys;
    CurveKeys<D>& piece = piece_.keys;
    if (keys.overshoot == piece.overshoot) return;
    const CurveKeys<D> wanted = with_corrections(piece, piece.overshoot);
    if (with_corrections(piece, keys.overshoot) == wanted) return;
    piece = wanted;
    if (with_corrections(piece, keys.overshoot) == wanted) return;
    const CurveKeys<D> written = with_corrections(keys, keys.overshoot);
    for (std::size_t k = 0; k < keys.keys.size(); ++k) {
      if (k + 1 != begin_) keys.keys[k].out = written.keys[k].out;
      if (k != end_) keys.keys[k].in = written.keys[k].in;
    }
    keys.overshoot = Overshoot::Limit;
  }

  template <class Each>
  void replace(std::vector<Each>& all, const std::vector<Each>& by) const {
    all.erase(all.begin() + begin_, all.begin() + end_);
    all.insert(all.begin() + begin_, by.begin(), by.end());
  }

  Shaped<D> keys_;
  std::size_t begin_, end_;
  Shaped<D> piece_;
};

/// The indices of the keys in [first, last]: from the first of them up to the second.
template <int D>
std::pair<std::size_t, std::size_t> keys_in(const std::vector<Key<D>>& keys, double first,
                                            double last) {
  const auto begin = std::ranges::lower_bound(keys, first, {}, &Key<D>::frame);
  const auto end = std::ranges::upper_bound(keys, last, {}, &Key<D>::frame);
  return {begin - keys.begin(), end - keys.begin()};
}

/// The keys of a curve with a loop, and the piece as it stands in the result.
template <int D>
CurveKeys<D> with_loop(const CurveKeys<D>& author, double first, double last,
                       const CurveKeys<D>& result) {
  CurveKeys<D> keys = result;
  keys.loop = author.loop;
  const auto [begin, end] = keys_in(author.keys, first, last);
  const auto [from, to] = keys_in(result.keys, first, last);
  keys.keys.assign(author.keys.begin(), author.keys.begin() + begin);
  keys.keys.insert(keys.keys.end(), result.keys.begin() + from, result.keys.begin() + to);
  keys.keys.insert(keys.keys.end(), author.keys.begin() + end, author.keys.end());
  return keys;
}

/// A key of the piece that is not in [first, last].
template <int D>
std::optional<Complaint> fault_of_piece(const CurveKeys<D>& piece, double first, double last) {
  const auto written = written_out(piece);
  if (!written) return written.error();
  const std::vector<Key<D>>& keys = written->keys_of(piece);
  for (std::size_t k = 0; k < keys.size(); ++k) {
    if (keys[k].frame >= first && keys[k].frame <= last) continue;
    return Complaint{written->origin_of(k), "the piece has a key at frame " +
                                                number_text(keys[k].frame) +
                                                "; it must be from frame " + number_text(first) +
                                                " to " + number_text(last)};
  }
  return std::nullopt;
}

}  // namespace

}  // namespace timeline

template <int D>
Checked<Curve<D>> splice(const Curve<D>& curve, double first, double last, const Curve<D>& piece) {
  using namespace timeline;
  if (const auto fault = fault_of_frames(first, last)) return tl::unexpected(*fault);
  if (const auto fault = fault_of_piece(piece.keys(), first, last)) return tl::unexpected(*fault);
  auto keys = shaped(curve.keys());
  if (!keys) return tl::unexpected(keys.error());
  auto inner = shaped(piece.keys());
  if (!inner) return tl::unexpected(inner.error());
  const auto [begin, end] = keys_in(keys->keys.keys, first, last);
  const Shaped<D> spliced = Splicing<D>(*std::move(keys), begin, end, *std::move(inner)).spliced();
  auto result = preserved(spliced.keys, spliced.shape);
  if (!result || !curve.keys().loop) return result;
  CurveKeys<D> author = with_loop(curve.keys(), first, last, result->keys());
  if (stands_for(author, result->keys(), spliced.shape, {}))
    return Curve<D>::make(std::move(author));
  return result;
}

template Checked<Curve<1>> splice(const Curve<1>&, double, double, const Curve<1>&);
template Checked<Curve<3>> splice(const Curve<3>&, double, double, const Curve<3>&);

}  // namespace pliant
