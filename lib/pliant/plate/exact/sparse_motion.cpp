#include "pliant/plate/exact/sparse_motion.hpp"

#include <algorithm>
#include <cmath>
#include <new>
#include <utility>

#include "pliant/core/expects.hpp"
#include "pliant/core/hash_stream.hpp"
#include "pliant/core/shelf.hpp"
#include "pliant/core/thread_pool.hpp"
#include "pliant/plate/solver_errors.hpp"

namespace pliant {
namespace {

// Those of the first step, which tries, and of the one that is accepted.
constexpr std::size_t most_kept = 2;

// In place of a step's length, for the factor that finds unknowns without a mass.
constexpr double length_when_held = -1;

template <class Number>
bool are_same(const Number* a, const Number* b, Eigen::Index count) {
  return std::equal(a, a + count, b);
}

bool have_same_pattern(const SparseMatrix& a, const SparseMatrix& b) {
  return a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         are_same(a.outerIndexPtr(), b.outerIndexPtr(), a.cols() + 1) &&
         are_same(a.innerIndexPtr(), b.innerIndexPtr(), a.nonZeros());
}

bool are_same(const MovingMatrix& a, const MovingMatrix& b) {
  return a.inertia == b.inertia && a.drag == b.drag &&
         have_same_pattern(a.stiffness, b.stiffness) &&
         are_same(a.stiffness.valuePtr(), b.stiffness.valuePtr(), a.stiffness.nonZeros());
}

template <class Number>
void add_to(HashStream& stream, const Number* first, std::size_t count) {
  stream.add({reinterpret_cast<const char*>(first), sizeof(Number) * count});
}

void add_pattern(HashStream& stream, const SparseMatrix& matrix) {
  add_to(stream, matrix.outerIndexPtr(), static_cast<std::size_t>(matrix.cols()) + 1);
  add_to(stream, matrix.innerIndexPtr(), static_cast<std::size_t>(matrix.nonZeros()));
}

Hash key_of_pattern(const SparseMatrix& matrix) {
  HashStream stream;
  stream.add("order of ");
  add_pattern(stream, matrix);
  return stream.hash();
}

Hash key_of_factors(const MovingMatrix& matrix, double length) {
  HashStream stream;
  stream.add("complex factors of ");
  add_pattern(stream, matrix.stiffness);
  add_to(stream, matrix.stiffness.valuePtr(),
         static_cast<std::size_t>(matrix.stiffness.nonZeros()));
  for (const auto* const numbers : {&matrix.inertia, &matrix.drag})
    add_to(stream, numbers->data(), numbers->size());
  add_to(stream, &length, 1);
  return stream.hash();
}

}  // namespace

struct SparseMotion::PatternItem final : Shelf::Item {
  bool is_of(const SparseMatrix& matrix) const {
    return starts.size() == static_cast<std::size_t>(matrix.cols()) + 1 &&
           rows.size() == static_cast<std::size_t>(matrix.nonZeros()) &&
           are_same(starts.data(), matrix.outerIndexPtr(), matrix.cols() + 1) &&
           are_same(rows.data(), matrix.innerIndexPtr(), matrix.nonZeros());
  }

  std::vector<int> starts, rows;
  SupernodePattern pattern;
};

struct SparseMotion::FactorsItem final : Shelf::Item {
  std::shared_ptr<const MovingMatrix> matrix;
  double length = 0;
  ComplexFactors factors;
};

template <class Work>
void SparseMotion::for_each_pole(const Work& work) {
  // A small matrix is not worth a thread.
  pliant::for_each(pattern_->size() > 2000 ? context_.threads : nullptr, pole_count, work);
}

Result<void> SparseMotion::prepare(MovingMatrix matrix) try {
  PLIANT_EXPECTS(matrix.inertia.size() == matrix.drag.size());
  if (matrix_ && are_same(*matrix_, matrix)) return {};
  const bool keeps_pattern = matrix_ && have_same_pattern(matrix_->stiffness, matrix.stiffness);
  matrix_.reset();
  factors_.clear();
  holding_.reset();
  if (!keeps_pattern) {
    if (auto found = find_pattern(matrix.stiffness); !found) return found;
  }
  matrix_ = std::make_shared<const MovingMatrix>(std::move(matrix));
  return {};
} catch (const std::bad_alloc&) {
  return fail(no_memory_for_factor(matrix.stiffness.cols()));
}

Result<void> SparseMotion::find_pattern(const SparseMatrix& matrix) {
  // The order copies the pattern; its entries are counted before they are stored.
  const std::size_t bytes = 250 * static_cast<std::size_t>(matrix.cols());
  const auto reserve = [&](std::size_t all) -> Result<void> {
    if (memory_.try_resize(all)) return {};
    return fail(factor_too_large(matrix.cols(), memory_.complaint(all)));
  };
  if (auto reserved = reserve(bytes); !reserved) return reserved;
  const Hash key = context_.shelf ? key_of_pattern(matrix) : Hash();
  const auto found = context_.shelf
                         ? context_.shelf->find<PatternItem>(
                               key, [&](const PatternItem& one) { return one.is_of(matrix); })
                         : nullptr;
  if (found) {
    pattern_ = std::shared_ptr<const SupernodePattern>(found, &found->pattern);
    return reserve(bytes + pattern_->memory());
  }
  auto made = std::make_shared<PatternItem>();
  made->pattern = SupernodePattern(matrix);
  if (auto reserved = reserve(bytes + made->pattern.memory()); !reserved) return reserved;
  ++counts_.analyses;
  pattern_ = std::shared_ptr<const SupernodePattern>(made, &made->pattern);
  if (!context_.shelf) return {};
  made->starts.assign(matrix.outerIndexPtr(), matrix.outerIndexPtr() + matrix.cols() + 1);
  made->rows.assign(matrix.innerIndexPtr(), matrix.innerIndexPtr() + matrix.nonZeros());
  const std::size_t all =
      made->pattern.memory() + (made->starts.size() + made->rows.size()) * sizeof(int);
  context_.shelf->keep(key, std::move(made), all);
  return {};
}

// Those on the shelf of an equal matrix and the same length, or new ones.
Result<std::shared_ptr<const SparseMotion::ComplexFactors>> SparseMotion::find_factors(
    double length, std::size_t count, const std::function<Result<void>(ComplexFactors&)>& make) {
  const Hash key = context_.shelf ? key_of_factors(*matrix_, length) : Hash();
  if (context_.shelf) {
    const auto found = context_.shelf->find<FactorsItem>(key, [&](const FactorsItem& one) {
      return one.length == length && are_same(*one.matrix, *matrix_);
    });
    if (found) return std::shared_ptr<const ComplexFactors>(found, &found->factors);
  }
  auto made = std::make_shared<FactorsItem>();
  made->factors.resize(count);
  if (auto done = make(made->factors); !done) return fail(done.error());
  counts_.factorizations += 2 * static_cast<int>(count);
  const std::shared_ptr<const ComplexFactors> factors(made, &made->factors);
  if (context_.shelf) {
    made->length = length;
    made->matrix = matrix_;
    const SparseMatrix& stiffness = matrix_->stiffness;
    const std::size_t bytes =
        count * ComplexFactor::bytes(*pattern_) +
        static_cast<std::size_t>(stiffness.nonZeros()) * (sizeof(double) + sizeof(int)) +
        static_cast<std::size_t>(stiffness.cols()) * (2 * sizeof(double) + sizeof(int));
    context_.shelf->keep(key, std::move(made), bytes);
  }
  return factors;
}

Result<SparseMotion::Factors*> SparseMotion::factors_for(double length) {
  const auto found = std::find_if(factors_.begin(), factors_.end(),
                                  [&](const Factors& one) { return one.length == length; });
  if (found != factors_.end()) {
    factors_.splice(factors_.begin(), factors_, found);
    return &factors_.front();
  }
  while (factors_.size() >= most_kept) factors_.pop_back();
  const int size = pattern_->size();
  const std::size_t bytes =
      pattern_->memory() + static_cast<std::size_t>(size) * 600 +
      (pole_count * (factors_.size() + 1) + 1) * ComplexFactor::bytes(*pattern_) +
      pole_count *
          (static_cast<std::size_t>(pattern_->solve_size()) * ComplexFactor::line * sizeof(double) +
           ComplexFactor::work_bytes(*pattern_));
  if (!memory_.try_resize(bytes)) return fail(factor_too_large(size, memory_.complaint(bytes)));
  const auto made = find_factors(length, pole_count, [&](ComplexFactors& factors) {
    std::array<Result<void>, pole_count> done;
    const SubStep step{length};
    for_each_pole([&](std::size_t pole) {
      const Complex rate = step.rate(static_cast<int>(pole));
      std::vector<Complex> shifts(matrix_->inertia.size());
      for (std::size_t k = 0; k < shifts.size(); ++k) {
        shifts[k] = (rate * matrix_->inertia[k] + Complex{matrix_->drag[k], 0}) * rate;
      }
      done[pole] = factors[pole].factorize(pattern_, matrix_->stiffness.valuePtr(), shifts, alone_);
    });
    for (Result<void>& one : done) {
      if (!one) return std::move(one);
    }
    return Result<void>();
  });
  if (!made) return fail(made.error());
  factors_.push_front({length, *made});
  return &factors_.front();
}

// The unknowns without a mass at the start of an interval: in equilibrium with the others, which a
// large diagonal holds.
Result<void> SparseMotion::find_massless(const Field& force, Field& w) {
  const int size = pattern_->size();
  const auto masses = static_cast<int>(matrix_->inertia.size());
  if (masses == size) return {};
  const Eigen::VectorXd diagonal = matrix_->stiffness.diagonal();
  const double hold = 1e20 * diagonal.cwiseAbs().maxCoeff();
  if (!holding_) {
    const std::size_t bytes = memory_.bytes() + ComplexFactor::bytes(*pattern_);
    if (!memory_.try_resize(bytes)) return fail(factor_too_large(size, memory_.complaint(bytes)));
    auto made = find_factors(length_when_held, 1, [&](ComplexFactors& factors) {
      const std::vector<Complex> shifts(matrix_->inertia.size(), Complex{hold, 0});
      return factors.front().factorize(pattern_, matrix_->stiffness.valuePtr(), shifts, alone_);
    });
    if (!made) return fail(made.error());
    holding_ = *made;
  }
  double* const x = cleared(0);
  for (int place = 0; place < size; ++place) {
    const int row = pattern_->order()[place];
    for (int c = 0; c < 3; ++c) {
      x[static_cast<std::size_t>(place) * ComplexFactor::line + c] =
          row < masses ? hold * w(row, c) : force(row, c);
    }
  }
  holding_->front().solve(alone_, x);
  for (int place = 0; place < size; ++place) {
    const int row = pattern_->order()[place];
    if (row < masses) continue;
    for (int c = 0; c < 3; ++c)
      w(row, c) = x[static_cast<std::size_t>(place) * ComplexFactor::line + c];
  }
  counts_.solves += 2;
  return {};
}

// K w.
Field SparseMotion::product(const Field& w) const {
  const SparseMatrix& upper = matrix_->stiffness;
  Field result = Field::Zero(w.rows(), 3);
  for (int component = 0; component < 3; ++component) {
    const double* const x = w.col(component).data();
    double* const y = result.col(component).data();
    for (int column = 0; column < upper.cols(); ++column) {
      double sum = 0;
      for (int k = upper.outerIndexPtr()[column]; k < upper.outerIndexPtr()[column + 1]; ++k) {
        const int row = upper.innerIndexPtr()[k];
        const double value = upper.valuePtr()[k];
        sum += value * x[row];
        if (row != column) y[row] += value * x[column];
      }
      y[column] += sum;
    }
  }
  return result;
}

// The solution of a pole, 0 in all rows.
double* SparseMotion::cleared(std::size_t pole) {
  NumberBlock& x = solutions_[pole];
  const auto count = static_cast<std::size_t>(pattern_->solve_size()) * ComplexFactor::line;
  if (x.count() != count) x = NumberBlock(count);
  std::fill_n(x.begin(), count, 0.0);
  return x.begin();
}

// Leaves x of each pole in `solutions_`. `lack` is K w - f, `growth` f', per second.
Result<void> SparseMotion::solve(const Factors& factors, const SubStep& step, const Field& lack,
                                 const Field& growth, const Field& v) {
  if (context_.is_stopped()) return interrupted();
  const int size = pattern_->size();
  const auto masses = static_cast<int>(matrix_->inertia.size());
  for_each_pole([&](std::size_t pole) {
    constexpr int half = ComplexFactor::line / 2;
    const int number = static_cast<int>(pole);
    const Complex of_growth = step.of_growth(number), of_v = step.rate(number) * step.of_lack();
    double* const x = cleared(pole);
    for (int place = 0; place < size; ++place) {
      const int row = pattern_->order()[place];
      double* const to = x + long{place} * ComplexFactor::line;
      for (int c = 0; c < 3; ++c) {
        Complex side = of_growth * growth(row, c) + Complex{step.of_lack() * lack(row, c), 0};
        if (row < masses) side = side - of_v * (matrix_->inertia[row] * v(row, c));
        to[c] = side.re;
        to[half + c] = side.im;
      }
    }
    (*factors.of_pole)[pole].solve(alone_, x);
  });
  counts_.solves += 2 * pole_count;
  return {};
}

Result<void> SparseMotion::advance(const TimeSteps& steps, const ForceChange& forces, Field& moving,
                                   Field& v) try {
  PLIANT_EXPECTS(matrix_ != nullptr);
  const int size = pattern_->size();
  const auto masses = static_cast<Eigen::Index>(matrix_->inertia.size());
  PLIANT_EXPECTS(moving.rows() == masses && v.rows() == masses && forces.first.rows() == size &&
                 forces.last.rows() == size);
  const Field growth = (forces.last - forces.first) / steps.length;
  const bool swings = std::any_of(matrix_->inertia.begin(), matrix_->inertia.end(),
                                  [](double inertia) { return inertia > 0; });
  Field w = Field::Zero(size, 3);
  w.topRows(masses) = moving;
  if (auto found = find_massless(forces.first, w); !found) return found;
  StepChoice choice(steps);
  Field next_w(size, 3), next_v(masses, 3);
  Field first_w, first_v;  // to begin again, if the steps look ahead
  double first_doubt = 0;
  const auto size_of = [&](double squared, double squared_speed) {
    return size_of_motion(std::sqrt(squared), swings ? std::sqrt(squared_speed) : 0, steps.length);
  };
  for (int number = 0; number < choice.count(); ++number) {
    const SubStep step{choice.length()};
    const auto factors = factors_for(step.length);
    if (!factors) return fail(factors.error());
    const Field lack = product(w) - (forces.first + growth * (number * step.length));
    if (auto solved = solve(**factors, step, lack, growth, v); !solved) return solved;
    double doubt = 0, before = 0, after = 0, speed = 0, old_speed = 0;
    for (int place = 0; place < size; ++place) {
      const int row = pattern_->order()[place];
      for (int c = 0; c < 3; ++c) {
        double moved = 0, velocity = 0, uncertain = 0;
        for (int pole = 0; pole < pole_count; ++pole) {
          constexpr int half = ComplexFactor::line / 2;
          const double* const at = solutions_[pole].begin() + long{place} * ComplexFactor::line + c;
          const Complex x{at[0], at[half]};
          moved += (step.to_w(pole) * x).re;
          velocity += (step.to_v(pole) * x).re;
          uncertain += (step.to_doubt(pole) * x).re;
        }
        next_w(row, c) = w(row, c) + moved;
        if (row >= masses) continue;
        next_v(row, c) = velocity;
        doubt += uncertain * uncertain;
        before += w(row, c) * w(row, c);
        after += next_w(row, c) * next_w(row, c);
        speed += velocity * velocity;
        old_speed += v(row, c) * v(row, c);
      }
    }
    const double at_start = size_of(before, old_speed), at_end = size_of(after, speed);
    if (number == 0) {
      first_doubt = std::sqrt(doubt);
      if (choice.looks_ahead(first_doubt, at_start, at_end)) {
        first_w = w;
        first_v = v;
      } else if (!choice.accepts(first_doubt, std::max(at_start, at_end))) {
        number = -1;
        continue;
      }
    }
    w.swap(next_w);
    v.swap(next_v);
    if (number + 1 == choice.count() && first_w.size() > 0) {
      const bool is_accepted = choice.accepts(first_doubt, at_end);
      if (!is_accepted) {
        w.swap(first_w);
        v.swap(first_v);
        number = -1;
      }
      first_w.resize(0, 3);
    }
  }
  moving = w.topRows(masses);
  return {};
} catch (const std::bad_alloc&) {
  return fail(no_memory_for_factor(pattern_->size()));
}

}  // namespace pliant
