#include "pliant/scene/text/defined_values.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;
using xml::DefinedValues;

TEST_CASE("a message names the definitions of the value that it is about", "[scene][expand]") {
  DefinedValues values;
  LineMap files("a.xml");
  const int rig = files.add_text("rig.xml", 0, 4);
  const auto w = values.add_definition("w", 0, 2), h = values.add_definition("h", rig, 3);
  values.add(5, "width", "-3", {w, h, w});
  values.add(5, "value", "1", {h});
  values.add(5, "value", "2", {w});
  values.add(6, "c", "4", {w});
  const auto told = [&](int line, std::string_view message) {
    return values.sources(line, message, files);
  };
  const std::string of_w = "; $w is defined at line 2";
  const std::string of_h = "; $h is defined at line 3 of rig.xml, included by a.xml:4";
  CHECK(told(5, "<grid> width=\"-3\": must be greater than 0") == of_w + of_h);
  CHECK(told(5, "<key> value=\"2\": not so") == of_w);
  CHECK(told(5, "<key> value=\"1\": not so") == of_h);
  // Another value, another line, another word.
  CHECK(told(5, "<key> value=\"3\": not so").empty());
  CHECK(told(7, "<grid> width=\"-3\": must be greater than 0").empty());
  CHECK(told(6, "s.c is -9, but must be greater") == of_w);
  CHECK(told(6, "s.cc and s.c2 and s.bc are wrong").empty());
  CHECK(told(6, "s.c") == of_w);
  CHECK(told(6, "<radial> has no attribute \"e\"; allowed: b, c").empty());
  CHECK(DefinedValues().sources(1, "s.c", files).empty());
}

TEST_CASE("the definitions behind values are few in memory and in messages", "[scene][expand]") {
  DefinedValues values;
  const LineMap files("a.xml");
  std::vector<std::uint32_t> many;
  for (int k = 0; k < 5; ++k)
    many.push_back(values.add_definition(std::string(1, static_cast<char>('a' + k)), 0, k + 1));
  values.add(1, "b", "1", many);
  for (std::size_t k = 1; k < DefinedValues::most_kept; ++k) values.add(2, "b", "1", {many[0]});
  values.add(3, "b", "1", {many[0]});
  CHECK(values.sources(1, "s.b", files) ==
        "; $a is defined at line 1; $b is defined at line 2; $c is defined at line 3");
  CHECK(values.sources(2, "s.b", files) == "; $a is defined at line 1");
  CHECK(values.sources(3, "s.b", files).empty());
  // A long line does not make each of its messages slow.
  DefinedValues crowd;
  const auto one = crowd.add_definition("one", 0, 1);
  for (int k = 0; k < 1000; ++k) crowd.add(1, "b", std::to_string(k), {one});
  CHECK(crowd.sources(1, "b=\"9\"", files) == "; $one is defined at line 1");
  CHECK(crowd.sources(1, "b=\"999\"", files).empty());
  std::uint32_t last = 0;
  for (std::size_t k = 0; k < DefinedValues::most_kept; ++k)
    last = values.add_definition("z", 0, 9);
  CHECK(values.sources(std::span(&last, 1), 0, files).empty());
}
