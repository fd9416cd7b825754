#include "pliant/scene/changes/changed_values.hpp"

#include <optional>
#include <random>
#include <string>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

namespace {

SceneChange some_change(std::mt19937& random) {
  const auto one_of = [&](const std::vector<std::string>& words) {
    return words[random() % words.size()];
  };
  constexpr SceneChange::Kind kinds[] = {SceneChange::Kind::Set, SceneChange::Kind::Times,
                                         SceneChange::Kind::Plus};
  return {kinds[random() % 3], one_of({"a", "b", ""}) + one_of({".", ".v", ".w", ""}) +
                                   one_of({"", ".x", ".y", ".progress", ".closed", ".", ".x.y"})};
}

}  // namespace

TEST_CASE("the first change of the same value is found", "[scene][change]") {
  std::mt19937 random(1);
  for (int round = 0; round < 3000; ++round) {
    ChangedValues values;
    std::vector<SceneChange> changes;
    for (int k = 0; k < 8; ++k) {
      const SceneChange change = some_change(random);
      std::optional<std::size_t> first;
      for (std::size_t n = changes.size(); n-- > 0;)
        if (change.overlaps(changes[n]) || changes[n].overlaps(change)) first = n;
      CAPTURE(change.typed());
      REQUIRE(values.add(change) == first);
      changes.push_back(change);
    }
  }
}
