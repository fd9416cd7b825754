// Arbitrary JSON of operations: a list of operations, which is the same when written and read
// again, or an error; and what is read is made on a small scene, or refused.

#include <algorithm>

#include "pliant/document/document.hpp"
#include "pliant/document/operation_json.hpp"
#include "tiny_scene.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

constexpr std::size_t most_operations = 8;  // that are made
constexpr std::size_t longest_text = 1'000'000;

SceneDocument small_document() {
  return SceneDocument::from_text(R"(<scene start="1" end="9">
  <surface name="s"><grid columns="3" rows="3"/></surface>
  <point name="f" targets="s" center="0 0 0" deformationRadius="1">
    <animate attribute="magnitude"><key frame="1" value="1"/><key frame="5" value="2"/></animate>
  </point>
  <radial name="g" center="1 0 0"/>
</scene>
)",
                                  "fuzz.xml", "")
      .value();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  auto operations = parse_operations(text_of(bytes, size));
  if (!operations) return check_error(operations.error()), 0;
  const auto json = to_json(*operations);
  require(json.has_value());
  const auto again = parse_operations(*json);
  require(again.has_value() && again->size() == operations->size());
  require(to_json(*again).value() == *json);

  operations->resize(std::min(operations->size(), most_operations));
  SceneDocument document = small_document();
  for (const Operation& operation : *operations) {
    require(!described(operation).empty());
    const std::string before = document.text();
    const auto change = document.apply({operation});
    if (!change) check_error(change.error(), any_number);
    if (!change) require(document.text() == before);
    if (document.text().size() > longest_text) break;
  }
  while (document.can_undo()) require(document.undo().has_value());
  require(document.text() == small_document().text());
  return 0;
}
