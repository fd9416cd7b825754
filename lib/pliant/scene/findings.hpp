#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant::xml {

/// What reading a scene has found so far: all problems, not only the first, and what an author
/// would want to know besides.
class Findings {
 public:
  explicit Findings(std::string file) : file_(std::move(file)) {}

  void add_problem(int line, std::string message);
  void add_note(int line, std::string message);

  /// How many problems were added: unchanged means that what was read in between is sound.
  std::size_t problem_count() const { return problem_count_; }

  /// Whether there are so many problems that further ones would not be listed: reading may stop.
  bool is_full() const;

  /// All problems as one error: in the order of lines, each once. Requires: there is a problem.
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
