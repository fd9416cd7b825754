#pragma once

// Whether a sanitizer is built in: PLIANT_SANITIZED.

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PLIANT_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PLIANT_SANITIZED
#endif
#endif

namespace pliant::testing {

/// So many random cases, or a tenth of them with a sanitizer, whose subject is the code that they
/// run rather than their numbers, and which takes ten times as long.
constexpr int rounds(int count) {
#ifdef PLIANT_SANITIZED
  return count / 10;
#else
  return count;
#endif
}

}  // namespace pliant::testing
