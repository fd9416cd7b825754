#include "pliant/exchange/loss_log.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace pliant::exchange {

void LossLog::add(const std::string& thing, const std::string& result, double frame,
                  std::size_t keys, double deviation, bool is_exact) {
  Entry& entry = entries_[{thing, result}];
  if (entry.count++ == 0) {
    entry.frame = frame;
    entry.order = entries_.size();
  }
  entry.keys += keys;
  entry.deviation = std::max(entry.deviation, deviation);
  entry.is_exact = entry.is_exact && is_exact;
}

void LossLog::add_side(std::string message, bool is_exact) {
  sides_.push_back({std::move(message), is_exact});
}

std::vector<Loss> LossLog::take() const {
  std::vector<std::pair<std::size_t, Loss>> ordered;
  for (const auto& [what, entry] : entries_) {
    std::string text = entry.count == 1 ? fmt::format("the {} of key {} ", what.first, entry.frame)
                                        : fmt::format("{} {}s, the first of key {}, ", entry.count,
                                                      what.first, entry.frame);
    text += entry.count > 1 && what.second.starts_with("was ") ? "were " + what.second.substr(4)
                                                               : what.second;
    if (entry.keys > 0) text += fmt::format(" {} key{}", entry.keys, entry.keys == 1 ? "" : "s");
    if (!entry.is_exact && entry.deviation > 0)
      text += fmt::format(", within {:.2g}", entry.deviation);
    ordered.push_back({entry.order, {std::move(text), entry.is_exact}});
  }
  std::sort(ordered.begin(), ordered.end(),
            [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Loss> losses = sides_;
  for (auto& [order, loss] : ordered) losses.push_back(std::move(loss));
  return losses;
}

}  // namespace pliant::exchange
