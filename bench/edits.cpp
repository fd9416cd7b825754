// Measures what a host pays for an edit while it is dragged: the centre of a force goes along a
// circle, and each place is a scene of its own, simulated with the shelf, the store in memory and
// the simulation of the scene before. Square sheets of 20 x 20 with three forces, 96 frames.
//
//   case     nodes on a side; `box`: all of the sheet is the region; `islands`: at most 61 x 61;
//            `keys`: 100 for each force, over 10 000 frames; `mesh`: an even grid as a mesh in
//            memory; `faces`: the same, read as a surface of triangles; `skin`: 301 x 301
//            vertices are driven by it
//   anew     making the simulation and its first frame, with nothing of the one before [ms]
//   made     the same, with all of it [ms]
//   frame    each further frame, without a store [ms]
//   stored   the same with a store in memory, which is written [ms]
//   share    of `stored` that the store takes, the median of the edits
//
// Medians over the edits. Run: build/release/bench/edits [--edits N]

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "measuring.hpp"
#include "pliant/pliant.hpp"

namespace {

using namespace pliant;

constexpr int frame_count = 96;

struct Case {
  std::string name;
  int side;
  Combine combine;
  double radius;  // of each region [length]
  int keys = 3;   // of each magnitude
  bool is_mesh = false;
  bool has_skin = false;
  UvReading reading = UvReading::Auto;
};

Scene make_scene(const Case& of, double angle) {
  Scene scene;
  scene.end = std::max(frame_count, 100 * of.keys);
  Surface sheet;
  sheet.name = "sheet";
  sheet.shape = GridSheet{.columns = of.side, .rows = of.side, .width = 20, .depth = 20};
  sheet.material.density = 40.0;
  sheet.material.damping = 20.0;
  sheet.solver.combine = of.combine;
  if (of.is_mesh) sheet.shape = make_mesh(std::get<GridSheet>(sheet.shape));
  sheet.reading.uv = of.reading;
  scene.surfaces.push_back(std::move(sheet));
  if (of.has_skin) {
    Surface skin;
    skin.name = "skin";
    skin.driven_by = "sheet";
    skin.shape = make_mesh(GridSheet{.columns = 301, .rows = 301, .width = 19, .depth = 19});
    scene.surfaces.push_back(std::move(skin));
  }
  CurveKeys<1> magnitude;
  for (int k = 0; k < of.keys; ++k)
    magnitude.keys.push_back({.frame = 1.0 + 12 * k, .value = {k % 2 == 0 ? 0.0 : 8000.0}});
  const std::vector<Value<3>> centers = {
      {-5 + std::cos(angle), 0, -5 + std::sin(angle)}, {5, 0, -5}, {0, 0, 5}};
  for (std::size_t k = 0; k < centers.size(); ++k) {
    Force force;
    force.name = fmt::format("poke{}", k);
    force.kind = PointChannels{.center = centers[k]};
    force.magnitude = Curve<1>::make(magnitude).value();
    force.deformation_radius = of.radius;
    force.force_radius = of.radius / 2;
    scene.forces.push_back(std::move(force));
  }
  return scene;
}

// The milliseconds of a part of one edit.
struct Edit {
  double made = 0;
  double frame = 0;
};

struct Kept {
  Shelf shelf{std::size_t{1} << 30};
  std::optional<MemoryStateStore> store;
  std::optional<Simulation> before;
};

// Plays a scene as a host does after an edit.
Edit play(Scene scene, Kept* kept, bool use_store) {
  SimulationOptions options;
  if (kept) {
    options.shelf = &kept->shelf;
    if (use_store) options.store = &kept->store.emplace(std::size_t{1} << 30);
  }
  std::optional<Simulation> simulation;
  Frame frame;
  Edit edit;
  edit.made = 1e3 * seconds([&] {
                simulation = value_or_abort(Simulation::make(std::move(scene), options));
                frame = value_or_abort(simulation->at(1));
              });
  edit.frame = 1e3 / (frame_count - 1) * seconds([&] {
                 for (int at = 2; at <= frame_count; ++at)
                   frame = value_or_abort(simulation->at(at, std::move(frame)));
               });
  if (kept) kept->before = std::move(simulation);
  return edit;
}

void measure(const Case& of, int edits) {
  std::vector<double> anew, made, plain, stored, share;
  Kept kept;
  play(make_scene(of, 0), &kept, false);
  for (int n = 1; n <= edits; ++n) {
    const Scene scene = make_scene(of, 0.1 * n);
    anew.push_back(play(scene, nullptr, false).made);
    const Edit without = play(scene, &kept, false), with = play(scene, &kept, true);
    made.push_back(without.made);
    plain.push_back(without.frame);
    stored.push_back(with.frame);
    share.push_back(1 - without.frame / with.frame);
  }
  fmt::print("{:>12} {:>8.2f} {:>8.2f} {:>8.2f} {:>8.2f} {:>7.2f}\n", of.name, typical(anew, false),
             typical(made, false), typical(plain, false), typical(stored, false),
             typical(share, false));
}

}  // namespace

int main(int count, char* arguments[]) {
  int edits = 15;
  if (!read_options(count, arguments, {{"--edits", &edits}}, "edits [--edits N]")) return 2;
  fmt::print("{:>12} {:>8} {:>8} {:>8} {:>8} {:>7}\n", "case", "anew", "made", "frame", "stored",
             "share");
  measure({"61 box", 61, Combine::Box, 12}, edits);
  measure({"201 islands", 201, Combine::Islands, 2.9}, edits);
  measure({"201 keys", 201, Combine::Islands, 2.9, 100}, edits);
  measure({"201 mesh", 201, Combine::Islands, 2.9, 3, true}, edits);
  measure({"201 faces", 201, Combine::Islands, 2.9, 3, true, false, UvReading::Surface}, edits);
  measure({"201 skin", 201, Combine::Islands, 2.9, 3, false, true}, edits);
  return 0;
}
