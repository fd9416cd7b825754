#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/scene/defined_values.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::xml {

/// The problems and notes found so far while reading a scene. All problems are kept, not only the
/// first.
class Findings {
 public:
  explicit Findings(std::string file) : files_(std::move(file)) {}
  explicit Findings(const SceneOrigin& origin)
      : files_(origin.files ? *origin.files : LineMap(origin.file)) {}

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

  /// Whether the list of problems is full: further ones would not be listed, so reading may stop.
  bool is_full() const;

  /// All problems, in the order of lines, without duplicates.
  std::vector<Error> problems() const;

  /// The same as one error. Requires: there is a problem.
  Error to_error() const;

  /// The notes in the order of lines.
  std::vector<SceneNote> notes() const;

 private:
  LineMap files_;
  DefinedValues values_;
  std::vector<Error> problems_;
  std::set<std::tuple<std::string, int, std::string>> included_;  // problems of included files
  std::vector<std::pair<int, std::string>> notes_;                // lines of the expanded text
  std::size_t problem_count_ = 0;
};

}  // namespace pliant::xml
