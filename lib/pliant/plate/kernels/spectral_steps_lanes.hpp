// Steps and the edge's matrix: the part of the kernels after spectral_fields_lanes.hpp. No #pragma
// once, no other header: see kernels.hpp.

namespace pliant {
namespace {

// Eight numbers, in one or more vectors: sums over rows use groups of eight for every width.
constexpr int parts = 8 / lanes;
struct Eight {
  Lanes part[parts];
};

PLIANT_INLINE Eight load8(const double* from) {
  Eight x;
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) x.part[k] = load(from + k * lanes);
  return x;
}
PLIANT_INLINE void store8(double* to, const Eight& x) {
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) store(to + k * lanes, x.part[k]);
}
PLIANT_INLINE Eight all8(double number) {
  Eight x;
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) x.part[k] = number - Lanes{};
  return x;
}
// Of vectors in `count` parts, part by part.
#define PLIANT_OPERATOR(Type, op, count)                         \
  PLIANT_INLINE Type operator op(const Type& a, const Type& b) { \
    Type x;                                                      \
    _Pragma("GCC unroll 4") for (int k = 0; k < (count); ++k) {  \
      x.part[k] = a.part[k] op b.part[k];                        \
    }                                                            \
    return x;                                                    \
  }
PLIANT_OPERATOR(Eight, +, parts)
PLIANT_OPERATOR(Eight, -, parts)
PLIANT_OPERATOR(Eight, *, parts)
PLIANT_OPERATOR(Eight, /, parts)
PLIANT_INLINE Eight operator*(const Eight& a, double b) { return a * all8(b); }

PLIANT_INLINE double sum_of(const Eight& x) {
  double n[8];
  store8(n, x);
  return ((n[0] + n[4]) + (n[2] + n[6])) + ((n[1] + n[5]) + (n[3] + n[7]));
}

// Rows processed together share the values of the columns. As many as there are registers for.
constexpr int rows_at_once = lanes == 8 ? 4 : lanes == 4 ? 2 : 1;

// `pending`, to which reflected steps have not added the load yet.
template <bool is_reflected>
PLIANT_INLINE Eight pending_at(const ComponentView& component, long at) {
  const Eight pending = load8(component.pending + at);
  if constexpr (is_reflected) return pending + load8(component.load + at);
  return pending;
}

// The sums over `Rows` rows of `pending` from row k on, and the remaining sums of the columns.
template <int Rows, bool is_reflected>
PLIANT_INLINE void gather(const ParityView& parity, const ComponentView& component, int k,
                          const Eight (&sums)[Rows]) {
  double taken[Rows], weight[Rows];
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
    component.row_sums[k + r] = sum_of(sums[r]);
    taken[r] = component.row_sums[k + r] * parity.row_pivot[k + r];
    weight[r] = parity.row_weight[k + r];
  }
  const long begin = static_cast<long>(k) * parity.pitch;
  for (int l = 0; l < parity.columns; l += 8) {
    Eight column = load8(component.column_sums + l);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      const long at = begin + static_cast<long>(r) * parity.pitch + l;
      const Eight pending = pending_at<is_reflected>(component, at);
      column = column + (pending - load8(parity.reciprocal + at) * taken[r]) * weight[r];
    }
    store8(component.column_sums + l, column);
  }
}

// What `pending` of the first step is made of.
enum class From { Motion, ReflectedMotion, Rest };

template <int Rows, From from>
PLIANT_INLINE void start_rows(const ParityView& parity, const ComponentView& component,
                              double shift, double inertia, int k) {
  constexpr bool is_reflected = from == From::ReflectedMotion;
  Eight sums[Rows] = {};
  const long begin = static_cast<long>(k) * parity.pitch;
  for (int l = 0; l < parity.columns; l += 8) {
    const Eight weight = load8(parity.column_weight + l);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      const long at = begin + static_cast<long>(r) * parity.pitch + l;
      const Eight reciprocal = load8(parity.reciprocal + at);
      const Eight load = load8(component.load + at) * reciprocal;
      Eight pending = load;
      if constexpr (from == From::Rest) {
        store8(component.pending + at, pending);
      } else {
        const Eight held =
            load8(component.displacement + at) * shift + load8(component.pending + at) * inertia;
        pending = load + held * reciprocal;
        store8(component.load + at, load);
        store8(component.pending + at, is_reflected ? held * reciprocal : pending);
      }
      sums[r] = sums[r] + weight * pending;
    }
  }
  gather<Rows, is_reflected>(parity, component, k, sums);
}

PLIANT_INLINE void clear(double* numbers, int count) {
  for (int l = 0; l < count; l += 8) store8(numbers + l, Eight{});
}

template <From from>
PLIANT_INLINE void start_steps(const ParityView& parity, const ComponentView& component,
                               double shift, double inertia) {
  clear(component.column_sums, parity.columns);
  int k = 0;
  for (; k + rows_at_once <= parity.rows; k += rows_at_once) {
    start_rows<rows_at_once, from>(parity, component, shift, inertia, k);
  }
  for (; k < parity.rows; ++k) start_rows<1, from>(parity, component, shift, inertia, k);
}

void start(const ParityView& parity, const ComponentView& component, double shift, double inertia) {
  start_steps<From::Motion>(parity, component, shift, inertia);
}

void reflected_start(const ParityView& parity, const ComponentView& component, double shift,
                     double inertia) {
  start_steps<From::ReflectedMotion>(parity, component, shift, inertia);
}

// Eq. (26): y = C^-1 q sums; xi = y/q. Resets the sums to 0.
void solve_edge(const ParityView& parity, const ComponentView& component) {
  const int n = parity.columns;
  double* const x = component.column_sums;
  for (int l = 0; l < n; l += 8) store8(x + l, load8(x + l) * load8(parity.column_scale + l));
  constexpr int rows = lanes == 2 ? 2 : 8;
  for (int i = 0; i < n; i += rows) {
    const double* const row = parity.inverse + static_cast<long>(i) * parity.inverse_pitch;
    Eight sums[rows] = {};
    for (int l = 0; l < n; l += 8) {
      const Eight right = load8(x + l);
#pragma GCC unroll 8
      for (int r = 0; r < rows; ++r) {
        sums[r] = sums[r] + load8(row + static_cast<long>(r) * parity.inverse_pitch + l) * right;
      }
    }
    for (int r = 0; r < rows; ++r) component.edge[i + r] = sum_of(sums[r]);
  }
  for (int l = 0; l < n; l += 8) {
    const Eight y = load8(component.edge + l);
    store8(component.edge + n + l, y * load8(parity.column_scale + l));
    store8(component.edge + l, y * load8(parity.column_unscale + l));
  }
  clear(x, n);
}

// Upsilon of the rows, from the edge and the row sums.
template <int Rows>
PLIANT_INLINE void solve_rows(const ParityView& parity, const ComponentView& component, int k,
                              double (&upsilon)[Rows]) {
  Eight sums[Rows] = {};
  const double* const weighted = component.edge + parity.columns;
  const long begin = static_cast<long>(k) * parity.pitch;
  for (int l = 0; l < parity.columns; l += 8) {
    const Eight edge = load8(weighted + l);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      sums[r] = sums[r] +
                edge * load8(parity.reciprocal + begin + static_cast<long>(r) * parity.pitch + l);
    }
  }
#pragma GCC unroll 4
  for (int r = 0; r < Rows; ++r) {
    upsilon[r] = (component.row_sums[k + r] - sum_of(sums[r])) * parity.row_pivot[k + r];
  }
}

template <int Rows, bool is_reflected>
PLIANT_INLINE void step_rows(const ParityView& parity, const ComponentView& component,
                             StepFactors factors, int k) {
  double upsilon[Rows];
  solve_rows<Rows>(parity, component, k, upsilon);
  Eight sums[Rows] = {};
  const long begin = static_cast<long>(k) * parity.pitch;
  for (int l = 0; l < parity.columns; l += 8) {
    const Eight xi = load8(component.edge + l);
    const Eight weight = load8(parity.column_weight + l);
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      const long at = begin + static_cast<long>(r) * parity.pitch + l;
      const Eight reciprocal = load8(parity.reciprocal + at);
      const Eight before = load8(component.displacement + at);
      const Eight load = load8(component.load + at);
      const Eight next =
          pending_at<is_reflected>(component, at) - (xi + all8(upsilon[r])) * reciprocal;
      const Eight held = (next * factors.grow - before * factors.keep) * reciprocal;
      Eight pending = load + held;
      if constexpr (is_reflected) {
        const Eight waiting = held - load8(component.pending + at);
        pending = load + waiting;
        store8(component.displacement + at, next + next - before);
        store8(component.pending + at, waiting);
      } else {
        store8(component.displacement + at, next);
        store8(component.pending + at, pending);
      }
      sums[r] = sums[r] + weight * pending;
    }
  }
  gather<Rows, is_reflected>(parity, component, k, sums);
}

template <bool is_reflected>
PLIANT_INLINE void one_step(const ParityView& parity, const ComponentView& component,
                            StepFactors factors) {
  solve_edge(parity, component);
  int k = 0;
  for (; k + rows_at_once <= parity.rows; k += rows_at_once) {
    step_rows<rows_at_once, is_reflected>(parity, component, factors, k);
  }
  for (; k < parity.rows; ++k) step_rows<1, is_reflected>(parity, component, factors, k);
}

void step(const ParityView& parity, const ComponentView& component, StepFactors factors) {
  one_step<false>(parity, component, factors);
}

void reflected_step(const ParityView& parity, const ComponentView& component, StepFactors factors) {
  one_step<true>(parity, component, factors);
}

// Calls take(at, w') for eight numbers at a time.
template <bool is_reflected, class Take>
PLIANT_INLINE void end_steps(const ParityView& parity, const ComponentView& component,
                             const Take& take) {
  solve_edge(parity, component);
  for (int k = 0; k < parity.rows; ++k) {
    double upsilon[1];
    solve_rows<1>(parity, component, k, upsilon);
    for (int l = 0; l < parity.columns; l += 8) {
      const long at = static_cast<long>(k) * parity.pitch + l;
      take(at, pending_at<is_reflected>(component, at) -
                   (load8(component.edge + l) + all8(upsilon[0])) * load8(parity.reciprocal + at));
    }
  }
}

void last_step(const ParityView& parity, const ComponentView& component, double rate) {
  end_steps<false>(parity, component, [&](long at, const Eight& next) PLIANT_INLINED {
    store8(component.pending + at, (next - load8(component.displacement + at)) * rate);
    store8(component.displacement + at, next);
  });
}

void solve_at_rest(const ParityView& parity, const ComponentView& component) {
  start_steps<From::Rest>(parity, component, 0, 0);
  end_steps<false>(parity, component, [&](long at, const Eight& solution) PLIANT_INLINED {
    store8(component.displacement + at, solution);
  });
}

void last_reflected_step(const ParityView& parity, const ComponentView& component,
                         const ReflectedStep& step) {
  // Keeps the padding of rows, whose 1/D is 0, at 0; changes no other number.
  const Eight least = all8(2.3e-308);
  end_steps<true>(parity, component, [&](long at, const Eight& next) PLIANT_INLINED {
    const Eight before = load8(component.displacement + at);
    const Eight held = load8(component.pending + at) / (load8(parity.reciprocal + at) + least);
    const Eight velocity = (held - before * step.shift) * (1 / step.inertia);
    store8(component.pending + at, (next - before) * (2 / step.dt) - velocity);
    store8(component.displacement + at, next + next - before);
  });
}

// C -= P_i^T P_j for `Rows` of the eight columns of panel i and for `Wide` panels from j on.
template <int Rows, int Wide>
PLIANT_INLINE void subtract_tile(const double* panel_i, const double* panel_j, long panel_size,
                                 int depth, double* c, int pitch) {
  Eight sum[Rows][Wide];
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 2
    for (int w = 0; w < Wide; ++w) sum[r][w] = load8(c + static_cast<long>(r) * pitch + 8 * w);
  }
  for (int k = 0; k < depth; ++k) {
    Eight right[Wide];
#pragma GCC unroll 2
    for (int w = 0; w < Wide; ++w) right[w] = load8(panel_j + w * panel_size + 8L * k);
#pragma GCC unroll 8
    for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 2
      for (int w = 0; w < Wide; ++w) sum[r][w] = sum[r][w] - right[w] * panel_i[8L * k + r];
    }
  }
#pragma GCC unroll 8
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 2
    for (int w = 0; w < Wide; ++w) store8(c + static_cast<long>(r) * pitch + 8 * w, sum[r][w]);
  }
}

// C -= P^T P in the upper triangle of C, whose order is a multiple of 8. P (depth x order) is
// stored in panels of eight columns. Every element is summed from the first row of P to the last.
void subtract_gram(const double* panels, int depth, int order, double* c, int pitch) {
  constexpr int rows = lanes == 8 ? 8 : lanes == 4 ? 4 : 2;
  const long panel_size = 8L * depth;
  for (int i = 0; i < order; i += 8) {
    const double* const left = panels + i / 8 * panel_size;
    int j = i;
    for (; lanes == 8 && j + 16 <= order; j += 16) {
      subtract_tile<8, 2>(left, panels + j / 8 * panel_size, panel_size, depth,
                          c + static_cast<long>(i) * pitch + j, pitch);
    }
    for (; j < order; j += 8) {
      for (int r = 0; r < 8; r += rows) {
        subtract_tile<rows, 1>(left + r, panels + j / 8 * panel_size, panel_size, depth,
                               c + static_cast<long>(i + r) * pitch + j, pitch);
      }
    }
  }
}

// U^T U = C for the upper triangle of C, in place, in blocks of rows; 1/U_ii on the diagonal.
// Returns the first row whose pivot is not positive, or -1.
int factor_upper(double* c, int order, int pitch, double* panels) {
  constexpr int block = 64;
  for (int begin = 0; begin < order; begin += block) {
    const int end = begin + block < order ? begin + block : order;
    for (int i = begin; i < end; ++i) {
      double* const row = c + static_cast<long>(i) * pitch;
      if (!(row[i] > 0) || row[i] > 1e300) return i;
      const double reciprocal = 1 / __builtin_sqrt(row[i]);
      row[i] = reciprocal;
      for (int l = i + 1; l < order; ++l) row[l] *= reciprocal;
      for (int below = i + 1; below < end; ++below) {
        double* const other = c + static_cast<long>(below) * pitch;
        const double weight = row[below];
        for (int l = below; l < order; ++l) other[l] -= row[l] * weight;
      }
    }
    const int depth = end - begin;
    for (int j = end; j < order; j += 8) {
      for (int k = 0; k < depth; ++k) {
        store8(panels + (static_cast<long>(j - end) / 8 * depth + k) * 8,
               load8(c + static_cast<long>(begin + k) * pitch + j));
      }
    }
    subtract_gram(panels, depth, order - end, c + static_cast<long>(end) * pitch + end, pitch);
  }
  return -1;
}

// One tile of C -= P_i^T P_j, of eight columns each.
PLIANT_INLINE void subtract_square(const double* panel_i, const double* panel_j, int depth,
                                   double* c, int pitch) {
  constexpr int rows = lanes == 8 ? 8 : lanes == 4 ? 4 : 2;
  for (int r = 0; r < 8; r += rows) {
    subtract_tile<rows, 1>(panel_i + r, panel_j, 0, depth, c + static_cast<long>(r) * pitch, pitch);
  }
}

// Replaces U by the full inverse of U^T U. First computes P with U^T P = I, lower triangular, in
// panels of eight columns, each from its own first row on; then P^T P.
void invert_upper(double* c, int order, int pitch, double* panels) {
  const long panel_size = 8L * order;
  double* const left = panels + order * static_cast<long>(order);  // eight columns of U
  for (int b = 0; b < order; b += 8) {
    for (int k = 0; k < b; ++k) store8(left + 8L * k, load8(c + static_cast<long>(k) * pitch + b));
    for (int j = 0; j <= b; j += 8) {
      double* const panel = panels + j / 8 * panel_size;
      double* const tile = panel + 8L * b;
      for (int r = 0; r < 8; ++r) {
        for (int l = 0; l < 8; ++l) tile[8 * r + l] = b + r == j + l ? 1 : 0;
      }
      subtract_square(left + 8L * j, panel + 8L * j, b - j, tile, 8);
      for (int r = 0; r < 8; ++r) {
        const double* const row = c + static_cast<long>(b + r) * pitch + b;
        const Eight solved = load8(tile + 8 * r) * row[r];
        store8(tile + 8 * r, solved);
        for (int below = r + 1; below < 8; ++below) {
          store8(tile + 8 * below, load8(tile + 8 * below) - solved * row[below]);
        }
      }
    }
  }
  for (int i = 0; i < order; i += 8) {
    for (int j = i; j < order; j += 8) {
      double tile[64] = {};
      subtract_square(panels + i / 8 * panel_size + 8L * j, panels + j / 8 * panel_size + 8L * j,
                      order - j, tile, 8);
      for (int r = 0; r < 8; ++r) {
        for (int l = 0; l < 8; ++l) {
          c[static_cast<long>(i + r) * pitch + j + l] = -tile[8 * r + l];
          c[static_cast<long>(j + l) * pitch + i + r] = -tile[8 * r + l];
        }
      }
    }
  }
}

// Eq. (25) and (27): the pivots 1/h_k, then C = diag(1/beta + sum over k of p_k^2/D_kl) - sum over
// k of z_k z_k^T with z_kl = q_l p_k/D_kl sqrt(1/h_k), and its inverse.
int invert_edge(const ParityView& parity, double beta, double delta, double* row_pivot, double* c,
                double* panels) {
  const int n = parity.columns;
  const int pitch = parity.inverse_pitch;
  for (int k = 0; k < parity.rows; ++k) {
    Eight sum = {};
    for (int l = 0; l < n; l += 8) {
      sum = sum + load8(parity.column_weight + l) *
                      load8(parity.reciprocal + static_cast<long>(k) * parity.pitch + l);
    }
    row_pivot[k] = 1 / (1 / delta + sum_of(sum));
  }
  for (int i = 0; i < n; ++i) clear(c + static_cast<long>(i) * pitch, n);
  for (int l = 0; l < n; l += 8) {
    const Eight scale = load8(parity.column_scale + l);
    Eight sum = all8(1 / beta);
    for (int k = 0; k < parity.rows; ++k) {
      const Eight reciprocal = load8(parity.reciprocal + static_cast<long>(k) * parity.pitch + l);
      sum = sum + reciprocal * parity.row_weight[k];
      const double weight = __builtin_sqrt(parity.row_weight[k] * row_pivot[k]);
      store8(panels + (static_cast<long>(l) / 8 * parity.rows + k) * 8,
             reciprocal * scale * weight);
    }
    double diagonal[8];
    store8(diagonal, sum);
    for (int k = 0; k < 8; ++k) c[static_cast<long>(l + k) * pitch + l + k] = diagonal[k];
  }
  subtract_gram(panels, parity.rows, n, c, pitch);
  const int failed = factor_upper(c, n, pitch, panels);
  if (failed < 0) invert_upper(c, n, pitch, panels);
  return failed;
}

}  // namespace

}  // namespace pliant
