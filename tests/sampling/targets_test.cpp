#include "pliant/sampling/targets.hpp"

#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

std::string text(const SurfaceTargets& targets) {
  std::string all;
  for (const auto& [force, group] : targets.forces) {
    all += std::to_string(force) + (group >= 0 ? "@" + std::to_string(group) : "") + ' ';
  }
  for (const std::size_t group : targets.groups) all += 'g' + std::to_string(group) + ' ';
  return all;
}

}  // namespace

TEST_CASE("targets are looked up by name, in the order of the scene", "[sampling][targets]") {
  Scene s = scene({sheet("a"), sheet("b"), sheet("c")},
                  {poke("all", {0, 0, 0}), poke("ca", {0, 0, 0}), poke("in_h", {0, 0, 0}),
                   poke("b_in_h", {0, 0, 0}), poke("in_g", {0, 0, 0})});
  s.forces[1].targets = {"c", "a", "c"};
  s.forces[2].group = s.forces[3].group = "h";
  s.forces[3].targets = {"b"};
  s.forces[4].group = "g";
  s.groups.push_back({.name = "g"});
  s.groups.push_back({.name = "h", .targets = {"b", "c"}});
  const std::vector<SurfaceTargets> targets = targets_of(s);
  REQUIRE(targets.size() == 3);
  CHECK(text(targets[0]) == "0 1 4@0 g0 ");
  CHECK(text(targets[1]) == "0 2@1 3@1 4@0 g0 g1 ");
  CHECK(text(targets[2]) == "0 1 2@1 4@0 g0 g1 ");
}
