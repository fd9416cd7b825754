// Runs the tests. A test that starts a thread must have the tag [threads], by which the thread
// sanitizer's build chooses its tests: without it the run fails. When a sanitizer ends the run, it
// says in which test.

#include <atomic>
#include <cstdio>
#include <string>
#include <vector>

#include <dlfcn.h>
#include <pthread.h>

#include "support/sanitized.hpp"

#if __has_include(<catch2/catch_session.hpp>)
#include <catch2/catch_session.hpp>
#include <catch2/catch_test_case_info.hpp>
#include <catch2/reporters/catch_reporter_event_listener.hpp>
#include <catch2/reporters/catch_reporter_registrars.hpp>
using EventListener = Catch::EventListenerBase;
#else
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
using EventListener = Catch::TestEventListenerBase;
#endif

namespace {

std::atomic<int> started_threads = 0;
std::vector<std::string> untagged_tests;  // that started a thread
std::string current_test;

class ThreadWatch : public EventListener {
 public:
  using EventListener::EventListener;

  void testCaseStarting(const Catch::TestCaseInfo& test) override {
    started_threads = 0;
    current_test = test.name;
  }

  void testCaseEnded(const Catch::TestCaseStats& stats) override {
    if (started_threads == 0) return;
    for (const auto& tag : stats.testInfo.tags) {
      if (tag == "threads") return;
    }
    untagged_tests.push_back(stats.testInfo.name);
  }
};

CATCH_REGISTER_LISTENER(ThreadWatch)

}  // namespace

#ifndef PLIANT_SANITIZED  // the sanitizers have a pthread_create of their own
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*run)(void*), void* argument) noexcept {
  static const auto create =
      reinterpret_cast<decltype(&pthread_create)>(dlsym(RTLD_NEXT, "pthread_create"));
  ++started_threads;
  return create(thread, attributes, run, argument);
}
#endif

#ifdef PLIANT_SANITIZED
extern "C" void __sanitizer_set_death_callback(void (*callback)());
#endif

// assimp 5.2 leaks memory if it refuses a file. Only the address sanitizer calls this.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }

int main(int count, char* arguments[]) {
#ifdef PLIANT_SANITIZED
  __sanitizer_set_death_callback(
      [] { std::fprintf(stderr, "in the test \"%s\"\n", current_test.c_str()); });
#endif
  const int failed = Catch::Session().run(count, arguments);
  for (const std::string& name : untagged_tests) {
    std::fprintf(stderr, "the test \"%s\" starts a thread, but lacks the tag [threads]\n",
                 name.c_str());
  }
  return failed != 0 ? failed : static_cast<int>(!untagged_tests.empty());
}
