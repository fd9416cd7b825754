#pragma once

// Counts every allocation of the executable that includes this in one file, and of all libraries
// linked to it: by malloc, calloc, realloc and the aligned functions, as in Eigen and CHOLMOD, and
// by operator new, which calls malloc. With a sanitizer, which replaces these functions itself,
// counts operator new only.

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <new>

#include "support/sanitized.hpp"

namespace pliant::testing {

inline std::atomic<long> allocations = 0;

#if defined(__GLIBC__) && !defined(PLIANT_SANITIZED)
inline constexpr bool counts_everything = true;
#else
inline constexpr bool counts_everything = false;
#endif

inline void* counted(void* memory) {
  ++allocations;
  if (memory == nullptr) std::abort();
  return memory;
}

}  // namespace pliant::testing

#if defined(__GLIBC__) && !defined(PLIANT_SANITIZED)

// glibc's own functions, under names that nothing replaces; its free accepts their memory.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* memory, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  ++pliant::testing::allocations;
  return __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) noexcept {
  ++pliant::testing::allocations;
  return __libc_calloc(count, size);
}
void* realloc(void* memory, std::size_t size) noexcept {
  ++pliant::testing::allocations;
  return __libc_realloc(memory, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  ++pliant::testing::allocations;
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  return memalign(alignment, size);
}
int posix_memalign(void** memory, std::size_t alignment, std::size_t size) noexcept {
  void* const given = memalign(alignment, size);
  if (given == nullptr) return ENOMEM;
  *memory = given;
  return 0;
}
}

#else

using pliant::testing::counted;

// Not inlined: otherwise GCC sees free() beside an operator new that it did not inline, and warns.

[[gnu::noinline]] void* operator new(std::size_t size) {
  return counted(std::malloc(size > 0 ? size : 1));
}
[[gnu::noinline]] void* operator new(std::size_t size, std::align_val_t alignment) {
  const auto unit = static_cast<std::size_t>(alignment);
  return counted(std::aligned_alloc(unit, (size + unit - 1) / unit * unit));
}
// std::stable_sort calls this one. The sanitizers' own would not match the deletes below.
[[gnu::noinline]] void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  return operator new(size);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, const std::nothrow_t&) noexcept {
  std::free(memory);
}
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}

#endif
