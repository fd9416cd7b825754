#include "pliant/plate/sparse/supernode_pattern.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include <Eigen/OrderingMethods>

namespace pliant {
namespace {

// Entries of L in so many columns with so many rows below.
constexpr long entries_of(long columns, long rows) { return triangle(columns) + rows * columns; }

std::vector<int> amd_order(const SparseMatrix& upper) {
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(upper.selfadjointView<Eigen::Upper>(), order);
  return {order.indices().data(), order.indices().data() + upper.cols()};
}

// Calls f(place, low, high) for the entries of a matrix: their place among its values, and their
// row and column in an order, the lower one first.
template <class F>
void for_each_entry(const SparseMatrix& upper, const std::vector<int>& order, const F& f) {
  std::vector<int> places(order.size());
  for (std::size_t k = 0; k < order.size(); ++k) places[order[k]] = static_cast<int>(k);
  for (int column = 0; column < static_cast<int>(upper.cols()); ++column) {
    for (int k = upper.outerIndexPtr()[column]; k < upper.outerIndexPtr()[column + 1]; ++k) {
      const auto [low, high] = std::minmax(places[upper.innerIndexPtr()[k]], places[column]);
      f(k, low, high);
    }
  }
}

// The parents of the columns of L in an order: the row of a column's first entry; -1: it has none.
std::vector<int> elimination_tree(const SparseMatrix& upper, const std::vector<int>& order) {
  std::vector<int> starts(order.size() + 1, 0);
  for_each_entry(upper, order, [&](int, int, int high) { ++starts[high + 1]; });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  std::vector<int> columns(static_cast<std::size_t>(upper.nonZeros()));
  std::vector<int> next(starts.begin(), starts.end() - 1);
  for_each_entry(upper, order, [&](int, int low, int high) { columns[next[high]++] = low; });
  std::vector<int> parents(order.size(), -1), ancestors(order.size(), -1);
  for (int row = 0; row < static_cast<int>(order.size()); ++row) {
    for (int k = starts[row]; k < starts[row + 1]; ++k) {
      for (int column = columns[k]; column >= 0 && column < row;) {
        const int above = std::exchange(ancestors[column], row);
        if (above < 0) parents[column] = row;
        column = above;
      }
    }
  }
  return parents;
}

// The nodes of a forest, children before their parents, those of one parent in ascending order.
std::vector<int> post_order(const std::vector<int>& parents) {
  const auto size = static_cast<int>(parents.size());
  std::vector<int> first_child(parents.size(), -1), next_sibling(parents.size(), -1);
  std::vector<int> stack, order;
  order.reserve(parents.size());
  for (int node = size - 1; node >= 0; --node) {
    if (parents[node] < 0) continue;
    next_sibling[node] = std::exchange(first_child[parents[node]], node);
  }
  for (int root = 0; root < size; ++root) {
    if (parents[root] >= 0) continue;
    stack.push_back(root);
    while (!stack.empty()) {
      const int node = stack.back();
      if (const int child = first_child[node]; child >= 0) {
        first_child[node] = next_sibling[child];
        stack.push_back(child);
      } else {
        order.push_back(node);
        stack.pop_back();
      }
    }
  }
  return order;
}

// Whether two supernodes are better as one that has so many columns and, in all, so many entries
// that are 0 of `entries`.
bool worth_joining(int columns, long zeros, long entries) {
  const auto share = static_cast<double>(zeros) / static_cast<double>(entries);
  if (columns <= 4) return share < 0.6;
  if (columns <= 16) return share < 0.35;
  if (columns <= 48) return share < 0.12;
  return share < 0.05;
}

}  // namespace

SupernodePattern::SupernodePattern(const SparseMatrix& upper) {
  const std::vector<int> rows = amd_order(upper);
  const std::vector<int> tree = elimination_tree(upper, rows);
  const std::vector<int> post = post_order(tree);
  std::vector<int> numbers(post.size()), parents(post.size());
  for (std::size_t k = 0; k < post.size(); ++k) numbers[post[k]] = static_cast<int>(k);
  order_.resize(post.size());
  for (std::size_t k = 0; k < post.size(); ++k) {
    order_[k] = rows[post[k]];
    parents[k] = tree[post[k]] < 0 ? -1 : numbers[tree[post[k]]];
  }
  find_own_entries(upper);
  join_columns(parents, counts(parents));
  divide_supernodes();
  find_rows();
  find_subtrees();
}

// Sorts the entries by columns of the order, and in each by rows.
void SupernodePattern::find_own_entries(const SparseMatrix& upper) {
  struct Entry {
    int column, place;
  };
  // By rows first; taken from there in order, the rows of a column ascend.
  std::vector<int> row_starts(order_.size() + 1, 0);
  own_starts_.assign(order_.size() + 1, 0);
  for_each_entry(upper, order_, [&](int, int low, int high) {
    ++row_starts[high + 1];
    ++own_starts_[low + 1];
  });
  std::partial_sum(row_starts.begin(), row_starts.end(), row_starts.begin());
  std::partial_sum(own_starts_.begin(), own_starts_.end(), own_starts_.begin());
  std::vector<Entry> by_rows(static_cast<std::size_t>(upper.nonZeros()));
  std::vector<int> next(row_starts.begin(), row_starts.end() - 1);
  for_each_entry(upper, order_, [&](int place, int low, int high) {
    by_rows[next[high]++] = {low, place};
  });
  own_entries_.resize(by_rows.size());
  next.assign(own_starts_.begin(), own_starts_.end() - 1);
  for (int row = 0; row < size(); ++row) {
    for (int k = row_starts[row]; k < row_starts[row + 1]; ++k)
      own_entries_[next[by_rows[k].column]++] = {row, by_rows[k].place};
  }
}

// Entries of each column of L and its diagonal. Requires: children come before their parents, in
// post-order. A column's entries are counted where the tree of a row begins to have it.
std::vector<int> SupernodePattern::counts(const std::vector<int>& parents) const {
  std::vector<int> counts(order_.size(), 1), first(order_.size()), last_first(order_.size(), -1);
  std::vector<int> last_leaf(order_.size(), -1), ancestors(order_.size());
  std::iota(ancestors.begin(), ancestors.end(), 0);
  std::iota(first.begin(), first.end(), 0);
  for (int column = 0; column < size(); ++column) {
    if (const int parent = parents[column]; parent >= 0) {
      first[parent] = std::min(first[parent], first[column]);
      counts[parent] = 0;  // not a leaf
    }
  }
  for (int column = 0; column < size(); ++column) {
    if (parents[column] >= 0) --counts[parents[column]];
    for (const OwnEntry& entry : own_entries(column)) {
      const int row = entry.row;
      if (row == column || first[column] <= last_first[row]) continue;
      last_first[row] = first[column];
      ++counts[column];
      const int leaf = std::exchange(last_leaf[row], column);
      if (leaf < 0) continue;
      // Counted twice above the last common ancestor of the two leaves.
      int common = leaf;
      while (ancestors[common] != common) common = ancestors[common];
      for (int node = leaf; node != common;) node = std::exchange(ancestors[node], common);
      --counts[common];
    }
    if (parents[column] >= 0) ancestors[column] = parents[column];
  }
  for (int column = 0; column < size(); ++column) {
    if (parents[column] >= 0) counts[parents[column]] += counts[column];
  }
  return counts;
}

void SupernodePattern::join_columns(const std::vector<int>& parents,
                                    const std::vector<int>& counts) {
  std::vector<long> zeros;  // of each supernode
  for (int column = 0; column < size(); ++column) {
    const int below = counts[column] - 1;
    const bool continues =
        column > 0 && parents[column - 1] == column && counts[column - 1] == counts[column] + 1;
    if (continues) {
      ++supernodes_.back().columns;
      supernodes_.back().rows = below;
    } else {
      supernodes_.push_back({column, 1, below});
      zeros.push_back(0);
    }
    if (column + 1 < size() && parents[column] == column + 1 &&
        counts[column] == counts[column + 1] + 1)
      continue;
    // The supernode is whole: it takes in those before it that are its children.
    while (supernodes_.size() > 1) {
      const Supernode& child = supernodes_[supernodes_.size() - 2];
      Supernode& node = supernodes_.back();
      if (parents[node.first - 1] < node.first || parents[node.first - 1] > column) break;
      const int columns = child.columns + node.columns;
      const long entries = entries_of(columns, node.rows);
      const long all = entries - entries_of(child.columns, child.rows) -
                       entries_of(node.columns, node.rows) + zeros[zeros.size() - 2] + zeros.back();
      if (!worth_joining(columns, all, entries)) break;
      node.first = child.first;
      node.columns = columns;
      zeros.back() = all;
      supernodes_[supernodes_.size() - 2] = node;
      zeros[zeros.size() - 2] = all;
      supernodes_.pop_back();
      zeros.pop_back();
    }
  }
}

// Large ones become several, one below the other: their fronts are smaller, and threads share them.
void SupernodePattern::divide_supernodes() {
  constexpr int most_columns = 512;
  std::vector<Supernode> divided;
  for (const Supernode& node : supernodes_) {
    const int parts = (node.columns + most_columns - 1) / most_columns;
    for (int part = 0; part < parts; ++part) {
      const int first = node.columns * part / parts, end = node.columns * (part + 1) / parts;
      divided.push_back({node.first + first, end - first});
    }
  }
  supernodes_ = std::move(divided);
}

// The rows below a supernode: those of the matrix, and those below its children.
void SupernodePattern::find_rows() {
  const auto count = static_cast<int>(supernodes_.size());
  std::vector<int> seen(order_.size(), -1), of_column(order_.size());
  parents_.assign(supernodes_.size(), -1);
  last_children_ = previous_siblings_ = parents_;
  for (int k = 0; k < count; ++k)
    std::fill_n(of_column.begin() + supernodes_[k].first, supernodes_[k].columns, k);
  for (int k = 0; k < count; ++k) {
    Supernode& node = supernodes_[k];
    const int end = node.first + node.columns;
    node.rows_at = static_cast<long>(rows_.size());
    node.entries_at = entry_count_;
    const auto take = [&](int row) {
      if (row < end || seen[row] == k) return;
      seen[row] = k;
      rows_.push_back(row);
    };
    for (int column = node.first; column < end; ++column) {
      for (const OwnEntry& entry : own_entries(column)) take(entry.row);
    }
    for_each_child(k, [&](int child) {
      // `take` may move the rows.
      const Supernode& below = supernodes_[child];
      for (int row = 0; row < below.rows; ++row)
        take(rows_[static_cast<std::size_t>(below.rows_at + row)]);
    });
    std::sort(rows_.begin() + node.rows_at, rows_.end());
    node.rows = static_cast<int>(rows_.size() - static_cast<std::size_t>(node.rows_at));
    entry_count_ += entries_of(node.columns, node.rows);
    if (node.rows == 0) continue;
    const int parent = of_column[rows_[static_cast<std::size_t>(node.rows_at)]];
    parents_[k] = parent;
    previous_siblings_[k] = std::exchange(last_children_[parent], k);
  }
}

// Does not depend on the threads, and so do the sums of a solve.
void SupernodePattern::find_subtrees() {
  constexpr double least_work = 2e6;  // multiplications, that are worth a thread
  constexpr double most_share = 1.0 / 12, least_share = most_share / 16;
  const std::size_t count = supernodes_.size();
  std::vector<double> works(count, 0);  // of the subtree of each
  std::vector<int> firsts(count);
  double all = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const Supernode& node = supernodes_[k];
    const double rows = node.columns + node.rows, below = node.rows;
    const double own = (rows * rows * rows - below * below * below) / 6;
    all += own;
    works[k] += own;
    firsts[k] = static_cast<int>(k);
    for_each_child(firsts[k], [&](int child) { firsts[k] = std::min(firsts[k], firsts[child]); });
    if (parents_[k] >= 0) works[parents_[k]] += works[k];
  }
  const auto is_small = [&](int k) { return works[k] <= most_share * all; };
  for (int k = 0; all > least_work && k < static_cast<int>(count); ++k) {
    const bool is_whole = is_small(k) && (parents_[k] < 0 || !is_small(parents_[k]));
    if (is_whole && works[k] >= least_share * all) subtrees_.push_back({firsts[k], k});
  }
  if (subtrees_.size() < 2) subtrees_.clear();
  solve_size_ = size();
  if (!subtrees_.empty()) solve_rows_ = rows_;
  int next = 0;
  for (Subtree& subtree : subtrees_) {
    for (; next < subtree.first; ++next) above_.push_back(next);
    next = subtree.root + 1;
    subtree.foreign_rows_at = solve_size_;
    const Supernode& root = supernodes_[subtree.root];
    const auto foreign = rows_below(root);
    solve_size_ += root.rows;
    const Supernode& first = supernodes_[subtree.first];
    for (long k = first.rows_at; k < root.rows_at + root.rows; ++k) {
      int& row = solve_rows_[static_cast<std::size_t>(k)];
      if (row < root.first + root.columns) continue;
      row =
          subtree.foreign_rows_at +
          static_cast<int>(std::lower_bound(foreign.begin(), foreign.end(), row) - foreign.begin());
    }
  }
  for (; next < static_cast<int>(count); ++next) above_.push_back(next);
}

std::size_t SupernodePattern::memory() const {
  return sizeof(int) * (order_.size() + own_starts_.size() + rows_.size() + solve_rows_.size()) +
         sizeof(OwnEntry) * own_entries_.size() +
         (sizeof(Supernode) + 3 * sizeof(int)) * supernodes_.size() + sizeof(int) * above_.size() +
         sizeof(Subtree) * subtrees_.size();
}

}  // namespace pliant
