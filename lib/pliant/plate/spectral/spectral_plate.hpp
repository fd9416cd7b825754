#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "pliant/core/memory_budget.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/run_context.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/kernels/kernels.hpp"
#include "pliant/plate/number_block.hpp"
#include "pliant/plate/plate_problem.hpp"
#include "pliant/plate/plate_solver.hpp"
#include "pliant/plate/solver_choice.hpp"
#include "pliant/plate/spectral/sine_plan.hpp"
#include "pliant/plate/time_steps.hpp"

namespace pliant {

/// A field on the nodes of a rectangle, or on its interior nodes: a pointer to the first interior
/// node of the first component, and the strides to the next ones.
struct NodesView {
  double* first = nullptr;
  long row_stride = 0;
  long component_stride = 0;
};
struct ConstNodesView {
  const double* first = nullptr;
  long row_stride = 0;
  long component_stride = 0;
};

/// A clamped plate in sine space, where its operator is a diagonal and four small dense matrices.
/// Opposite edges may be pinned instead; with all four pinned it is the diagonal alone.
/// Stores the tables and the factors for one system and the state of three components. Solves in
/// O(nodes log side), steps in O(nodes). docs/model.md, "In sine space". Internal to plate.
class SpectralPlate {
 public:
  explicit SpectralPlate(const RunContext& context = {});

  /// Prepares for a system. Reuse of the last one never changes a result's bits. Errors:
  /// SolverFailed if the matrix is not positive definite or not finite; OutOfMemory.
  Result<void> prepare(const PlateSystem& system);

  /// Solves for three right-hand sides on the interior nodes. Requires: prepared.
  void solve(const ConstNodesView& load, const NodesView& solution);

  /// Likewise for some components only; the others are neither read nor written. If there are
  /// `runs` of interior nodes, the load must be 0 outside, and the solution may be left there.
  /// Lines across without any of these nodes are not transformed; the numbers are the same.
  void solve_for(const std::vector<int>& components, const ConstNodesView& load,
                 std::span<const UnknownRun> runs, const NodesView& solution);

  /// Steps on the interior nodes with the prepared shift; the load excludes the rim's part.
  /// Requires: prepared; shift and inertia are those of steps.solved_length(). Returns false if the
  /// context's stop request returns true; displacement and velocity are then unchanged. `watch` is
  /// called after each step, once the displacement was written; false: no step follows, and the
  /// velocity is not written. Empty: nobody watches.
  bool advance(const ConstNodesView& load, double inertia, const TimeSteps& steps,
               const NodesView& displacement, const NodesView& velocity,
               const std::function<bool()>& watch = {});

  const SolverCounts& counts() const { return counts_; }
  std::size_t memory() const { return memory_.bytes(); }

 private:
  friend class SpectralMotion;

  // Storage of one pair of parities. Rows are the modes along, columns those across.
  struct Parity {
    int rows = 0;
    int columns = 0;  // padded
    int pitch = 0;
    int inverse_pitch = 0;
    double* reciprocal = nullptr;
    double* row_pivot = nullptr;
    double* inverse = nullptr;
    double* panels = nullptr;  // workspace of the factorisation
    double* load[3] = {};
    double* displacement[3] = {};
    double* pending[3] = {};
    double* growth[3] = {};  // a transformed load, in exact steps; not the plate's
    double* sums[3] = {};    // of rows, of columns, and the edge
  };

  // The modes of one direction.
  struct Modes {
    double* eigenvalue[2] = {};  // of -(1 -2 1), by parity
    double* scale[2] = {};       // p_k, by parity
    double* unscale[2] = {};     // 1/p_k, by parity
    double* weight[2] = {};      // p_k^2, by parity
    double* in = nullptr;        // factor in the forward transform, by mode
    double* out = nullptr;       // and in the inverse transform
  };

  // Independent of the others: one component in one pair of parities.
  struct Block {
    int parity, component;
  };
  struct Blocks {
    std::size_t count = 0;
    Block all[12] = {};
  };

  // Columns `first` to before `last` of a transform, from a multiple of `pair_columns` on.
  struct Columns {
    int first, last;
  };

  Result<void> lay_out(int columns, int rows);
  void carve(Carver& carver);
  void fill_modes();
  bool fill_diagonal(const PlateSystem& system, int parity);
  ParityView view_of(int parity) const;
  ComponentView component_of(int parity, int component) const;
  void find_still(const ConstNodesView& load, const ConstNodesView& displacement,
                  const ConstNodesView& velocity);
  bool is_zero(const ConstNodesView& field, int component) const;
  bool are_equal(const ConstNodesView& one, const ConstNodesView& other) const;
  void clear(const NodesView& field, int component) const;
  Blocks moving_blocks() const;
  std::size_t task_count() const;
  TransformView transform_of(long row_stride) const;
  CoefficientsView coefficients_of(double* (Parity::*numbers)[3], int component) const;
  int between_width() const;
  void to_sines(const ConstNodesView& field, double* (Parity::*to)[3]);
  void to_sines(const ConstNodesView& field, double* (Parity::*to)[3],
                std::span<const Columns> parts, bool is_in_pairs);
  void from_sines(double* (Parity::*from)[3], const NodesView& field);
  void from_sines(double* (Parity::*from)[3], const NodesView& field,
                  std::span<const Columns> parts, bool is_in_pairs);
  std::vector<Columns> columns_with(std::span<const UnknownRun> runs) const;
  bool is_large() const { return long{columns_} * rows_ > 10'000; }
  // Runs tasks that write different numbers. On a small plate they are not worth a thread.
  template <class Work>
  void for_each(std::size_t count, const Work& work) {
    pliant::for_each(is_large() ? context_.threads : nullptr, count, work);
  }
  template <class Work>
  void for_columns(std::span<const Columns> parts, const Work& work);

  RunContext context_;
  const PlateKernels& kernels_;
  MemoryShare memory_;
  SolverCounts counts_;
  std::optional<PlateSystem> prepared_;

  int columns_ = 0;  // of the grid of the current layout
  int rows_ = 0;
  bool is_along_u_ = true;  // the longer direction is u
  SinePlan plans_[2];       // across, along
  NumberBlock numbers_;
  TransformView transform_;
  Modes modes_[2];  // across, along
  Parity parities_[4];
  double* between_[3] = {};
  bool is_still_[3] = {};  // components where all is 0, and remains 0
  double* work_ = nullptr;
  std::size_t work_size_ = 0;  // of one task
};

}  // namespace pliant
