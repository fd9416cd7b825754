#include "pliant/plate/energy/flowing_places.hpp"

#include <algorithm>
#include <utility>

namespace pliant {
namespace {

// Vectors are read and written whole.
std::size_t with_room(std::size_t count) { return (count + 14) / 8 * 8; }

}  // namespace

FlowingPlaces::FlowingPlaces(FlowingPlate& plate, const PlateKernels& kernels,
                             std::vector<int> places, std::vector<int> components,
                             Eigen::Index unknowns)
    : kernels_(kernels), places_(std::move(places)), components_(std::move(components)) {
  PlaceRows rows = plate.rows_of(places_);
  std::vector<int> numbers(static_cast<std::size_t>(unknowns), -1);
  for (const int unknown : rows.unknowns) {
    if (unknown >= 0) numbers[unknown] = 0;
  }
  for (int unknown = 0; unknown < static_cast<int>(unknowns); ++unknown) {
    if (numbers[unknown] < 0) continue;
    numbers[unknown] = static_cast<int>(unknowns_.size());
    if (spans_.empty() || spans_.back().first + spans_.back().count < unknown)
      spans_.push_back({unknown, 0});
    ++spans_.back().count;
    unknowns_.push_back(unknown);
  }
  for (int& unknown : rows.unknowns) {
    if (unknown >= 0) unknown = numbers[unknown];
  }
  make_runs(rows);
  for (const PlaceRows::Pattern& own : rows.patterns) {
    laws_.push_back({own.form.uu, own.form.coupling, own.form.vv, own.form.uv, own.law.yield,
                     1 / (1 + own.law.hardening), own.area});
  }
  for (const int pattern : rows.pattern_of)
    shares_.push_back(1 + rows.patterns[pattern].law.hardening);
  held_ = std::move(rows.held);
  view_ = {static_cast<int>(components_.size()),
           static_cast<long>(with_room(places_.size())),
           static_cast<long>(with_room(unknowns_.size())),
           static_cast<int>(runs_.size()),
           runs_.data(),
           terms_.data(),
           laws_.data()};
  const std::size_t size = 3 * components_.size() * with_room(places_.size());
  for (Numbers* const all : {&stress_, &xi_, &change_, &there_, &work_}) all->assign(size, 0.0);
  tangent_.assign(2 * with_room(places_.size()), 0.0);
}

// A place belongs to the run of the one before it if it has its material, and if each unknown is
// the next one, or both are held.
void FlowingPlaces::make_runs(const PlaceRows& rows) {
  const int count = static_cast<int>(places_.size());
  const auto follows = [&](int place) {
    if (rows.pattern_of[place] != rows.pattern_of[place - 1]) return false;
    const int* const before = rows.unknowns.data() + rows.starts[place - 1];
    const int* const own = rows.unknowns.data() + rows.starts[place];
    const auto& by = rows.patterns[rows.pattern_of[place]].by;
    for (std::size_t k = 0; k < by.size(); ++k) {
      if (by[k] == std::array<double, 3>{}) continue;
      if (before[k] < 0 ? own[k] >= 0 : own[k] != before[k] + 1) return false;
    }
    return true;
  };
  for (int place = 0; place < count; ++place) {
    if (place > 0 && follows(place)) {
      ++runs_.back().count;
      continue;
    }
    FlowRun run{place, 1, rows.pattern_of[place], {}};
    const auto& by = rows.patterns[run.law].by;
    const int* const own = rows.unknowns.data() + rows.starts[place];
    for (std::size_t kind = 0; kind < 3; ++kind) {
      run.terms[kind] = static_cast<int>(terms_.size());
      for (std::size_t k = 0; k < by.size(); ++k) {
        if (by[k][kind] != 0 && own[k] >= 0) terms_.push_back({by[k][kind], own[k]});
      }
    }
    run.terms[3] = static_cast<int>(terms_.size());
    runs_.push_back(run);
  }
}

double FlowingPlaces::longest(const Numbers& numbers, Eigen::Index first, Eigen::Index last) const {
  const auto place = [&](Eigen::Index unknown) {
    return std::lower_bound(unknowns_.begin(), unknowns_.end(), unknown) - unknowns_.begin();
  };
  double longest = 0;
  for (std::size_t n = 0; n < components_.size(); ++n) {
    const double* const own = numbers.data() + n * pitch();
    longest = std::max(longest, kernels_.longest(place(last) - place(first), own + place(first)));
  }
  return longest;
}

FlowingPlaces::Numbers FlowingPlaces::taken_over(const FlowingPlaces& earlier,
                                                 const Numbers& numbers) const {
  Numbers own = zero();
  std::size_t at = 0;
  for (std::size_t k = 0; k < earlier.unknowns_.size(); ++k) {
    while (unknowns_[at] < earlier.unknowns_[k]) ++at;
    for (std::size_t n = 0; n < components_.size(); ++n)
      own[n * pitch() + at] = numbers[n * earlier.pitch() + k];
  }
  return own;
}

// Calls f(where they are, those of the plate, count) for numbers side by side.
template <class F>
void FlowingPlaces::for_each_span(const F& f) const {
  for (std::size_t n = 0; n < components_.size(); ++n) {
    std::size_t begin = n * pitch();
    for (const UnknownRun& span : spans_) {
      f(begin, components_[n], span.first, span.count);
      begin += static_cast<std::size_t>(span.count);
    }
  }
}

void FlowingPlaces::take_from(const Field& all, Numbers& own) const {
  own.resize(components_.size() * pitch());
  for_each_span([&](std::size_t at, int column, int first, int count) {
    std::copy_n(all.col(column).data() + first, count, own.data() + at);
  });
}

void FlowingPlaces::add_to(Field& all, const Numbers& own) const {
  for_each_span([&](std::size_t at, int column, int first, int count) {
    double* const to = all.col(column).data() + first;
    for (int k = 0; k < count; ++k) to[k] += own[at + k];
  });
}

void FlowingPlaces::clear_in(Field& all) const {
  for_each_span([&](std::size_t, int column, int first, int count) {
    std::fill_n(all.col(column).data() + first, count, 0.0);
  });
}

void FlowingPlaces::begin(const PlasticField& from) {
  for (int kind = 0; kind < 3; ++kind) {
    for (std::size_t n = 0; n < components_.size(); ++n) {
      const int column = 3 * kind + components_[n];
      double* const own = stress_.data() + (kind * components_.size() + n) * view_.places;
      for (std::size_t k = 0; k < places_.size(); ++k)
        own[k] = held_[k][column] - shares_[k] * from(places_[k], column);
    }
  }
}

void FlowingPlaces::go_to(const Numbers& x, Numbers& forces) {
  kernels_.flow_curvatures(view_, x.data(), stress_.data(), xi_.data());
  std::fill(change_.begin(), change_.end(), 0.0);
  flow_after(0, forces);
}

double FlowingPlaces::look_along(const Numbers& way) {
  return kernels_.flow_along(view_, way.data(), xi_.data(), tangent_.data(), change_.data());
}

void FlowingPlaces::flow_after(double part, Numbers& forces) {
  forces.assign(components_.size() * pitch(), 0.0);
  flowing_ = kernels_.flow(view_, {xi_.data(), change_.data(), part, there_.data(), tangent_.data(),
                                   work_.data(), forces.data()});
}

void FlowingPlaces::grow(PlasticField& plastic, double part) const {
  for (int kind = 0; kind < 3; ++kind) {
    for (std::size_t n = 0; n < components_.size(); ++n) {
      const int column = 3 * kind + components_[n];
      const double* const xi = there_.data() + (kind * components_.size() + n) * view_.places;
      for (std::size_t k = 0; k < places_.size(); ++k) {
        if (tangent_[k] != 0) plastic(places_[k], column) += part * (tangent_[k] * xi[k]);
      }
    }
  }
}

}  // namespace pliant
