#include "pliant/body/cycle.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/body/state_numbers.hpp"
#include "pliant/core/anderson_mixing.hpp"
#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

constexpr double largest_gap = 1e-6;  // of a cycle
constexpr double wanted_gap = 1e-10;  // at little cost

// The gap must also be this part of the first round's: what drifts away closes no better when it is
// far away, and a gap by a large displacement would be small.
constexpr double largest_part = 1e-2;
constexpr int most_rounds_for_more = 20;

// A state that is carried so many times farther than the first round is none of a cycle, which a
// resonance makes larger by the rounds that it needs at most: there rounding hides any gap.
constexpr double farthest = 1e6;
constexpr int most_rounds_carried = 30;

// The acceleration starts anew if the gap grows by this factor, and rests if it has not halved the
// gap for a while. What it did to stiff modes may take plain rounds long to forget, so these begin
// where the gap was shortest, and each rest is twice as long as the one before.
constexpr double growth = 10;
constexpr int patience = 40;
constexpr int first_rest = 80;

// Fewer on a large surface; 96 bytes for a node each.
std::size_t depth_of(const BodyState& state) {
  constexpr std::size_t most_numbers = std::size_t{1} << 25;
  return std::clamp<std::size_t>(most_numbers / (2 * std::max<std::size_t>(1, number_count(state))),
                                 3, 20);
}

double largest_length(const Field& a, const Field& b) {
  double largest = 0;
  for (Eigen::Index row = 0; row < a.rows(); ++row) {
    const double x = a(row, 0) - b(row, 0), y = a(row, 1) - b(row, 1), z = a(row, 2) - b(row, 2);
    const double square = x * x + y * y + z * z;
    if (!(square <= largest)) largest = square;  // not a number too
  }
  return std::isinf(largest) ? longest_vector(a - b).length : std::sqrt(largest);
}

struct Gap {
  double length = std::numeric_limits<double>::infinity();
  double peak = 0;  // the largest displacement of the cycle

  double share() const { return length == 0 ? 0 : length / peak; }
};

class Search {
 public:
  Search(Body& body, const CycleRound& round)
      : body_(body), round_(round), mixing_(depth_of(body.state())) {
    const Field& rest = body.rest();
    if (rest.size() > 0)
      rounding_ = 64 * std::numeric_limits<double>::epsilon() * rest.cwiseAbs().maxCoeff();
  }

  Result<BodyState> run() {
    state_ = body_.rest_state();
    int rounds = 0;
    for (int round = 1; round <= max_rounds; ++round) {
      rounds = round;
      if (auto gone = go_round(); !gone) {
        if (!may_go_back(gone.error())) return fail(gone.error());
        state_ = *std::move(plain_);
        plain_.reset();
        mixing_.clear();
        continue;
      }
      if (round == 1) first_ = gap_;
      if (is_carried_away(gap_) && ++rounds_carried_ > most_rounds_carried) break;
      if (round_.told) round_.told(round, gap_.share());
      const bool is_better = is_closed(gap_)
                                 ? !is_closed(best_gap_) || gap_.share() < best_gap_.share()
                                 : !is_closed(best_gap_) && gap_.length < best_gap_.length;
      if (is_better) {
        if (gap_.length < best_gap_.length / 2) last_gain_ = round;
        best_gap_ = gap_;
        best_image_ = image_;
        if (is_closed(gap_)) best_ = state_;
      }
      if (is_closed(best_gap_)) {
        const bool is_done = best_gap_.share() <= wanted_gap || best_gap_.length <= rounding_;
        if (is_done || ++rounds_for_more_ > most_rounds_for_more) return std::move(best_);
      }
      go_on(round);
    }
    if (is_closed(best_gap_)) return std::move(best_);
    if (rounds_carried_ > 0) {
      return fail(
          ErrorCode::SolverFailed,
          fmt::format(
              "its motion does not close to a cycle of {} frame{}: after {} rounds it is still "
              "carried away, by {:.3g} in the first, since nothing holds it and its loads do "
              "not cancel over the cycle; no damping changes that",
              round_.frames, round_.frames == 1 ? "" : "s", rounds, first_.length));
    }
    return fail(
        ErrorCode::SolverFailed,
        fmt::format("its motion does not close to a cycle of {} frame{}: after {} rounds the "
                    "state at its end is still apart from that at its beginning by {:.3g} "
                    "of the largest displacement, at most {:g} is allowed; more damping "
                    "makes it forget how it began",
                    round_.frames, round_.frames == 1 ? "" : "s", max_rounds, best_gap_.share(),
                    largest_gap));
  }

 private:
  // From state_ through all frames: the gap, and image_.
  Result<void> go_round() {
    body_.restore(state_);
    gap_.peak = displacement();
    for (int frame = 0; frame < round_.frames; ++frame) {
      if (auto advanced = round_.advance(frame); !advanced) return advanced;
      gap_.peak = std::max(gap_.peak, displacement());
    }
    image_ = body_.state();
    gap_.length =
        std::max(largest_length(image_.positions, state_.positions),
                 round_.frame_time * largest_length(image_.velocities, state_.velocities));
    return {};
  }

  double displacement() const { return largest_length(body_.state().positions, body_.rest()); }

  bool is_closed(const Gap& gap) const {
    if (is_carried_away(gap)) return false;
    return (gap.share() <= largest_gap && gap.length <= largest_part * first_.length) ||
           gap.length <= rounding_;
  }

  bool is_carried_away(const Gap& gap) const { return gap.peak > farthest * first_.peak; }

  // A combination of states may be one from which no motion leads on.
  bool may_go_back(const Error& error) const {
    return plain_ && (error.code == ErrorCode::NotFinite || error.code == ErrorCode::SolverFailed);
  }

  // Chooses the state of the next round.
  void go_on(int round) {
    const bool has_grown = !(gap_.length <= growth * before_);
    before_ = gap_.length;
    if (has_grown) mixing_.clear();
    if (round >= std::max(last_gain_ + patience, rest_end_)) {
      mixing_.clear();
      last_gain_ = round;
      is_plain_ = !is_plain_;
      if (is_plain_) {
        image_ = best_image_;
        rest_end_ = round + rest_;
        rest_ *= 2;
      }
    }
    if (is_plain_) {
      state_ = std::move(image_);
      plain_.reset();
      return;
    }
    const double time = round_.frame_time;
    std::vector<double> mixed = mixing_.next(numbers_of(state_, time), numbers_of(image_, time));
    state_ = with_numbers(image_, time, mixed);
    plain_ = std::move(image_);
  }

  Body& body_;
  const CycleRound& round_;
  AndersonMixing mixing_;
  double rounding_ = 0;  // of positions [length]
  Gap first_ = {};       // of the first round
  BodyState state_, image_, best_;
  BodyState best_image_;            // what the shortest gap led to
  std::optional<BodyState> plain_;  // what the last round led to, if state_ is not that
  Gap gap_, best_gap_;
  double before_ = std::numeric_limits<double>::infinity();
  int last_gain_ = 0, rounds_for_more_ = 0, rounds_carried_ = 0;
  int rest_ = first_rest, rest_end_ = 0;  // of the acceleration; the round in which it ends
  bool is_plain_ = false;
};

}  // namespace

Result<BodyState> find_cycle(Body& body, const CycleRound& round) {
  PLIANT_EXPECTS(round.frames >= 1 && round.frame_time > 0 && round.advance);
  // Six states, and the past.
  const std::size_t bytes =
      number_count(body.state()) * sizeof(double) * (2 * depth_of(body.state()) + 12);
  MemoryShare share(round.memory);
  if (!share.try_resize(bytes)) {
    return fail(ErrorCode::OutOfMemory, "looking for its cycle " + share.complaint(bytes));
  }
  return Search(body, round).run();
}

}  // namespace pliant
