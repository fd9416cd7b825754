#pragma once

#include <algorithm>

#include <fmt/format.h>

#include "pliant/document/editor.hpp"

namespace pliant::edit {

template <class Change>
Result<void> Editor::for_each_curve(const std::vector<std::string>& channels,
                                    const Change& change) {
  for (const std::string& channel : channels) {
    const auto curve = curve_of(channel);
    if (!curve) return fail(curve.error());
    auto done = std::visit([&](const auto& one) -> Result<void> { return change(one); }, *curve);
    if (!done) return done;
  }
  return {};
}

template <class Change>
Result<void> Editor::for_each_keys(const std::vector<KeysOf>& keys, const Change& change) {
  for (const KeysOf& some : keys) {
    auto found =
        for_each_curve({some.channel}, [&]<int D>(const KeyedCurve<D>& curve) -> Result<void> {
          std::vector<std::size_t> indices;
          for (const double frame : some.frames) {
            const auto key = std::ranges::lower_bound(curve.keys(), frame, {}, &Key<D>::frame);
            if (key == curve.keys().end() || key->frame != frame)
              return draft_.refuse(fmt::format(
                  "{} has no key at frame {}; it has {}, from {} to {}", some.channel, frame,
                  curve.keys().size(), curve.keys().front().frame, curve.keys().back().frame));
            indices.push_back(key - curve.keys().begin());
          }
          std::ranges::sort(indices);
          indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
          if (indices.empty()) return {};
          return change(curve, indices);
        });
    if (!found) return found;
  }
  return {};
}

}  // namespace pliant::edit
