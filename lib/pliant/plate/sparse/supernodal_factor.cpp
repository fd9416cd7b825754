#include <algorithm>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/plate/sparse/sparse_factor.hpp"
#include "pliant/plate/sparse/supernodal_numbers.hpp"

namespace pliant {
namespace {

class SupernodalFactor final : public SparseFactor {
 public:
  explicit SupernodalFactor(const RunContext& context) : context_(context) {}

  Result<void> analyze(const SparseMatrix& matrix) override {
    numbers_.reset();
    pattern_ = std::make_shared<const SupernodePattern>(matrix);
    return {};
  }

  std::size_t bytes() const override {
    const SupernodePattern& pattern = this->pattern();
    return Numbers::bytes(pattern) +
           sizeof(double) * static_cast<std::size_t>(long{pattern.solve_size()} * Numbers::line);
  }

  std::size_t work_bytes() const override { return Numbers::work_bytes(pattern()); }

  Result<void> factorize(const SparseMatrix& matrix, const StopRequest& should_stop) override {
    PLIANT_EXPECTS(pattern_ && pattern_->size() == matrix.cols());
    numbers_.reset();
    auto numbers = std::make_shared<Numbers>();
    RunContext context = context_;
    context.should_stop = should_stop;
    auto made = numbers->factorize(pattern_, matrix.valuePtr(), {}, context);
    if (made) numbers_ = std::move(numbers);
    return made;
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    const SupernodePattern& pattern = numbers_->pattern();
    const std::vector<int>& order = pattern.order();
    const int size = pattern.size();
    const auto count = static_cast<std::size_t>(pattern.solve_size()) * Numbers::line;
    if (x_.count() != count) {
      x_ = NumberBlock(count);
      std::fill_n(x_.begin(), count, 0.0);
    }
    double* to = x_.begin();
    for (int row = 0; row < size; ++row, to += Numbers::line) {
      for (int c = 0; c < 3; ++c) to[c] = right_hand_sides(order[row], c);
    }
    numbers_->solve(context_, x_.begin());
    Field solution(size, 3);
    const double* from = x_.begin();
    for (int row = 0; row < size; ++row, from += Numbers::line) {
      for (int c = 0; c < 3; ++c) solution(order[row], c) = from[c];
    }
    return solution;
  }

  bool share(const SparseFactor& other) override {
    numbers_ = static_cast<const SupernodalFactor&>(other).numbers_;
    return true;
  }

 private:
  using Numbers = SupernodalNumbers<double>;

  const SupernodePattern& pattern() const { return numbers_ ? numbers_->pattern() : *pattern_; }

  RunContext context_;
  std::shared_ptr<const SupernodePattern> pattern_;  // of the analysis
  std::shared_ptr<const Numbers> numbers_;           // perhaps of several
  NumberBlock x_;                                    // that a solve works on
};

}  // namespace

std::unique_ptr<SparseFactor> make_supernodal_factor(const RunContext& context) {
  return std::make_unique<SupernodalFactor>(context);
}

}  // namespace pliant
