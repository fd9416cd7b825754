#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/text/defined_values.hpp"

namespace pliant::xml {

/// The problems and notes found so far while reading a scene. All problems are kept, not only the
/// first. All parts of reading have the same one, and ask it whether to end.
class Findings {
 public:
  explicit Findings(std::string file, StopRequest should_stop = {})
      : files_(std::move(file)), should_stop_(std::move(should_stop)) {}
  explicit Findings(const SceneOrigin& origin, StopRequest should_stop = {})
      : files_(origin.files ? *origin.files : LineMap(origin.file)),
        should_stop_(std::move(should_stop)) {}
  Findings(const Findings&) = delete;
  Findings& operator=(const Findings&) = delete;

  /// From now on lines are those of the expanded text. A problem of a value that was made of
  /// definitions also tells where they are.
  void use(LineMap files, DefinedValues values = {}) {
    files_ = std::move(files);
    values_ = std::move(values);
  }

  void add_problem(int line, std::string message);
  void add_note(int line, std::string message);

  /// The same of a place that is known. Problems that are alike, in a file that is included several
  /// times, are one.
  void add_problem(ScenePlace place, std::string message);

  /// Counts a problem that follows from one that was added, and is not told.
  void add_consequence() { ++problem_count_; }

  /// `line 5`, for a message at the line `from`: see `LineMap`.
  std::string title_of(int line, int from) const { return files_.title_of(line, from); }

  /// The number of problems added. If it has not changed, the elements read in between have no
  /// problem.
  std::size_t problem_count() const { return problem_count_; }

  /// Whether reading is to end: the list of problems is full, so that further ones would not be
  /// listed, or the caller wants it. After `parts` of work, see StopPoll.
  bool is_over(std::size_t parts);
  /// As `is_over`, as far as it is known.
  bool is_over() const { return is_stopped_ || is_full(); }
  void stop();                                     ///< the work on a part was stopped
  bool is_stopped() const { return is_stopped_; }  ///< the caller wants it; counts as a problem
  const StopRequest& should_stop() const { return should_stop_; }

  /// Whether a problem may be told with the nearest of the names of a scene, which are many. Of
  /// very many problems only the first are.
  bool may_compare_names() const { return problem_count_ < most_compared; }

  /// Keys that the loops of all curves copy, each of which is a segment in memory.
  static constexpr std::int64_t most_copied_keys = 1'000'000;
  std::int64_t copied_keys() const { return copied_keys_; }
  void count_copied_keys(std::int64_t count) { copied_keys_ += count; }

  /// All problems, in the order of lines, without duplicates.
  std::vector<Error> problems() const;

  /// The same as one error; Interrupted if the caller wanted reading to end. Requires: there is a
  /// problem.
  Error to_error() const;

  /// The notes in the order of lines.
  std::vector<SceneNote> notes() const;

 private:
  static constexpr std::size_t most_compared = 50;

  bool is_full() const;

  LineMap files_;
  DefinedValues values_;
  StopRequest should_stop_;
  StopPoll poll_{should_stop_};
  bool is_stopped_ = false;
  std::vector<Error> problems_;
  std::set<std::tuple<std::string, int, std::string>> included_;  // problems of included files
  std::vector<std::pair<int, std::string>> notes_;                // lines of the expanded text
  std::size_t problem_count_ = 0;
  std::size_t bytes_ = 0;  // of messages
  std::int64_t copied_keys_ = 0;
};

}  // namespace pliant::xml
