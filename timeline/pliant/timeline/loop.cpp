#include "pliant/timeline/loop.hpp"

#include <algorithm>
#include <cmath>

#include "pliant/timeline/checks.hpp"
#include "pliant/timeline/easing.hpp"
#include "pliant/timeline/number_text.hpp"

namespace pliant::timeline {

namespace {

template <int D>
void append(WrittenKeys<D>& written, const Key<D>& key, std::size_t origin) {
  written.keys.push_back(key);
  written.origin.push_back(origin);
}

/// Copy n of a key: moved by n spans, raised by n offsets.
template <int D>
Key<D> copy_of(Key<D> key, const Loop<D>& loop, double n) {
  key.frame += n * (loop.to - loop.from);
  for (int c = 0; c < D; ++c) {
    key.value[c] += n * loop.offset[c];
    if (key.left) (*key.left)[c] += n * loop.offset[c];
  }
  return key;
}

template <int D>
std::optional<Complaint> fault_of_copies(const WrittenKeys<D>& written) {
  const std::vector<Key<D>>& keys = written.keys;
  for (std::size_t k = 0; k < keys.size(); ++k) {
    double largest = std::fabs(keys[k].frame);
    for (const double value : keys[k].value) largest = std::max(largest, std::fabs(value));
    if (keys[k].left) {
      for (const double value : *keys[k].left) largest = std::max(largest, std::fabs(value));
    }
    if (!(largest <= largest_number)) {
      return Complaint{written.origin[k], "a copy of this key by the loop reaches " +
                                              number_text(largest) + "; no number may exceed " +
                                              number_text(largest_number)};
    }
    if (k == 0) continue;
    if (!(keys[k].frame > keys[k - 1].frame)) {
      return Complaint{written.origin[k], "a copy of this key by the loop falls on frame " +
                                              number_text(keys[k].frame) +
                                              " together with the previous key; frames must "
                                              "strictly increase, also after rounding"};
    }
    if (!Easing::is_sound(keys[k - 1].next, keys[k].frame - keys[k - 1].frame)) {
      return Complaint{written.origin[k - 1],
                       "period is " + number_text(*keys[k - 1].next.period) +
                           "; the segment must not have more than 1e15 periods"};
    }
  }
  return std::nullopt;
}

}  // namespace

template <int D>
Checked<WrittenKeys<D>> written_out(const CurveKeys<D>& keys) {
  WrittenKeys<D> written;
  const bool has_copies = keys.loop && (keys.loop->before > 0 || keys.loop->after > 0);
  if (!has_copies) {
    if (keys.loop) written.notes.push_back({0, "the loop has no copies and no effect"});
    return written;
  }

  const Loop<D>& loop = *keys.loop;
  const double span = loop.to - loop.from;
  const double start = loop.from - loop.before * span;
  // Both formulas for the end of the last copy, so that no key is lost between their roundings.
  const double end = std::max(loop.to + loop.after * span, loop.from + (loop.after + 1.0) * span);
  const auto is_looped = [&](const Key<D>& key) {
    return key.frame >= loop.from && key.frame < loop.to;
  };
  std::vector<std::size_t> looped;
  for (std::size_t k = 0; k < keys.keys.size(); ++k) {
    if (is_looped(keys.keys[k])) looped.push_back(k);
  }
  const double copies = 1.0 + loop.before + loop.after;
  const double count = copies * static_cast<double>(looped.size());
  if (count > most_written_keys) {
    return tl::unexpected(
        Complaint{looped.front(), "the loop writes out " + number_text(count) + " keys; at most " +
                                      number_text(most_written_keys) + " are allowed"});
  }

  for (std::size_t k = 0; k < keys.keys.size(); ++k) {
    if (keys.keys[k].frame < start) append(written, keys.keys[k], k);
  }
  for (int n = -loop.before; n <= loop.after; ++n) {
    for (const std::size_t k : looped) append(written, copy_of(keys.keys[k], loop, n), k);
  }
  append(written, copy_of(keys.keys[looped.front()], loop, loop.after + 1.0), looped.front());
  for (std::size_t k = 0; k < keys.keys.size(); ++k) {
    const Key<D>& key = keys.keys[k];
    if (key.frame > end) append(written, key, k);
    if (key.frame >= start && key.frame <= end && !is_looped(key)) {
      written.notes.push_back({k, "key at frame " + number_text(key.frame) +
                                      " is hidden by the loop, which covers frames " +
                                      number_text(start) + " to " + number_text(end)});
    }
  }
  if (const auto fault = fault_of_copies(written)) return tl::unexpected(*fault);
  return written;
}

template Checked<WrittenKeys<1>> written_out(const CurveKeys<1>&);
template Checked<WrittenKeys<3>> written_out(const CurveKeys<3>&);

}  // namespace pliant::timeline
