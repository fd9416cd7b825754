#include "cli/commands/suggest_formats.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "cli/commands/info_formats.hpp"
#include "cli/terminal/json.hpp"
#include "cli/terminal/report.hpp"

namespace pliant::cli {
namespace {

// Numbers that are not finite become null.
Json goal_json(const std::optional<GoalResult>& goal) {
  if (!goal) return nullptr;
  const bool is_told = goal->obstacle != Obstacle::None;
  return {{"wanted", goal->wanted},
          {"found", goal->is_known ? Json(goal->found) : Json(nullptr)},
          {"miss", goal->miss()},
          {"obstacle", is_told ? Json(name_of(goal->obstacle)) : Json(nullptr)},
          {"reason", is_told ? Json(goal->reason) : Json(nullptr)}};
}

std::string value_text(const SuggestedValue& value) {
  const std::string keys =
      value.keys > 0
          ? fmt::format(", the largest of {}", counted(static_cast<int>(value.keys), "key"))
          : "";
  if (value.before == value.after) return fmt::format("stays {:g}{}", value.after, keys);
  return fmt::format("{:g}, was {:g}{}", value.after, value.before, keys);
}

// Of many magnitudes, which all change by one factor, only the first are shown.
std::string values_text(const std::vector<SuggestedValue>& values) {
  constexpr std::size_t most = 16, at_start = 10;
  const auto is_shown = [&](std::size_t k) {
    return values.size() <= most || k < at_start || !values[k].path.ends_with(".magnitude");
  };
  std::size_t width = 0, hidden = 0;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (is_shown(k)) width = std::max(width, values[k].path.size());
    hidden += is_shown(k) ? 0 : 1;
  }
  std::string text;
  for (std::size_t k = 0; k < values.size(); ++k) {
    if (is_shown(k))
      text += fmt::format("  {:<{}}  {}\n", values[k].path, width, value_text(values[k]));
    if (hidden > 0 && k + 1 == at_start)
      text += fmt::format("  … and {} more magnitudes, by the same factor\n", hidden);
  }
  return text;
}

// One line of the table: a goal, what was found, how far it is off, and more about it.
struct Row {
  std::string name = {}, wanted = {}, found = {}, off = {}, more = {};
};

Row row_of(std::string_view name, const GoalResult& goal, std::string_view unit, std::string more) {
  Row row{.name = std::string(name),
          .wanted = fmt::format("{:.4g}{}", goal.wanted, unit),
          .found = "not known",
          .more = std::move(more)};
  if (!goal.is_known) return row;
  row.found = std::isfinite(goal.found) ? fmt::format("{:.4g}{}", goal.found, unit) : "never";
  const double percent = 100 * (goal.found / goal.wanted - 1);
  if (std::isfinite(percent)) {
    row.off = std::abs(percent) < 0.005 ? "0.00 %"
              : std::abs(percent) < 1e6 ? fmt::format("{:+.2f} %", percent)
                                        : fmt::format("{:+.3g} %", percent);
  }
  return row;
}

std::string table_text(const std::vector<Row>& rows) {
  std::size_t widths[4] = {0, 0, 0, 0};
  for (const Row& row : rows) {
    const std::string* const cells[] = {&row.name, &row.wanted, &row.found, &row.off};
    for (std::size_t k = 0; k < 4; ++k) widths[k] = std::max(widths[k], cells[k]->size());
  }
  std::string text;
  for (const auto& [name, wanted, found, off, more] : rows) {
    std::string line = fmt::format("  {:<{}}  {:>{}}  {:>{}}  {:>{}}  {}", name, widths[0], wanted,
                                   widths[1], found, widths[2], off, widths[3], more);
    line.erase(line.find_last_not_of(' ') + 1);
    text += line + '\n';
  }
  return text;
}

}  // namespace

std::string suggest_json(const SuggestFacts& facts) {
  const Suggestion& one = facts.suggestion;
  Json values = Json::array();
  for (const SuggestedValue& value : one.values) {
    values.push_back({{"channel", value.path},
                      {"before", value.before},
                      {"after", value.after},
                      {"keys", value.keys}});
  }
  const Json json = {{"format", "pliant-suggest-1"},
                     {"file", facts.file},
                     {"surface", facts.surface},
                     {"force", facts.force.empty() ? Json(nullptr) : Json(facts.force)},
                     {"met", one.meets_goals()},
                     {"written", facts.is_written},
                     {"values", values},
                     {"peak", goal_json(one.peak)},
                     {"peakIsStatic", false},  // as it was in earlier versions
                     {"settlingTime", goal_json(one.settling)},
                     {"frequency", goal_json(one.frequency)},
                     {"region", one.region},
                     {"notes", one.notes},
                     {"before", preview_json(one.before, one.scene)},
                     {"after", preview_json(one.after, one.scene)}};
  return json.dump(2, ' ', true, Json::error_handler_t::replace) + '\n';
}

std::string suggest_text(const SuggestFacts& facts) {
  const Suggestion& one = facts.suggestion;
  std::string text = fmt::format("{}: {}, moved by {}\n", printable(facts.file), facts.surface,
                                 facts.force.empty() ? "all its forces" : facts.force + " alone");
  text += values_text(one.values);
  std::vector<Row> rows = {{"", "wanted", "found", "", ""}};
  std::vector<std::pair<std::string_view, const GoalResult*>> missed;
  const auto add = [&](std::string_view name, const GoalResult& goal, std::string_view unit,
                       std::string more) {
    rows.push_back(row_of(name, goal, unit, std::move(more)));
    if (!goal.reason.empty()) missed.emplace_back(name, &goal);
  };
  const RegionPreview* const region =
      one.region < one.after.regions.size() ? &one.after.regions[one.region] : nullptr;
  const bool is_known = region && region->has_vibration;
  if (one.peak) {
    std::string more;
    if (one.after.played) more = fmt::format("at frame {}", one.after.played->frame);
    add("peak", *one.peak, "", more);
  }
  if (one.settling) {
    add("settles", *one.settling, " s",
        is_known && std::isfinite(region->settling.time) ? counted(region->settling.frames, "frame")
                                                         : "");
  }
  if (one.frequency) {
    add("rings", *one.frequency, " Hz",
        is_known && std::isfinite(region->animated.damping_ratio)
            ? fmt::format("damping ratio {:.3g}", region->animated.damping_ratio)
            : "");
  }
  text += table_text(rows);
  for (const auto& [name, goal] : missed) text += fmt::format("  {}: {}\n", name, goal->reason);
  for (const std::string& note : one.notes) text += fmt::format("  note: {}\n", note);
  if (facts.is_written) text += fmt::format("  written to {}\n", printable(facts.file));
  return text;
}

}  // namespace pliant::cli
