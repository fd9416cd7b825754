#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::xml {

/// The problems and notes found so far while reading a scene. All problems are kept, not only the
/// first.
class Findings {
 public:
  explicit Findings(std::string file) : file_(std::move(file)) {}

  void add_problem(int line, std::string message);
  void add_note(int line, std::string message);

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
  std::string file_;
  std::vector<Error> problems_;
  std::vector<SceneNote> notes_;
  std::size_t problem_count_ = 0;
};

}  // namespace pliant::xml
