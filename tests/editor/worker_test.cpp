#include "editor/worker.hpp"

#include <future>
#include <memory>
#include <new>
#include <stdexcept>
#include <utility>

#include "support/catch.hpp"

using pliant::editor::Worker;

TEST_CASE("work that throws is dropped, and the next is done", "[editor][worker][threads]") {
  Worker worker;
  std::promise<int> done;
  bool has_thrown = false;
  const auto dropped = std::make_shared<int>(0);
  std::weak_ptr<int> is_there = dropped;
  worker.add([dropped] { throw std::bad_alloc(); });
  worker.add([] { throw std::runtime_error("what"); });
  worker.add([] { throw 7; });
  worker.add([&] { done.set_value(7); });
  worker.begin([&] {
    if (!std::exchange(has_thrown, true)) throw std::bad_alloc();
  });
  CHECK(done.get_future().get() == 7);
  worker.end();
  CHECK(has_thrown);
  CHECK(is_there.use_count() == 1);
}

TEST_CASE("a worker that never begins ends", "[editor][worker]") {
  Worker worker;
  worker.add([] { FAIL(); });
  worker.end();
}
