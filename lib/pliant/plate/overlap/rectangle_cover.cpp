#include "pliant/plate/overlap/rectangle_cover.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <tuple>

#include "pliant/core/expects.hpp"

namespace pliant {
namespace {

// An outline with more steps is ragged: no small number of boxes follows it.
constexpr std::size_t max_bands = 32;
constexpr std::size_t max_candidates = 64;
// Limit of the nodes of all rectangles together, per node of the plate.
constexpr long max_work = 4;

// Equal neighbouring rows, or columns, form a band; a mask becomes a small table of bands by bands.
struct Bands {
  std::vector<int> columns;  // the start of each band, then the end of the last one
  std::vector<int> rows;
  std::vector<std::uint8_t> is_inside;

  int across() const { return static_cast<int>(columns.size()) - 1; }
  int along() const { return static_cast<int>(rows.size()) - 1; }
  bool has(int p, int q) const {
    return is_inside[std::size_t(q) * std::size_t(across()) + p] != 0;
  }
};

// Empty if there are too many.
Bands bands_of(const Grid& grid, const InteriorMask& interior) {
  const auto row = [&](int j) { return interior.begin() + std::ptrdiff_t{j} * grid.columns; };
  Bands bands;
  std::vector<std::uint8_t> begins(static_cast<std::size_t>(grid.columns), 0);
  for (int j = 0; j < grid.rows; ++j) {
    if (j > 0 && std::equal(row(j), row(j + 1), row(j - 1))) continue;
    bands.rows.push_back(j);
    if (bands.rows.size() > max_bands) return {};
    for (int i = 1; i < grid.columns; ++i) begins[i] |= row(j)[i] != row(j)[i - 1];
  }
  begins[0] = 1;
  for (int i = 0; i < grid.columns; ++i) {
    if (begins[i]) bands.columns.push_back(i);
  }
  if (bands.columns.size() > max_bands) return {};
  for (const int j : bands.rows) {
    for (const int i : bands.columns) bands.is_inside.push_back(row(j)[i]);
  }
  bands.columns.push_back(grid.columns);
  bands.rows.push_back(grid.rows);
  return bands;
}

// All rectangles of bands that are inside the mask and not part of a larger such rectangle. Stops
// at `max_candidates` + 1.
std::vector<Box> maximal_rectangles(const Bands& bands) {
  std::vector<Box> found;
  const auto is_filled = [&](int q, int first, int last) {
    if (q < 0 || q >= bands.along()) return false;
    for (int p = first; p <= last; ++p) {
      if (!bands.has(p, q)) return false;
    }
    return true;
  };
  for (int q0 = 0; q0 < bands.along(); ++q0) {
    std::vector<std::uint8_t> is_filled_from(static_cast<std::size_t>(bands.across()), 1);
    for (int q1 = q0; q1 < bands.along(); ++q1) {
      for (int p = 0; p < bands.across(); ++p) is_filled_from[p] &= bands.has(p, q1);
      for (int p = 0; p < bands.across(); ++p) {
        if (!is_filled_from[p]) continue;
        const int first = p;
        while (p + 1 < bands.across() && is_filled_from[p + 1]) ++p;
        if (is_filled(q0 - 1, first, p) || is_filled(q1 + 1, first, p)) continue;
        found.push_back({first, p, q0, q1});
        if (found.size() > max_candidates) return found;
      }
    }
  }
  return found;
}

struct Interval {
  int first, last;
};

// Whether intervals reach from `first` to `last`, each overlapping the next by at least a quarter
// of the shorter one.
bool reaches(const std::vector<Interval>& intervals, int first, int last) {
  const auto length = [](const Interval& interval) { return interval.last - interval.first; };
  Interval current{first, first};
  for (const Interval& one : intervals) {
    if (one.first == first && one.last > current.last) current = one;
  }
  while (current.last > first && current.last < last) {
    Interval next = current;
    for (const Interval& one : intervals) {
      const int shared = current.last - one.first;
      if (one.last > next.last && 4 * shared >= std::min(length(one), length(current))) next = one;
    }
    if (next.last == current.last) return false;
    current = next;
  }
  return current.last == last;
}

// Whether in each band, along u and along v, the rectangles reach across every run inside the mask.
bool is_cover(const Bands& bands, const std::vector<Box>& rectangles) {
  const auto holds = [&](bool along_u, int band, int place) {
    return along_u ? bands.has(place, band) : bands.has(band, place);
  };
  for (const bool along_u : {true, false}) {
    const auto& begin = along_u ? bands.columns : bands.rows;
    const int places = along_u ? bands.across() : bands.along();
    for (int band = 0; band < (along_u ? bands.along() : bands.across()); ++band) {
      for (int place = 0; place < places; ++place) {
        if (!holds(along_u, band, place)) continue;
        const int first = place;
        while (place + 1 < places && holds(along_u, band, place + 1)) ++place;
        std::vector<Interval> intervals;
        for (const Box& box : rectangles) {
          const Interval across = along_u ? Interval{box.j0, box.j1} : Interval{box.i0, box.i1};
          const Interval along = along_u ? Interval{box.i0, box.i1} : Interval{box.j0, box.j1};
          const bool is_here = across.first <= band && band <= across.last;
          if (is_here && first <= along.first && along.last <= place) {
            intervals.push_back({begin[along.first], begin[along.last + 1]});
          }
        }
        if (!reaches(intervals, begin[first], begin[place + 1])) return false;
      }
    }
  }
  return true;
}

long area(const Box& box) { return long{box.columns()} * box.rows(); }

}  // namespace

std::vector<Box> cover_by_rectangles(const Outline& outline) {
  PLIANT_EXPECTS(!outline.is_rectangle());
  const Bands bands = bands_of(outline.grid(), outline.mask());
  if (bands.columns.empty()) return {};
  std::vector<Box> cover = maximal_rectangles(bands);
  if (cover.size() > max_candidates) return {};
  const auto nodes_of = [&](const Box& box) {
    return Box{bands.columns[box.i0], bands.columns[box.i1 + 1] - 1, bands.rows[box.j0],
               bands.rows[box.j1 + 1] - 1};
  };
  std::sort(cover.begin(), cover.end(), [&](const Box& a, const Box& b) {
    const auto place = [&](const Box& box) {
      return std::tuple(area(nodes_of(box)), box.j0, box.i0);
    };
    return place(a) < place(b);
  });
  // Removes the rectangles that the others make unnecessary, the smallest first.
  for (std::size_t k = 0; k < cover.size();) {
    std::vector<Box> others = cover;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
    if (is_cover(bands, others)) {
      cover = std::move(others);
    } else {
      ++k;
    }
  }
  long work = 0;
  for (Box& box : cover) {
    box = nodes_of(box);
    work += area(box);
  }
  const bool is_good = cover.size() <= std::size_t{max_cover_rectangles} &&
                       work <= max_work * outline.unknown_count();
  return is_good ? cover : std::vector<Box>{};
}

}  // namespace pliant
