#include "pliant/plate/spectral/spectral_plate.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <new>

#include "pliant/core/expects.hpp"
#include "pliant/plate/solver_errors.hpp"
#include "pliant/plate/stencil.hpp"

namespace pliant {
namespace {

int filled_up(int count) { return (count + row_unit - 1) / row_unit * row_unit; }

// Rows at a distance of a multiple of 4096 bytes compete for the same cache sets.
int pitch_of(int columns) { return columns % 512 == 0 ? columns + row_unit : columns; }

int modes_of(int parity, int length) {
  return parity == 0 ? odd_modes(length) : even_modes(length);
}

}  // namespace

SpectralPlate::SpectralPlate(const RunContext& context)
    : context_(context), kernels_(kernels_of_width(context.most_lanes)), memory_(context.memory) {}

// Calls work(component, first, last, numbers) for columns [first, last), all those of `parts`, of
// each component that moves; with the numbers that a task works in. Columns are independent, so no
// bit depends on how they are divided.
template <class Work>
void SpectralPlate::for_columns(std::span<const Columns> parts, const Work& work) {
  const auto units_of = [](const Columns& part) {
    return (part.last - part.first + pair_columns - 1) / pair_columns;
  };
  int units = 0;
  for (const Columns& part : parts) units += units_of(part);
  const std::size_t tasks = task_count();
  for_each(tasks, [&](std::size_t task) {
    const int begin = static_cast<int>(units * task / tasks);
    const int end = static_cast<int>(units * (task + 1) / tasks);
    for (int component = 0; component < 3; ++component) {
      if (is_still_[component]) continue;
      int before = 0;
      for (const Columns& part : parts) {
        const int own = units_of(part);
        const auto column = [&](int unit) {
          return std::min(part.last, part.first + pair_columns * std::clamp(unit - before, 0, own));
        };
        if (column(begin) < column(end)) {
          work(component, column(begin), column(end), work_ + task * work_size_);
        }
        before += own;
      }
    }
  });
}

// Those of the transforms across that have any of these nodes, and their neighbours.
std::vector<SpectralPlate::Columns> SpectralPlate::columns_with(
    std::span<const UnknownRun> runs) const {
  const int count = plans_[1].length() - 1, width = columns_ - 2;
  std::vector<char> has(static_cast<std::size_t>((count + pair_columns - 1) / pair_columns), 0);
  const auto mark = [&](int first, int last) {
    for (int unit = first / pair_columns; unit <= last / pair_columns; ++unit) has[unit] = 1;
  };
  for (const UnknownRun& run : runs) {
    const int end = run.first + run.count;
    for (int begin = run.first, next = 0; begin < end; begin = next) {
      const int row = begin / width;
      next = std::min(end, (row + 1) * width);
      if (is_along_u_) {
        mark(begin - row * width, next - 1 - row * width);
      } else {
        mark(row, row);
      }
    }
  }
  std::vector<Columns> parts;
  for (int unit = 0; unit < static_cast<int>(has.size()); ++unit) {
    if (!has[unit]) continue;
    const int first = unit * pair_columns;
    if (parts.empty() || parts.back().last < first) parts.push_back({first, first});
    parts.back().last = std::min(count, first + pair_columns);
  }
  return parts;
}

TransformView SpectralPlate::transform_of(long row_stride) const {
  TransformView view = transform_;
  view.across_stride = is_along_u_ ? row_stride : 1;
  view.along_stride = is_along_u_ ? 1 : row_stride;
  return view;
}

CoefficientsView SpectralPlate::coefficients_of(double* (Parity::*numbers)[3],
                                                int component) const {
  CoefficientsView coefficients;
  for (int k = 0; k < 4; ++k) coefficients.of[k] = (parities_[k].*numbers)[component];
  return coefficients;
}

void SpectralPlate::carve(Carver& carver) {
  const auto take = [&](std::size_t count) { return carver.take_apart(count); };
  const int lengths[2] = {plans_[0].length(), plans_[1].length()};
  for (int direction = 0; direction < 2; ++direction) {
    for (int parity = 0; parity < 2; ++parity) {
      const int count = filled_up(modes_of(parity, lengths[direction]));
      modes_[direction].eigenvalue[parity] = take(count);
      modes_[direction].scale[parity] = take(count);
      modes_[direction].unscale[parity] = take(count);
      modes_[direction].weight[parity] = take(count);
    }
    modes_[direction].in = take(lengths[direction]);
    modes_[direction].out = take(lengths[direction]);
  }
  transform_.across_in = modes_[0].in;
  transform_.across_out = modes_[0].out;
  transform_.along_in = modes_[1].in;
  transform_.along_out = modes_[1].out;
  transform_.even_column = filled_up(odd_modes(lengths[0]));
  const int width = transform_.even_column + filled_up(even_modes(lengths[0]));
  transform_.between_pitch = pitch_of(width);

  work_size_ = 0;
  for (const SinePlan& plan : plans_) {
    const SineView view = plan.view();
    const long size = sine_work(view) * kernels_.lanes + sine_points(view) * group_columns;
    work_size_ = std::max(work_size_, static_cast<std::size_t>(size));
  }
  work_size_ = (work_size_ + 511) / 512 * 512 + row_unit;
  work_ = carver.take_apart(task_count() * work_size_);
  for (double*& between : between_) {
    between = take(long{lengths[1] - 1} * transform_.between_pitch);
  }
  for (int k = 0; k < 4; ++k) {
    Parity& parity = parities_[k];
    parity.rows = modes_of(k / 2, lengths[1]);
    parity.columns = filled_up(modes_of(k % 2, lengths[0]));
    parity.pitch = pitch_of(parity.columns);
    parity.inverse_pitch = parity.pitch;
    transform_.pitch[k % 2] = parity.pitch;
    const long size = long{parity.rows} * parity.pitch;
    parity.reciprocal = take(size);
    parity.row_pivot = take(parity.rows);
    parity.inverse = take(long{parity.columns} * parity.inverse_pitch);
    parity.panels = take(panel_size(parity.rows, parity.columns));
    for (int component = 0; component < 3; ++component) {
      parity.displacement[component] = take(size);
      parity.pending[component] = take(size);
      parity.load[component] = take(size);
      parity.sums[component] = take(parity.rows + row_unit + 3L * parity.columns);
    }
  }
}

Result<void> SpectralPlate::lay_out(int columns, int rows) {
  if (columns == columns_ && rows == rows_) return {};
  columns_ = rows_ = 0;
  const long size = long{columns - 2} * (rows - 2);
  is_along_u_ = columns >= rows;
  const int across = std::min(columns, rows) - 1;
  const int along = std::max(columns, rows) - 1;
  const std::size_t tables = SinePlan::most_size(across) + SinePlan::most_size(along);
  // Tables first: the size of the rest depends on them, and they are small.
  if (const std::size_t bytes = (tables + numbers_.count()) * sizeof(double);
      !memory_.try_resize(bytes)) {
    return fail(no_memory_to_solve(size, memory_.complaint(bytes)));
  }
  if (plans_[0].length() != across) plans_[0] = SinePlan(across);
  if (plans_[1].length() != along) plans_[1] = SinePlan(along);
  transform_.across = plans_[0].view();
  transform_.along = plans_[1].view();

  Carver count(nullptr);
  carve(count);
  if (count.used() > numbers_.count()) {
    numbers_ = NumberBlock();
    const std::size_t bytes = (tables + count.used()) * sizeof(double);
    if (!memory_.try_resize(bytes)) {
      const Error error = no_memory_to_solve(size, memory_.complaint(bytes));
      (void)memory_.try_resize(tables * sizeof(double));  // less memory is always available
      return fail(error);
    }
    numbers_ = NumberBlock(count.used());
  }
  // The padding of rows remains 0 from here on.
  constexpr std::size_t piece = std::size_t{1} << 21U;
  for (std::size_t at = 0; at < count.used(); at += piece) {
    if (at > 0 && context_.is_stopped()) return interrupted();
    std::fill_n(numbers_.begin() + at, std::min(piece, count.used() - at), 0.0);
  }
  Carver carver(numbers_.begin());
  carve(carver);
  columns_ = columns;
  rows_ = rows;
  ++counts_.analyses;

  fill_modes();
  return {};
}

void SpectralPlate::fill_modes() {
  for (int direction = 0; direction < 2; ++direction) {
    const int length = plans_[direction].length();
    const Modes& modes = modes_[direction];
    for (int mode = 1; mode < length; ++mode) {
      const int parity = (mode + 1) % 2;
      const int place = (mode - 1) / 2;
      const double sine = turn_point(mode, 2L * length).sine;
      const double half = turn_point(mode, 4L * length).sine;
      const double p = std::sqrt(2.0 / length) * sine;
      modes.eigenvalue[parity][place] = 4 * half * half;
      modes.scale[parity][place] = p;
      modes.unscale[parity][place] = 1 / p;
      modes.weight[parity][place] = p * p;
      modes.in[mode - 1] = 1 / sine;
      modes.out[mode - 1] = sine * (2.0 / length);
    }
  }
}

Result<void> SpectralPlate::prepare(const PlateSystem& system) try {
  PLIANT_EXPECTS(system.outline.is_rectangle());
  if (prepared_ == system) return {};
  const Grid& grid = system.outline.grid();
  PLIANT_EXPECTS(grid.columns >= 3 && grid.rows >= 3);
  prepared_.reset();
  if (auto laid_out = lay_out(grid.columns, grid.rows); !laid_out) return laid_out;
  ++counts_.factorizations;

  const Stencil<double> stencil(grid, system.stiffness);
  const double edge_u = 4 * stencil.b;
  const double edge_v = 4 * stencil.d;
  // Edges that are pinned do not couple the modes.
  const Edges& edges = system.outline.edges();
  PLIANT_EXPECTS(edges.u0 == edges.u1 && edges.v0 == edges.v1);
  const bool is_pinned_u = edges.u0 == Edge::Pinned, is_pinned_v = edges.v0 == Edge::Pinned;
  const bool is_pinned_along = is_along_u_ ? is_pinned_u : is_pinned_v;
  const bool is_pinned_across = is_along_u_ ? is_pinned_v : is_pinned_u;
  const double beta = is_along_u_ ? edge_u : edge_v;
  const double delta = is_pinned_across ? 0 : is_along_u_ ? edge_v : edge_u;
  if (is_large() && context_.is_stopped()) return interrupted();
  int failed[4];
  for_each(4, [&](std::size_t k) {
    Parity& parity = parities_[k];
    failed[k] = -1;
    if (parity.rows == 0 || parity.columns == 0) return;
    if (!fill_diagonal(system, static_cast<int>(k))) {
      failed[k] = 0;
      return;
    }
    failed[k] = kernels_.invert_edge(view_of(static_cast<int>(k)), beta, delta, parity.row_pivot,
                                     parity.inverse, parity.panels);
    if (is_pinned_along) {
      std::fill_n(parity.inverse, long{parity.columns} * parity.inverse_pitch, 0.0);
    }
  });
  for (const int pivot : failed) {
    if (pivot >= 0) return fail(not_positive_definite(unknown_count(system.outline), pivot));
  }
  prepared_ = system;
  return {};
} catch (const std::bad_alloc&) {
  return fail(no_memory_to_solve(unknown_count(system.outline), "does not fit in memory"));
}

// 1/D with D the eigenvalues of the simply supported plate, goal included. Eq. (22). Returns
// whether all are positive.
bool SpectralPlate::fill_diagonal(const PlateSystem& system, int k) {
  const Parity& parity = parities_[k];
  const Grid& grid = system.outline.grid();
  const Stiffness& stiffness = system.stiffness;
  const double shift = system.shift + system.goal;
  const double h_along = is_along_u_ ? grid.hu : grid.hv;
  const double h_across = is_along_u_ ? grid.hv : grid.hu;
  const double b = is_along_u_ ? stiffness.b : stiffness.d;
  const double d = is_along_u_ ? stiffness.d : stiffness.b;
  // With c < 0 the mixed term is subtracted from the squares. With s and t the roots of the squares
  //   s^2 + t^2 + (c/sqrt(bd)) s t = (s - t)^2 + (c + 2 sqrt(bd))/sqrt(bd) s t,
  // which has no cancellation.
  const bool takes_away = stiffness.c < 0;
  const double root = -stiffness.least_c() / 2;
  const double mixed = (takes_away ? stiffness.c - stiffness.least_c() : stiffness.c) / root;
  const double scale_s = std::sqrt(b) / (h_along * h_along);
  const double scale_t = std::sqrt(d) / (h_across * h_across);
  const double* const along = modes_[1].eigenvalue[k / 2];
  const double* const across = modes_[0].eigenvalue[k % 2];
  const int count = modes_of(k % 2, plans_[0].length());
  bool is_positive = true;
  for (int row = 0; row < parity.rows; ++row) {
    double* const out = parity.reciprocal + long{row} * parity.pitch;
    const double s = scale_s * along[row];
    for (int l = 0; l < count; ++l) {
      const double t = scale_t * across[l];
      const double squares = takes_away ? (s - t) * (s - t) : s * s + t * t;
      const double diagonal = squares + mixed * (s * t) + shift;
      is_positive =
          is_positive && diagonal > 0 && diagonal < std::numeric_limits<double>::infinity();
      out[l] = 1 / diagonal;
    }
  }
  return is_positive;
}

ParityView SpectralPlate::view_of(int k) const {
  const Parity& parity = parities_[k];
  return {parity.rows,       parity.columns,          parity.pitch,
          parity.reciprocal, modes_[1].weight[k / 2], modes_[0].weight[k % 2],
          parity.row_pivot,  modes_[0].scale[k % 2],  modes_[0].unscale[k % 2],
          parity.inverse,    parity.inverse_pitch};
}

ComponentView SpectralPlate::component_of(int k, int component) const {
  const Parity& parity = parities_[k];
  double* const columns = parity.sums[component] + filled_up(parity.rows);
  return {parity.displacement[component],
          parity.pending[component],
          parity.load[component],
          parity.sums[component],
          columns,
          columns + parity.columns};
}

void SpectralPlate::to_sines(const ConstNodesView& field, double* (Parity::*to)[3]) {
  const Columns all[] = {{0, plans_[1].length() - 1}};
  to_sines(field, to, all, false);
}

// The field is 0 but in these columns.
void SpectralPlate::to_sines(const ConstNodesView& field, double* (Parity::*to)[3],
                             std::span<const Columns> parts, bool is_in_pairs) {
  TransformView view = transform_of(field.row_stride);
  view.is_in_pairs = is_in_pairs;
  const int count = plans_[1].length() - 1;
  for (int component = 0; component < 3; ++component) {
    if (is_still_[component]) continue;
    int column = 0;
    const auto clear_to = [&](int end) {
      for (; column < end; ++column) {
        std::fill_n(between_[component] + long{column} * view.between_pitch, between_width(), 0.0);
      }
    };
    for (const Columns& part : parts) {
      clear_to(part.first);
      column = part.last;
    }
    clear_to(count);
  }
  for_columns(parts, [&](int component, int first, int last, double* work) {
    kernels_.in_across(view, field.first + component * field.component_stride, first, last,
                       between_[component], work);
  });
  const Columns between[] = {{0, between_width()}};
  for_columns(between, [&](int component, int first, int last, double* work) {
    kernels_.in_along(view, between_[component], first, last, coefficients_of(to, component), work);
  });
}

void SpectralPlate::from_sines(double* (Parity::*from)[3], const NodesView& field) {
  const Columns all[] = {{0, plans_[1].length() - 1}};
  from_sines(from, field, all, false);
}

// Writes the field only in these columns.
void SpectralPlate::from_sines(double* (Parity::*from)[3], const NodesView& field,
                               std::span<const Columns> parts, bool is_in_pairs) {
  TransformView view = transform_of(field.row_stride);
  view.is_in_pairs = is_in_pairs;
  const Columns between[] = {{0, between_width()}};
  for_columns(between, [&](int component, int first, int last, double* work) {
    kernels_.out_along(view, coefficients_of(from, component), first, last, between_[component],
                       work);
  });
  for_columns(parts, [&](int component, int first, int last, double* work) {
    kernels_.out_across(view, between_[component], first, last,
                        field.first + component * field.component_stride, work);
  });
}

// Forces along one axis leave two components of a displacement at 0; those need no work.
void SpectralPlate::find_still(const ConstNodesView& load, const ConstNodesView& displacement,
                               const ConstNodesView& velocity) {
  for (int component = 0; component < 3; ++component) {
    is_still_[component] = is_zero(displacement, component) && is_zero(velocity, component) &&
                           is_zero(load, component);
  }
}

bool SpectralPlate::is_zero(const ConstNodesView& field, int component) const {
  for (int j = 0; j < rows_ - 2; ++j) {
    const double* const row =
        field.first + component * field.component_stride + j * field.row_stride;
    if (!std::all_of(row, row + columns_ - 2, [](double number) { return number == 0; })) {
      return false;
    }
  }
  return true;
}

// At what moves.
bool SpectralPlate::are_equal(const ConstNodesView& one, const ConstNodesView& other) const {
  const auto row = [](const ConstNodesView& field, int component, int j) {
    return field.first + component * field.component_stride + j * field.row_stride;
  };
  for (int component = 0; component < 3; ++component) {
    for (int j = 0; !is_still_[component] && j < rows_ - 2; ++j) {
      const double* const of_one = row(one, component, j);
      if (!std::equal(of_one, of_one + columns_ - 2, row(other, component, j))) return false;
    }
  }
  return true;
}

void SpectralPlate::clear(const NodesView& field, int component) const {
  for (int j = 0; j < rows_ - 2; ++j) {
    std::fill_n(field.first + component * field.component_stride + j * field.row_stride,
                columns_ - 2, 0.0);
  }
}

// Those in which not all is 0.
SpectralPlate::Blocks SpectralPlate::moving_blocks() const {
  Blocks blocks;
  for (int k = 0; k < 4; ++k) {
    if (parities_[k].rows == 0 || parities_[k].columns == 0) continue;
    for (int component = 0; component < 3; ++component) {
      if (!is_still_[component]) blocks.all[blocks.count++] = {k, component};
    }
  }
  return blocks;
}

std::size_t SpectralPlate::task_count() const {
  return context_.threads ? static_cast<std::size_t>(context_.threads->thread_count()) : 1;
}

int SpectralPlate::between_width() const {
  return transform_.even_column + filled_up(even_modes(plans_[0].length()));
}

void SpectralPlate::solve(const ConstNodesView& load, const NodesView& solution) {
  PLIANT_EXPECTS(prepared_.has_value());
  ++counts_.solves;
  for (int component = 0; component < 3; ++component) {
    is_still_[component] = is_zero(load, component);
    if (is_still_[component]) clear(solution, component);
  }
  to_sines(load, &Parity::load);
  const Blocks blocks = moving_blocks();
  for_each(blocks.count, [&](std::size_t task) {
    const auto [k, index] = blocks.all[task];
    const ParityView parity = view_of(k);
    const ComponentView component = component_of(k, index);
    const long size = long{parity.rows} * parity.pitch;
    std::fill_n(component.displacement, size, 0.0);
    std::fill_n(component.pending, size, 0.0);
    kernels_.start(parity, component, 0, 0);
    kernels_.last_step(parity, component, 0);
  });
  from_sines(&Parity::displacement, solution);
}

void SpectralPlate::solve_for(const std::vector<int>& components, const ConstNodesView& load,
                              std::span<const UnknownRun> runs, const NodesView& solution) {
  PLIANT_EXPECTS(prepared_.has_value());
  ++counts_.solves;
  std::fill_n(is_still_, 3, true);
  for (const int component : components) is_still_[component] = false;
  const std::vector<Columns> parts =
      runs.empty() ? std::vector<Columns>{{0, plans_[1].length() - 1}} : columns_with(runs);
  to_sines(load, &Parity::load, parts, true);
  const Blocks blocks = moving_blocks();
  for_each(blocks.count, [&](std::size_t task) {
    const auto [k, index] = blocks.all[task];
    // In place, so that less has to be in cache.
    ComponentView component = component_of(k, index);
    component.pending = component.displacement = component.load;
    kernels_.solve(view_of(k), component);
  });
  from_sines(&Parity::load, solution, parts, true);
}

bool SpectralPlate::advance(const ConstNodesView& load, double inertia, const TimeSteps& steps,
                            const NodesView& displacement, const NodesView& velocity,
                            const std::function<bool()>& watch) {
  PLIANT_EXPECTS(prepared_.has_value());
  const auto view = [](const NodesView& nodes) {
    return ConstNodesView{nodes.first, nodes.row_stride, nodes.component_stride};
  };
  find_still(load, view(displacement), view(velocity));
  to_sines(load, &Parity::load);
  to_sines(view(displacement), &Parity::displacement);
  to_sines(view(velocity), &Parity::pending);

  // Eq. (28): shift w' + inertia v' with v' = (w' - w)/dt; reflected, eq. (28a).
  const double dt = steps.solved_length();
  const double shift = prepared_->shift;
  const double keep = inertia / dt;
  const bool is_reflected = steps.are_reflected();
  const StepFactors factors =
      is_reflected ? StepFactors{2 * (shift + keep), 2 * keep} : StepFactors{shift + keep, keep};
  std::atomic<bool> is_stopped = false;
  const Blocks blocks = moving_blocks();
  const auto run = [&](std::size_t task, int first, int last) {
    const auto [k, index] = blocks.all[task];
    const ParityView parity = view_of(k);
    const ComponentView component = component_of(k, index);
    if (first == 1) {
      (is_reflected ? kernels_.reflected_start : kernels_.start)(parity, component, shift, inertia);
    }
    for (int step = first; step <= last; ++step) {
      if (is_stopped) return;
      // The blocks ask in turn, so that the stop request is called once per step.
      const bool asks = static_cast<std::size_t>(step - 1) % blocks.count == task;
      if (asks && context_.is_stopped()) {
        is_stopped = true;
        return;
      }
      if (step < steps.count) {
        (is_reflected ? kernels_.reflected_step : kernels_.step)(parity, component, factors);
      } else if (is_reflected) {
        kernels_.last_reflected_step(parity, component, {shift, inertia, dt});
      } else {
        kernels_.last_step(parity, component, 1 / dt);
      }
    }
  };
  // All steps at once, unless somebody looks at each.
  const int together = watch ? 1 : steps.count;
  for (int first = 1; first <= steps.count; first += together) {
    for_each(blocks.count, [&](std::size_t task) { run(task, first, first + together - 1); });
    if (is_stopped) return false;
    counts_.solves += together;
    from_sines(&Parity::displacement, displacement);
    if (watch && !watch()) return true;
  }
  from_sines(&Parity::pending, velocity);
  return true;
}

}  // namespace pliant
