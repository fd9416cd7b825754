#include "pliant/simulation/warnings.hpp"

#include "support/catch.hpp"

using namespace pliant;
using Catch::Matchers::Contains;

TEST_CASE("warnings come once a cause, with all its frames", "[simulation][warnings]") {
  WarningLog log;
  for (const int frame : {7, 5, 6, 9}) log.add(Warning::Kind::LostNodes, "sheet", "poke", frame);
  log.add(Warning::Kind::RegionTooSmall, "sheet", "poke", 2);
  log.add(Warning::Kind::LostNodes, "sheet", "other", 7);
  const auto warnings = log.warnings();
  REQUIRE(warnings.size() == 3);
  CHECK_THAT(
      warnings[0].message(),
      Contains("\"poke\" selects fewer than 3 x 3 nodes of \"sheet\"") && Contains("at frame 2"));
  CHECK_THAT(warnings[1].message(),
             Contains("\"other\" lost its own nodes on \"sheet\" at frame 7:"));
  CHECK_THAT(warnings[2].message(),
             Contains("\"poke\" lost its own nodes") && Contains("at frames 5-7, 9"));
}
