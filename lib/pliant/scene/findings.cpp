#include "pliant/scene/findings.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <utility>

#include "pliant/core/expects.hpp"

namespace pliant::xml {
namespace {

/// A file of 256 MiB may contain a problem every few bytes, and each message needs about a hundred
/// bytes.
constexpr std::size_t most_listed = 10'000;

}  // namespace

void Findings::add_problem(int line, std::string message) {
  ++problem_count_;
  if (is_full()) return;
  problems_.push_back(Error{
      .code = ErrorCode::InvalidInput, .message = std::move(message), .file = file_, .line = line});
}

bool Findings::is_full() const { return problems_.size() >= most_listed; }

void Findings::add_note(int line, std::string message) {
  if (notes_.size() < most_listed) notes_.push_back({line, std::move(message)});
}

std::vector<Error> Findings::problems() const {
  std::vector<Error> problems = sorted(problems_, file_);
  if (is_full())
    problems.push_back(Error{.code = ErrorCode::InvalidInput,
                             .message = "too many problems; reading stopped here",
                             .file = file_,
                             .line = problems.back().line});
  return problems;
}

Error Findings::to_error() const {
  PLIANT_EXPECTS(!problems_.empty());
  return as_one(problems(), file_);
}

std::vector<SceneNote> Findings::notes() const {
  std::vector<SceneNote> notes = notes_;
  std::stable_sort(notes.begin(), notes.end(),
                   [](const SceneNote& a, const SceneNote& b) { return a.line < b.line; });
  return notes;
}

}  // namespace pliant::xml
