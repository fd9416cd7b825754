// Many operations of one edit, each of its own object.
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/document/document.hpp"
#include "pliant/scene/text/markup.hpp"
#include "support/catch.hpp"

namespace pliant::testing {
namespace {

/// Forces and groups laid out in several ways.
std::string many_objects(int count, const std::string& line_end) {
  std::string text = "<!-- a -->" + line_end + "<scene version='1' start='1' end='9'>" + line_end;
  text += " <surface name=\"sheet\"><grid columns=\"4\" rows=\"4\"/></surface>" + line_end;
  for (int k = 0; k < count; ++k) {
    switch (k % 5) {
      case 0:
        text += fmt::format("\t<point name='f{0}' magnitude=' 1'/> <!-- f{0} -->", k) + line_end;
        break;
      case 1:
        text += fmt::format("<point name=\"f{}\" center=\"0 0 0\"></point>", k);
        break;
      case 2:
        text += fmt::format(
            "{1}   <point name=\"f{0}\">{1}     <animate attribute=\"magnitude\">"
            "<key frame=\"1\" value=\"0.50\"/>{1}<key frame=\"4\" value=\"2\"/>"
            "</animate>{1}   </point>{1}",
            k, line_end);
        break;
      case 3:
        text += fmt::format(
            "  <group name=\"g{0}\">{1}    <radial name=\"f{0}\"{1}"
            "            magnitude=\"1\"/>{1}  </group>{1}",
            k, line_end);
        break;
      default:
        text += fmt::format(
            "  <define name=\"d{0}\" value=\"{0}\"/>{1}  <vortex name=\"f{0}\" "
            "magnitude=\"$d{0}\"/>{1}",
            k, line_end);
    }
  }
  return text + "</scene>" + line_end;
}

std::vector<Operation> many_operations(int count) {
  std::vector<Operation> operations;
  for (int k = 0; k < count; ++k) {
    const std::string channel = fmt::format("f{}.magnitude", k);
    CurveKeys<1> keys;
    for (const double frame : {1.0, 3.0, 4.0})
      keys.keys.push_back({.frame = frame, .value = {frame + k}});
    if (k % 2 == 0)
      operations.emplace_back(edit::SetCurve{channel, keys});
    else
      operations.emplace_back(edit::Set{channel, fmt::format("{}", k)});
    if (k % 3 == 0) operations.emplace_back(edit::Set{fmt::format("f{}.center.y", k), "2"});
  }
  return operations;
}

SceneDocument many_document(const std::string& text) {
  return SceneDocument::from_text(text, "a.xml", "").value();
}

TEST_CASE("many operations make the text that they make one by one", "[document]") {
  for (const char* line_end : {"\n", "\r\n"}) {
    const std::string text = many_objects(15, line_end);
    SceneDocument together = many_document(text), apart = many_document(text);
    const std::vector<Operation> operations = many_operations(15);
    const auto change = together.apply(operations);
    REQUIRE(change);
    for (const Operation& operation : operations) REQUIRE(apart.apply({operation}));
    CHECK(together.text() == apart.text());
    CHECK(together.scene() == apart.scene());

    std::string edited = text;
    for (const TextEdit& edit : change->edits) {
      REQUIRE(edited.compare(edit.at, edit.removed.size(), edit.removed) == 0);
      edited.replace(edit.at, edit.removed.size(), edit.inserted);
    }
    CHECK(edited == together.text());
    REQUIRE(together.undo());
    CHECK(together.text() == text);
  }
}

TEST_CASE("an operation among many that is refused is refused as if it were alone", "[document]") {
  const std::string text = many_objects(15, "\n");
  for (const Operation& wrong :
       {Operation(edit::Set{"f3.magnitudo", "1"}), Operation(edit::Set{"f99.magnitude", "1"}),
        Operation(edit::SetCurve{"f1.falloff", CurveKeys<1>{}})}) {
    SceneDocument alone = many_document(text), among = many_document(text);
    std::vector<Operation> operations = many_operations(15);
    operations.push_back(wrong);
    const auto expected = alone.apply({wrong}), refused = among.apply(operations);
    REQUIRE_FALSE(expected);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message == expected.error().message);
    CHECK(among.text() == text);
  }
}

}  // namespace
}  // namespace pliant::testing
