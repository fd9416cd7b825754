#include "pliant/core/expects.hpp"

#include <cstdio>
#include <exception>

namespace pliant {

void contract_broken(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: requirement broken: %s\n", file, line, condition);
  std::terminate();
}

}  // namespace pliant
