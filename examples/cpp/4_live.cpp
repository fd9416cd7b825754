// Plays a surface live, as a game or an installation does: the program moves a force from frame to
// frame, with no last frame. What was played is then baked as a scene, with the same bits.

#include <cmath>
#include <cstdio>

#include <pliant/pliant.hpp>

#include "tell.hpp"

int main() {
  pliant::Scene scene;
  pliant::Surface sheet;
  sheet.name = "sheet";
  sheet.shape = pliant::GridSheet{.columns = 41, .rows = 41, .width = 8, .depth = 8};
  sheet.material.density = 0.05;
  sheet.solver.release = pliant::Release::Recover;  // what is let go springs back
  scene.surfaces = {sheet};
  pliant::Force finger;
  finger.name = "finger";
  finger.deformation_radius = 2.5;
  finger.force_radius = 1;
  scene.forces = {finger};

  // A program that needs no scene of it leaves `records` out: then nothing grows.
  auto live = pliant::LiveSimulation::make(scene, {.simulation = {.threads = 2}, .records = true});
  if (!live) return tell(live.error());

  pliant::Frame shown;  // its memory is used again
  for (int step = 0; step < 60; ++step) {
    // What a hand or a sensor would say: a circle, pressed in its first half.
    const double angle = 0.1 * step;
    const pliant::Value<3> at = {2 * std::cos(angle), 0, 2 * std::sin(angle)};
    if (auto set = live->set("finger.center", at); !set) return tell(set.error());
    if (auto set = live->set("finger.magnitude", step < 30 ? -4000 : 0); !set) {
      return tell(set.error());
    }
    if (auto done = live->advance(); !done) return tell(done.error());
    auto frame = live->positions(std::move(shown));
    if (!frame) return tell(frame.error());
    shown = *std::move(frame);
    if (step % 10 == 9) {
      std::printf("frame %2d: %.3f at most\n", shown.number(),
                  shown.surface("sheet").peak_displacement());
    }
  }

  // The same as a scene with keys: an animator can open it, and its last frame is the one shown.
  const auto performance = live->performance();
  if (!performance) return tell(performance.error());
  auto simulation = pliant::Simulation::make(*performance);
  if (!simulation) return tell(simulation.error());
  const auto last = simulation->at(live->frame());
  if (!last) return tell(last.error());
  const bool is_same = last->surface("sheet").positions() == shown.surface("sheet").positions();
  std::printf("the scene that was played %s\n", is_same ? "has the same bits" : "differs");
  return is_same ? 0 : 1;
}
