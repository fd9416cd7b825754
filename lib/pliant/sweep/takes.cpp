#include "pliant/sweep/takes.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <unordered_set>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/stop_request.hpp"
#include "pliant/core/text.hpp"
#include "pliant/scene/changes/changed_values.hpp"
#include "pliant/sweep/csv.hpp"
#include "pliant/sweep/sobol.hpp"
#include "pliant/sweep/values.hpp"

namespace pliant {
namespace {

tl::unexpected<Error> refuse(std::string message) {
  return fail(ErrorCode::InvalidInput, std::move(message));
}

Result<void> check_text_count(std::size_t count) {
  if (count <= most_take_texts) return {};
  return refuse(fmt::format("{} values are too many; at most {} are allowed, over all takes", count,
                            most_take_texts));
}

constexpr std::size_t parts_of_value = 16;  // for a StopPoll

std::string vary_option(const std::string& typed) { return "--vary " + printable(typed); }

// Whether all rows below the header have one value in a column. Requires: all are as wide.
bool is_the_same(const std::vector<CsvRow>& rows, std::size_t column) {
  return std::all_of(rows.begin() + 1, rows.end(), [&](const CsvRow& row) {
    return row.fields[column] == rows[1].fields[column];
  });
}

}  // namespace

std::string VariedPath::title() const {
  return path + (kind == SceneChange::Kind::Times  ? "*"
                 : kind == SceneChange::Kind::Plus ? "+"
                                                   : "");
}

Result<Takes> Takes::make(const SweepVariation& variation, const StopRequest& should_stop) {
  Takes takes;
  takes.plan_.scene_count = variation.scene_count;
  ChangedValues values;
  for (const std::string& typed : variation.set) {
    auto change = parse_change(typed);
    if (!change) return refuse("--set " + change.error().message);
    if (const auto other = values.add(*change))
      return refuse(fmt::format("--set {}: {} changes the same value", typed,
                                takes.plan_.set[*other].typed()));
    takes.plan_.set.push_back(*std::move(change));
  }
  if (variation.table) {
    if (!variation.vary.empty() || variation.samples)
      return refuse("--takes: the table says what varies, so it excludes --vary and --sample");
    if (auto read = takes.read_table(variation, values, should_stop); !read)
      return fail(read.error());
  } else if (auto read = takes.read_axes(variation, values, should_stop); !read) {
    return fail(read.error());
  }
  if (auto counted = takes.count_takes(); !counted) return fail(counted.error());
  return takes;
}

Result<Takes> Takes::of(TakePlan plan) {
  const auto is_sound = [&](const TakeAxis& axis) {
    return axis.count >= 1 && !axis.paths.empty() &&
           axis.texts.size() == axis.count * axis.paths.size() &&
           std::all_of(axis.paths.begin(), axis.paths.end(),
                       [&](std::size_t path) { return path < plan.paths.size(); });
  };
  std::vector<int> uses(plan.paths.size());
  bool are_sound = plan.scene_count >= 1;
  for (const TakeAxis& axis : plan.axes) {
    are_sound = are_sound && is_sound(axis);
    if (!are_sound) break;
    for (const std::size_t path : axis.paths) ++uses[path];
  }
  if (!are_sound || !std::all_of(uses.begin(), uses.end(), [](int count) { return count == 1; }))
    return refuse("the axes of the takes do not belong together");
  Takes takes;
  takes.plan_ = std::move(plan);
  if (auto counted = takes.count_takes(); !counted) return fail(counted.error());
  return takes;
}

// Of a table nothing is quoted: it may still be any file.
Result<void> Takes::add_path(const std::string& option, const SceneChange& change,
                             ChangedValues& values) {
  if (const auto other = values.add(change)) {
    if (*other < plan_.set.size())
      return refuse(
          fmt::format("{}: --set {} sets the same value", option, plan_.set[*other].typed()));
    return refuse(fmt::format(
        "{}: {} varies the same value", option,
        table_title_.empty() ? plan_.paths[*other - plan_.set.size()].title() : "another column"));
  }
  plan_.paths.push_back({change.path, change.kind, option});
  return {};
}

Result<void> Takes::read_axes(const SweepVariation& variation, ChangedValues& values,
                              const StopRequest& should_stop) {
  struct Interval {
    double from, to;
  };
  std::vector<Interval> intervals;
  TakeAxis sampled;
  for (const std::string& typed : variation.vary) {
    const std::string option = vary_option(typed);
    const auto change = parse_change(typed);
    if (!change) return refuse(option + ": write PATH=VALUES, PATH*=VALUES or PATH+=VALUES");
    auto run = parse_axis_values(change->text, should_stop);
    if (!run && run.error().code == ErrorCode::Interrupted) return fail(run.error());
    if (!run) return refuse(fmt::format("{}: {}", option, run.error().message));
    if (auto added = add_path(option, *change, values); !added) return added;
    if (!run->is_interval()) {
      TakeAxis& axis = plan_.axes.emplace_back();
      axis.paths = {plan_.paths.size() - 1};
      axis.count = run->texts.size();
      for (const std::string& text : run->texts) axis.texts.push_back(text);
      // Ahead of further ones, each of which may have a million values.
      if (auto counted = count_takes(); !counted) return counted;
      continue;
    }
    if (!variation.samples)
      return refuse(
          fmt::format("{}: an interval needs --sample N, the number of points in it; or "
                      "write A:B:N",
                      option));
    if (intervals.size() == most_intervals)
      return refuse(fmt::format("{}: at most {} intervals can be sampled", option, most_intervals));
    intervals.push_back({run->from, run->to});
    sampled.paths.push_back(plan_.paths.size() - 1);
  }
  if (!variation.samples) return {};
  if (intervals.empty())
    return refuse("--sample: no --vary has an interval A:B to take points from");
  if (*variation.samples < 1 || *variation.samples > most_takes)
    return refuse(fmt::format("--sample {}: must be an integer from 1 to {}", *variation.samples,
                              most_takes));
  sampled.count = *variation.samples;
  if (auto few = check_text_count(sampled.count * intervals.size()); !few) return few;
  constexpr std::size_t points_at_once = 1024;
  for (std::size_t first = 0; first < sampled.count; first += points_at_once) {
    if (is_stopped(should_stop)) return interrupted();
    const std::vector<double> points =
        sobol_points(intervals.size(), first, std::min(points_at_once, sampled.count - first));
    for (std::size_t k = 0; k < points.size(); ++k) {
      const auto& [from, to] = intervals[k % intervals.size()];
      const double value = from + (to - from) * points[k];
      if (!std::isfinite(value))
        return refuse(fmt::format("--sample: the interval {}:{} is too long", from, to));
      sampled.texts.push_back(fmt::format("{}", value));
    }
  }
  plan_.axes.insert(plan_.axes.begin(), std::move(sampled));
  return {};
}

Result<void> Takes::read_table(const SweepVariation& variation, ChangedValues& values,
                               const StopRequest& should_stop) {
  auto rows = parse_csv(*variation.table, most_takes + 1, should_stop);  // and the header
  table_title_ =
      variation.table_name.empty() ? "--takes" : "--takes " + printable(variation.table_name);
  const auto at_line = [&](int line, const std::string& message) {
    return refuse(fmt::format("{}, line {}: {}", table_title_, line, message));
  };
  if (!rows && rows.error().code == ErrorCode::Interrupted) return fail(rows.error());
  if (!rows) return at_line(rows.error().line, rows.error().message);
  if (rows->size() < 2)
    return refuse(table_title_ + ": the table needs a header of paths, and a row a take");
  const CsvRow& header = rows->front();
  for (const CsvRow& row : *rows) {
    if (row.fields.size() != header.fields.size())
      return at_line(row.line, fmt::format("has {} values, but the header has {} columns",
                                           row.fields.size(), header.fields.size()));
  }
  TakeAxis axis;
  std::vector<std::size_t> columns;
  for (std::size_t column = 0; column < header.fields.size(); ++column) {
    if (is_stopped(should_stop)) return interrupted();
    const std::string field(trim(header.fields[column], ascii_blanks));
    const bool is_empty = field.empty() && std::ranges::all_of(*rows, [&](const CsvRow& row) {
                            return row.fields[column].empty();
                          });
    if (is_empty) continue;  // some programs end each row by a separator
    if (field == "scene" && (plan_.scene_count > 1 || !is_the_same(*rows, column))) {
      return at_line(
          header.line,
          "its rows are of several scenes; make a table of the rows of each scene, and run "
          "each scene by itself");
    }
    if (!field.empty() && field.find('.') == std::string::npos) {
      columns_left_out_.push_back(field);
      continue;
    }
    columns.push_back(column);
    SceneChange change{.path = field};
    if (!field.empty() && (field.back() == '*' || field.back() == '+')) {
      change.kind = field.back() == '*' ? SceneChange::Kind::Times : SceneChange::Kind::Plus;
      change.path.pop_back();
    }
    if (change.path.empty()) return at_line(header.line, "a path is missing in the header");
    axis.paths.push_back(plan_.paths.size());
    const std::string option =
        fmt::format("{}, line {}: column {}", table_title_, header.line, column + 1);
    if (auto added = add_path(option, change, values); !added) return added;
  }
  if (columns.empty()) return at_line(header.line, "no column is headed by a path NAME.ATTRIBUTE");
  axis.count = rows->size() - 1;
  if (auto few = check_text_count(axis.count * columns.size()); !few) return few;
  StopPoll stop(should_stop);
  for (std::size_t k = 1; k < rows->size(); ++k) {
    CsvRow& row = (*rows)[k];
    if (stop.after(parts_of_value * row.fields.size())) return interrupted();
    row_lines_.push_back(row.line);
    for (const std::size_t column : columns) axis.texts.push_back(row.fields[column]);
    row.fields = {};
  }
  plan_.axes.push_back(std::move(axis));
  return {};
}

Result<void> Takes::count_takes() {
  if (plan_.axes.empty() && plan_.scene_count < 2)
    return refuse("nothing varies; give --vary, --takes or several scenes");
  double all = static_cast<double>(plan_.scene_count);
  for (const TakeAxis& axis : plan_.axes) all *= static_cast<double>(axis.count);
  if (all > static_cast<double>(most_takes))
    return refuse(
        fmt::format("{:.0f} takes are too many; at most {} are allowed", all, most_takes));
  count_ = static_cast<std::size_t>(all);
  return {};
}

std::string Takes::place_of(std::size_t path, std::string_view text) const {
  if (row_lines_.empty()) return plan_.paths[path].option;
  const TakeAxis& axis = plan_.axes.back();
  const auto column = static_cast<std::size_t>(
      std::find(axis.paths.begin(), axis.paths.end(), path) - axis.paths.begin());
  std::size_t row = 0;
  while (row + 1 < axis.count && axis.texts[row * axis.paths.size() + column] != text) ++row;
  return fmt::format("{}, line {}", table_title_, row_lines_[row]);
}

std::size_t Takes::scene_of(std::size_t take) const { return take / (count_ / plan_.scene_count); }

std::vector<std::string_view> Takes::texts(std::size_t take) const {
  std::vector<std::string_view> texts(plan_.paths.size());
  for (std::size_t k = plan_.axes.size(); k-- > 0;) {
    const TakeAxis& axis = plan_.axes[k];
    const std::size_t first = take % axis.count * axis.paths.size();
    for (std::size_t n = 0; n < axis.paths.size(); ++n)
      texts[axis.paths[n]] = axis.texts[first + n];
    take /= axis.count;
  }
  return texts;
}

std::vector<SceneChange> Takes::changes(std::size_t take) const {
  std::vector<SceneChange> changes = plan_.set;
  const std::vector<std::string_view> own = texts(take);
  for (std::size_t k = 0; k < plan_.paths.size(); ++k)
    changes.push_back({plan_.paths[k].kind, plan_.paths[k].path, std::string(own[k])});
  return changes;
}

std::vector<std::string_view> Takes::texts_of(std::size_t path,
                                              const StopRequest& should_stop) const {
  std::vector<std::string_view> texts;
  std::unordered_set<std::string_view> known;
  StopPoll stop(should_stop);
  for (const TakeAxis& axis : plan_.axes) {
    const auto found = std::find(axis.paths.begin(), axis.paths.end(), path);
    if (found == axis.paths.end()) continue;
    known.reserve(axis.count);  // at once: to grow it again and again would take long in one piece
    for (auto k = static_cast<std::size_t>(found - axis.paths.begin()); k < axis.texts.size();
         k += axis.paths.size()) {
      if (known.insert(axis.texts[k]).second) texts.push_back(axis.texts[k]);
      if (stop.after(parts_of_value)) return texts;
    }
  }
  return texts;
}

}  // namespace pliant
