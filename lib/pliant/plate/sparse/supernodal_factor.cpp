#include "pliant/plate/sparse/supernodal_factor.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <numeric>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "pliant/core/expects.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/number_block.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/sparse/supernode_pattern.hpp"

namespace pliant {
namespace {

constexpr int panels_of(int rows) { return (rows + panel_rows - 1) / panel_rows; }

struct FactorNumbers {
  std::shared_ptr<const SupernodePattern> pattern;
  NumberBlock entries;  // of L, see `SupernodesView`
  std::vector<double> pivots;
};

struct FactorTools {
  const PlateKernels& kernels;
  ThreadPool* threads;
  StopRequest should_stop = {};
};

// The rows and columns of a front: those of its supernode, then those below. What is eliminated is
// kept in panels of 8 rows, column by column: first the supernode's own rows, then, in a new panel,
// those below. What is left is the lower triangle of the rows below, row by row.
struct FrontShape {
  int columns = 0, rows = 0;

  explicit FrontShape(const Supernode& node) : columns(node.columns), rows(node.rows) {}

  long panel() const { return long{panel_rows} * columns; }
  int own_panels() const { return panels_of(columns); }
  int panels() const { return own_panels() + panels_of(rows); }
  long stride() const { return long{panel_rows} * panels_of(rows); }
  long numbers() const { return panels() * panel() + rows * stride(); }
};

// Makes the columns of some supernodes, one after another.
class Fronts {
 public:
  // What a supernode leaves to its parent: the lower triangle of the rows below it.
  struct Update {
    const Fronts* maker = nullptr;
    long at = 0;  // in `waiting_`
  };

  // Supernodes in ascending order, and the updates of all, in memory of the fronts that make them.
  Fronts(FactorNumbers& numbers, const FactorTools& tools, std::span<const int> supernodes,
         std::vector<Update>& updates)
      : pattern_(*numbers.pattern),
        numbers_(numbers),
        tools_(tools),
        poll_(tools.should_stop),
        supernodes_(supernodes),
        updates_(updates),
        places_(static_cast<std::size_t>(pattern_.size())) {
    const auto [front, waiting] = numbers_for(pattern_, supernodes);
    front_ = NumberBlock(static_cast<std::size_t>(front));
    waiting_ = NumberBlock(static_cast<std::size_t>(waiting));
  }

  static std::size_t bytes(const SupernodePattern& pattern, std::span<const int> supernodes) {
    const auto [front, waiting] = numbers_for(pattern, supernodes);
    return sizeof(double) * static_cast<std::size_t>(front + waiting) +
           sizeof(int) * static_cast<std::size_t>(pattern.size());
  }

  Result<void> factorize(const double* values) {
    for (const int supernode : supernodes_) {
      gather(supernode, values);
      if (auto done = eliminate(pattern_.supernodes()[supernode]); !done) return done;
      leave_update(supernode);
    }
    // What waits is for others.
    front_ = {};
    return {};
  }

 private:
  // The largest front, and the most that waits at a time.
  static std::array<long, 2> numbers_for(const SupernodePattern& pattern,
                                         std::span<const int> supernodes) {
    long front = 0, most_waiting = 0, waiting = 0;
    for (const int supernode : supernodes) {
      const Supernode& node = pattern.supernodes()[supernode];
      front = std::max(front, FrontShape(node).numbers());
      pattern.for_each_child(supernode, [&](int child) {
        if (std::binary_search(supernodes.begin(), supernodes.end(), child))
          waiting -= triangle(pattern.supernodes()[child].rows + 1);
      });
      waiting += triangle(node.rows + 1);
      most_waiting = std::max(most_waiting, waiting);
    }
    return {front, most_waiting};
  }

  // The number of an own column in a panel's row: a place of the front, own rows first.
  double& in_panel(const FrontShape& shape, int place, int column) const {
    const int row =
        place < shape.columns ? place : place - shape.columns + shape.own_panels() * panel_rows;
    return front_
        .begin()[row / panel_rows * shape.panel() + long{column} * panel_rows + row % panel_rows];
  }

  // The matrix's entries and what the children leave.
  void gather(int number, const double* values) {
    const Supernode& node = pattern_.supernodes()[number];
    const FrontShape shape(node);
    std::fill_n(front_.begin(), shape.numbers(), 0.0);
    for (int k = 0; k < node.columns; ++k) places_[node.first + k] = k;
    const auto below = pattern_.rows_below(node);
    for (int k = 0; k < node.rows; ++k) places_[below[k]] = node.columns + k;
    for (int column = 0; column < node.columns; ++column) {
      for (const auto& [row, place] : pattern_.own_entries(node.first + column))
        in_panel(shape, places_[row], column) += values[place];
    }
    pattern_.for_each_child(number, [&](int child) {
      add_update(shape, child);
      // Those that are made here are the last that wait.
      if (updates_[child].maker == this) waiting_end_ = updates_[child].at;
    });
  }

  void add_update(const FrontShape& shape, int child) {
    const auto rows = pattern_.rows_below(pattern_.supernodes()[child]);
    const auto count = static_cast<int>(rows.size());
    targets_.resize(rows.size());
    for (int k = 0; k < count; ++k) targets_[k] = places_[rows[k]];
    const auto own = static_cast<int>(
        std::lower_bound(targets_.begin(), targets_.end(), shape.columns) - targets_.begin());
    double* const left = front_.begin() + shape.panels() * shape.panel() - shape.columns;
    const double* from = updates_[child].maker->waiting_.begin() + updates_[child].at;
    for (int row = 0; row < count; ++row) {
      const int own_end = std::min(own, row + 1);
      double* const panel = &in_panel(shape, targets_[row], 0);
      for (int k = 0; k < own_end; ++k) panel[long{targets_[k]} * panel_rows] += *from++;
      double* const to = left + (targets_[row] - shape.columns) * shape.stride();
      for (int k = own; k <= row; ++k) to[targets_[k]] += *from++;
    }
  }

  Result<void> eliminate(const Supernode& node) {
    const FrontShape shape(node);
    const int columns = node.columns;
    double* const panels = front_.begin();
    double* const lower = numbers_.entries.begin() + node.entries_at;
    double* const pivots = numbers_.pivots.data() + node.first;
    for (int block = 0; block < shape.own_panels(); ++block) {
      double* const panel = panels + block * shape.panel();
      const int first = block * panel_rows, last = std::min(columns, first + panel_rows);
      tools_.kernels.reduce_panels({panel, shape.panel(), 1, lower}, 0, first, first);
      for (int row = first; row < last; ++row) {
        for (int k = 0; k < first; ++k)
          lower[triangle(row) + k] = panel[long{k} * panel_rows + row - first] / pivots[k];
      }
      tools_.kernels.reduce_panels({panel, shape.panel(), 1, lower}, first, last, first);
      if (const int failed = eliminate_block(panel, first, last, lower, pivots); failed >= 0)
        return fail(not_positive_definite(pattern_.size(), node.first + failed));
      if (poll_.after(parts_of(long{panel_rows} * first * first / 2))) return interrupted();
    }
    double* const below = lower + triangle(columns);
    double* const panels_below = panels + shape.own_panels() * shape.panel();
    const auto reduce = [&](int row, int end) {
      double* const panel = panels_below + row / panel_rows * shape.panel();
      tools_.kernels.reduce_panels({panel, shape.panel(), panels_of(end - row), lower}, 0, columns,
                                   columns);
      for (int k = row; k < end; ++k) {
        const double* const from =
            panel + (k - row) / panel_rows * shape.panel() + (k - row) % panel_rows;
        for (int column = 0; column < columns; ++column)
          below[long{k} * columns + column] = from[long{column} * panel_rows] / pivots[column];
      }
    };
    if (!for_rows(node.rows, long{columns} * columns / 2, reduce)) return interrupted();
    double* const left = panels + shape.panels() * shape.panel();
    const auto subtract = [&](int begin, int end) {
      for (int row = begin; row < end; row += rows_at_once) {
        const int count = std::min(rows_at_once, end - row);
        tools_.kernels.subtract_products({left + row * shape.stride(), shape.stride(), count,
                                          columns, below + long{row} * columns, panels_below,
                                          shape.panel(), panels_of(row + count)});
      }
    };
    if (!for_rows(node.rows, long{columns} * node.rows / 2, subtract)) return interrupted();
    return {};
  }

  // Calls work(begin, end) for rows, some at the same time; so many products for each. False: it
  // was stopped.
  template <class Work>
  bool for_rows(int rows, long products, const Work& work) {
    constexpr long worth_threads = 1'000'000;  // products
    const bool is_large = tools_.threads && products * rows > worth_threads;
    const int at_a_time = rows_of_group;
    std::atomic<bool> stopped = false;
    pliant::for_each(is_large ? tools_.threads : nullptr,
                     static_cast<std::size_t>((rows + at_a_time - 1) / at_a_time),
                     [&](std::size_t group) {
                       const int begin = static_cast<int>(group) * at_a_time;
                       const int end = std::min(rows, begin + at_a_time);
                       if (stopped) return;
                       work(begin, end);
                       StopPoll poll(tools_.should_stop);
                       if (poll.after(parts_of(products * (end - begin)))) stopped = true;
                     });
    return !stopped && !poll_.after(parts_of(products * rows));
  }

  // Eliminates the columns of a block from its own rows, from which those before are eliminated.
  // The first column whose pivot is not positive; -1: none.
  static int eliminate_block(double* panel, int first, int last, double* lower, double* pivots) {
    for (int column = first; column < last; ++column) {
      double* const own = panel + long{column} * panel_rows;
      const double pivot = own[column - first];
      if (!(pivot > 0 && pivot <= std::numeric_limits<double>::max())) return column;
      pivots[column] = pivot;
      for (int row = column + 1; row < last; ++row) {
        const double entry = own[row - first] / pivot;
        lower[triangle(row) + column] = entry;
        double* const of_row = panel + long{row} * panel_rows;
        for (int k = row; k < last; ++k) of_row[k - first] -= own[k - first] * entry;
      }
    }
    return -1;
  }

  void leave_update(int number) {
    const Supernode& node = pattern_.supernodes()[number];
    const FrontShape shape(node);
    updates_[number] = {this, waiting_end_};
    const double* from = front_.begin() + shape.panels() * shape.panel();
    for (int row = 0; row < node.rows; ++row, from += shape.stride()) {
      std::copy_n(from, row + 1, waiting_.begin() + waiting_end_);
      waiting_end_ += row + 1;
    }
  }

  static std::size_t parts_of(long products) {
    constexpr long products_of_part = 8;  // some nanoseconds
    return static_cast<std::size_t>(products / products_of_part + 1);
  }

  static constexpr int rows_at_once = 4, rows_of_group = 4 * panel_rows;

  const SupernodePattern& pattern_;
  FactorNumbers& numbers_;
  const FactorTools& tools_;
  StopPoll poll_;
  std::span<const int> supernodes_;
  std::vector<Update>& updates_;
  std::vector<int> places_;  // of the front's rows
  std::vector<int> targets_;
  NumberBlock front_;
  NumberBlock waiting_;  // updates, for their parents
  long waiting_end_ = 0;
};

class SupernodalFactor final : public SparseFactor {
 public:
  explicit SupernodalFactor(const RunContext& context)
      : kernels_(kernels_of_width(context.most_lanes)), threads_(context.threads) {}

  Result<void> analyze(const SparseMatrix& matrix) override {
    numbers_.reset();
    pattern_ = std::make_shared<const SupernodePattern>(matrix);
    return {};
  }

  std::size_t bytes() const override {
    const SupernodePattern& pattern = this->pattern();
    return pattern.memory() +
           sizeof(double) * static_cast<std::size_t>(pattern.entry_count() + pattern.size() +
                                                     long{pattern.solve_size()} * row_numbers);
  }

  // As if all subtrees were made at the same time.
  std::size_t work_bytes() const override {
    const SupernodePattern& pattern = this->pattern();
    std::size_t bytes = Fronts::bytes(pattern, pattern.above_subtrees());
    for (const auto& supernodes : supernodes_of_subtrees(pattern))
      bytes += Fronts::bytes(pattern, supernodes);
    return bytes + (sizeof(int) + sizeof(Fronts::Update)) * pattern.supernodes().size();
  }

  Result<void> factorize(const SparseMatrix& matrix, const StopRequest& should_stop) override {
    PLIANT_EXPECTS(pattern_ && pattern_->size() == matrix.cols());
    numbers_.reset();
    auto numbers = std::make_shared<FactorNumbers>();
    numbers->pattern = pattern_;
    numbers->entries = NumberBlock(static_cast<std::size_t>(pattern_->entry_count()));
    numbers->pivots.resize(static_cast<std::size_t>(pattern_->size()));
    std::vector<Fronts::Update> updates(pattern_->supernodes().size());
    const auto subtrees = supernodes_of_subtrees(*pattern_);
    std::vector<std::optional<Fronts>> fronts(subtrees.size());
    std::vector<Result<void>> results(subtrees.size());
    const FactorTools alone{kernels_, nullptr, should_stop};
    std::atomic<bool> stopped = false;
    pliant::for_each(threads_, subtrees.size(), [&](std::size_t k) {
      if (stopped) return;
      fronts[k].emplace(*numbers, alone, subtrees[k], updates);
      results[k] = fronts[k]->factorize(matrix.valuePtr());
      if (!results[k] && results[k].error().code == ErrorCode::Interrupted) stopped = true;
    });
    for (Result<void>& result : results) {
      if (!result) return std::move(result);
    }
    const FactorTools all{kernels_, threads_, should_stop};
    Fronts above(*numbers, all, pattern_->above_subtrees(), updates);
    if (auto done = above.factorize(matrix.valuePtr()); !done) return done;
    numbers_ = std::move(numbers);
    return {};
  }

  Result<Field> solve(const Field& right_hand_sides) override {
    const SupernodePattern& pattern = *numbers_->pattern;
    const std::vector<int>& order = pattern.order();
    const int size = pattern.size();
    const auto count = static_cast<std::size_t>(pattern.solve_size()) * row_numbers;
    if (x_.count() != count) {
      x_ = NumberBlock(count);
      std::fill_n(x_.begin(), count, 0.0);
    }
    for (int row = 0; row < size; ++row) {
      for (int c = 0; c < 3; ++c) of_row(row)[c] = right_hand_sides(order[row], c);
    }
    solve_in_place(pattern);
    Field solution(size, 3);
    for (int row = 0; row < size; ++row) {
      for (int c = 0; c < 3; ++c) solution(order[row], c) = of_row(row)[c];
    }
    return solution;
  }

  bool share(const SparseFactor& other) override {
    numbers_ = static_cast<const SupernodalFactor&>(other).numbers_;
    return true;
  }

 private:
  const SupernodePattern& pattern() const { return numbers_ ? *numbers_->pattern : *pattern_; }
  double* of_row(int row) { return x_.begin() + row * long{row_numbers}; }

  static std::vector<std::vector<int>> supernodes_of_subtrees(const SupernodePattern& pattern) {
    std::vector<std::vector<int>> all;
    for (const auto& subtree : pattern.subtrees()) {
      std::vector<int>& supernodes =
          all.emplace_back(static_cast<std::size_t>(subtree.root + 1 - subtree.first));
      std::iota(supernodes.begin(), supernodes.end(), subtree.first);
    }
    return all;
  }

  // Subtrees have rows of their own for what is above them, which is added in their order.
  void solve_in_place(const SupernodePattern& pattern) {
    const SupernodesView view = {pattern.supernodes().data(), pattern.solve_rows().data(),
                                 numbers_->entries.begin(), numbers_->pivots.data()};
    const auto& subtrees = pattern.subtrees();
    const auto& above = pattern.above_subtrees();
    const auto foreign_rows = [&](const SupernodePattern::Subtree& subtree) {
      return pattern.rows_below(pattern.supernodes()[subtree.root]);
    };
    const auto for_each_subtree = [&](const auto& work) {
      pliant::for_each(threads_, subtrees.size(), [&](std::size_t k) { work(subtrees[k]); });
    };
    for_each_subtree([&](const SupernodePattern::Subtree& subtree) {
      const auto rows = foreign_rows(subtree);
      std::fill_n(of_row(subtree.foreign_rows_at), rows.size() * row_numbers, 0.0);
      for (int k = subtree.first; k <= subtree.root; ++k)
        kernels_.solve_forward(view, k, x_.begin());
    });
    for (const auto& subtree : subtrees) {
      const double* from = of_row(subtree.foreign_rows_at);
      for (const int row : foreign_rows(subtree)) {
        for (int c = 0; c < row_numbers; ++c) of_row(row)[c] += *from++;
      }
    }
    for (const int k : above) kernels_.solve_forward(view, k, x_.begin());
    for (auto k = above.rbegin(); k != above.rend(); ++k)
      kernels_.solve_backward(view, *k, x_.begin());
    for_each_subtree([&](const SupernodePattern::Subtree& subtree) {
      double* to = of_row(subtree.foreign_rows_at);
      for (const int row : foreign_rows(subtree)) to = std::copy_n(of_row(row), row_numbers, to);
      for (int k = subtree.root; k >= subtree.first; --k)
        kernels_.solve_backward(view, k, x_.begin());
    });
  }

  const PlateKernels& kernels_;
  ThreadPool* threads_;
  std::shared_ptr<const SupernodePattern> pattern_;  // of the analysis
  std::shared_ptr<const FactorNumbers> numbers_;     // perhaps of several
  NumberBlock x_;                                    // that a solve works on
};

}  // namespace

std::unique_ptr<SparseFactor> make_supernodal_factor(const RunContext& context) {
  return std::make_unique<SupernodalFactor>(context);
}

}  // namespace pliant
