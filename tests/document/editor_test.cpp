#include "pliant/document/editor.hpp"

#include <string>

#include "pliant/scene/format/contents.hpp"
#include "support/catch.hpp"
#include "support/harbour.hpp"

namespace pliant::testing {
namespace {

TEST_CASE("elements that a description lists can be edited", "[document][contents]") {
  Harbour harbour;
  const std::vector<ElementFormat> formats = formats_of(xml::contents_of(harbour));
  auto draft = edit::Draft::make("<harbour>\n  <boat name=\"a\"/>\n</harbour>\n", "h.xml");
  REQUIRE(draft);
  const Scene none;
  edit::Editor editor(
      *draft, none, [](const std::string&) { return invalid(""); }, formats);
  const auto apply = [&](const Operation& operation) {
    const auto done = editor.apply(operation);
    return done ? std::string() : done.error().message;
  };
  CHECK(apply(edit::Set{"a.masts", "2"}).empty());
  CHECK(apply(edit::Set{"a.tension", "3"}).empty());
  CHECK(apply(edit::Animate{{"a.tension"}, 1}).empty());
  CHECK(draft->text() ==
        "<harbour>\n"
        "  <boat name=\"a\">\n"
        "    <rig masts=\"2\">\n"
        "      <animate attribute=\"tension\">\n"
        "        <key frame=\"1\" value=\"3\"/>\n"
        "      </animate>\n"
        "    </rig>\n"
        "  </boat>\n"
        "</harbour>\n");
  CHECK(apply(edit::Set{"a.sail", "1"}).find("allowed: name, tension, masts") != std::string::npos);
}

}  // namespace
}  // namespace pliant::testing
