// Steps with complex shifts: the part of the kernels after spectral_steps_lanes.hpp. No #pragma
// once, no other header: see kernels.hpp.

namespace pliant {
namespace {

// Eight complex numbers.
struct Pairs {
  Eight re, im;
};

PLIANT_INLINE Pairs load_pairs(const double* re, const double* im) {
  return {load8(re), load8(im)};
}
PLIANT_INLINE Pairs all_pairs(ComplexNumber a) { return {all8(a.re), all8(a.im)}; }
PLIANT_INLINE Pairs operator+(const Pairs& a, const Pairs& b) { return {a.re + b.re, a.im + b.im}; }
PLIANT_INLINE Pairs operator-(const Pairs& a, const Pairs& b) { return {a.re - b.re, a.im - b.im}; }
PLIANT_INLINE Pairs operator*(const Pairs& a, const Pairs& b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
PLIANT_INLINE Pairs operator*(const Pairs& a, const Eight& b) { return {a.re * b, a.im * b}; }
PLIANT_INLINE ComplexNumber sum_of(const Pairs& a) { return {sum_of(a.re), sum_of(a.im)}; }

PLIANT_INLINE ComplexNumber operator*(ComplexNumber a, ComplexNumber b) {
  return {a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re};
}
PLIANT_INLINE ComplexNumber operator-(ComplexNumber a, ComplexNumber b) {
  return {a.re - b.re, a.im - b.im};
}
PLIANT_INLINE ComplexNumber inverse_of(ComplexNumber a) {
  const double square = a.re * a.re + a.im * a.im;
  return {a.re / square, -a.im / square};
}

// Rows at a time: what is the same for all of them is read once, and their sums hide each other's
// latency.
constexpr int exact_rows = lanes == 8 ? 2 : 1;

// The right-hand side of a shift at eight nodes. Without growth it is a few operations less, with
// the same bits.
struct Sources {
  Eight lack, growth, v;
};
template <bool grows>
PLIANT_INLINE Sources sources_at(const ExactView& view, long at) {
  if constexpr (!grows) return {load8(view.lack + at), {}, load8(view.v + at)};
  return {load8(view.lack + at), load8(view.growth + at), load8(view.v + at)};
}
template <bool grows>
PLIANT_INLINE Pairs side_of(const Sources& from, const ShiftFactors& factors) {
  if constexpr (!grows) return {from.lack + from.v * factors.v.re, from.v * factors.v.im};
  return {(from.lack + from.growth * factors.growth.re) + from.v * factors.v.re,
          from.growth * factors.growth.im + from.v * factors.v.im};
}

// The right-hand sides of rows times 1/D, their sums, and what remains for the columns.
template <int Rows, bool grows>
PLIANT_INLINE void begin_rows(const ParityView& parity, const ShiftView* shifts,
                              const ExactFactors& factors, const ExactView& view, int k) {
  const int n = parity.columns;
  const long begin = static_cast<long>(k) * parity.pitch;
  Pairs taken[Rows][shift_count];
  for (int r = 0; r < Rows; ++r) {
    const long row_begin = begin + static_cast<long>(r) * parity.pitch;
    Pairs sums[shift_count] = {};
    for (int l = 0; l < n; l += 8) {
      const Sources from = sources_at<grows>(view, row_begin + l);
      const Eight weight = load8(parity.column_weight + l);
#pragma GCC unroll 4
      for (int p = 0; p < shift_count; ++p) {
        const Pairs reciprocal =
            load_pairs(shifts[p].re + row_begin + l, shifts[p].im + row_begin + l);
        sums[p] = sums[p] + side_of<grows>(from, factors.of[p]) * reciprocal * weight;
      }
    }
#pragma GCC unroll 4
    for (int p = 0; p < shift_count; ++p) {
      const ComplexNumber sum = sum_of(sums[p]);
      double* const row = view.row_sums + (static_cast<long>(k + r) * shift_count + p) * 2;
      row[0] = sum.re;
      row[1] = sum.im;
      taken[r][p] = all_pairs(
          sum * ComplexNumber{shifts[p].row_pivot_re[k + r], shifts[p].row_pivot_im[k + r]});
    }
  }
  for (int l = 0; l < n; l += 8) {
    Sources from[Rows];
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      from[r] = sources_at<grows>(view, begin + static_cast<long>(r) * parity.pitch + l);
    }
#pragma GCC unroll 4
    for (int p = 0; p < shift_count; ++p) {
      double* const column = view.column_sums + 2L * p * n + l;
      Pairs sum = load_pairs(column, column + n);
#pragma GCC unroll 4
      for (int r = 0; r < Rows; ++r) {
        const long at = begin + static_cast<long>(r) * parity.pitch + l;
        const Pairs reciprocal = load_pairs(shifts[p].re + at, shifts[p].im + at);
        const Pairs rest = (side_of<grows>(from[r], factors.of[p]) - taken[r][p]) * reciprocal;
        sum = sum + rest * all8(parity.row_weight[k + r]);
      }
      store8(column, sum.re);
      store8(column + n, sum.im);
    }
  }
}

// Eq. (26) with complex numbers. Resets the sums to 0.
PLIANT_INLINE void solve_complex_edge(const ParityView& parity, const ShiftView& shift, double* re,
                                      double* edge) {
  const int n = parity.columns;
  double* const im = re + n;
  for (int l = 0; l < n; l += 8) {
    const Eight scale = load8(parity.column_scale + l);
    store8(re + l, load8(re + l) * scale);
    store8(im + l, load8(im + l) * scale);
  }
  constexpr int rows = lanes == 8 ? 4 : lanes == 4 ? 2 : 1;
  for (int i = 0; i < n; i += rows) {
    const long begin = static_cast<long>(i) * parity.inverse_pitch;
    Pairs sums[rows] = {};
    for (int l = 0; l < n; l += 8) {
      const Pairs right = load_pairs(re + l, im + l);
#pragma GCC unroll 4
      for (int r = 0; r < rows; ++r) {
        const long at = begin + static_cast<long>(r) * parity.inverse_pitch + l;
        sums[r] = sums[r] + load_pairs(shift.inverse_re + at, shift.inverse_im + at) * right;
      }
    }
    for (int r = 0; r < rows; ++r) {
      const ComplexNumber y = sum_of(sums[r]);
      edge[i + r] = y.re;
      edge[n + i + r] = y.im;
    }
  }
  for (int l = 0; l < n; l += 8) {
    const Pairs y = load_pairs(edge + l, edge + n + l);
    const Eight scale = load8(parity.column_scale + l), unscale = load8(parity.column_unscale + l);
    store8(edge + 2L * n + l, y.re * scale);
    store8(edge + 3L * n + l, y.im * scale);
    store8(edge + l, y.re * unscale);
    store8(edge + n + l, y.im * unscale);
  }
  clear(re, n);
  clear(im, n);
}

// Upsilon, then the solutions, of which the next w and v are sums, and the doubt.
template <int Rows, bool grows, bool has_doubt>
PLIANT_INLINE void end_rows(const ParityView& parity, const ShiftView* shifts,
                            const ExactFactors& factors, const ExactView& view, int k) {
  const int n = parity.columns;
  const long begin = static_cast<long>(k) * parity.pitch;
  Pairs sums[Rows][shift_count] = {};
  for (int l = 0; l < n; l += 8) {
#pragma GCC unroll 4
    for (int p = 0; p < shift_count; ++p) {
      const double* const edge = view.edge + 4L * p * n + l;
      const Pairs scaled = load_pairs(edge + 2L * n, edge + 3L * n);
#pragma GCC unroll 4
      for (int r = 0; r < Rows; ++r) {
        const long at = begin + static_cast<long>(r) * parity.pitch + l;
        sums[r][p] = sums[r][p] + scaled * load_pairs(shifts[p].re + at, shifts[p].im + at);
      }
    }
  }
  Pairs upsilon[Rows][shift_count];
  for (int r = 0; r < Rows; ++r) {
#pragma GCC unroll 4
    for (int p = 0; p < shift_count; ++p) {
      const double* const row = view.row_sums + (static_cast<long>(k + r) * shift_count + p) * 2;
      const ComplexNumber pivot = {shifts[p].row_pivot_re[k + r], shifts[p].row_pivot_im[k + r]};
      upsilon[r][p] = all_pairs((ComplexNumber{row[0], row[1]} - sum_of(sums[r][p])) * pivot);
    }
  }
  for (int l = 0; l < n; l += 8) {
    Sources from[Rows];
    Eight w[Rows], v[Rows] = {}, doubt[Rows] = {};
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      const long at = begin + static_cast<long>(r) * parity.pitch + l;
      from[r] = sources_at<grows>(view, at);
      w[r] = load8(view.w + at);
    }
#pragma GCC unroll 4
    for (int p = 0; p < shift_count; ++p) {
      const ShiftFactors& own = factors.of[p];
      const double* const edge = view.edge + 4L * p * n + l;
      const Pairs of_edge = load_pairs(edge, edge + n);
#pragma GCC unroll 4
      for (int r = 0; r < Rows; ++r) {
        const long at = begin + static_cast<long>(r) * parity.pitch + l;
        const Pairs reciprocal = load_pairs(shifts[p].re + at, shifts[p].im + at);
        const Pairs x = (side_of<grows>(from[r], own) - (of_edge + upsilon[r][p])) * reciprocal;
        w[r] = w[r] + (x.re * own.next_w.re - x.im * own.next_w.im);
        v[r] = v[r] + (x.re * own.next_v.re - x.im * own.next_v.im);
        if constexpr (has_doubt) doubt[r] = doubt[r] + (x.re * own.doubt.re - x.im * own.doubt.im);
      }
    }
#pragma GCC unroll 4
    for (int r = 0; r < Rows; ++r) {
      const long at = begin + static_cast<long>(r) * parity.pitch + l;
      store8(view.next_w + at, w[r]);
      store8(view.next_v + at, v[r]);
      if constexpr (has_doubt) store8(view.doubt + at, doubt[r]);
    }
  }
}

// (K w - f - time f') scale, with K = D + beta times sums of columns + delta times those of rows.
void find_lack(const ParityView& parity, const LackView& lack, const ExactView& view) {
  const int n = parity.columns;
  clear(view.edge, n);
  for (int k = 0; k < parity.rows; ++k) {
    const double* const w = view.w + static_cast<long>(k) * parity.pitch;
    for (int l = 0; l < n; l += 8) {
      store8(view.edge + l, load8(view.edge + l) + load8(w + l) * parity.row_weight[k]);
    }
  }
  for (int k = 0; k < parity.rows; ++k) {
    const long begin = static_cast<long>(k) * parity.pitch;
    Eight sum = {};
    for (int l = 0; l < n; l += 8) {
      sum = sum + load8(view.w + begin + l) * load8(parity.column_weight + l);
    }
    const Eight of_row = all8(sum_of(sum) * lack.delta);
    for (int l = 0; l < n; l += 8) {
      const Eight diagonal = load8(lack.diagonal + begin + l);
      const Eight held =
          load8(view.w + begin + l) * diagonal + (load8(view.edge + l) * lack.beta + of_row);
      Eight force = load8(view.load + begin + l);
      if (view.growth) force = force + load8(view.growth + begin + l) * lack.time;
      store8(lack.lack + begin + l, (held - force) * lack.scale);
    }
  }
}

template <bool grows, bool has_doubt>
PLIANT_INLINE void take_exact_step(const ParityView& parity, const ShiftView* shifts,
                                   const ExactFactors& factors, const ExactView& view) {
  int k = 0;
  for (; k + exact_rows <= parity.rows; k += exact_rows)
    begin_rows<exact_rows, grows>(parity, shifts, factors, view, k);
  for (; k < parity.rows; ++k) begin_rows<1, grows>(parity, shifts, factors, view, k);
  for (int p = 0; p < shift_count; ++p) {
    solve_complex_edge(parity, shifts[p], view.column_sums + 2L * p * parity.columns,
                       view.edge + 4L * p * parity.columns);
  }
  for (k = 0; k + exact_rows <= parity.rows; k += exact_rows)
    end_rows<exact_rows, grows, has_doubt>(parity, shifts, factors, view, k);
  for (; k < parity.rows; ++k) end_rows<1, grows, has_doubt>(parity, shifts, factors, view, k);
}

void exact_step(const ParityView& parity, const ShiftView* shifts, const ExactFactors& factors,
                const ExactView& view) {
  if (view.growth) {
    (view.doubt ? take_exact_step<true, true> : take_exact_step<true, false>)(parity, shifts,
                                                                              factors, view);
  } else {
    (view.doubt ? take_exact_step<false, true> : take_exact_step<false, false>)(parity, shifts,
                                                                                factors, view);
  }
}

double exact_size(const ParityView& parity, const double* numbers) {
  double size = 0;
  for (int k = 0; k < parity.rows; ++k) {
    Eight sum = {};
    for (int l = 0; l < parity.columns; l += 8) {
      const Eight x = load8(numbers + static_cast<long>(k) * parity.pitch + l);
      sum = sum + x * x * load8(parity.column_weight + l);
    }
    size += sum_of(sum) * parity.row_weight[k];
  }
  return size;
}

// C -= sum over k of s_k a_k a_k^T, of eight rows k at a time; a_kl = q_l R_kl. The products come
// in the order of k in each element.
PLIANT_INLINE void subtract_rows(const ParityView& parity, const ShiftView& own, int k, int count,
                                 double* c_re, double* c_im) {
  const int n = parity.columns;
  for (int i = 0; i < n; ++i) {
    ComplexNumber left[8];
    for (int r = 0; r < count; ++r) {
      const long at = static_cast<long>(k + r) * parity.pitch + i;
      const double scale = parity.column_scale[i] * parity.row_weight[k + r];
      left[r] = ComplexNumber{own.row_pivot_re[k + r], own.row_pivot_im[k + r]} *
                ComplexNumber{own.re[at] * scale, own.im[at] * scale};
    }
    for (int l = i / 8 * 8; l < n; l += 8) {
      const long place = static_cast<long>(i) * parity.inverse_pitch + l;
      Pairs sum = load_pairs(c_re + place, c_im + place);
      const Eight scale = load8(parity.column_scale + l);
      for (int r = 0; r < count; ++r) {
        const long at = static_cast<long>(k + r) * parity.pitch + l;
        sum = sum - (load_pairs(own.re + at, own.im + at) * scale) * all_pairs(left[r]);
      }
      store8(c_re + place, sum.re);
      store8(c_im + place, sum.im);
    }
  }
}

// The inverse of a symmetric matrix, by columns that are exchanged one after another. No pivoting:
// see `ComplexFactor`. Returns the first column without a pivot, or -1.
PLIANT_INLINE int invert_complex(double* re, double* im, int n, int pitch) {
  for (int p = 0; p < n; ++p) {
    double* const row_re = re + static_cast<long>(p) * pitch;
    double* const row_im = im + static_cast<long>(p) * pitch;
    const double size = row_re[p] * row_re[p] + row_im[p] * row_im[p];
    if (!(size > 0) || size > 1e300) return p;
    const ComplexNumber pivot = inverse_of({row_re[p], row_im[p]});
    const Pairs by = all_pairs(pivot);
    for (int l = 0; l < n; l += 8) {
      const Pairs scaled = load_pairs(row_re + l, row_im + l) * by;
      store8(row_re + l, scaled.re);
      store8(row_im + l, scaled.im);
    }
    row_re[p] = pivot.re;
    row_im[p] = pivot.im;
    for (int i = 0; i < n; ++i) {
      if (i == p) continue;
      double* const other_re = re + static_cast<long>(i) * pitch;
      double* const other_im = im + static_cast<long>(i) * pitch;
      const ComplexNumber factor = {other_re[p], other_im[p]};
      const Pairs times = all_pairs(factor);
      other_re[p] = other_im[p] = 0;
      for (int l = 0; l < n; l += 8) {
        const Pairs rest =
            load_pairs(other_re + l, other_im + l) - load_pairs(row_re + l, row_im + l) * times;
        store8(other_re + l, rest.re);
        store8(other_im + l, rest.im);
      }
    }
  }
  return -1;
}

// Eq. (25) and (27) with D + shift in place of D.
int prepare_shift(const ParityView& parity, const double* diagonal, ComplexNumber shift,
                  double beta, double delta, const ShiftTables& to) {
  const int n = parity.columns;
  const ShiftView own = {to.re, to.im, to.row_pivot_re, to.row_pivot_im, nullptr, nullptr};
  for (int k = 0; k < parity.rows; ++k) {
    Pairs sum = {};
    for (int l = 0; l < n; l += 8) {
      const long at = static_cast<long>(k) * parity.pitch + l;
      const Eight re = load8(diagonal + at) + all8(shift.re), im = all8(shift.im);
      const Eight square = re * re + im * im;  // infinite in the padding
      const Pairs reciprocal = {re / square, (all8(0) - im) / square};
      store8(to.re + at, reciprocal.re);
      store8(to.im + at, reciprocal.im);
      sum = sum + reciprocal * load8(parity.column_weight + l);
    }
    ComplexNumber pivot = sum_of(sum);
    pivot.re += 1 / delta;
    pivot = inverse_of(pivot);
    to.row_pivot_re[k] = pivot.re;
    to.row_pivot_im[k] = pivot.im;
  }
  for (int i = 0; i < n; ++i) {
    clear(to.inverse_re + static_cast<long>(i) * parity.inverse_pitch, n);
    clear(to.inverse_im + static_cast<long>(i) * parity.inverse_pitch, n);
  }
  for (int l = 0; l < n; l += 8) {
    Pairs sum = {all8(1 / beta), {}};
    for (int k = 0; k < parity.rows; ++k) {
      const long at = static_cast<long>(k) * parity.pitch + l;
      sum = sum + load_pairs(to.re + at, to.im + at) * all8(parity.row_weight[k]);
    }
    double re[8], im[8];
    store8(re, sum.re);
    store8(im, sum.im);
    for (int k = 0; k < 8; ++k) {
      to.inverse_re[static_cast<long>(l + k) * parity.inverse_pitch + l + k] = re[k];
      to.inverse_im[static_cast<long>(l + k) * parity.inverse_pitch + l + k] = im[k];
    }
  }
  for (int k = 0; k < parity.rows; k += 8) {
    const int count = parity.rows - k < 8 ? parity.rows - k : 8;
    subtract_rows(parity, own, k, count, to.inverse_re, to.inverse_im);
  }
  for (int i = 0; i < n; ++i) {
    for (int l = 0; l < i; ++l) {
      const long to_place = static_cast<long>(i) * parity.inverse_pitch + l;
      const long from = static_cast<long>(l) * parity.inverse_pitch + i;
      to.inverse_re[to_place] = to.inverse_re[from];
      to.inverse_im[to_place] = to.inverse_im[from];
    }
  }
  return invert_complex(to.inverse_re, to.inverse_im, n, parity.inverse_pitch);
}

}  // namespace

}  // namespace pliant
