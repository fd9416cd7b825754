#include "pliant/plate/spectral/spectral_motion.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <utility>

#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {
namespace {

// Those of the first step, which tries, and of the one that is accepted.
constexpr std::size_t most_tables = 2;

ComplexNumber number_of(Complex a) { return {a.re, a.im}; }

}  // namespace

// Lays out the workspace; with a null block it only counts.
std::size_t SpectralMotion::carve(double* block) {
  Carver carver(block);
  for (CachedLoad& cached : cached_loads_) {
    cached.nodes = carver.take(long{plate_.rows_ - 2} * (plate_.columns_ - 2));
  }
  for (int k = 0; k < 4; ++k) {
    SpectralPlate::Parity& parity = plate_.parities_[k];
    const long size = long{parity.rows} * parity.pitch;
    diagonal_[k] = carver.take(size);
    for (int component = 0; component < 3; ++component) {
      BlockWork& work = work_[k][component];
      ExactView& view = work.view;
      for (double*& sines : cached_loads_[component].sines[k]) sines = carver.take(size);
      work.growth = carver.take(size);
      work.w[0] = parity.displacement[component];
      work.v[0] = parity.pending[component];
      work.w[1] = carver.take(size);
      work.v[1] = carver.take(size);
      work.doubt = carver.take(size);
      work.lack = carver.take(size);
      view.row_sums = carver.take(2L * shift_count * parity.rows);
      view.column_sums = carver.take(2L * shift_count * parity.columns);
      view.edge = carver.take(4L * shift_count * parity.columns);
    }
  }
  return carver.used();
}

Result<void> SpectralMotion::reserve(std::size_t tables) {
  const std::size_t bytes = (numbers_.count() + tables * table_size_) * sizeof(double);
  if (memory_.try_resize(bytes)) return {};
  return fail(no_memory_to_solve(unknown_count(system_->outline.grid()), memory_.complaint(bytes)));
}

Result<void> SpectralMotion::take(const PlateSystem& system) {
  const Grid& grid = system.outline.grid();
  const bool is_laid_out = plate_.columns_ == grid.columns && plate_.rows_ == grid.rows;
  if (is_laid_out && system_ == system) return {};
  system_.reset();
  tables_.clear();
  if (auto laid_out = plate_.lay_out(grid.columns, grid.rows); !laid_out) return laid_out;
  const std::size_t count = carve(nullptr);
  if (count != numbers_.count()) numbers_ = NumberBlock();
  const std::size_t bytes = count * sizeof(double);
  if (!memory_.try_resize(bytes)) {
    return fail(no_memory_to_solve(unknown_count(grid), memory_.complaint(bytes)));
  }
  if (count != numbers_.count()) numbers_ = NumberBlock(count);
  for (CachedLoad& cached : cached_loads_) cached.is_valid = false;
  constexpr std::size_t at_a_time = std::size_t{1} << 20U;
  for (std::size_t first = 0; first < count; first += at_a_time) {
    if (context_.is_stopped()) return interrupted();
    std::fill_n(numbers_.begin() + first, std::min(at_a_time, count - first), 0.0);
  }
  carve(numbers_.begin());

  plate_.prepared_.reset();
  const Stencil<double> stencil(grid, system.stiffness);
  const double edge_u = 4 * stencil.b, edge_v = 4 * stencil.d;
  beta_ = plate_.is_along_u_ ? edge_u : edge_v;
  delta_ = plate_.is_along_u_ ? edge_v : edge_u;
  for (int k = 0; k < 4; ++k) {
    const SpectralPlate::Parity& parity = plate_.parities_[k];
    if (parity.rows == 0 || parity.columns == 0) continue;
    if (context_.is_stopped()) return interrupted();
    if (!plate_.fill_diagonal(system, k))
      return fail(not_positive_definite(unknown_count(grid), 0));
    const long size = long{parity.rows} * parity.pitch;
    for (long n = 0; n < size; ++n) {
      const double reciprocal = parity.reciprocal[n];  // 0 in the padding
      diagonal_[k][n] = reciprocal > 0 ? 1 / reciprocal : 1e300;
    }
  }
  system_ = system;
  return {};
}

Result<SpectralMotion::Tables*> SpectralMotion::tables_for(double length) {
  const auto found = std::find_if(tables_.begin(), tables_.end(),
                                  [&](const Tables& one) { return one.length == length; });
  if (found != tables_.end()) {
    tables_.splice(tables_.begin(), tables_, found);
    return &tables_.front();
  }
  while (tables_.size() >= most_tables) tables_.pop_back();
  Tables tables;
  tables.length = length;
  const auto carve_tables = [&](double* block) {
    Carver carver(block);
    for (int k = 0; k < 4; ++k) {
      const SpectralPlate::Parity& parity = plate_.parities_[k];
      const long size = long{parity.rows} * parity.pitch;
      const long inverse = long{parity.columns} * parity.inverse_pitch;
      for (ShiftTables& of_pole : tables.of[k]) {
        of_pole = {carver.take(size),        carver.take(size),    carver.take(parity.rows),
                   carver.take(parity.rows), carver.take(inverse), carver.take(inverse)};
      }
    }
    return carver.used();
  };
  table_size_ = carve_tables(nullptr);
  if (auto reserved = reserve(tables_.size() + 1); !reserved) return fail(reserved.error());
  tables.numbers = NumberBlock(table_size_);
  carve_tables(tables.numbers.begin());

  const SubStep step{length};
  int failed[4 * pole_count];
  std::atomic<bool> is_stopped = false;
  plate_.for_each(4 * pole_count, [&](std::size_t task) {
    if (!is_stopped && context_.is_stopped()) is_stopped = true;
    if (is_stopped) return;
    const auto k = static_cast<int>(task / pole_count), pole = static_cast<int>(task % pole_count);
    const SpectralPlate::Parity& parity = plate_.parities_[k];
    failed[task] = -1;
    if (parity.rows == 0 || parity.columns == 0) return;
    const Complex rate = step.rate(pole);
    const Complex shift = (rate * dynamics_.density + Complex{dynamics_.damping, 0}) * rate;
    failed[task] = plate_.kernels_.prepare_shift(plate_.view_of(k), diagonal_[k], number_of(shift),
                                                 beta_, delta_, tables.of[k][pole]);
  });
  if (is_stopped) return interrupted();
  for (const int pivot : failed) {
    if (pivot >= 0) {
      return fail(not_positive_definite(unknown_count(system_->outline.grid()), pivot));
    }
  }
  counts_.factorizations += 2 * pole_count;
  tables_.push_front(std::move(tables));
  return &tables_.front();
}

// From w[0] and v[0] to w[1] and v[1].
void SpectralMotion::step(std::size_t block, int number, const SubStep& step, const Tables& tables,
                          bool has_doubt) {
  const auto [k, component] = blocks_.all[block];
  BlockWork& work = work_[k][component];
  ExactView& view = work.view;
  view.w = work.w[0];
  view.v = work.v[0];
  view.next_w = work.w[1];
  view.next_v = work.v[1];
  view.doubt = has_doubt ? work.doubt : nullptr;
  const ParityView parity = plate_.view_of(k);
  view.lack = work.lack;
  plate_.kernels_.find_lack(parity,
                            {.diagonal = diagonal_[k],
                             .beta = beta_,
                             .delta = delta_,
                             .time = number * step.length,
                             .scale = step.of_lack(),
                             .lack = work.lack},
                            view);
  static_assert(shift_count == pole_count);
  ShiftView shifts[shift_count];
  ExactFactors factors;
  for (int pole = 0; pole < pole_count; ++pole) {
    const ShiftTables& of = tables.of[k][pole];
    shifts[pole] = {of.re, of.im, of.row_pivot_re, of.row_pivot_im, of.inverse_re, of.inverse_im};
    factors.of[pole] = {.growth = number_of(step.of_growth(pole)),
                        .v = number_of(step.rate(pole) * (-dynamics_.density * step.of_lack())),
                        .next_w = number_of(step.to_w(pole)),
                        .next_v = number_of(step.to_v(pole)),
                        .doubt = number_of(step.to_doubt(pole))};
  }
  plate_.kernels_.exact_step(parity, shifts, factors, view);
}

// The sizes of the state that begins the next step (0), or that the last one made (1).
void SpectralMotion::measure(std::size_t block, int at) {
  const auto [k, component] = blocks_.all[block];
  BlockWork& work = work_[k][component];
  const ParityView parity = plate_.view_of(k);
  work.sizes.w[at] = plate_.kernels_.exact_size(parity, work.w[at]);
  work.sizes.v[at] = plate_.kernels_.exact_size(parity, work.v[at]);
  if (at == 1) work.sizes.doubt = plate_.kernels_.exact_size(parity, work.doubt);
}

// The steps after the first one. False: stopped.
bool SpectralMotion::finish(int count, const SubStep& length, const Tables& tables) {
  std::atomic<bool> is_stopped = false;
  // A step of a large block takes a while.
  const bool is_large = long{plate_.columns_} * plate_.rows_ > 100'000;
  plate_.for_each(blocks_.count, [&](std::size_t block) {
    const auto [k, component] = blocks_.all[block];
    BlockWork& work = work_[k][component];
    for (int number = 1; number <= count; ++number) {
      std::swap(work.w[0], work.w[1]);
      std::swap(work.v[0], work.v[1]);
      if (number == count) break;
      if (is_stopped) return;
      const bool asks = is_large || static_cast<std::size_t>(number) % blocks_.count == block;
      if (asks && context_.is_stopped()) {
        is_stopped = true;
        return;
      }
      step(block, number, length, tables, false);
    }
  });
  counts_.solves += 2L * pole_count * (count - 1);
  return !is_stopped;
}

bool SpectralMotion::is_cached(const ConstNodesView& load, int component) const {
  const CachedLoad& cached = cached_loads_[component];
  if (!cached.is_valid) return false;
  const int columns = plate_.columns_ - 2;
  for (int j = 0; j < plate_.rows_ - 2; ++j) {
    const double* const row = load.first + component * load.component_stride + j * load.row_stride;
    // By bits: -0 has other ones than 0.
    if (std::memcmp(cached.nodes + long{j} * columns, row, columns * sizeof(double)) != 0) {
      return false;
    }
  }
  return true;
}

// Transforms the loads of the components that move: the first into `load` of the work, the last
// into the plate's `growth`. Whether they differ.
bool SpectralMotion::take_loads(const ConstNodesView& first_load, const ConstNodesView& last_load) {
  const auto transform = [&](const ConstNodesView& load, int next) {
    for (int k = 0; k < 4; ++k) {
      for (int component = 0; component < 3; ++component) {
        const CachedLoad& cached = cached_loads_[component];
        plate_.parities_[k].growth[component] = cached.sines[k][(cached.place + next) % 2];
      }
    }
    plate_.to_sines(load, &SpectralPlate::Parity::growth);
  };
  const std::array<bool, 3> is_still = {plate_.is_still_[0], plate_.is_still_[1],
                                        plate_.is_still_[2]};
  for (int component = 0; component < 3; ++component) {
    plate_.is_still_[component] = is_still[component] || is_cached(first_load, component);
  }
  transform(first_load, 0);
  std::copy(is_still.begin(), is_still.end(), plate_.is_still_);
  const bool grows = !plate_.are_equal(first_load, last_load);
  if (grows) transform(last_load, 1);
  const ConstNodesView& load = grows ? last_load : first_load;
  for (int component = 0; component < 3; ++component) {
    if (is_still[component]) continue;
    CachedLoad& cached = cached_loads_[component];
    for (int k = 0; k < 4; ++k) {
      ExactView& view = work_[k][component].view;
      view.load = cached.sines[k][cached.place];
      view.growth = grows ? work_[k][component].growth : nullptr;
    }
    if (grows) cached.place = 1 - cached.place;
    cached.is_valid = true;
    const int columns = plate_.columns_ - 2;
    for (int j = 0; j < plate_.rows_ - 2; ++j) {
      std::copy_n(load.first + component * load.component_stride + j * load.row_stride, columns,
                  cached.nodes + long{j} * columns);
    }
  }
  return grows;
}

Result<void> SpectralMotion::advance(const PlateSystem& system, const Dynamics& dynamics,
                                     const TimeSteps& steps, const ConstNodesView& first_load,
                                     const ConstNodesView& last_load, const NodesView& displacement,
                                     const NodesView& velocity) {
  if (dynamics.density != dynamics_.density || dynamics.damping != dynamics_.damping) {
    tables_.clear();
  }
  dynamics_ = dynamics;
  if (auto taken = take(system); !taken) return taken;
  const auto view = [](const NodesView& nodes) {
    return ConstNodesView{nodes.first, nodes.row_stride, nodes.component_stride};
  };
  plate_.find_still(last_load, view(displacement), view(velocity));
  for (int component = 0; component < 3; ++component) {
    plate_.is_still_[component] =
        plate_.is_still_[component] && plate_.is_zero(first_load, component);
  }
  const auto take_state = [&] {
    plate_.to_sines(view(displacement), &SpectralPlate::Parity::displacement);
    plate_.to_sines(view(velocity), &SpectralPlate::Parity::pending);
    carve(numbers_.begin());  // w[0] and v[0] are those of the plate again
  };
  if (context_.is_stopped()) return interrupted();
  take_state();
  if (context_.is_stopped()) return interrupted();
  const bool grows = take_loads(first_load, last_load);
  blocks_ = plate_.moving_blocks();
  if (blocks_.count == 0) return {};
  if (grows) {
    plate_.for_each(blocks_.count, [&](std::size_t block) {
      const auto [k, component] = blocks_.all[block];
      const SpectralPlate::Parity& parity = plate_.parities_[k];
      const long size = long{parity.rows} * parity.pitch;
      BlockWork& work = work_[k][component];
      const double* const last = parity.growth[component];
      for (long n = 0; n < size; ++n) work.growth[n] = (last[n] - work.view.load[n]) / steps.length;
    });
  }

  StepChoice choice(steps);
  // The size of the motion in a state of all blocks.
  const auto size_of = [&](int at) {
    double displacement = 0, speed = 0;
    for (std::size_t block = 0; block < blocks_.count; ++block) {
      const auto [k, component] = blocks_.all[block];
      displacement += work_[k][component].sizes.w[at];
      speed += work_[k][component].sizes.v[at];
    }
    const bool swings = dynamics.density > 0;
    return size_of_motion(std::sqrt(displacement), swings ? std::sqrt(speed) : 0, steps.length);
  };
  for (bool is_done = false; !is_done;) {
    if (context_.is_stopped()) return interrupted();
    const SubStep length{choice.length()};
    const auto tables = tables_for(length.length);
    if (!tables) return fail(tables.error());
    std::atomic<bool> is_stopped = false;
    plate_.for_each(blocks_.count, [&](std::size_t block) {
      if (!is_stopped && context_.is_stopped()) is_stopped = true;
      if (is_stopped) return;
      step(block, 0, length, **tables, true);
      measure(block, 0);
      measure(block, 1);
    });
    if (is_stopped) return interrupted();
    counts_.solves += 2 * pole_count;
    double squared_doubt = 0;
    for (std::size_t block = 0; block < blocks_.count; ++block) {
      const auto [k, component] = blocks_.all[block];
      squared_doubt += work_[k][component].sizes.doubt;
    }
    const double doubt = std::sqrt(squared_doubt), before = size_of(0), after = size_of(1);
    const bool looks_ahead = choice.looks_ahead(doubt, before, after);
    if (!looks_ahead && !choice.accepts(doubt, std::max(before, after))) continue;
    if (!finish(choice.count(), length, **tables)) {
      return interrupted();
    }
    is_done = true;
    if (!looks_ahead) continue;
    plate_.for_each(blocks_.count, [&](std::size_t block) { measure(block, 0); });
    is_done = choice.accepts(doubt, size_of(0));
    if (!is_done) take_state();
  }
  // Read where the last step put them.
  const auto exchange_places = [&] {
    for (std::size_t block = 0; block < blocks_.count; ++block) {
      const auto [k, component] = blocks_.all[block];
      std::swap(plate_.parities_[k].displacement[component], work_[k][component].w[0]);
      std::swap(plate_.parities_[k].pending[component], work_[k][component].v[0]);
    }
  };
  exchange_places();
  plate_.from_sines(&SpectralPlate::Parity::displacement, displacement);
  plate_.from_sines(&SpectralPlate::Parity::pending, velocity);
  exchange_places();
  return {};
}

}  // namespace pliant
