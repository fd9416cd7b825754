#include "pliant/core/expects.hpp"

#include <cstdio>
#include <exception>

namespace pliant {

void contract_broken(std::string_view requirement, const char* file, int line) {
  std::fprintf(stderr, "%s:%d: requirement broken: %.*s\n", file, line,
               static_cast<int>(requirement.size()), requirement.data());
  std::terminate();
}

}  // namespace pliant
