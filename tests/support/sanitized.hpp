#pragma once

// Whether a sanitizer is built in: PLIANT_SANITIZED.

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define PLIANT_SANITIZED
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define PLIANT_SANITIZED
#endif
#endif

#if defined(__SANITIZE_THREAD__)
#define PLIANT_WATCHES_THREADS
#elif defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define PLIANT_WATCHES_THREADS
#endif
#endif

namespace pliant::testing {

#ifdef PLIANT_SANITIZED
inline constexpr bool is_sanitized = true;
#else
inline constexpr bool is_sanitized = false;
#endif

/// Whether it is the thread sanitizer, which finds nothing in what a single thread does.
#ifdef PLIANT_WATCHES_THREADS
inline constexpr bool watches_threads = true;
#else
inline constexpr bool watches_threads = false;
#endif

/// `count` random cases, or a tenth of them with a sanitizer, which checks the code that they run
/// rather than their numbers, and which needs ten times as long.
constexpr int rounds(int count) { return is_sanitized ? count / 10 : count; }

}  // namespace pliant::testing
