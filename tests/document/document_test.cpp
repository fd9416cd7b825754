#include "pliant/document/document.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>

#include "pliant/document/text_edit.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/read.hpp"
#include "support/catch.hpp"
#include "support/scene_values.hpp"
#include "support/scenes.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {
namespace {

const std::string text =
    "\xEF\xBB\xBF<scene version='1' start='1' end='9'>\r\n  <point name='a' magnitude='1.0'/>\r\n"
    "  <point name='b'/>\n</scene>";

SceneDocument document() { return SceneDocument::from_text(text, "shot.xml", "").value(); }

TEST_CASE("edits have names, and are taken back and made again", "[document]") {
  SceneDocument one = document();
  CHECK(one.undo_name().empty());
  CHECK_FALSE(one.undo());
  REQUIRE(one.apply({edit::Set{"a.magnitude", "2"}}));
  const std::string first = one.text();
  REQUIRE(one.apply({edit::Rename{"a", "c"}, edit::Set{"c.magnitude", "3"}}));
  const std::string second = one.text();
  REQUIRE(one.apply({edit::Delete{{"b"}}}, "tidy up"));
  CHECK(one.undo_name() == "tidy up");
  CHECK(one.undo().value().name == "tidy up");
  CHECK(one.redo_name() == "tidy up");
  CHECK(one.undo_name() == "rename a to c and 1 more");
  CHECK(one.text() == second);
  CHECK(one.undo().value().parts == std::vector<std::string>{"a", "c", "c.magnitude"});
  CHECK(one.undo_name() == "set a.magnitude");
  CHECK(one.text() == first);
  REQUIRE(one.undo());
  CHECK(one.text() == text);
  CHECK(one.scene().forces.at(0).magnitude.at(1)[0] == 1);
  CHECK_FALSE(one.can_undo());
  REQUIRE(one.redo());
  REQUIRE(one.redo());
  CHECK(one.text() == second);
  // A new edit: what was undone is lost.
  REQUIRE(one.apply({edit::Set{"b.magnitude", "4"}}));
  CHECK_FALSE(one.can_redo());
  CHECK_FALSE(one.redo());
}

TEST_CASE("several operations are made all or none", "[document]") {
  SceneDocument one = document();
  const auto change =
      one.apply({edit::Set{"a.magnitude", "2"}, edit::Rename{"b", "z"}, edit::Set{"z.to", "1"}});
  CHECK_FALSE(change);
  CHECK(one.text() == text);
  CHECK(one.scene().forces.at(1).name == "b");
  CHECK_FALSE(one.can_undo());
  // Only the whole must be right.
  REQUIRE(one.apply({edit::Set{"scene.start", "20"}, edit::Set{"scene.end", "30"}}));
  CHECK(one.scene().start == 20);
}

TEST_CASE("the caller's check counts", "[document]") {
  DocumentOptions options;
  options.check = [](const Scene& scene) -> Result<void> {
    if (scene.forces.size() < 3) return {};
    return fail(ErrorCode::InvalidInput, "too many forces");
  };
  SceneDocument one = SceneDocument::from_text(text, "shot.xml", "", options).value();
  const auto change = one.apply({edit::Add{"point", "c"}});
  REQUIRE_FALSE(change);
  CHECK(change.error().message == "too many forces");
  CHECK(one.text() == text);
}

TEST_CASE("what cannot be read is no document", "[document]") {
  CHECK_FALSE(SceneDocument::from_text("<scene>", "shot.xml", ""));
  CHECK_FALSE(SceneDocument::open("no/such/file.xml"));
  const auto negative = SceneDocument::from_text(
      "<scene version='1' start='1' end='9'><point name='a'><animate attribute='forceRadius'><key "
      "frame='1' value='1'/><key frame='9' value='-1'/></animate></point></scene>",
      "shot.xml", "");
  REQUIRE_FALSE(negative);
  CHECK_THAT(negative.error().message, contains_text("a.forceRadius at frame"));
}

TEST_CASE("a document is saved whole, and knows its file", "[document]") {
  const ScratchFolder folder;
  const std::string file = (folder.path() / "shot.xml").string();
  std::ofstream(file, std::ios::binary) << text;
  SceneDocument one = SceneDocument::open(file).value();
  CHECK(one.is_saved());
  REQUIRE(one.apply({edit::Set{"a.magnitude", "2"}}));
  CHECK_FALSE(one.is_saved());
  CHECK(read_file(file).value() == text);
  REQUIRE(one.save());
  CHECK(one.is_saved());
  CHECK(read_file(file).value() == one.text());
  CHECK_FALSE(one.has_file_changed().value());
  std::ofstream(file, std::ios::binary | std::ios::app) << "\n";
  CHECK(one.has_file_changed().value());
  REQUIRE(one.undo());
  CHECK_FALSE(one.is_saved());

  const std::string other = (folder.path() / "other.xml").string();
  REQUIRE(one.save_as(other));
  CHECK(one.file() == other);
  CHECK(one.scene().origin.file == other);
  CHECK(read_file(other).value() == text);
  CHECK_FALSE(one.save_as((folder.path() / "none" / "x.xml").string()));
  CHECK(one.file() == other);
}

TEST_CASE("a file that another program wrote is loaded as an edit", "[document]") {
  const ScratchFolder folder;
  const std::string file = folder.write("shot.xml", text);
  SceneDocument one = SceneDocument::open(file).value();
  CHECK(one.load().value().edits.empty());
  REQUIRE(one.apply({edit::Set{"a.magnitude", "2"}}));
  const std::string mine = one.text();
  std::string other = text;
  other.insert(other.find("<scene"), "<!-- theirs -->");
  folder.write("shot.xml", other);
  const auto loaded = one.load();
  REQUIRE(loaded);
  CHECK(loaded->name == "load");
  CHECK(one.text() == other);
  CHECK(one.is_saved());
  CHECK_FALSE(one.has_file_changed().value());
  REQUIRE(one.undo());
  CHECK(one.text() == mine);
  CHECK_FALSE(one.is_saved());
  REQUIRE(one.save());  // in place of what was loaded
  CHECK(read_file(file).value() == mine);

  folder.write("shot.xml", "<scene>");
  CHECK_FALSE(one.load());
  CHECK(one.text() == mine);
  CHECK(one.has_file_changed().value());
  std::filesystem::remove(file);
  CHECK_FALSE(one.load());
  CHECK(one.text() == mine);
}

TEST_CASE("a document reads the files that it includes again", "[document]") {
  const ScratchFolder folder;
  const auto part = [&](const std::string& magnitude) {
    folder.write("part.xml",
                 "<fragment><point name='b' magnitude='" + magnitude + "'/></fragment>");
  };
  part("1");
  const std::string file = folder.write(
      "shot.xml",
      "<scene version='1' start='1' end='9'><point name='a'/><include file='part.xml'/></scene>");
  SceneDocument one = SceneDocument::open(file).value();
  REQUIRE(one.apply({edit::Set{"a.magnitude", "2"}}));
  const auto magnitude = [&] { return one.scene().forces[1].magnitude.at(1)[0]; };
  part("7");
  CHECK(magnitude() == 1);
  REQUIRE(one.refresh());
  CHECK(magnitude() == 7);
  CHECK(one.undo_name() == "set a.magnitude");
  part("x");
  const auto refused = one.refresh();
  REQUIRE_FALSE(refused);
  CHECK(refused.error().file == (folder.path() / "part.xml").string());
  CHECK(magnitude() == 7);
  part("8");
  REQUIRE(one.amend({edit::Set{"a.magnitude", "3"}}));
  CHECK(magnitude() == 8);
}

TEST_CASE("messages name a document's new file, also beside included ones", "[document]") {
  const ScratchFolder folder;
  const std::string first = (folder.path() / "a.xml").string();
  const std::string other = (folder.path() / "b.xml").string();
  REQUIRE(write_file((folder.path() / "rig.xml").string(), "<point name='f'/>"));
  REQUIRE(write_file(first,
                     "<scene version='1' start='1' end='2'>\n<surface name='s'><grid columns='5' "
                     "rows='5'/></surface>\n<include file='rig.xml'/></scene>"));
  SceneDocument one = SceneDocument::open(first).value();
  REQUIRE(one.save_as(other));
  CHECK(one.scene().origin.place_of("s").file == other);
  CHECK(one.scene().origin.place_of("f").chain == "included by " + other + ":3");
}

TEST_CASE("relative files keep a document in its folder", "[document]") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.path() / "b");
  SceneDocument one = SceneDocument::from_text(
                          "<scene version='1' start='1' end='2'><surface name='s'><mesh "
                          "file='a.obj'/></surface></scene>",
                          (folder.path() / "a.xml").string(), folder.path().string())
                          .value();
  const auto saved = one.save_as((folder.path() / "b" / "a.xml").string());
  REQUIRE_FALSE(saved);
  CHECK_THAT(saved.error().message, contains_text("relative to its own folder"));
  CHECK_FALSE(std::filesystem::exists(folder.path() / "b" / "a.xml"));
  CHECK(one.save_as((folder.path() / "c.xml").string()));
}

TEST_CASE("a link is saved to the file that it leads to, if that is wanted", "[document]") {
  const ScratchFolder folder;
  std::filesystem::create_directory(folder.path() / "real");
  const std::filesystem::path file = folder.path() / "real" / "a.xml";
  const std::string link = (folder.path() / "link.xml").string();
  const std::string plain = "<scene version='1' start='1' end='2'><point name='a'/></scene>";
  REQUIRE(write_file(file, plain));
  std::filesystem::create_symlink("real/a.xml", link);
  {
    SceneDocument one = SceneDocument::open(link).value();
    REQUIRE(one.apply({edit::Set{"a.magnitude", "2"}}));
    for (const auto& saved : {one.save(), one.save_as(link)}) {
      REQUIRE_FALSE(saved);
      CHECK_THAT(saved.error().message, contains_text("symbolic link"));
    }
    CHECK(*read_file(file) == plain);
  }
  SceneDocument one = SceneDocument::open(link, {.follows_links = true}).value();
  REQUIRE(one.apply({edit::Set{"a.magnitude", "2"}}));
  REQUIRE(one.save());
  CHECK(*read_file(file) == one.text());
  REQUIRE(one.undo());
  REQUIRE(one.save_as(link));
  CHECK(*read_file(file) == plain);
  CHECK(std::filesystem::is_symlink(link));
  CHECK(one.file() == link);
  CHECK(one.folder() == folder.path().string());
}

TEST_CASE("a scene made in code is saved to a file", "[document]") {
  const ScratchFolder folder;
  const Scene made = scene({sheet("s")}, {poke("f", {0, 0, 0})});
  const std::string file = (folder.path() / "made.xml").string();
  REQUIRE(save_scene(made, file));
  CHECK(SceneValues(load_scene(file).value()) == SceneValues(made));
}

TEST_CASE("numbers are written with the fewest digits that are the same", "[document]") {
  CHECK(edit::to_text(0.1) == "0.1");
  CHECK(edit::to_text(8000.0) == "8000");
  CHECK(edit::to_text({1, -0.5, 1e300}) == "1 -0.5 1e+300");
  CHECK(edit::to_text(true) == "true");
  for (const double number : {1.0 / 3, 5e-324, std::numeric_limits<double>::max(), -0.0})
    CHECK(std::strtod(edit::to_text(number).c_str(), nullptr) == number);
}

TEST_CASE("a batch of edits is reversed by its reverse", "[document]") {
  const edit::EditBatch batch = {{0, "", "<<"}, {1, "bc", ""}, {4, "e", "longer"}, {5, "", "!"}};
  const std::string before = "abcde";
  const std::string now = edit::made(before, batch);
  CHECK(now == "<<adlonger!");
  CHECK(edit::made(now, edit::reversed(batch)) == before);
  CHECK(edit::reversed(edit::reversed(batch)) == batch);
}

}  // namespace
}  // namespace pliant::testing
