#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/scene/scene.hpp"
#include "pliant/scene/text/source_map.hpp"

namespace pliant::xml {

/// The problems and notes found so far while reading a scene. All problems are kept, not only the
/// first. All parts of reading have the same one, and ask it whether to end.
class Findings {
 public:
  explicit Findings(std::shared_ptr<const SourceMap> sources, StopRequest should_stop = {})
      : sources_(std::move(sources)), should_stop_(std::move(should_stop)) {}
  /// About one file, and its text if that is known.
  explicit Findings(std::string file, std::shared_ptr<const SourceText> text = {},
                    StopRequest should_stop = {})
      : Findings(std::make_shared<SourceMap>(std::move(file), std::move(text)),
                 std::move(should_stop)) {}
  explicit Findings(const SceneOrigin& origin, StopRequest should_stop = {})
      : Findings(origin.sources ? origin.sources : std::make_shared<SourceMap>(origin.file),
                 std::move(should_stop)) {}
  Findings(const Findings&) = delete;
  Findings& operator=(const Findings&) = delete;

  const SourceMap& sources() const { return *sources_; }

  /// Problems that are alike, on a line of a file that is included several times, are one.
  void add_problem(const TextPlace& place, std::string message);
  void add_problem(Error error);  ///< that has its place
  void add_note(const TextPlace& place, std::string message);

  /// Counts a problem that follows from one that was added, and is not told.
  void add_consequence() { ++problem_count_; }

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

  /// The notes in the order of their places.
  std::vector<SceneNote> notes() const;

 private:
  static constexpr std::size_t most_compared = 50;

  bool is_full() const;
  void list(Error error);

  std::shared_ptr<const SourceMap> sources_;
  StopRequest should_stop_;
  StopPoll poll_{should_stop_};
  bool is_stopped_ = false;
  std::vector<Error> problems_;
  std::set<std::tuple<std::string, int, std::string>> included_;  // problems of included files
  std::vector<std::pair<TextPlace, std::string>> notes_;
  std::size_t problem_count_ = 0;
  std::size_t bytes_ = 0;  // of messages
  std::int64_t copied_keys_ = 0;
};

}  // namespace pliant::xml
