// Another program writes the page of a scene, byte for byte as `pliant view` did.
// usage: page SCENE FIRST LAST OUT EXPECTED

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include <pliant/pliant.hpp>
#include <pliant/viewer/view_page.hpp>

namespace {

std::string bytes_of(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

int tell(const pliant::Error& error) {
  for (const std::string& line : pliant::to_lines(error)) std::puts(line.c_str());
  return 1;
}

}  // namespace

int main(int count, char* arguments[]) {
  if (count != 6) return 2;
  const auto scene = pliant::load_scene(arguments[1]);
  if (!scene) return tell(scene.error());
  auto simulation = pliant::Simulation::make(*scene);
  if (!simulation) return tell(simulation.error());
  const pliant::FrameSpan frames{std::atoi(arguments[2]), std::atoi(arguments[3])};
  const auto written = pliant::write_view_page(*simulation, arguments[4], {.frames = frames});
  if (!written) return tell(written.error());
  const std::string page = bytes_of(arguments[4]);
  return !page.empty() && page == bytes_of(arguments[5]) ? 0 : 1;
}
