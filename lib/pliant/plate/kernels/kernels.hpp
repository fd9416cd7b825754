#pragma once

namespace pliant {

// The per-node work of the solvers, compiled several times: for the vectors that every
// machine of the architecture has, and for wider ones. Each number passes through the same
// operations in the same order for every width, without fused multiply-add, so all are
// bit-identical. The kernels include no other header: an inline function compiled here for a newer
// CPU could replace the one that the rest of the program uses. Internal to plate.

/// A Fourier transform of a length that is a product of small primes.
struct FourierView {
  int length = 1;
  int stage_count = 0;
  const int* radices = nullptr;  ///< of the stages, each 2, 3, 4, 5, 7, 8, 11 or 13
  /// A stage of radix r on n points, m = n/r: cos and sin of 2 pi j/r for j = 1 ... (r-1)/2 if r is
  /// odd, then for p = 1 ... m-1 and j = 1 ... r-1 those of 2 pi p j/n.
  const double* tables = nullptr;
};

/// Pairs of the points k and L-k of a sine transform of odd prime length L.
struct PairsView {
  const int* evens = nullptr;     ///< the even one of each pair
  const double* turns = nullptr;  ///< for each pair, scaled cos and sin of its rotation
};

/// The sine transform S_k = sum over j of x_j sin(pi j k/L), j and k from 1 to L-1. docs/model.md.
/// There are three methods: if L is a product of small primes, the stages of one Fourier transform;
/// if it is another prime, a convolution over the powers of a primitive root; otherwise a
/// convolution with a chirp.
struct SineView {
  int length = 2;                  ///< L >= 2
  FourierView fourier;             ///< of L points, or of the convolution
  const double* fold = nullptr;    ///< except with powers: cos and sin of pi j/L for j < L
  const int* places = nullptr;     ///< with stages: index of wave number k after them, for k < L
  const double* chirp = nullptr;   ///< with a chirp: cos and sin of pi j^2/L, j < L
  PairsView in, out;               ///< with powers: (L-1)/2 pairs each, in the order of the powers
  const double* kernel = nullptr;  ///< of a convolution: transformed, in the order of the stages
};

/// Doubles that a sine transform needs per lane, for its points and its workspace.
constexpr long sine_points(const SineView& view) { return view.length - 1; }
constexpr long sine_work(const SineView& view) { return 2L * view.fourier.length; }

/// Columns that the transforms of a field read together. Their space follows the workspace.
constexpr int group_columns = 32;

/// Columns of which each of the first half is transformed together with one of the second, if
/// transforms are in pairs: no bit depends on vectors, but the two columns on each other's
/// rounding.
constexpr int pair_columns = 16;

/// The modes of one direction are stored by parity: 1, 3, 5 ... and then 2, 4, 6 ...
constexpr int odd_modes(int length) { return length / 2; }
constexpr int even_modes(int length) { return (length - 1) / 2; }

/// Rows are padded with zeros to whole vectors.
constexpr int row_unit = 8;

/// How a field on the nodes is transformed into four fields of sine coefficients, one for each pair
/// of parities. The shorter direction is transformed first; afterwards its modes are contiguous.
/// "Between" means after the first transform and before the second.
struct TransformView {
  SineView across;         ///< the shorter direction
  SineView along;          ///< the longer one
  long across_stride = 0;  ///< from node to node of the field
  long along_stride = 0;
  int between_pitch = 0;              ///< of the (length along - 1) x between_pitch numbers between
  int even_column = 0;                ///< of a row between: where the even modes begin
  int pitch[2] = {0, 0};              ///< of the rows of coefficients with odd, even modes across
  bool is_in_pairs = false;           ///< of columns, where the length allows
  const double* across_in = nullptr;  ///< factor of each mode in the forward transform, by mode - 1
  const double* along_in = nullptr;
  const double* across_out = nullptr;  ///< and in the inverse transform
  const double* along_out = nullptr;
};

/// Coefficients of one field by parity: [2 * (is mode along even) + (is mode across even)].
struct CoefficientsView {
  double* of[4] = {nullptr, nullptr, nullptr, nullptr};
};

/// One pair of parities: a diagonal matrix and the coupling of its rows and columns. docs/model.md.
struct ParityView {
  int rows = 0;     ///< modes along
  int columns = 0;  ///< modes across, padded
  int pitch = 0;
  const double* reciprocal = nullptr;      ///< rows x pitch: 1/D
  const double* row_weight = nullptr;      ///< p_k^2
  const double* column_weight = nullptr;   ///< q_l^2, 0 in the padding
  const double* row_pivot = nullptr;       ///< 1/(1/delta + sum over l of q_l^2/D_kl)
  const double* column_scale = nullptr;    ///< q_l, 0 in the padding
  const double* column_unscale = nullptr;  ///< 1/q_l, 0 in the padding
  const double* inverse = nullptr;         ///< columns x inverse_pitch: of C
  int inverse_pitch = 0;
};

/// One component of the state in one pair of parities, each number scaled by 1/(p_k q_l).
struct ComponentView {
  double* displacement = nullptr;  ///< rows x pitch
  double* pending = nullptr;       ///< (load + shift w + inertia v)/D of the next step
  double* load = nullptr;          ///< load/D
  double* row_sums = nullptr;      ///< of `pending`, weighted by q_l^2
  double* column_sums = nullptr;   ///< of `pending`, after the rows are eliminated
  double* edge = nullptr;          ///< 2 x columns: xi, and xi weighted by q_l^2
};

constexpr long panel_size(int rows, int columns) {
  const long depth = rows > 64 ? rows : 64;
  return (depth > columns + 8 ? depth : columns + 8) * columns;
}

/// One step: w' = pending - (xi + upsilon)/D, then the next pending = load/D + (grow w' - keep
/// w)/D. A reflected one leaves the load out of `pending`, so that the velocity loses no digits:
/// w' = pending + load/D - (xi + upsilon)/D, then the next w = 2 w' - w, and the next pending =
/// (grow w' - keep w)/D - pending.
struct StepFactors {
  double grow = 0;
  double keep = 0;
};

/// What the velocity before the last reflected step is found from: v = (pending D - shift
/// w)/inertia.
struct ReflectedStep {
  double shift = 0;
  double inertia = 0;
  double dt = 0;  ///< that is solved
};

struct ComplexNumber {
  double re = 0;
  double im = 0;
};

/// What a `ParityView` has of D, for D + z with one complex z.
struct ShiftView {
  const double* re = nullptr;  ///< rows x pitch: 1/(D + z)
  const double* im = nullptr;
  const double* row_pivot_re = nullptr;
  const double* row_pivot_im = nullptr;
  const double* inverse_re = nullptr;  ///< columns x inverse_pitch: of C
  const double* inverse_im = nullptr;
};
struct ShiftTables {
  double* re = nullptr;
  double* im = nullptr;
  double* row_pivot_re = nullptr;
  double* row_pivot_im = nullptr;
  double* inverse_re = nullptr;
  double* inverse_im = nullptr;
};

/// Shifts of an exact step, each with a conjugate.
constexpr int shift_count = 4;

/// The right-hand side of one shift is the lack + growth f' + v v with these factors; the real
/// parts of its solution times the others are its part of the step of w, the next v and the doubt.
struct ShiftFactors {
  ComplexNumber growth, v;
  ComplexNumber next_w, next_v, doubt;
};
struct ExactFactors {
  ShiftFactors of[shift_count];
};

/// The lack of force, (K w - f - time f') scale. In the padding it is no number of the plate.
struct LackView {
  const double* diagonal = nullptr;  ///< rows x pitch: D
  double beta = 0, delta = 0;        ///< of the sums over columns and rows
  double time = 0;
  double scale = 0;
  double* lack = nullptr;
};

/// One component in one pair of parities, scaled as in `ComponentView`.
struct ExactView {
  const double* load = nullptr;    ///< rows x pitch: f at the start of the interval, then f'
  const double* growth = nullptr;  ///< null: 0
  const double* lack = nullptr;
  const double* w = nullptr;
  const double* v = nullptr;
  double* next_w = nullptr;
  double* next_v = nullptr;
  double* doubt = nullptr;        ///< null: not wanted
  double* row_sums = nullptr;     ///< workspace: rows x shifts x 2
  double* column_sums = nullptr;  ///< shifts x 2 x columns; 0 before and after
  double* edge = nullptr;         ///< shifts x 4 x columns
};

/// Neighbouring columns of a factor L that have the same rows below them.
struct Supernode {
  int first = 0, columns = 0;
  int rows = 0;         ///< below it
  long rows_at = 0;     ///< in `SupernodesView::rows`
  long entries_at = 0;  ///< in `SupernodesView::entries`
};

/// Numbers of a row that is solved: three right-hand sides, and one that pads them.
constexpr int row_numbers = 4;

/// A factor L D L^T in supernodes. The entries of each are the strict lower triangle of its own
/// rows, then the rows below, both row by row.
struct SupernodesView {
  const Supernode* supernodes = nullptr;  ///< in the order of their columns
  const int* rows = nullptr;
  const double* entries = nullptr;
  const double* pivots = nullptr;  ///< D; complex: 1/D
};

/// Rows of a panel: a matrix's rows, so many at a time, column by column.
constexpr int panel_rows = 8;

/// Panels of which the columns are eliminated, and the rows of L of these columns: its strict lower
/// triangle, row by row.
struct PanelsView {
  double* panels = nullptr;
  long stride = 0;  ///< from panel to panel
  int count = 0;
  const double* lower = nullptr;
};

/// Rows, at most four, from which products of rows of L and of panels are subtracted.
struct ProductsView {
  double* rows = nullptr;
  long stride = 0;  ///< from row to row
  int count = 0;
  int columns = 0;               ///< of L and of the panels
  const double* of_l = nullptr;  ///< row by row
  const double* panels = nullptr;
  long panel_stride = 0;
  int panel_count = 0;
};

/// What a curvature of the first place of a run has of an unknown; the next place has as much of
/// the next unknown.
struct FlowTerm {
  double weight = 0;
  long unknown = 0;
};

/// Places side by side, of one material, whose unknowns are side by side too.
struct FlowRun {
  int first = 0, count = 0;
  int law = 0;
  int terms[4] = {};  ///< where those of uu, vv and uv begin, and where they end
};

/// The form C, yield stress, 1/(1 + H) and area of places.
struct FlowLaw {
  double uu = 0, coupling = 0, vv = 0, uv = 0;
  double yield = 0, share = 0, area = 0;
};

/// Places that may flow, in one to three components. Numbers on places are uu of each component,
/// then vv, then uv, `places` apart; on unknowns one component after the other, `unknowns` apart.
/// Behind the last number of each there is room for seven more.
struct FlowView {
  int components = 1;
  long places = 0, unknowns = 0;
  int run_count = 0;
  const FlowRun* runs = nullptr;  ///< with ascending places
  const FlowTerm* terms = nullptr;
  const FlowLaw* laws = nullptr;
};

/// The return mapping of places at xi + part change, eq. (8j): k_p grows by whole xi.
struct FlowStep {
  const double* xi = nullptr;
  const double* change = nullptr;
  double part = 0;
  double* there = nullptr;    ///< xi + part change
  double* tangent = nullptr;  ///< as k changes by dk, k_p does by whole dk + along xi (xi . C dk)
  double* work = nullptr;     ///< as many as on places
  double* forces = nullptr;   ///< to which those of the growth are added
};

/// Those of a factor in supernodes, of real numbers or of complex ones. A complex number is two
/// doubles; of a column of a panel, and of a row that is solved, the real parts come first.
struct FactorKernels {
  /// Subtracts from each column j of first to last - 1 the columns k < j, k < depth, times row j of
  /// L.
  void (*reduce_panels)(const PanelsView& view, int first, int last, int depth);

  /// Subtracts from number n of each row the product of its row of L and row n of the panels.
  void (*subtract_products)(const ProductsView& view);

  /// Solve for three right-hand sides with L of one supernode, and with D L^T of it. `x`: of each
  /// row `row_numbers`, the right-hand sides and zeros, then the solutions.
  void (*solve_forward)(const SupernodesView& factor, int supernode, double* x);
  void (*solve_backward)(const SupernodesView& factor, int supernode, double* x);
};

/// One component of a row of nodes with one stencil and form, at the first of them. The rows
/// before and after it, and a node more at both ends, are read too.
struct StressRow {
  const double* before = nullptr;  ///< displacements
  const double* here = nullptr;
  const double* after = nullptr;
  const double* plastic[3] = {};         ///< k_p of uu, vv and uv
  double share = 0;                      ///< 1 + H
  double along[3] = {}, across[3] = {};  ///< weights of k_uu along the row, and of k_vv
  double slope = 0;                      ///< what is prescribed of k_vv
  double twist = 0;
  double uu = 0, coupling = 0, vv = 0, uv = 0;  ///< the form C
};

/// The kernels for one width of vectors.
struct PlateKernels {
  const char* name;
  int lanes;  ///< doubles in a vector

  /// Transforms `lanes` columns at once: `points` is (length - 1) x lanes, `work` as `sine_work`.
  void (*sine_transform)(const SineView& view, double* points, double* work);
  /// Likewise of two such tiles at once, for half the work. Requires: view.places.
  void (*sine_transform_pair)(const SineView& view, double* points, double* others, double* work);

  /// One chunk of the transforms across: those at nodes [first, last) along. Chunks of all begin at
  /// multiples of `pair_columns`.
  void (*in_across)(const TransformView& view, const double* field, int first, int last,
                    double* between, double* work);
  /// One chunk of the transforms along: columns [first, last) between.
  void (*in_along)(const TransformView& view, const double* between, int first, int last,
                   const CoefficientsView& coefficients, double* work);
  void (*out_along)(const TransformView& view, const CoefficientsView& coefficients, int first,
                    int last, double* between, double* work);
  void (*out_across)(const TransformView& view, const double* between, int first, int last,
                     double* field, double* work);

  /// Turns the transformed `load`, w and v (v in `pending`) into load/D and the first step's
  /// pending.
  void (*start)(const ParityView& parity, const ComponentView& component, double shift,
                double inertia);
  /// Likewise for w = v = 0, which are not read, and the end: leaves the solution in
  /// `displacement`. All three may be one.
  void (*solve)(const ParityView& parity, const ComponentView& component);
  /// Solves for the edge and computes one step of one component.
  void (*step)(const ParityView& parity, const ComponentView& component, StepFactors factors);
  /// The last step; leaves the velocity, (w' - w) times `rate`, in `pending`.
  void (*last_step)(const ParityView& parity, const ComponentView& component, double rate);
  void (*reflected_start)(const ParityView& parity, const ComponentView& component, double shift,
                          double inertia);
  void (*reflected_step)(const ParityView& parity, const ComponentView& component,
                         StepFactors factors);
  /// The last step; leaves the velocity, 2 (w' - w)/dt - v, in `pending`.
  void (*last_reflected_step)(const ParityView& parity, const ComponentView& component,
                              const ReflectedStep& step);

  /// Computes `row_pivot`, and C's inverse in `inverse`. `panels` has `panel_size` doubles. Returns
  /// the first column whose pivot is not positive, or -1.
  int (*invert_edge)(const ParityView& parity, double beta, double delta, double* row_pivot,
                     double* inverse, double* panels);

  /// The tables of D + shift; D (rows x pitch) is 1e300 in the padding. Returns the first column
  /// without a pivot, or -1.
  int (*prepare_shift)(const ParityView& parity, const double* diagonal, ComplexNumber shift,
                       double beta, double delta, const ShiftTables& to);
  /// The lack of one component, for a step.
  void (*find_lack)(const ParityView& parity, const LackView& lack, const ExactView& view);
  /// An exact step of one component, from w and v to the next.
  void (*exact_step)(const ParityView& parity, const ShiftView* shifts, const ExactFactors& factors,
                     const ExactView& view);
  /// The sum of the squares over the nodes of a field given by its coefficients, but for a factor.
  double (*exact_size)(const ParityView& parity, const double* numbers);

  /// The curvatures of places for displacements `x`, added to `base`.
  void (*flow_curvatures)(const FlowView& view, const double* x, const double* base,
                          double* curvatures);
  /// Returns how many places flow.
  long (*flow)(const FlowView& view, const FlowStep& step);
  /// The change of curvatures along a way on the unknowns. Returns how the forces of a flow that is
  /// now at `xi` change along it, times the way.
  double (*flow_along)(const FlowView& view, const double* way, const double* xi,
                       const double* tangent, double* change);

  /// Adds the squared stress of one component at so many nodes of a row.
  void (*add_squared_stress)(const StressRow& row, long count, double* sums);

  /// a . b, b <- part_a a + part_b b, and to += part of, of so many numbers, a multiple of 8.
  double (*dot_product)(long count, const double* a, const double* b);
  void (*combine)(long count, double part_a, const double* a, double part_b, double* b);
  void (*add_scaled)(long count, double* to, double part, const double* of);
  /// The largest absolute value of so many numbers; leaves out those that are none.
  double (*longest)(long count, const double* numbers);

  FactorKernels factor, complex_factor;
};

/// The kernels that this machine can run, the widest first; the last one runs everywhere. nullptr
/// for k beyond the last one. Requires: k >= 0.
const PlateKernels* runnable_kernels(int k);

/// The widest of them with at most `most_lanes` lanes; the narrowest if none has so few.
const PlateKernels& kernels_of_width(int most_lanes);

extern const PlateKernels baseline_kernels;
#ifdef PLIANT_WIDE_KERNELS
extern const PlateKernels avx2_kernels;
extern const PlateKernels avx512_kernels;
#endif

}  // namespace pliant
