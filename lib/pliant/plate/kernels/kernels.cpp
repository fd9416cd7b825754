#include "pliant/plate/kernels/kernels.hpp"

namespace pliant {

const PlateKernels* runnable_kernels(int k) {
#ifdef PLIANT_WIDE_KERNELS
  const bool has_avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
                          __builtin_cpu_supports("avx512vl");
  if (has_avx512 && k-- == 0) return &avx512_kernels;
  if (__builtin_cpu_supports("avx2") && k-- == 0) return &avx2_kernels;
#endif
  return k == 0 ? &baseline_kernels : nullptr;
}

const PlateKernels& kernels_of_width(int most_lanes) {
  int k = 0;
  while (runnable_kernels(k)->lanes > most_lanes && runnable_kernels(k + 1)) ++k;
  return *runnable_kernels(k);
}

}  // namespace pliant
