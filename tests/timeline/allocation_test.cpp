// Evaluation does not allocate. An executable of its own, since it counts what everyone allocates.

#include <cstdio>
#include <cstdlib>
#include <new>

#include "pliant/timeline/curve.hpp"
#include "pliant/timeline/sampler.hpp"
#include "timeline/authoring.hpp"

namespace {

long allocations = 0;

void* counted(void* memory) {
  ++allocations;
  if (memory == nullptr) std::abort();
  return memory;
}

}  // namespace

void* operator new(std::size_t size) { return counted(std::malloc(size > 0 ? size : 1)); }
void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto unit = static_cast<std::size_t>(alignment);
  return counted(std::aligned_alloc(unit, (size + unit - 1) / unit * unit));
}
// std::stable_sort asks this one. The sanitizers' own would not match the deletes below.
void* operator new(std::size_t size, const std::nothrow_t&) noexcept { return operator new(size); }
void operator delete(void* memory) noexcept { std::free(memory); }
void operator delete(void* memory, const std::nothrow_t&) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::align_val_t) noexcept { std::free(memory); }
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept { std::free(memory); }

int main() {
  using namespace pliant;
  testing::Whim whim(91);
  long while_evaluating = 0;
  double sum = 0;
  for (int round = 0; round < 300; ++round) {
    const Curve<1> curve = testing::make(whim.keys(12));
    const long before = allocations;
    Sampler<1> sampler(curve);
    for (double t = -60; t < 200; t += 0.25) {
      sum += sampler.value(t)[0] + curve.value(t)[0] + curve.left_value(t)[0];
      sum += sampler.velocity(t)[0] + curve.velocity(t)[0] + curve.left_velocity(t)[0];
      sum += curve.range(t, t + 9).high[0];
    }
    while_evaluating += allocations - before;
  }
  std::printf("%ld allocations in all, %ld while evaluating (sum %g)\n", allocations,
              while_evaluating, sum);
  return allocations > 0 && while_evaluating == 0 ? 0 : 1;
}
