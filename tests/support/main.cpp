#if __has_include(<catch2/catch_session.hpp>)
#include <catch2/catch_session.hpp>
int main(int count, char* arguments[]) { return Catch::Session().run(count, arguments); }
#else
#define CATCH_CONFIG_MAIN
#include <catch2/catch.hpp>
#endif

// assimp 5.2 leaks memory when it refuses a file. Used by the address sanitizer only.
extern "C" const char* __lsan_default_suppressions() { return "leak:libassimp"; }
