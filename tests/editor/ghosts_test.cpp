#include "editor/ghosts.hpp"

#include <chrono>
#include <future>
#include <memory>
#include <utility>

#include "editor/frame_solver.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using namespace std::chrono_literals;
using editor::FrameAnswer;
using editor::FrameSolver;
using editor::Ghost;
using editor::Ghosts;

namespace {

Scene pushed_sheet(int end, int nodes_along = 21) {
  Scene scene;
  scene.end = end;
  scene.surfaces = {sheet("sheet", nodes_along)};
  Force force;
  force.name = "poke";
  force.magnitude = 1000;
  force.deformation_radius = 5;
  force.force_radius = 3;
  scene.forces = {force};
  return scene;
}

std::future<FrameAnswer> ask(FrameSolver& solver, editor::Revision revision, int frame) {
  auto answered = std::make_shared<std::promise<FrameAnswer>>();
  solver.ask({.revision = revision, .frame = frame},
             [answered](FrameAnswer told) { answered->set_value(std::move(told)); });
  return answered->get_future();
}

}  // namespace

TEST_CASE("the ghost that was not asked for longest gives way", "[editor][ghosts][threads]") {
  FrameSolver present({.notify = [] {}});
  Ghosts ghosts(present, {});
  ghosts.begin(1, pushed_sheet(3));
  ghosts.begin(2, pushed_sheet(5));
  REQUIRE(ghosts.find(1));
  CHECK(ghosts.find(1)->frames.last == 3);
  CHECK(ghosts.begin(3, pushed_sheet(7)).frames.last == 7);
  CHECK(ghosts.find(1));
  CHECK_FALSE(ghosts.find(2));
  CHECK(ghosts.count() == Ghosts::most);
}

TEST_CASE("a ghost ends a while after the last question, and answers what waits",
          "[editor][ghosts][threads]") {
  FrameSolver present({.notify = [] {}});
  Ghosts ghosts(present, {});
  const Ghost& ghost = ghosts.begin(1, pushed_sheet(100'000, 61));
  auto waiting = ask(*ghost.solver, Ghost::revision, 100'000);
  const auto begun = ghost.asked;
  ghosts.end_idle(begun + 29s);
  CHECK(ghosts.count() == 1);
  ghosts.end_idle(begun + 30s);
  CHECK(ghosts.count() == 0);
  CHECK_FALSE(waiting.get());
}

TEST_CASE("a ghost waits while somebody asks for the document", "[editor][ghosts][threads]") {
  FrameSolver present({.notify = [] {}});
  present.take(1, pushed_sheet(100'000, 61));
  auto first = ask(present, 1, 100'000);
  Ghosts ghosts(present, {});
  const Ghost& ghost = ghosts.begin(1, pushed_sheet(20));
  auto behind = ask(*ghost.solver, Ghost::revision, 20);
  CHECK(behind.wait_for(300ms) == std::future_status::timeout);
  present.take(2, pushed_sheet(20));
  CHECK_FALSE(first.get());
  // The same scene, the same bytes.
  const FrameAnswer ghostly = behind.get(), own = ask(present, 2, 20).get();
  REQUIRE(ghostly);
  REQUIRE(*ghostly);
  CHECK(***ghostly == ***own);
}
