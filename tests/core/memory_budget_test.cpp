#include "pliant/core/memory_budget.hpp"

#include <memory>
#include <utility>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("shares of a budget never add up to more than it", "[core][memory]") {
  MemoryBudget budget(100);
  MemoryShare a(&budget);
  CHECK(a.try_resize(60));
  {
    MemoryShare b(&budget);
    CHECK_FALSE(b.try_resize(41));
    CHECK(budget.available() == 40);
    CHECK(b.try_resize(40));
    CHECK_FALSE(a.try_resize(61));
    CHECK(a.bytes() == 60);
    CHECK(a.try_resize(10));
    CHECK(b.try_resize(90));
    CHECK(budget.available() == 0);
  }
  CHECK(budget.available() == 90);  // b is destroyed
  {
    const MemoryShare moved = std::move(a);
    CHECK(moved.bytes() == 10);
  }
  CHECK(budget.available() == 100);
  MemoryShare unlimited(nullptr);
  CHECK(unlimited.try_resize(std::size_t{1} << 60));
}

TEST_CASE("a share that was moved from knows its budget no more", "[core][memory]") {
  auto budget = std::make_unique<MemoryBudget>(100);
  MemoryShare a(budget.get());
  {
    MemoryShare b = std::move(a);
    REQUIRE(b.try_resize(70));
  }
  budget.reset();  // `a` outlives the budget
  CHECK(a.try_resize(200));
}

TEST_CASE("bytes are spelled with three digits", "[core][memory]") {
  CHECK(bytes_text(0) == "0 B");
  CHECK(bytes_text(999) == "999 B");
  CHECK(bytes_text(1'000) == "1 kB");
  CHECK(bytes_text(1'234'567) == "1.23 MB");
  CHECK(bytes_text(999'600'000) == "1 GB");
  MemoryBudget budget(2'000'000'000);
  MemoryShare a(&budget), b(&budget);
  REQUIRE((a.try_resize(500'000'000) && b.try_resize(300'000'000)));
  CHECK(a.complaint(5'000'000'000) == "needs 5 GB, more than the 1.7 GB left of the 2 GB allowed");
}
