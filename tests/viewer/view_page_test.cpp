#include "pliant/viewer/view_page.hpp"

#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"
#include "viewer/page.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

Simulation made() { return Simulation::make(scene({sheet("s")}, {poke("f", {0, 0, 0})})).value(); }

std::string page_complaint(const ViewPageOptions& options) {
  Simulation simulation = made();
  const auto page = view_page(simulation, options);
  return page ? "none" : page.error().message;
}

}  // namespace

TEST_CASE("a page is the same at any time, and of all frames by default", "[viewer][view_page]") {
  if (!viewer::page_template()) return;  // a build without npm
  Simulation simulation = made();
  int frames = 0;
  const auto page = view_page(simulation, {.frame_done = [&] { ++frames; }});
  REQUIRE(page);
  CHECK(frames == 12);
  CHECK_THAT(*page, contains_text("<title>pliant</title>"));
  CHECK(view_page(simulation, {.frames = FrameSpan{1, 12}}).value() == *page);
  const auto some = view_page(simulation, {.frames = FrameSpan{3, 5}});
  REQUIRE(some);
  CHECK(*some != *page);
  Simulation fresh = made();
  CHECK(view_page(fresh, {.frames = FrameSpan{3, 5}}).value() == *some);
}

TEST_CASE("a page that cannot be made is refused in one line", "[viewer][view_page]") {
  if (!viewer::page_template()) {
    CHECK_THAT(page_complaint({}), contains_text("this build has no viewer"));
    return;
  }
  for (const FrameSpan frames : {FrameSpan{0, 3}, FrameSpan{3, 13}, FrameSpan{4, 3}}) {
    CHECK_THAT(page_complaint({.frames = frames}), contains_text("the scene has frames 1 to 12"));
  }
  CHECK_THAT(page_complaint({.max_memory = 1000}),
             contains_text("a page of 12 frames of 169 vertices needs ") &&
                 Catch::Matchers::EndsWith("; choose fewer frames"));
  CHECK(page_complaint({.should_stop = [] { return true; }}) == "interrupted");
}

TEST_CASE("the file of a page appears whole or not at all", "[viewer][view_page]") {
  if (!viewer::page_template()) return;
  const ScratchFolder folder;
  const std::string file = folder.file("page.html").string();
  Simulation simulation = made();
  int asked = 0;
  const auto stopped =
      write_view_page(simulation, file, {.should_stop = [&] { return ++asked > 20; }});
  REQUIRE_FALSE(stopped);
  CHECK(stopped.error().code == ErrorCode::Interrupted);
  CHECK(folder.entry_count() == 0);
  REQUIRE(write_view_page(simulation, file));
  CHECK(read_file(file, 1 << 30).value() == view_page(simulation).value());
  const auto lost = write_view_page(simulation, folder.file("no/page.html").string());
  REQUIRE_FALSE(lost);
  CHECK(lost.error().code == ErrorCode::Unwritable);
}
