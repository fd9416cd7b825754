// Makes of the processes of one machine those of a cluster's nodes (LD_PRELOAD): the name of the
// host is that of the Slurm node. On the node PLIANT_SHIM_BROKEN, CHOLMOD computes the largest
// number of each solution with another last bit. PLIANT_SHIM_PAUSE is a time in milliseconds that
// each line of the log of a sweep waits, so that takes last without a processor.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <string_view>

#include <cholmod.h>
#include <dlfcn.h>
#include <unistd.h>

namespace {

std::string_view variable(const char* name) {
  const char* const text = std::getenv(name);
  return text == nullptr ? "" : text;
}

}  // namespace

// The command asks for it once for each line of the log.
extern "C" int gethostname(char* name, std::size_t size) noexcept {
  const std::string_view node = variable("SLURMD_NODENAME");
  if (node.empty()) {
    using Function = int (*)(char*, std::size_t);
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, "gethostname"))(name, size);
  }
  if (const auto pause = variable("PLIANT_SHIM_PAUSE"); !pause.empty())
    usleep(1000 * static_cast<useconds_t>(std::atoi(pause.data())));
  const std::size_t length = node.copy(name, size - 1);
  name[length] = '\0';
  return 0;
}

extern "C" int cholmod_solve2(int system, cholmod_factor* factor, cholmod_dense* right,
                              cholmod_sparse* right_set, cholmod_dense** solution,
                              cholmod_sparse** solution_set, cholmod_dense** y, cholmod_dense** e,
                              cholmod_common* common) {
  using Function = decltype(&cholmod_solve2);
  static const auto solve = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "cholmod_solve2"));
  const int done = solve(system, factor, right, right_set, solution, solution_set, y, e, common);
  const std::string_view broken = variable("PLIANT_SHIM_BROKEN");
  if (done == 0 || broken.empty() || broken != variable("SLURMD_NODENAME")) return done;
  auto* const numbers = static_cast<double*>((*solution)->x);
  double& largest = *std::max_element(numbers, numbers + (*solution)->nrow * (*solution)->ncol);
  largest = std::nextafter(largest, 0);
  return done;
}
