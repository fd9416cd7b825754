// Transfer of the columns of a field into the sine transform and of its coefficients out of it: the
// second part of the kernels, after sine_transform_lanes.hpp.
// No #pragma once, no other header: see kernels.hpp.

namespace pliant {
namespace {

// Transposes: in each round, neighbours at a distance of a power of two exchange halves.
template <int Apart>
PLIANT_INLINE void exchange(Lanes& a, Lanes& b) {
  const Lanes x = a, y = b;
#if PLIANT_LANES == 2
  a = __builtin_shufflevector(x, y, 0, 2);
  b = __builtin_shufflevector(x, y, 1, 3);
#elif PLIANT_LANES == 4
  if constexpr (Apart == 1) {
    a = __builtin_shufflevector(x, y, 0, 4, 2, 6);
    b = __builtin_shufflevector(x, y, 1, 5, 3, 7);
  } else {
    a = __builtin_shufflevector(x, y, 0, 1, 4, 5);
    b = __builtin_shufflevector(x, y, 2, 3, 6, 7);
  }
#else
  if constexpr (Apart == 1) {
    a = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
    b = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
  } else if constexpr (Apart == 2) {
    a = __builtin_shufflevector(x, y, 0, 1, 8, 9, 4, 5, 12, 13);
    b = __builtin_shufflevector(x, y, 2, 3, 10, 11, 6, 7, 14, 15);
  } else {
    a = __builtin_shufflevector(x, y, 0, 1, 2, 3, 8, 9, 10, 11);
    b = __builtin_shufflevector(x, y, 4, 5, 6, 7, 12, 13, 14, 15);
  }
#endif
}
template <int Apart>
PLIANT_INLINE void exchange_all(Lanes (&x)[lanes]) {
#pragma GCC unroll 8
  for (int k = 0; k < lanes; ++k) {
    if ((k & Apart) == 0) exchange<Apart>(x[k], x[k + Apart]);
  }
}
PLIANT_INLINE void transpose(Lanes (&x)[lanes]) {
  exchange_all<1>(x);
  if constexpr (lanes >= 4) exchange_all<2>(x);
  if constexpr (lanes == 8) exchange_all<4>(x);
}

// The first `count` <= lanes numbers, the others 0.
PLIANT_INLINE Lanes load_some(const double* from, int count) {
  if (count == lanes) return load(from);
  Lanes x = {};
  for (int lane = 0; lane < count; ++lane) x[lane] = from[lane];
  return x;
}
PLIANT_INLINE void store_some(double* to, Lanes x, int count) {
  if (count == lanes) return store(to, x);
  for (int lane = 0; lane < count; ++lane) to[lane] = x[lane];
}

PLIANT_INLINE int least(int a, int b) { return a < b ? a : b; }

// Columns that are side by side in memory are read and written in groups of several tiles, since a
// row of one tile alone is only one cache line of a page.

// The tiles of a group, each points x lanes, after the room for the transform itself.
PLIANT_INLINE double* tiles_in(const SineView& view, double* work) {
  return work + sine_work(view) * lanes;
}

// If the nodes along are contiguous: `count` columns, starting at `from`, into tiles.
void fetch_columns(const double* from, long stride, int points, int count, double* tiles) {
  const long tile = static_cast<long>(points) * lanes;
  for (int j = 0; j < points; ++j) {
    for (int done = 0, g = 0; done < count; done += lanes, ++g) {
      store(tiles + g * tile + static_cast<long>(j) * lanes,
            load_some(from + j * stride + done, least(lanes, count - done)));
    }
  }
}

void put_columns(const double* tiles, long stride, int points, int count, double* to) {
  const long tile = static_cast<long>(points) * lanes;
  for (int j = 0; j < points; ++j) {
    for (int done = 0, g = 0; done < count; done += lanes, ++g) {
      store_some(to + j * stride + done, load(tiles + g * tile + static_cast<long>(j) * lanes),
                 least(lanes, count - done));
    }
  }
}

// If the points of a transform are contiguous: `count` <= lanes rows into one tile.
void fetch_rows(const double* from, long stride, int points, int count, double* tile) {
  for (int j = 0; j < points; j += lanes) {
    const int wide = least(lanes, points - j);
    Lanes x[lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      x[lane] = lane < count ? load_some(from + lane * stride + j, wide) : Lanes{};
    }
    transpose(x);
    for (int r = 0; r < wide; ++r) store(tile + static_cast<long>(j + r) * lanes, x[r]);
  }
}

void put_rows(const double* tile, long stride, int points, int count, double* to) {
  for (int j = 0; j < points; j += lanes) {
    const int wide = least(lanes, points - j);
    Lanes x[lanes];
    for (int r = 0; r < lanes; ++r) {
      x[r] = r < wide ? load(tile + static_cast<long>(j + r) * lanes) : Lanes{};
    }
    transpose(x);
    for (int lane = 0; lane < count; ++lane) store_some(to + lane * stride + j, x[lane], wide);
  }
}

// Copies the modes of one parity from a tile of all modes (odd ones at even indices) to the rows
// between the two transforms.
void put_modes(const TransformView& view, const double* tile, int parity, int count, double* to) {
  const int modes = parity == 0 ? odd_modes(view.across.length) : even_modes(view.across.length);
  double* const begin = to + parity * view.even_column;
  for (int m = 0; m < modes; m += lanes) {
    Lanes x[lanes];
    for (int r = 0; r < lanes; ++r) {
      const int l = 2 * (m + r) + parity;
      x[r] =
          m + r < modes ? load(tile + static_cast<long>(l) * lanes) * view.across_in[l] : Lanes{};
    }
    transpose(x);
    for (int lane = 0; lane < count; ++lane) {
      store(begin + static_cast<long>(lane) * view.between_pitch + m, x[lane]);
    }
  }
}

void fetch_modes(const TransformView& view, const double* from, int parity, int count,
                 double* tile) {
  const int modes = parity == 0 ? odd_modes(view.across.length) : even_modes(view.across.length);
  const double* const begin = from + parity * view.even_column;
  for (int m = 0; m < modes; m += lanes) {
    Lanes x[lanes];
    for (int lane = 0; lane < lanes; ++lane) {
      x[lane] =
          lane < count ? load(begin + static_cast<long>(lane) * view.between_pitch + m) : Lanes{};
    }
    transpose(x);
    for (int r = 0; r < least(lanes, modes - m); ++r) {
      const int l = 2 * (m + r) + parity;
      store(tile + static_cast<long>(l) * lanes, x[r] * view.across_out[l]);
    }
  }
}

// Transforms so many columns side by side in tiles: in pairs if that is wanted, and all sixteen are
// there.
PLIANT_INLINE void transform_tiles(const SineView& view, bool is_in_pairs, int width, double* tiles,
                                   double* work) {
  const long points = view.length - 1;
  int done = 0;
  if (is_in_pairs && view.places) {
    constexpr int half = pair_columns / 2;
    for (; done + pair_columns <= width; done += pair_columns) {
      for (int lane = done; lane < done + half; lane += lanes) {
        sine_transform_pair(view, tiles + lane * points, tiles + (lane + half) * points, work);
      }
    }
  }
  for (; done < width; done += lanes) sine_transform(view, tiles + done * points, work);
}

// Columns that are fetched, transformed and put while they are in cache.
PLIANT_INLINE int columns_at_once(const TransformView& view) {
  return view.is_in_pairs ? pair_columns : lanes;
}

void in_across(const TransformView& view, const double* field, int first, int last, double* between,
               double* work) {
  const int points = view.across.length - 1;
  double* const tiles = tiles_in(view.across, work);
  for (int i = first; i < last; i += group_columns) {
    const int width = least(group_columns, last - i);
    if (view.along_stride == 1) {
      fetch_columns(field + i, view.across_stride, points, width, tiles);
    }
    for (int begin = 0; begin < width; begin += columns_at_once(view)) {
      const int end = least(width, begin + columns_at_once(view));
      for (int done = begin; view.along_stride != 1 && done < end; done += lanes) {
        fetch_rows(field + (i + done) * view.along_stride, view.along_stride, points,
                   least(lanes, end - done), tiles + static_cast<long>(done) * points);
      }
      transform_tiles(view.across, view.is_in_pairs, end - begin,
                      tiles + static_cast<long>(begin) * points, work);
      for (int done = begin; done < end; done += lanes) {
        const double* const tile = tiles + static_cast<long>(done) * points;
        double* const to = between + static_cast<long>(i + done) * view.between_pitch;
        put_modes(view, tile, 0, least(lanes, end - done), to);
        put_modes(view, tile, 1, least(lanes, end - done), to);
      }
    }
  }
}

void out_across(const TransformView& view, const double* between, int first, int last,
                double* field, double* work) {
  const int points = view.across.length - 1;
  double* const tiles = tiles_in(view.across, work);
  for (int i = first; i < last; i += group_columns) {
    const int width = least(group_columns, last - i);
    for (int begin = 0; begin < width; begin += columns_at_once(view)) {
      const int end = least(width, begin + columns_at_once(view));
      for (int done = begin; done < end; done += lanes) {
        double* const tile = tiles + static_cast<long>(done) * points;
        const double* const from = between + static_cast<long>(i + done) * view.between_pitch;
        fetch_modes(view, from, 0, least(lanes, end - done), tile);
        fetch_modes(view, from, 1, least(lanes, end - done), tile);
      }
      transform_tiles(view.across, view.is_in_pairs, end - begin,
                      tiles + static_cast<long>(begin) * points, work);
      for (int done = begin; view.along_stride != 1 && done < end; done += lanes) {
        put_rows(tiles + static_cast<long>(done) * points, view.along_stride, points,
                 least(lanes, end - done), field + (i + done) * view.along_stride);
      }
    }
    if (view.along_stride == 1) put_columns(tiles, view.across_stride, points, width, field + i);
  }
}

// The coefficients of mode k along (counted from 0) at a column of the rows between the two
// transforms.
PLIANT_INLINE double* coefficients_at(const TransformView& view,
                                      const CoefficientsView& coefficients, int k, int column) {
  const int parity = column >= view.even_column;
  return coefficients.of[2 * (k % 2) + parity] + static_cast<long>(k / 2) * view.pitch[parity] +
         (column - parity * view.even_column);
}

void in_along(const TransformView& view, const double* between, int first, int last,
              const CoefficientsView& coefficients, double* work) {
  const int points = view.along.length - 1;
  double* const tiles = tiles_in(view.along, work);
  for (int column = first; column < last; column += group_columns) {
    const int width = least(group_columns, last - column);
    fetch_columns(between + column, view.between_pitch, points, width, tiles);
    transform_tiles(view.along, view.is_in_pairs, width, tiles, work);
    for (int k = 0; k < points; ++k) {
      for (int done = 0; done < width; done += lanes) {
        store(coefficients_at(view, coefficients, k, column + done),
              load(tiles + static_cast<long>(done) * points + static_cast<long>(k) * lanes) *
                  view.along_in[k]);
      }
    }
  }
}

void out_along(const TransformView& view, const CoefficientsView& coefficients, int first, int last,
               double* between, double* work) {
  const int points = view.along.length - 1;
  double* const tiles = tiles_in(view.along, work);
  for (int column = first; column < last; column += group_columns) {
    const int width = least(group_columns, last - column);
    for (int k = 0; k < points; ++k) {
      for (int done = 0; done < width; done += lanes) {
        store(tiles + static_cast<long>(done) * points + static_cast<long>(k) * lanes,
              load(coefficients_at(view, coefficients, k, column + done)) * view.along_out[k]);
      }
    }
    transform_tiles(view.along, view.is_in_pairs, width, tiles, work);
    put_columns(tiles, view.between_pitch, points, width, between + column);
  }
}

}  // namespace
}  // namespace pliant
