#include "editor/frame_solver.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <future>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "pliant/files/single_precision.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using editor::FrameAnswer;
using editor::FrameQuestion;
using editor::FrameSolver;

namespace {

// What a thread is told, for others to wait for.
class News {
 public:
  std::function<void()> listener() {
    return [this] {
      const std::lock_guard lock(mutex_);
      ++count_;
      changed_.notify_all();
    };
  }
  template <class Holds>
  void wait_until(const Holds& holds) {
    std::unique_lock lock(mutex_);
    while (!holds()) changed_.wait_for(lock, std::chrono::milliseconds(10));
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int count_ = 0;
};

Scene moving_sheet(double magnitude, int end = 20) {
  Scene scene;
  scene.end = end;
  scene.surfaces = {sheet("sheet")};
  Force force;
  force.name = "poke";
  force.magnitude = magnitude;
  force.deformation_radius = 5;
  force.force_radius = 3;
  scene.forces = {force};
  return scene;
}

std::string bytes_of(Simulation& simulation, int frame) {
  const Frame at = *simulation.at(frame);
  std::string bytes;
  for (const SurfaceFrame& surface : at.surfaces()) {
    const auto single = *to_single(surface.positions(), frame);
    const auto count = static_cast<std::uint32_t>(single.size() / 3);
    bytes.append(reinterpret_cast<const char*>(&count), sizeof count);
    bytes.append(reinterpret_cast<const char*>(single.data()), single.size() * sizeof(float));
  }
  return bytes;
}

FrameAnswer ask(FrameSolver& solver, const FrameQuestion& question) {
  auto answered = std::make_shared<std::promise<FrameAnswer>>();
  auto answer = answered->get_future();
  solver.ask(question, [answered](FrameAnswer told) { answered->set_value(std::move(told)); });
  return answer.get();
}

}  // namespace

TEST_CASE("frames in any order are those of a simulation", "[editor][frame_solver][threads]") {
  News news;
  FrameSolver solver({.notify = news.listener()});
  for (int revision = 1; revision <= 3; ++revision) {
    const Scene scene = moving_sheet(1000.0 * revision);
    auto reference = Simulation::make(scene);
    REQUIRE(reference);
    solver.take(revision, scene);
    for (const int frame : {20, 3, 11, 1, 20}) {
      const FrameAnswer answer = ask(solver, {.revision = revision, .frame = frame});
      REQUIRE(answer);
      REQUIRE(*answer);
      CHECK(***answer == bytes_of(*reference, frame));
    }
  }
}

TEST_CASE("after a while all frames are there", "[editor][frame_solver][threads]") {
  News news;
  FrameSolver solver({.notify = news.listener()});
  solver.take(7, moving_sheet(1000));
  const editor::ReadyFrames all{7, {{1, 20}}};
  news.wait_until([&] { return solver.ready() == all; });
  solver.take(8, moving_sheet(2000));
  CHECK(solver.ready().revision == 8);
  news.wait_until([&] { return solver.ready() == editor::ReadyFrames{8, {{1, 20}}}; });
}

TEST_CASE("a question about another revision than the newest has no answer",
          "[editor][frame_solver][threads]") {
  News news;
  FrameSolver solver({.notify = news.listener()});
  CHECK_FALSE(ask(solver, {.revision = 0, .frame = 1}));
  CHECK_FALSE(ask(solver, {.revision = 1, .frame = 1}));
  // One that waits is answered as soon as there is another.
  Scene slow = moving_sheet(1000, 100'000);
  slow.surfaces = {sheet("sheet", is_sanitized ? 31 : 101)};
  solver.take(1, slow);
  std::promise<bool> answered;
  solver.ask({.revision = 1, .frame = 100'000},
             [&](const FrameAnswer& answer) { answered.set_value(answer.has_value()); });
  solver.take(2, moving_sheet(1));
  CHECK_FALSE(answered.get_future().get());
  CHECK(ask(solver, {.revision = 2, .frame = 20}));
}

TEST_CASE("a scene that cannot be played fails, until there is another",
          "[editor][frame_solver][threads]") {
  News news;
  FrameSolver solver({.notify = news.listener()});
  Scene bad = moving_sheet(1000);
  bad.surfaces[0].material.density = -1;
  solver.take(1, bad);
  const FrameAnswer answer = ask(solver, {.revision = 1, .frame = 3});
  REQUIRE(answer);
  REQUIRE_FALSE(*answer);
  REQUIRE(solver.failure());
  CHECK(solver.failure()->message == (*answer).error().message);
  solver.take(2, moving_sheet(1000));
  CHECK_FALSE(solver.failure());
  CHECK(ask(solver, {.revision = 2, .frame = 3})->has_value());
}

TEST_CASE("frames are those of their revision, whenever the next one comes",
          "[editor][frame_solver][threads]") {
  News news;
  FrameSolver solver({.notify = news.listener()});
  // Little to solve, and much to write down: most of the time no stop is asked for.
  Scene scene = moving_sheet(0, 2);
  scene.surfaces = {sheet("sheet", is_sanitized ? 61 : 301)};
  std::vector<std::string> bytes;
  for (const double height : {1.0, 2.0}) {
    scene.surfaces[0].transform.translate = Value<3>{0, height, 0};
    auto reference = Simulation::make(scene);
    bytes.push_back(bytes_of(*reference, 1));
  }
  for (int revision = 1; revision <= 100; ++revision) {
    const std::size_t which = revision % 2;
    scene.surfaces[0].transform.translate = Value<3>{0, 1.0 + static_cast<double>(which), 0};
    solver.take(revision, scene);
    if (revision % 10 == 0)
      CHECK(***ask(solver, {.revision = revision, .frame = 1}) == bytes[which]);
    solver.ask({.revision = revision, .frame = 1}, [](const FrameAnswer&) {});
    std::this_thread::sleep_for(std::chrono::microseconds(137 * (revision % 50)));
  }
}

TEST_CASE("a question whose frame is solved as the next revision comes has no answer",
          "[editor][frame_solver][threads]") {
  std::optional<FrameSolver> solver;
  bool is_taken = false;
  solver.emplace(FrameSolver::Options{.notify = [&] {
    if (!std::exchange(is_taken, true)) solver->take(2, moving_sheet(2000));
  }});
  solver->take(1, moving_sheet(1000, 1));
  CHECK_FALSE(ask(*solver, {.revision = 1, .frame = 1}));
  auto reference = Simulation::make(moving_sheet(2000));
  CHECK(***ask(*solver, {.revision = 2, .frame = 9}) == bytes_of(*reference, 9));
}

namespace {

// A force whose function does something at a frame, and says how much it pushes.
Scene scripted_sheet(std::function<double(int frame)> act) {
  Scene scene = moving_sheet(1000);
  scene.surfaces[0].solver.region = SolvedRegion::All;
  scene.forces[0].kind =
      CustomForce{.unit_force = [act](const Vector3d&, const ForceTime& time) -> Vector3d {
        return {0, act(time.frame), 0};
      }};
  return scene;
}

// Frames in the order in which they were answered.
class Order {
 public:
  std::function<void(FrameAnswer)> reply(int frame) {
    return [this, frame](const FrameAnswer& answer) {
      const std::lock_guard lock(mutex_);
      if (answer && *answer) frames_.push_back(frame);
    };
  }
  std::vector<int> frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<int> frames_;
};

}  // namespace

TEST_CASE("the frame that was asked for last is solved first", "[editor][frame_solver][threads]") {
  News news;
  FrameSolver solver({.notify = news.listener()});
  Order order;
  std::promise<void> are_asked;
  solver.take(1, moving_sheet(1000));
  // In the solver's thread, so that all of them wait.
  solver.ask({.revision = 1, .frame = 1}, [&](const FrameAnswer&) {
    for (const int frame : {9, 5, 17, 3, 12})
      solver.ask({.revision = 1, .frame = frame}, order.reply(frame));
    are_asked.set_value();
  });
  are_asked.get_future().wait();
  news.wait_until([&] { return order.frames().size() == 5; });
  CHECK(order.frames() == std::vector{12, 3, 17, 5, 9});
}

TEST_CASE("a frame gives way to an earlier one, and is solved after it",
          "[editor][frame_solver][threads]") {
  News news;
  std::optional<FrameSolver> solver;
  Order order;
  bool is_asked = false;
  const bool is_wanted = GENERATE(true, false);  // or solved because nothing else is to do
  const Scene scene = scripted_sheet([&](int frame) {
    if (frame < 8 || std::exchange(is_asked, true)) return 1.0;
    for (const int number : {18, 4})
      solver->ask({.revision = 1, .frame = number}, order.reply(number));
    return 1.0;
  });
  solver.emplace(FrameSolver::Options{.notify = news.listener()});
  solver->take(1, scene);
  if (is_wanted) solver->ask({.revision = 1, .frame = 15}, order.reply(15));
  news.wait_until([&] { return order.frames().size() == (is_wanted ? 3 : 2); });
  CHECK(order.frames() == (is_wanted ? std::vector{4, 18, 15} : std::vector{4, 18}));
  auto reference = Simulation::make(scripted_sheet([](int) { return 1.0; }));
  for (const int frame : {4, 15, 18})
    CHECK(***ask(*solver, {.revision = 1, .frame = frame}) == bytes_of(*reference, frame));
}

TEST_CASE("a run that fails at a frame has those before, and is drawn",
          "[editor][frame_solver][threads]") {
  News news;
  FrameSolver solver({.notify = news.listener()});
  const bool lacks_memory = GENERATE(false, true);
  const Scene scene = scripted_sheet([lacks_memory](int frame) {
    if (frame >= 9 && lacks_memory) throw std::bad_alloc();
    return frame >= 9 ? std::numeric_limits<double>::quiet_NaN() : 1.0;
  });
  auto reference = Simulation::make(scripted_sheet([](int) { return 1.0; }));
  solver.take(1, scene);
  news.wait_until([&] { return solver.ready().ranges == std::vector{std::pair(1, 9)}; });
  news.wait_until([&] { return solver.failure().has_value(); });
  CHECK(solver.failure()->code == (lacks_memory ? ErrorCode::OutOfMemory : ErrorCode::NotFinite));
  for (const int frame : {10, 20, 15, 10}) {
    const FrameAnswer answer = ask(solver, {.revision = 1, .frame = frame});
    REQUIRE(answer);
    REQUIRE_FALSE(*answer);
    CHECK((*answer).error().message == solver.failure()->message);
  }
  for (const int frame : {9, 1, 5})
    CHECK(***ask(solver, {.revision = 1, .frame = frame}) == bytes_of(*reference, frame));
  CHECK(ask(solver, {.kind = FrameQuestion::Kind::Scene, .revision = 1})->has_value());
  CHECK(
      ask(solver, {.kind = FrameQuestion::Kind::Details, .revision = 1, .frame = 4})->has_value());
  solver.take(2, moving_sheet(1000));
  CHECK(ask(solver, {.revision = 2, .frame = 20})->has_value());
}

TEST_CASE("a run that fails says nothing of a newer revision", "[editor][frame_solver][threads]") {
  FrameSolver solver({.notify = [] {}});
  Scene bad = moving_sheet(1000);
  bad.surfaces[0].material.density = -1;
  for (int revision = 1; revision <= 400; revision += 2) {
    solver.take(revision, bad);
    std::this_thread::sleep_for(std::chrono::microseconds(revision));
    solver.refuse(revision + 1, {.message = "refused"});
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    REQUIRE(solver.failure()->message == "refused");
  }
}

TEST_CASE("frames that do not fit are solved again when they are asked for",
          "[editor][frame_solver][threads]") {
  News news;
  SimulationOptions options;
  options.max_memory = 40'000'000;  // a quarter of it for frames of 20 KB
  FrameSolver solver({.simulation = options, .notify = news.listener()});
  const int end = 900;
  Scene scene = moving_sheet(1000, end);
  scene.surfaces = {sheet("sheet", 41)};
  auto reference = Simulation::make(scene);
  solver.take(1, scene);
  news.wait_until(
      [&] { return solver.failure() || solver.ready().ranges == std::vector{std::pair(1, end)}; });
  REQUIRE_FALSE(solver.failure());
  for (const int frame : {1, end, 400, 2}) {
    const FrameAnswer answer = ask(solver, {.revision = 1, .frame = frame});
    REQUIRE(answer);
    REQUIRE(*answer);
    CHECK(***answer == bytes_of(*reference, frame));
  }
}

TEST_CASE("a shape keeps its key while it is the same", "[editor][frame_solver][threads]") {
  News news;
  FrameSolver solver({.notify = news.listener()});
  const auto keys = [&](int revision) {
    const FrameAnswer answer =
        ask(solver, {.kind = FrameQuestion::Kind::Scene, .revision = revision});
    REQUIRE(answer);
    const auto scene = viewer::Json::parse(***answer);
    std::vector<std::string> found;
    for (const auto& surface : scene["surfaces"]) found.push_back(surface["shape"]);
    for (const auto& collider : scene["colliders"]) found.push_back(collider["shape"]);
    for (const std::string& key : found) CHECK(solver.shape(key));
    return found;
  };
  Scene scene = moving_sheet(1000);
  Collider ball;
  ball.name = "ball";
  ball.transform.translate = Value<3>{0, 5, 0};
  scene.colliders = {ball};
  solver.take(1, scene);
  const auto first = keys(1);
  REQUIRE(first.size() == 2);
  scene.forces[0].magnitude = 7;
  scene.colliders[0].transform.translate = Value<3>{0, 6, 0};
  solver.take(2, scene);
  CHECK(keys(2) == first);
  scene.surfaces[0] = sheet("sheet", 15);
  solver.take(3, scene);
  const auto third = keys(3);
  CHECK(third[0] != first[0]);
  CHECK(third[1] == first[1]);
  CHECK_FALSE(solver.shape("none"));
}
