#include "pliant/plate/sparse/supernodal_numbers.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/solver_errors.hpp"

namespace pliant {
namespace {

constexpr int panels_of(int rows) { return (rows + panel_rows - 1) / panel_rows; }

template <class Number>
constexpr int width = SupernodalNumbers<Number>::line / row_numbers;

template <class Number>
const FactorKernels& kernels_of(const RunContext& context) {
  const PlateKernels& kernels = kernels_of_width(context.most_lanes);
  return width<Number> == 1 ? kernels.factor : kernels.complex_factor;
}

template <class Number>
Number* numbers_in(const NumberBlock& block) {
  return reinterpret_cast<Number*>(block.begin());
}

// Numbers in eights, as vectors read them: of complex ones first the real parts.
template <class Number>
struct Eights {
  double* first;

  double* at(long k) const {
    return width<Number> == 1 ? first + k
                              : first + k / panel_rows * (2 * panel_rows) + k % panel_rows;
  }
  Number get(long k) const {
    const double* const from = at(k);
    if constexpr (width<Number> == 1)
      return *from;
    else
      return {from[0], from[panel_rows]};
  }
  void set(long k, Number number) const {
    double* const to = at(k);
    if constexpr (width<Number> == 1) {
      *to = number;
    } else {
      to[0] = number.re;
      to[panel_rows] = number.im;
    }
  }
  void add(long k, Number number) const { set(k, get(k) + number); }
};

// A number over a pivot, of which `kept` is what is kept.
double over(double number, double kept) { return number / kept; }
Complex over(Complex number, Complex kept) { return number * kept; }

// What is kept of a pivot; none if it is no pivot.
std::optional<double> kept_of(double pivot) {
  if (!(pivot > 0 && pivot <= std::numeric_limits<double>::max())) return {};
  return pivot;
}
std::optional<Complex> kept_of(Complex pivot) {
  const double square = pivot.re * pivot.re + pivot.im * pivot.im;
  if (!(square > 0 && square < 1e300)) return {};
  return reciprocal(pivot);
}

// What is made.
template <class Number>
struct Made {
  const SupernodePattern& pattern;
  Number* entries;
  Number* pivots;
};

// What it is made of, and with.
template <class Number>
struct Making {
  const double* values;
  std::span<const Number> shifts;
  const FactorKernels& kernels;
  ThreadPool* threads;
  const StopRequest& should_stop;
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

  // The panel of a row, and the row in it; a supernode's own rows come first.
  int panel_row(int row) const {
    return row < columns ? row : row - columns + own_panels() * panel_rows;
  }
};

// Makes the columns of some supernodes, one after another.
template <class Number>
class Fronts {
 public:
  // What a supernode leaves to its parent: the lower triangle of the rows below it.
  struct Update {
    const Fronts* maker = nullptr;
    long at = 0;  // in `waiting_`
  };

  // Supernodes in ascending order, and the updates of all, in memory of the fronts that make them.
  Fronts(const Made<Number>& made, const Making<Number>& making, std::span<const int> supernodes,
         std::vector<Update>& updates)
      : made_(made),
        making_(making),
        poll_(making.should_stop),
        supernodes_(supernodes),
        updates_(updates),
        places_(static_cast<std::size_t>(made.pattern.size())) {
    const auto [front, waiting] = numbers_for(made.pattern, supernodes);
    front_ = NumberBlock(static_cast<std::size_t>(width<Number> * front));
    waiting_ = NumberBlock(static_cast<std::size_t>(width<Number> * waiting));
  }

  static std::size_t bytes(const SupernodePattern& pattern, std::span<const int> supernodes) {
    const auto [front, waiting] = numbers_for(pattern, supernodes);
    return sizeof(Number) * static_cast<std::size_t>(front + waiting) +
           sizeof(int) * static_cast<std::size_t>(pattern.size());
  }

  Result<void> factorize() {
    for (const int supernode : supernodes_) {
      gather(supernode);
      if (auto done = eliminate(made_.pattern.supernodes()[supernode]); !done) return done;
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

  // The numbers of a panel, column by column.
  Eights<Number> panel(const FrontShape& shape, int number) const {
    return {front_.begin() + width<Number> * number * shape.panel()};
  }

  // A row of what is left.
  Eights<Number> left(const FrontShape& shape, int row) const {
    return {front_.begin() +
            width<Number> * (shape.panels() * shape.panel() + row * shape.stride())};
  }

  // To an own column of a row.
  void add(const FrontShape& shape, int row, int column, Number number) const {
    const int at = shape.panel_row(row);
    panel(shape, at / panel_rows).add(long{column} * panel_rows + at % panel_rows, number);
  }

  // The matrix's entries and what the children leave.
  void gather(int number) {
    const SupernodePattern& pattern = made_.pattern;
    const Supernode& node = pattern.supernodes()[number];
    const FrontShape shape(node);
    std::fill_n(front_.begin(), width<Number> * shape.numbers(), 0.0);
    for (int k = 0; k < node.columns; ++k) places_[node.first + k] = k;
    const auto below = pattern.rows_below(node);
    for (int k = 0; k < node.rows; ++k) places_[below[k]] = node.columns + k;
    for (int column = 0; column < node.columns; ++column) {
      for (const auto& [row, place] : pattern.own_entries(node.first + column))
        add(shape, places_[row], column, Number{making_.values[place]});
      const auto own = static_cast<std::size_t>(pattern.order()[node.first + column]);
      if (own < making_.shifts.size()) add(shape, column, column, making_.shifts[own]);
    }
    pattern.for_each_child(number, [&](int child) {
      add_update(shape, child);
      // Those that are made here are the last that wait.
      if (updates_[child].maker == this) waiting_end_ = updates_[child].at;
    });
  }

  void add_update(const FrontShape& shape, int child) {
    const auto rows = made_.pattern.rows_below(made_.pattern.supernodes()[child]);
    const auto count = static_cast<int>(rows.size());
    targets_.resize(rows.size());
    for (int k = 0; k < count; ++k) targets_[k] = places_[rows[k]];
    const auto own = static_cast<int>(
        std::lower_bound(targets_.begin(), targets_.end(), shape.columns) - targets_.begin());
    const Number* from = numbers_in<Number>(updates_[child].maker->waiting_) + updates_[child].at;
    for (int row = 0; row < count; ++row) {
      const int own_end = std::min(own, row + 1), at = shape.panel_row(targets_[row]);
      const Eights<Number> in_panel = panel(shape, at / panel_rows);
      for (int k = 0; k < own_end; ++k)
        in_panel.add(long{targets_[k]} * panel_rows + at % panel_rows, *from++);
      if (own > row) continue;
      const Eights<Number> to = left(shape, targets_[row] - shape.columns);
      for (int k = own; k <= row; ++k) to.add(targets_[k] - shape.columns, *from++);
    }
  }

  Result<void> eliminate(const Supernode& node) {
    constexpr int doubles = width<Number>;
    const FrontShape shape(node);
    const FactorKernels& kernels = making_.kernels;
    const int columns = node.columns;
    const long panel_stride = doubles * shape.panel(), stride = doubles * shape.stride();
    Number* const lower = made_.entries + node.entries_at;
    Number* const pivots = made_.pivots + node.first;
    const auto* const of_lower = reinterpret_cast<const double*>(lower);
    for (int block = 0; block < shape.own_panels(); ++block) {
      const Eights<Number> own = panel(shape, block);
      const int first = block * panel_rows, last = std::min(columns, first + panel_rows);
      kernels.reduce_panels({own.first, panel_stride, 1, of_lower}, 0, first, first);
      for (int row = first; row < last; ++row) {
        for (int k = 0; k < first; ++k)
          lower[triangle(row) + k] = over(own.get(long{k} * panel_rows + row - first), pivots[k]);
      }
      kernels.reduce_panels({own.first, panel_stride, 1, of_lower}, first, last, first);
      if (const int failed = eliminate_block(own, first, last, lower, pivots); failed >= 0)
        return fail(not_positive_definite(made_.pattern.size(), node.first + failed));
      if (poll_.after(parts_of(long{panel_rows} * first * first / 2))) return interrupted();
    }
    Number* const below = lower + triangle(columns);
    double* const panels_below = panel(shape, shape.own_panels()).first;
    const auto reduce = [&](int row, int end) {
      double* const first = panels_below + row / panel_rows * panel_stride;
      kernels.reduce_panels({first, panel_stride, panels_of(end - row), of_lower}, 0, columns,
                            columns);
      for (int k = row; k < end; ++k) {
        const Eights<Number> from = {first + (k - row) / panel_rows * panel_stride};
        for (int column = 0; column < columns; ++column) {
          below[long{k} * columns + column] =
              over(from.get(long{column} * panel_rows + (k - row) % panel_rows), pivots[column]);
        }
      }
    };
    if (!for_rows(node.rows, long{columns} * columns / 2, reduce)) return interrupted();
    const auto* const of_below = reinterpret_cast<const double*>(below);
    const auto subtract = [&](int begin, int end) {
      for (int row = begin; row < end; row += rows_at_once) {
        const int count = std::min(rows_at_once, end - row);
        kernels.subtract_products({left(shape, row).first, stride, count, columns,
                                   of_below + doubles * (long{row} * columns), panels_below,
                                   panel_stride, panels_of(row + count)});
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
    const bool is_large = making_.threads && products * rows > worth_threads;
    const int at_a_time = rows_of_group;
    std::atomic<bool> stopped = false;
    pliant::for_each(is_large ? making_.threads : nullptr,
                     static_cast<std::size_t>((rows + at_a_time - 1) / at_a_time),
                     [&](std::size_t group) {
                       const int begin = static_cast<int>(group) * at_a_time;
                       const int end = std::min(rows, begin + at_a_time);
                       if (stopped) return;
                       work(begin, end);
                       StopPoll poll(making_.should_stop);
                       if (poll.after(parts_of(products * (end - begin)))) stopped = true;
                     });
    return !stopped && !poll_.after(parts_of(products * rows));
  }

  // Eliminates the columns of a block from its own rows, from which those before are eliminated.
  // The first column whose pivot is not positive; -1: none.
  static int eliminate_block(const Eights<Number>& panel, int first, int last, Number* lower,
                             Number* pivots) {
    for (int column = first; column < last; ++column) {
      const auto at = [&](int row) { return panel.get(long{column} * panel_rows + row - first); };
      const auto pivot = kept_of(at(column));
      if (!pivot) return column;
      pivots[column] = *pivot;
      for (int row = column + 1; row < last; ++row) {
        const Number entry = over(at(row), *pivot);
        lower[triangle(row) + column] = entry;
        for (int k = row; k < last; ++k) {
          const long to = long{row} * panel_rows + k - first;
          panel.set(to, panel.get(to) - at(k) * entry);
        }
      }
    }
    return -1;
  }

  void leave_update(int number) {
    const Supernode& node = made_.pattern.supernodes()[number];
    const FrontShape shape(node);
    updates_[number] = {this, waiting_end_};
    Number* to = numbers_in<Number>(waiting_) + waiting_end_;
    for (int row = 0; row < node.rows; ++row) {
      const Eights<Number> from = left(shape, row);
      for (int k = 0; k <= row; ++k) *to++ = from.get(k);
    }
    waiting_end_ += triangle(node.rows + 1);
  }

  static std::size_t parts_of(long products) {
    constexpr long products_of_part = 8;  // some nanoseconds
    return static_cast<std::size_t>(products / products_of_part + 1);
  }

  static constexpr int rows_at_once = 4, rows_of_group = 4 * panel_rows;

  const Made<Number>& made_;
  const Making<Number>& making_;
  StopPoll poll_;
  std::span<const int> supernodes_;
  std::vector<Update>& updates_;
  std::vector<int> places_;  // of the front's rows
  std::vector<int> targets_;
  NumberBlock front_;
  NumberBlock waiting_;  // updates, for their parents
  long waiting_end_ = 0;
};

// The supernodes of each subtree.
std::vector<std::vector<int>> supernodes_of_subtrees(const SupernodePattern& pattern) {
  std::vector<std::vector<int>> all;
  for (const auto& subtree : pattern.subtrees()) {
    std::vector<int>& supernodes =
        all.emplace_back(static_cast<std::size_t>(subtree.root + 1 - subtree.first));
    std::iota(supernodes.begin(), supernodes.end(), subtree.first);
  }
  return all;
}

}  // namespace

template <class Number>
std::size_t SupernodalNumbers<Number>::bytes(const SupernodePattern& pattern) {
  return pattern.memory() +
         sizeof(Number) * static_cast<std::size_t>(pattern.entry_count() + pattern.size());
}

// As if all subtrees were made at the same time.
template <class Number>
std::size_t SupernodalNumbers<Number>::work_bytes(const SupernodePattern& pattern) {
  std::size_t bytes = Fronts<Number>::bytes(pattern, pattern.above_subtrees());
  for (const auto& supernodes : supernodes_of_subtrees(pattern))
    bytes += Fronts<Number>::bytes(pattern, supernodes);
  return bytes +
         (sizeof(int) + sizeof(typename Fronts<Number>::Update)) * pattern.supernodes().size();
}

template <class Number>
Result<void> SupernodalNumbers<Number>::factorize(std::shared_ptr<const SupernodePattern> pattern,
                                                  const double* values,
                                                  std::span<const Number> shifts,
                                                  const RunContext& context) {
  pattern_ = std::move(pattern);
  entries_ = NumberBlock(static_cast<std::size_t>(width<Number> * pattern_->entry_count()));
  pivots_.resize(static_cast<std::size_t>(pattern_->size()));
  const Made<Number> made = {*pattern_, numbers_in<Number>(entries_), pivots_.data()};
  std::vector<typename Fronts<Number>::Update> updates(pattern_->supernodes().size());
  const auto subtrees = supernodes_of_subtrees(*pattern_);
  std::vector<std::optional<Fronts<Number>>> fronts(subtrees.size());
  std::vector<Result<void>> results(subtrees.size());
  const FactorKernels& kernels = kernels_of<Number>(context);
  const Making<Number> alone{values, shifts, kernels, nullptr, context.should_stop};
  std::atomic<bool> stopped = false;
  pliant::for_each(context.threads, subtrees.size(), [&](std::size_t k) {
    if (stopped) return;
    fronts[k].emplace(made, alone, subtrees[k], updates);
    results[k] = fronts[k]->factorize();
    if (!results[k] && results[k].error().code == ErrorCode::Interrupted) stopped = true;
  });
  for (Result<void>& result : results) {
    if (!result) return std::move(result);
  }
  const Making<Number> all{values, shifts, kernels, context.threads, context.should_stop};
  Fronts<Number> above(made, all, pattern_->above_subtrees(), updates);
  return above.factorize();
}

// Subtrees have rows of their own for what is above them, which is added in their order.
template <class Number>
void SupernodalNumbers<Number>::solve(const RunContext& context, double* x) const {
  const SupernodePattern& pattern = *pattern_;
  const FactorKernels& kernels = kernels_of<Number>(context);
  const SupernodesView view = {pattern.supernodes().data(), pattern.solve_rows().data(),
                               entries_.begin(), reinterpret_cast<const double*>(pivots_.data())};
  const auto& subtrees = pattern.subtrees();
  const auto& above = pattern.above_subtrees();
  const auto of_row = [&](int row) { return x + long{row} * line; };
  const auto foreign_rows = [&](const SupernodePattern::Subtree& subtree) {
    return pattern.rows_below(pattern.supernodes()[subtree.root]);
  };
  const auto for_each_subtree = [&](const auto& work) {
    pliant::for_each(context.threads, subtrees.size(), [&](std::size_t k) { work(subtrees[k]); });
  };
  for_each_subtree([&](const SupernodePattern::Subtree& subtree) {
    const auto rows = foreign_rows(subtree);
    std::fill_n(of_row(subtree.foreign_rows_at), rows.size() * line, 0.0);
    for (int k = subtree.first; k <= subtree.root; ++k) kernels.solve_forward(view, k, x);
  });
  for (const auto& subtree : subtrees) {
    const double* from = of_row(subtree.foreign_rows_at);
    for (const int row : foreign_rows(subtree)) {
      for (int c = 0; c < line; ++c) of_row(row)[c] += *from++;
    }
  }
  for (const int k : above) kernels.solve_forward(view, k, x);
  for (auto k = above.rbegin(); k != above.rend(); ++k) kernels.solve_backward(view, *k, x);
  for_each_subtree([&](const SupernodePattern::Subtree& subtree) {
    double* to = of_row(subtree.foreign_rows_at);
    for (const int row : foreign_rows(subtree)) to = std::copy_n(of_row(row), line, to);
    for (int k = subtree.root; k >= subtree.first; --k) kernels.solve_backward(view, k, x);
  });
}

template class SupernodalNumbers<double>;
template class SupernodalNumbers<Complex>;

}  // namespace pliant
