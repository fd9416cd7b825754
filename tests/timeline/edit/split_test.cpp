#include "pliant/timeline/edit/split.hpp"

#include "pliant/timeline/compile.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "timeline/authoring.hpp"

namespace pliant::testing {
namespace {

timeline::Track<1> track_of(std::vector<Key<1>> keys) {
  return timeline::compile<1>({.keys = std::move(keys)})->curve.track;
}

TEST_CASE("handles are those of the keys", "[timeline][split]") {
  const auto track = track_of({key(0, 1, of_handle(2, 3)), key(8, 4, of_handle(-1, 5))});
  const auto handles = timeline::handles_of(track, 0);
  CHECK_THAT(handles.start.frames, WithinAbs(2, 1e-15));
  CHECK_THAT(handles.start.value[0], WithinAbs(3, 1e-15));
  CHECK_THAT(handles.end.frames, WithinAbs(1, 1e-15));
  CHECK_THAT(handles.end.value[0], WithinAbs(5, 1e-14));
  CHECK(handles.end.as_tangent(false).handle_frames == -handles.end.frames);
}

TEST_CASE("halves of a segment are joined to the whole", "[timeline][split]") {
  Whim whim(1);
  for (int round = 0; round < rounds(1000); ++round) {
    const auto whole = track_of({key(0, 1, of_handle(whim.between(0, 4), whim.between(-3, 3))),
                                 key(4, 2, of_handle(-whim.between(0, 4), whim.between(-3, 3)))});
    const double frame = whim.between(0.1, 3.9);
    const auto parts = timeline::split(whole, 0, frame);
    std::vector<Key<1>> keys = {
        key(0, 1), key(frame, whole.value(frame, timeline::Limit::At, 0)[0]), key(4, 2)};
    keys[0].out = parts.left.start.as_tangent(true);
    keys[1].in = parts.left.end.as_tangent(false);
    keys[1].out = parts.right.start.as_tangent(true);
    keys[2].in = parts.right.end.as_tangent(false);
    const auto joined = timeline::joined(track_of(keys), 0);
    const auto handles = timeline::handles_of(whole, 0);
    CAPTURE(round, frame);
    REQUIRE(joined);
    REQUIRE_THAT(joined->start.frames, WithinAbs(handles.start.frames, 1e-11));
    REQUIRE_THAT(joined->start.value[0], WithinAbs(handles.start.value[0], 1e-11));
    REQUIRE_THAT(joined->end.frames, WithinAbs(handles.end.frames, 1e-11));
    REQUIRE_THAT(joined->end.value[0], WithinAbs(handles.end.value[0], 1e-11));
    keys[1].value[0] += 1e-6;
    REQUIRE(!timeline::joined(track_of(keys), 0));
  }
}

}  // namespace
}  // namespace pliant::testing
