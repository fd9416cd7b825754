// What places of a plate that flow do in a turn: the part of the kernels after
// step_exactly_lanes.hpp. No #pragma once, no other header: see kernels.hpp.

namespace pliant {
namespace {

using Mask __attribute__((vector_size(8 * PLIANT_LANES))) = long long;

// The numbers where `larger` is over the bound, and 0 elsewhere.
PLIANT_INLINE Eight where_over(const Eight& larger, double bound, const Eight& numbers) {
  Eight x;
#pragma GCC unroll 4
  for (int k = 0; k < parts; ++k) {
    const auto is_over = reinterpret_cast<Mask>(larger.part[k] > bound - Lanes{});
    x.part[k] = reinterpret_cast<Lanes>(reinterpret_cast<Mask>(numbers.part[k]) & is_over);
  }
  return x;
}

PLIANT_INLINE Eight root_of(const Eight& x) {
  double n[8];
  store8(n, x);
#pragma GCC unroll 8
  for (int k = 0; k < 8; ++k) n[k] = __builtin_sqrt(n[k]);
  return load8(n);
}

// The first `count` numbers, the others 0.
PLIANT_INLINE Eight first_of(const Eight& x, int count) {
  if (count >= 8) return x;
  double n[8];
  store8(n, x);
  for (int k = count; k < 8; ++k) n[k] = 0;
  return load8(n);
}

// C k for all components, of eight places; k as the numbers on places are ordered.
template <int N>
PLIANT_INLINE void find_moments(const FlowLaw& law, const Eight (&k)[3 * N], Eight (&m)[3 * N]) {
#pragma GCC unroll 3
  for (int n = 0; n < N; ++n) {
    m[n] = k[n] * law.uu + k[N + n] * law.coupling;
    m[N + n] = k[n] * law.coupling + k[N + n] * law.vv;
    m[2 * N + n] = k[2 * N + n] * law.uv;
  }
}

template <int N>
PLIANT_INLINE Eight product_of(const Eight (&a)[3 * N], const Eight (&b)[3 * N]) {
  Eight sum = a[0] * b[0];
#pragma GCC unroll 9
  for (int n = 1; n < 3 * N; ++n) sum = sum + a[n] * b[n];
  return sum;
}

template <int N>
PLIANT_INLINE void load_all(const FlowView& view, const double* from, long at,
                            Eight (&numbers)[3 * N]) {
#pragma GCC unroll 9
  for (int n = 0; n < 3 * N; ++n) numbers[n] = load8(from + n * view.places + at);
}

// Runs are done eight places at a time. What is written behind the end of one is overwritten by the
// next, or in the room behind the last.

// The curvatures of a run, to which those of `base`, if there are, are added.
template <bool has_base>
PLIANT_INLINE void bend_run(const FlowView& view, const FlowRun& run, const double* x,
                            const double* base, double* curvatures) {
  for (int n = 0; n < view.components; ++n) {
    const double* const from = x + n * view.unknowns;
    for (int kind = 0; kind < 3; ++kind) {
      const FlowTerm* const first = view.terms + run.terms[kind];
      const FlowTerm* const last = view.terms + run.terms[kind + 1];
      const long begin = (kind * view.components + n) * view.places + run.first;
      for (int i = 0; i < run.count; i += 8) {
        Eight sum = {};
        if constexpr (has_base) sum = load8(base + begin + i);
        for (const FlowTerm* term = first; term < last; ++term)
          sum = sum + load8(from + term->unknown + i) * term->weight;
        store8(curvatures + begin + i, sum);
      }
    }
  }
}

void flow_curvatures(const FlowView& view, const double* x, const double* base,
                     double* curvatures) {
  for (int r = 0; r < view.run_count; ++r) bend_run<true>(view, view.runs[r], x, base, curvatures);
}

// Adds the forces of moments on the places `begin` to `end` of a run.
PLIANT_INLINE void add_flow_forces(const FlowView& view, const FlowRun& run, const double* moments,
                                   int begin, int end, double* forces) {
  for (int n = 0; n < view.components; ++n) {
    for (int kind = 0; kind < 3; ++kind) {
      const double* const of = moments + (kind * view.components + n) * view.places;
      for (int t = run.terms[kind]; t < run.terms[kind + 1]; ++t) {
        const FlowTerm term = view.terms[t];
        double* const to = forces + n * view.unknowns + term.unknown;
        for (int i = begin; i < end; i += 8)
          store8(to + i, load8(to + i) + load8(of + i) * term.weight);
      }
    }
  }
}

template <int N>
long flow_components(const FlowView& view, const FlowStep& step) {
  Eight count = {};
  for (int r = 0; r < view.run_count; ++r) {
    const FlowRun run = view.runs[r];
    const FlowLaw law = view.laws[run.law];
    int begin = run.count, end = 0;  // of those that flow
    for (int i = 0; i < run.count; i += 8) {
      const long at = run.first + i;
      Eight xi[3 * N], change[3 * N], moments[3 * N];
      load_all<N>(view, step.xi, at, xi);
      load_all<N>(view, step.change, at, change);
#pragma GCC unroll 9
      for (int n = 0; n < 3 * N; ++n) {
        xi[n] = xi[n] + change[n] * step.part;
        store8(step.there + n * view.places + at, xi[n]);
      }
      find_moments<N>(law, xi, moments);
      const Eight squared = first_of(product_of<N>(xi, moments), run.count - i);
      const double bound = law.yield * law.yield;
      const Eight flows = where_over(squared, bound, all8(1));
      const bool is_any = sum_of(flows) > 0;
      Eight whole = {}, along = {};
      if (is_any) {
        const Eight reciprocal = all8(1) / root_of(squared);
        const Eight left = reciprocal * (law.share * law.yield);
        whole = where_over(squared, bound, all8(law.share) - left);
        along = where_over(squared, bound, left * (reciprocal * reciprocal));
        count = count + flows;
        begin = begin < i ? begin : i;
        end = i + 8;
      }
      store8(step.tangent + at, whole);
      store8(step.tangent + view.places + at, along);
      const Eight by_area = whole * law.area;
#pragma GCC unroll 9
      for (int n = 0; n < 3 * N; ++n) {
        store8(step.work + n * view.places + i, where_over(squared, bound, moments[n] * by_area));
      }
    }
    add_flow_forces(view, run, step.work, begin, end, step.forces);
  }
  return static_cast<long>(sum_of(count));
}

long flow(const FlowView& view, const FlowStep& step) {
  switch (view.components) {
    case 1:
      return flow_components<1>(view, step);
    case 2:
      return flow_components<2>(view, step);
    default:
      return flow_components<3>(view, step);
  }
}

template <int N>
double flow_along_components(const FlowView& view, const double* way, const double* xi,
                             const double* tangent, double* change) {
  Eight sum = {};
  for (int r = 0; r < view.run_count; ++r) {
    const FlowRun run = view.runs[r];
    const FlowLaw law = view.laws[run.law];
    bend_run<false>(view, run, way, nullptr, change);
    for (int i = 0; i < run.count; i += 8) {
      const long at = run.first + i;
      Eight here[3 * N], changes[3 * N], moments[3 * N];
      load_all<N>(view, xi, at, here);
      load_all<N>(view, change, at, changes);
      find_moments<N>(law, changes, moments);
      const Eight across = product_of<N>(here, moments);
      const Eight all = load8(tangent + at) * product_of<N>(changes, moments) +
                        load8(tangent + view.places + at) * (across * across);
      sum = sum + first_of(all * law.area, run.count - i);
    }
  }
  return sum_of(sum);
}

double flow_along(const FlowView& view, const double* way, const double* xi, const double* tangent,
                  double* change) {
  switch (view.components) {
    case 1:
      return flow_along_components<1>(view, way, xi, tangent, change);
    case 2:
      return flow_along_components<2>(view, way, xi, tangent, change);
    default:
      return flow_along_components<3>(view, way, xi, tangent, change);
  }
}

// Of `Numbers` nodes from i on, one or as many as in a vector.
template <class Numbers>
PLIANT_INLINE Numbers squared_stress(const StressRow& row, long i) {
  const auto at = [=](const double* from) PLIANT_INLINED {
    if constexpr (sizeof(Numbers) == sizeof(double)) {
      return from[i];
    } else {
      return load(from + i);
    }
  };
  const Numbers here = at(row.here);
  const Numbers of_u = row.along[0] * at(row.here - 1) + row.along[1] * here +
                       row.along[2] * at(row.here + 1) - row.share * at(row.plastic[0]);
  const Numbers of_v = row.across[0] * at(row.before) + row.across[1] * here +
                       row.across[2] * at(row.after) + row.slope - row.share * at(row.plastic[1]);
  const Numbers of_uv = row.twist * ((at(row.after + 1) - at(row.after - 1)) -
                                     (at(row.before + 1) - at(row.before - 1))) -
                        row.share * at(row.plastic[2]);
  return row.uu * of_u * of_u + 2 * row.coupling * of_u * of_v + row.vv * of_v * of_v +
         row.uv * of_uv * of_uv;
}

void add_squared_stress(const StressRow& row, long count, double* sums) {
  long i = 0;
  for (; i + lanes <= count; i += lanes)
    store(sums + i, load(sums + i) + squared_stress<Lanes>(row, i));
  for (; i < count; ++i) sums[i] += squared_stress<double>(row, i);
}

double dot_product(long count, const double* a, const double* b) {
  Eight sums[4] = {};
  long k = 0;
  for (; k + 32 <= count; k += 32) {
#pragma GCC unroll 4
    for (int n = 0; n < 4; ++n) sums[n] = sums[n] + load8(a + k + 8 * n) * load8(b + k + 8 * n);
  }
  for (; k < count; k += 8) sums[0] = sums[0] + load8(a + k) * load8(b + k);
  return sum_of((sums[0] + sums[2]) + (sums[1] + sums[3]));
}

void combine(long count, double part_a, const double* a, double part_b, double* b) {
  for (long k = 0; k < count; k += 8) store8(b + k, load8(a + k) * part_a + load8(b + k) * part_b);
}

void add_scaled(long count, double* to, double part, const double* of) {
  for (long k = 0; k < count; k += 8) store8(to + k, load8(to + k) + load8(of + k) * part);
}

// The larger number of each lane, `a` where `b` is none.
PLIANT_INLINE Lanes larger(const Lanes& a, const Lanes& b) {
  const auto is_b = reinterpret_cast<Mask>(b > a);
  return reinterpret_cast<Lanes>((reinterpret_cast<Mask>(b) & is_b) |
                                 (reinterpret_cast<Mask>(a) & ~is_b));
}

double longest(long count, const double* numbers) {
  Lanes most = {};
  long k = 0;
  for (; k + lanes <= count; k += lanes) {
    const Lanes x = load(numbers + k);
    most = larger(larger(most, x), -x);
  }
  double longest = 0;
  const auto take = [&](double x) PLIANT_INLINED {
    longest = x > longest ? x : longest;
    longest = -x > longest ? -x : longest;
  };
  for (int lane = 0; lane < lanes; ++lane) take(most[lane]);
  for (; k < count; ++k) take(numbers[k]);
  return longest;
}

}  // namespace
}  // namespace pliant
