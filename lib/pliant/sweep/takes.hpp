#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/changes/change.hpp"
#include "pliant/sweep/text_list.hpp"

namespace pliant {

class ChangedValues;

/// The most values that all axes of a sweep may have, each counted where it stands: a hundred for
/// each of a million takes.
inline constexpr std::size_t most_take_texts = 100'000'000;

/// What varies in a sweep, as typed. docs/sweeps.md.
struct SweepVariation {
  std::size_t scene_count = 1;         ///< the first axis if there are several
  std::vector<std::string> set = {};   ///< `--set`: in every take
  std::vector<std::string> vary = {};  ///< `--vary PATH=VALUES`, `PATH*=VALUES`, `PATH+=VALUES`
  std::optional<std::size_t> samples = {};  ///< `--sample`: points for all intervals together
  std::optional<std::string> table = {};    ///< `--takes`: the text of a CSV, in place of `vary`
  std::string table_name = {};              ///< its file, for messages
};

/// A value that differs from take to take.
struct VariedPath {
  std::string path;
  SceneChange::Kind kind = SceneChange::Kind::Set;
  std::string option = {};  ///< as typed, for messages: `--vary PATH=VALUES`; empty: unknown

  std::string title() const;  ///< as the table heads it: PATH, `PATH*` or `PATH+`
};

/// Paths that vary together: row k has the text of each, one after the other.
struct TakeAxis {
  std::vector<std::size_t> paths = {};  ///< by their index
  TextList texts = {};                  ///< count x paths
  std::size_t count = 0;                ///< of rows, >= 1
};

/// What the takes of a sweep are made from, as it is stored.
struct TakePlan {
  std::size_t scene_count = 1;
  std::vector<SceneChange> set = {};   ///< made in every take
  std::vector<VariedPath> paths = {};  ///< in the order of the table
  std::vector<TakeAxis> axes = {};     ///< the slowest first, without the scenes
};

/// All takes of a sweep: the product of its axes, the last one fastest, numbered from 0. The scenes
/// are the slowest axis, then all intervals together, then the others as typed.
class Takes {
 public:
  /// Errors: InvalidInput, beginning with the option as typed: a word that is none; a path that is
  /// varied twice, or set too; an interval without samples or samples without an interval; more
  /// than `most_intervals`; nothing that varies; more than `most_takes` takes, with their number; a
  /// table whose rows are not as wide as its header, with the line; more than `most_take_texts`
  /// values. Interrupted.
  static Result<Takes> make(const SweepVariation& variation, const StopRequest& should_stop = {});

  /// The same from its plan. Errors: InvalidInput: they do not belong together.
  static Result<Takes> of(TakePlan plan);

  const TakePlan& plan() const { return plan_; }

  std::size_t count() const { return count_; }
  std::size_t scene_of(std::size_t take) const;

  const std::vector<SceneChange>& set() const { return plan_.set; }
  const std::vector<VariedPath>& paths() const { return plan_.paths; }

  /// `--takes FILE` of a table, for messages; empty: there is none.
  const std::string& table_title() const { return table_title_; }

  /// The columns of a table that are no paths, such as the measures of an earlier sweep.
  const std::vector<std::string>& columns_left_out() const { return columns_left_out_; }

  /// The text of each path in a take.
  std::vector<std::string_view> texts(std::size_t take) const;

  /// What is changed in its scene: what is set, then each path.
  std::vector<SceneChange> changes(std::size_t take) const;

  /// Where a path has a text, for messages: the first row of a table, or the option as typed.
  std::string place_of(std::size_t path, std::string_view text) const;

  /// Each text that a path has in some take, in the order of the first take that has it. Some are
  /// missing if it was asked to stop.
  std::vector<std::string_view> texts_of(std::size_t path,
                                         const StopRequest& should_stop = {}) const;

 private:
  Result<void> read_axes(const SweepVariation& variation, ChangedValues& values,
                         const StopRequest& should_stop);
  Result<void> read_table(const SweepVariation& variation, ChangedValues& values,
                          const StopRequest& should_stop);
  Result<void> add_path(const std::string& option, const SceneChange& change,
                        ChangedValues& values);
  Result<void> count_takes();

  TakePlan plan_;
  std::size_t count_ = 0;
  std::vector<int> row_lines_;  // of a table
  std::string table_title_;     // `--takes FILE`
  std::vector<std::string> columns_left_out_;
};

}  // namespace pliant
