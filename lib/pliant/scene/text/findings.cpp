#include "pliant/scene/text/findings.hpp"

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
/// But one may name files and objects as long as paths and names may be.
constexpr std::size_t most_bytes = std::size_t{16} << 20U;

}  // namespace

void Findings::add_problem(int line, std::string message) {
  message += values_.sources(line, message, files_);
  add_problem(files_.place_of(line), std::move(message));
}

void Findings::add_problem(ScenePlace place, std::string message) {
  ++problem_count_;
  if (is_full()) return;
  const bool is_new =
      place.chain.empty() || included_.emplace(place.file, place.line, message).second;
  if (!is_new) return;
  message = place.told(std::move(message));
  bytes_ += message.size() + place.file.size();
  problems_.push_back(Error{.code = ErrorCode::InvalidInput,
                            .message = std::move(message),
                            .file = std::move(place.file),
                            .line = place.line});
}

bool Findings::is_full() const { return problems_.size() >= most_listed || bytes_ >= most_bytes; }

bool Findings::is_over(std::size_t parts) {
  if (!is_stopped_ && poll_.after(parts)) stop();
  return is_over();
}

void Findings::stop() {
  is_stopped_ = true;
  ++problem_count_;
}

void Findings::add_note(int line, std::string message) {
  if (notes_.size() >= most_listed || bytes_ >= most_bytes) return;
  bytes_ += message.size();
  notes_.emplace_back(line, std::move(message));
}

std::vector<Error> Findings::problems() const {
  const std::string& file = files_.texts().front().file;
  std::vector<Error> problems = sorted(problems_, file);
  if (is_full())
    problems.push_back(Error{.code = ErrorCode::InvalidInput,
                             .message = "too many problems; reading stopped here",
                             .file = problems.back().file,
                             .line = problems.back().line});
  return problems;
}

Error Findings::to_error() const {
  if (is_stopped_) return interrupted().value();
  PLIANT_EXPECTS(!problems_.empty());
  return as_one(problems(), files_.texts().front().file);
}

std::vector<SceneNote> Findings::notes() const {
  std::vector<std::pair<int, std::string>> ordered = notes_;
  std::stable_sort(ordered.begin(), ordered.end(),
                   [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<SceneNote> notes;
  for (auto& [line, message] : ordered) {
    ScenePlace place = files_.place_of(line);
    message = place.told(std::move(message));
    notes.push_back({place.line, std::move(message), std::move(place.file)});
  }
  return notes;
}

}  // namespace pliant::xml
