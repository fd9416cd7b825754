#pragma once

#include <list>
#include <optional>
#include <vector>

#include "pliant/plate/exact/substeps.hpp"
#include "pliant/plate/spectral/spectral_plate.hpp"

namespace pliant {

/// Exact steps of a clamped plate in sine space: those of `SparseMotion`, with D + z in place of D.
/// Internal to plate.
class SpectralMotion {
 public:
  /// Works in the layout of `plate`, and leaves it unprepared.
  SpectralMotion(SpectralPlate& plate, const RunContext& context)
      : plate_(plate), context_(context), memory_(context.memory) {}

  /// Advances as `SpectralPlate::advance`, from the first load to the last. Reuse never changes a
  /// bit. Errors: SolverFailed; OutOfMemory; Interrupted, with displacement and velocity unchanged.
  Result<void> advance(const PlateSystem& system, const Dynamics& dynamics, const TimeSteps& steps,
                       const ConstNodesView& first_load, const ConstNodesView& last_load,
                       const NodesView& displacement, const NodesView& velocity);

  SolverCounts counts() const { return counts_; }  ///< a complex solve counts as two
  std::size_t memory() const { return memory_.bytes(); }

 private:
  // For steps of one length.
  struct Tables {
    double length = 0;
    NumberBlock numbers;
    ShiftTables of[4][pole_count];  // by parity
  };
  // Of a block of the plate.
  struct BlockWork {
    ExactView view;
    double* w[2] = {};  // now and next, in turn
    double* v[2] = {};
    double* growth = nullptr;
    double* doubt = nullptr;
    double* lack = nullptr;
    struct {
      double w[2] = {}, v[2] = {}, doubt = 0;
    } sizes;  // squared
  };

  // One component of a load and its transform, which the next interval begins with if the load is
  // keyed.
  struct CachedLoad {
    bool is_valid = false;
    double* nodes = nullptr;   // row by row
    double* sines[4][2] = {};  // by parity: the transform and room for the next one, in turn
    int place = 0;             // that of the transform
  };

  Result<void> take(const PlateSystem& system);
  bool is_cached(const ConstNodesView& load, int component) const;
  bool take_loads(const ConstNodesView& first_load, const ConstNodesView& last_load);
  Result<Tables*> tables_for(double length);
  std::size_t carve(double* block);
  void step(std::size_t block, int number, const SubStep& step, const Tables& tables,
            bool has_doubt);
  void measure(std::size_t block, int at);
  bool finish(int count, const SubStep& length, const Tables& tables);
  Result<void> reserve(std::size_t tables);

  SpectralPlate& plate_;
  RunContext context_;
  MemoryShare memory_;
  SolverCounts counts_;
  std::optional<PlateSystem> system_;
  Dynamics dynamics_;
  NumberBlock numbers_;
  double* diagonal_[4] = {};  // D, by parity
  double beta_ = 0, delta_ = 0;
  std::size_t table_size_ = 0;  // numbers
  BlockWork work_[4][3];
  CachedLoad cached_loads_[3];
  SpectralPlate::Blocks blocks_;
  std::list<Tables> tables_;  // the last used first
};

}  // namespace pliant
