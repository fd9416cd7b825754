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

void Findings::add_problem(const TextPlace& place, std::string message) {
  ++problem_count_;
  if (is_full()) return;
  const bool is_included = place.is_known() && place.text != 0;
  if (is_included) {
    const ScenePlace told = sources_->place_of(place);
    if (!included_.emplace(told.file, told.line, message).second) return;
  }
  list(sources_->located({.message = std::move(message)}, place));
}

void Findings::add_problem(Error error) {
  ++problem_count_;
  if (!is_full()) list(std::move(error));
}

void Findings::list(Error error) {
  bytes_ += error.message.size() + error.file.size();
  problems_.push_back(std::move(error));
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

void Findings::add_note(const TextPlace& place, std::string message) {
  if (notes_.size() >= most_listed || bytes_ >= most_bytes) return;
  bytes_ += message.size();
  notes_.emplace_back(place, std::move(message));
}

std::vector<Error> Findings::problems() const {
  std::vector<Error> problems = sorted(problems_, sources_->sources().front().file);
  if (is_full()) {
    problems.push_back(problems.back());
    problems.back().message = "too many problems; reading stopped here";
  }
  return problems;
}

Error Findings::to_error() const {
  if (is_stopped_) return interrupted().value();
  PLIANT_EXPECTS(!problems_.empty());
  return as_one(problems(), sources_->sources().front().file);
}

std::vector<SceneNote> Findings::notes() const {
  std::vector<std::pair<TextPlace, std::string>> ordered = notes_;
  std::stable_sort(ordered.begin(), ordered.end(), [&](const auto& a, const auto& b) {
    return sources_->is_before(a.first, b.first);
  });
  std::vector<SceneNote> notes;
  for (auto& [at, message] : ordered) {
    ScenePlace place = sources_->place_of(at);
    message = place.told(std::move(message));
    notes.push_back({place, std::move(message), std::move(place.file)});
  }
  return notes;
}

}  // namespace pliant::xml
