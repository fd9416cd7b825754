#include "pliant/region/closed_boxes.hpp"

namespace pliant {
namespace {

using Lines = std::vector<std::uint8_t>;

struct LineRun {
  int first = 0, last = -1;
};

// The shortest run that holds all marked lines, counted round if they are closed; of several, the
// one that begins first. It leaves out the longest gap.
LineRun run_around(const Lines& marked, bool is_closed) {
  const int count = static_cast<int>(marked.size());
  int first = 0, last = count - 1;
  while (first < count && marked[first] == 0) ++first;
  if (first == count) return {};
  while (marked[last] == 0) --last;
  if (!is_closed) return {first, last};
  LineRun best{first, last};
  int longest = count - 1 - last + first;  // the gap across the seam
  for (int line = first; line < last;) {
    int next = line + 1;
    while (marked[next] == 0) ++next;
    if (next - line - 1 > longest) {
      longest = next - line - 1;
      best = {next, line + count};
    }
    line = next;
  }
  if (longest == 0) return {0, count - 1};
  return best;
}

void mark(Lines& lines, int first, int last) {
  const int count = static_cast<int>(lines.size());
  for (int line = first; line <= last; ++line) lines[line < count ? line : line - count] = 1;
}

LineRun placed_run(int first, int last, int count) {
  if (last - first + 1 >= count) return {0, count - 1};
  const int laps = first < 0 ? 1 : first >= count ? -1 : 0;
  return {first + laps * count, last + laps * count};
}

bool is_in(const LineRun& outer, const LineRun& inner, int count, bool is_closed) {
  const auto is_between = [&](int moved) {
    return outer.first <= inner.first + moved && inner.last + moved <= outer.last;
  };
  if (is_between(0)) return true;
  return is_closed && (outer.last - outer.first + 1 == count || is_between(count));
}

}  // namespace

Box placed(const Grid& grid, Box box) {
  if (box.is_empty()) return box;
  if (grid.is_closed_u) {
    const auto [first, last] = placed_run(box.i0, box.i1, grid.columns);
    box.i0 = first;
    box.i1 = last;
  }
  if (grid.is_closed_v) {
    const auto [first, last] = placed_run(box.j0, box.j1, grid.rows);
    box.j0 = first;
    box.j1 = last;
  }
  return box;
}

Box box_around(const Grid& grid, std::span<const Box> boxes) {
  if (grid.is_open()) {
    Box all;
    for (const Box& box : boxes) all.include(box);
    return all;
  }
  LineMarks marks(grid);
  for (const Box& box : boxes) marks.include(box);
  return marks.box();
}

bool holds(const Grid& grid, const Box& outer, const Box& inner) {
  if (grid.is_open() || outer.is_empty() || inner.is_empty()) return holds(outer, inner);
  return is_in({outer.i0, outer.i1}, {inner.i0, inner.i1}, grid.columns, grid.is_closed_u) &&
         is_in({outer.j0, outer.j1}, {inner.j0, inner.j1}, grid.rows, grid.is_closed_v);
}

LineMarks::LineMarks(const Grid& grid)
    : grid_(grid),
      columns_(static_cast<std::size_t>(grid.columns), 0),
      rows_(static_cast<std::size_t>(grid.rows), 0) {}

void LineMarks::include(const Box& box) {
  if (box.is_empty()) return;
  mark(columns_, box.i0, box.i1);
  mark(rows_, box.j0, box.j1);
}

bool LineMarks::holds(const Box& box) const {
  const auto are_marked = [](const Lines& lines, int first, int last) {
    return std::find(lines.begin() + first, lines.begin() + last + 1, 0) ==
           lines.begin() + last + 1;
  };
  return are_marked(columns_, box.i0, box.i1) && are_marked(rows_, box.j0, box.j1);
}

Box LineMarks::box() const {
  const LineRun along_u = run_around(columns_, grid_.is_closed_u);
  const LineRun along_v = run_around(rows_, grid_.is_closed_v);
  if (along_u.last < along_u.first) return {};
  return {along_u.first, along_u.last, along_v.first, along_v.last};
}

}  // namespace pliant
