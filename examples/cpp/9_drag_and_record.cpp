// What an editor does while a hand moves: a force is dragged over a scene file, each place solved
// anew, and then recorded from a frame on.
// usage: 9_drag_and_record SCENE, which has forces "poke" and "bulge" and a surface "sheet"

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <pliant/pliant.hpp>

#include "tell.hpp"

int main(int count, char* arguments[]) {
  if (count != 2) return 2;
  namespace edit = pliant::edit;
  auto document = pliant::SceneDocument::open(arguments[1]);
  if (!document) return tell(document.error());
  const std::string before = document->text();

  // What all simulations share: an edit then costs what it changes.
  pliant::Shelf shelf(std::size_t{256} << 20);
  pliant::MemoryStateStore store(std::size_t{256} << 20);
  const pliant::SimulationOptions options{.store = &store, .shelf = &shelf};
  const int frame = 20;

  // A drag is one step of undo: each place of the hand takes that of the one before.
  for (int k = 0; k < 10; ++k) {
    const std::string place = edit::to_text({0.125 * k, 0, 0.0625 * k});
    const std::vector<pliant::Operation> moved = {edit::Set{"poke.center", place}};
    auto step = k == 0 ? document->apply(moved, "drag poke") : document->amend(moved, "drag poke");
    if (!step) return tell(step.error());
    auto simulation = pliant::Simulation::make(document->scene(), options);
    if (!simulation) return tell(simulation.error());
    const auto shown = simulation->at(frame);
    if (!shown) return tell(shown.error());
    std::printf("poke at %s: %.3f at most\n", place.c_str(),
                shown->surface("sheet").peak_displacement());
  }

  // Recording begins at the frame that is shown, with the state of the surface there.
  auto simulation = pliant::Simulation::make(document->scene(), options);
  if (!simulation) return tell(simulation.error());
  const auto state = simulation->state_bytes(frame);
  if (!state) return tell(state.error());
  auto live = pliant::LiveSimulation::from_state(document->scene(), *state);
  if (!live) return tell(live.error());
  pliant::CurveKeys<1> recorded;
  const auto record = [&](int at, double value) {
    recorded.keys.push_back({.frame = static_cast<double>(at),
                             .value = {value},
                             .next = {.kind = pliant::Interpolation::Kind::Linear}});
  };
  record(frame - 1, 3200);  // the value until then, which the scene has for "bulge"
  for (int k = 0; k < 12; ++k) {
    const double strength = 6000 * std::sin(0.5 * k);
    if (auto set = live->set("bulge.magnitude", strength); !set) return tell(set.error());
    record(live->frame(), strength);
    if (auto done = live->advance(); !done) return tell(done.error());
  }
  const auto last = live->positions();
  if (!last) return tell(last.error());

  // The piece takes the place of the constant, and plays as it was seen.
  const double first_key = recorded.keys.front().frame, last_key = recorded.keys.back().frame;
  const auto spliced = document->apply(
      {edit::Splice{"bulge.magnitude", first_key, last_key, recorded}}, "record bulge.magnitude");
  if (!spliced) return tell(spliced.error());
  auto again = pliant::Simulation::make(document->scene(), options);
  if (!again) return tell(again.error());
  const auto played = again->at(live->frame());
  if (!played) return tell(played.error());
  const bool is_same = played->surface("sheet").positions() == last->surface("sheet").positions();
  std::printf("what was recorded %s\n", is_same ? "has the same bits" : "differs");

  // Two steps: the recording and the drag.
  for (int k = 0; k < 2; ++k)
    if (auto undone = document->undo(); !undone) return tell(undone.error());
  return is_same && document->text() == before ? 0 : 1;
}
