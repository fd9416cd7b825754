// Edits that are amended, dropped, undone and made again, and whole texts that replace others.

#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "pliant/document/document.hpp"
#include "pliant/document/text_edit.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/scene/read.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {
namespace {

std::string poked_text(const std::string& magnitude, const std::string& more = "") {
  return "<scene version='1' start='1' end='9'>\r\n  <point name='a' magnitude='" + magnitude +
         "'/>\r\n  <!-- ü -->" + more + "\r\n</scene>";
}

SceneDocument poked_scene() {
  return SceneDocument::from_text(poked_text("1"), "shot.xml", "").value();
}

edit::Set magnitude_to(const std::string& value) { return {"a.magnitude", value}; }

/// The text with the edits of a change made.
std::string with_edits(std::string text, const Change& change) {
  for (const TextEdit& edit : change.edits) {
    REQUIRE(text.compare(edit.at, edit.removed.size(), edit.removed) == 0);
    text.replace(edit.at, edit.removed.size(), edit.inserted);
  }
  return text;
}

double first_magnitude(const SceneDocument& document) {
  return document.scene().forces.at(0).magnitude.at(1)[0];
}

/// What a document must be, kept the slow way.
struct History {
  struct Step {
    std::string name, text;
    std::vector<Step> replaced;  // what could be made again before it
  };
  std::string first;
  std::vector<Step> done = {}, undone = {};  // the last of each is the next

  const std::string& text() const { return done.empty() ? first : done.back().text; }
  std::string text_before() const { return done.size() < 2 ? first : done[done.size() - 2].text; }
  void make(std::string name, std::string text) {
    done.push_back({std::move(name), std::move(text), std::exchange(undone, {})});
  }
  void drop() {
    undone = std::move(done.back().replaced);
    done.pop_back();
  }
  void amend(std::string name, std::string text) {
    drop();
    if (text != this->text()) make(std::move(name), std::move(text));
  }
  static void move(std::vector<Step>& from, std::vector<Step>& to) {
    to.push_back(std::move(from.back()));
    from.pop_back();
  }
};

TEST_CASE("a document's history is that of whole texts", "[document][random]") {
  std::mt19937 bits(7);
  const auto below = [&](int count) { return static_cast<int>(bits() % count); };
  for (int run = 0; run < rounds(40); ++run) {
    SceneDocument one = poked_scene();
    History model{.first = one.text()};
    for (int k = 0; k < 120; ++k) {
      const std::string before = one.text();
      const std::string name = "step " + std::to_string(k);
      const std::string value = std::to_string(1 + below(6));
      Result<Change> change = Change{};
      bool is_possible = true;
      switch (below(8)) {
        case 0:
        case 1:
          change = one.apply({magnitude_to(value)}, name);
          if (poked_text(value) != before) model.make(name, poked_text(value));
          break;
        case 2:
          change = one.replace(poked_text(value), name);
          if (poked_text(value) != before) model.make(name, poked_text(value));
          break;
        case 3:
          is_possible = !model.done.empty();
          change = one.amend({magnitude_to("2"), magnitude_to(value)}, name);
          if (is_possible) model.amend(name, poked_text(value));
          break;
        case 4:
          is_possible = !model.done.empty();
          change = one.drop();
          if (is_possible) model.drop();
          break;
        case 5:
          is_possible = !model.undone.empty();
          change = one.redo();
          if (is_possible) History::move(model.undone, model.done);
          break;
        case 6:  // refused
          is_possible = false;
          change = below(2) == 0 ? one.amend({magnitude_to(value), magnitude_to("x")})
                                 : one.replace("<scene>");
          break;
        default:
          is_possible = !model.done.empty();
          change = one.undo();
          if (is_possible) History::move(model.done, model.undone);
      }
      CAPTURE(run, k, before);
      REQUIRE(change.has_value() == is_possible);
      REQUIRE(one.text() == model.text());
      if (change) REQUIRE(with_edits(before, *change) == one.text());
      REQUIRE(first_magnitude(one) ==
              parse_scene(one.text(), "", "").value().forces[0].magnitude.at(1)[0]);
      REQUIRE(one.can_undo() == !model.done.empty());
      REQUIRE(one.can_redo() == !model.undone.empty());
      REQUIRE(one.undo_name() == (model.done.empty() ? "" : model.done.back().name));
      REQUIRE(one.redo_name() == (model.undone.empty() ? "" : model.undone.back().name));
    }
    for (; !model.done.empty(); model.done.pop_back()) REQUIRE(one.undo());
    CHECK(one.text() == model.first);
  }
}

TEST_CASE("a drag is one edit, and is taken back without a trace", "[document]") {
  SceneDocument one = poked_scene();
  REQUIRE(one.apply({magnitude_to("2")}, "first"));
  REQUIRE(one.apply({magnitude_to("3")}, "second"));
  REQUIRE(one.undo());
  REQUIRE(one.apply({magnitude_to("4")}, "drag"));
  for (const char* const value : {"5", "6", "7.5"}) {
    const std::string before = one.text();
    const auto change = one.amend({magnitude_to(value)}, "drag");
    REQUIRE(change);
    CHECK(with_edits(before, *change) == poked_text(value));
    CHECK(change->parts == std::vector<std::string>{"a.magnitude"});
  }
  CHECK(first_magnitude(one) == 7.5);
  CHECK(one.undo_name() == "drag");
  CHECK_FALSE(one.can_redo());
  const auto dropped = one.drop();
  REQUIRE(dropped);
  CHECK(dropped->name == "drag");
  CHECK(one.text() == poked_text("2"));
  CHECK(one.undo_name() == "first");
  CHECK(one.redo_name() == "second");
  REQUIRE(one.redo());
  CHECK(one.text() == poked_text("3"));
}

TEST_CASE("an amended edit that changes no byte is none", "[document]") {
  SceneDocument one = poked_scene();
  REQUIRE(one.apply({magnitude_to("2")}, "first"));
  REQUIRE(one.undo());
  for (const std::vector<Operation>& nothing :
       {std::vector<Operation>{}, std::vector<Operation>{magnitude_to("1")}}) {
    REQUIRE(one.apply({magnitude_to("4")}, "drag"));
    const std::string before = one.text();
    const auto change = one.amend(nothing);
    REQUIRE(change);
    CHECK(with_edits(before, *change) == poked_text("1"));
    CHECK_FALSE(one.can_undo());
    CHECK(one.redo_name() == "first");
  }
}

TEST_CASE("an amended edit names what both changed", "[document]") {
  SceneDocument one = poked_scene();
  REQUIRE(one.apply({magnitude_to("2")}));
  const auto change = one.amend({edit::Set{"a.forceRadius", "3"}});
  REQUIRE(change);
  CHECK(change->name == "set a.forceRadius");
  CHECK(change->parts == std::vector<std::string>{"a.forceRadius", "a.magnitude"});
  // The edit itself changes one of them.
  CHECK(one.undo().value().parts == std::vector<std::string>{"a.forceRadius"});
  CHECK(one.text() == poked_text("1"));
  // The same bytes again: nothing changes, but the name.
  REQUIRE(one.redo());
  const auto same = one.amend({edit::Set{"a.forceRadius", "3"}}, "again");
  REQUIRE(same);
  CHECK(same->edits.empty());
  CHECK(one.undo_name() == "again");
}

TEST_CASE("an amendment is all or nothing", "[document]") {
  SceneDocument one = poked_scene();
  CHECK(one.amend({magnitude_to("2")}).error().message == "there is nothing to amend");
  CHECK(one.drop().error().message == "there is nothing to undo");
  REQUIRE(one.apply({magnitude_to("2")}, "first"));
  CHECK_FALSE(one.amend({magnitude_to("3"), magnitude_to("x")}));
  CHECK_FALSE(one.amend({magnitude_to("3"), edit::Rename{"nobody", "b"}}));
  CHECK(one.text() == poked_text("2"));
  CHECK(one.undo_name() == "first");
  REQUIRE(one.undo());
  REQUIRE(one.redo());
  CHECK(one.text() == poked_text("2"));
}

TEST_CASE("what is amended is the last edit that is not undone", "[document]") {
  SceneDocument one = poked_scene();
  REQUIRE(one.apply({magnitude_to("2")}, "first"));
  REQUIRE(one.apply({magnitude_to("3")}, "second"));
  REQUIRE(one.undo());
  REQUIRE(one.amend({magnitude_to("4")}, "first, amended"));
  // What was made after it was made of another text.
  CHECK_FALSE(one.can_redo());
  REQUIRE(one.undo());
  CHECK(one.text() == poked_text("1"));
  CHECK(one.redo_name() == "first, amended");
}

TEST_CASE("an edit is amended and dropped after a save too", "[document]") {
  const ScratchFolder folder;
  const std::string file = (folder.path() / "shot.xml").string();
  REQUIRE(write_file(file, poked_text("1")));
  SceneDocument one = SceneDocument::open(file).value();
  REQUIRE(one.apply({magnitude_to("2")}));
  REQUIRE(one.save());
  REQUIRE(one.amend({magnitude_to("3")}));
  CHECK_FALSE(one.is_saved());
  REQUIRE(one.amend({magnitude_to("2")}));
  CHECK(one.is_saved());
  const std::string other = (folder.path() / "other.xml").string();
  REQUIRE(one.save_as(other));
  REQUIRE(one.amend({magnitude_to("4")}));
  CHECK(one.scene().origin.file == other);
  REQUIRE(one.drop());
  CHECK(one.text() == poked_text("1"));
  CHECK_FALSE(one.is_saved());
}

TEST_CASE("the caller's check counts for amendments and whole texts", "[document]") {
  DocumentOptions options;
  int count = 0;
  options.check = [&count](const Scene& scene) -> Result<void> {
    ++count;
    if (scene.forces[0].magnitude.at(1)[0] < 5) return {};
    return fail(ErrorCode::InvalidInput, "too strong");
  };
  SceneDocument one = SceneDocument::from_text(poked_text("1"), "a.xml", "", options).value();
  REQUIRE(one.apply({magnitude_to("2")}));
  count = 0;
  CHECK(one.amend({magnitude_to("6")}).error().message == "too strong");
  CHECK(one.replace(poked_text("7")).error().message == "too strong");
  CHECK(count == 2);
  CHECK(one.text() == poked_text("2"));
}

TEST_CASE("a whole text is one edit of what differs", "[document]") {
  SceneDocument one = poked_scene();
  const auto change = one.replace(poked_text("12"));
  REQUIRE(change);
  CHECK(change->name == "replace the text");
  CHECK(change->edits == std::vector<TextEdit>{{poked_text("1").find("'/>"), "", "2"}});
  CHECK(change->parts == std::vector<std::string>{"a"});
  const auto named = one.replace(
      "<scene version='1' start='1' end='8'><point name='b' magnitude='12'/></scene>", "load");
  REQUIRE(named);
  CHECK(named->parts == std::vector<std::string>{"a", "b", "scene"});
  CHECK(one.scene().forces[0].name == "b");
  CHECK(one.undo().value().name == "load");
  CHECK(one.text() == poked_text("12"));
  REQUIRE(one.redo());
  CHECK(one.scene().end == 8);
  // The same text is no edit; a comment is one of no object.
  REQUIRE(one.undo());
  CHECK(one.replace(one.text()).value().edits.empty());
  CHECK(one.redo_name() == "load");
  CHECK(one.replace(poked_text("12", "<!---->")).value().parts.empty());
  CHECK_FALSE(one.can_redo());
}

TEST_CASE("a text that cannot be read replaces none", "[document]") {
  SceneDocument one = poked_scene();
  for (const std::string wrong :
       {"", "<scene>", "<scene version='1' start='1' end='9'>\xC3</scene>"}) {
    const auto refused = one.replace(wrong);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().file == "shot.xml");
    CHECK(one.text() == poked_text("1"));
    CHECK_FALSE(one.can_undo());
  }
}

TEST_CASE("the difference of two texts keeps whole characters", "[document]") {
  using edit::difference;
  CHECK(difference("abc", "abc") == TextEdit{3, "", ""});
  CHECK(difference("", "abc") == TextEdit{0, "", "abc"});
  CHECK(difference("abab", "ab") == TextEdit{2, "ab", ""});
  CHECK(difference("aüb", "aöb") == TextEdit{1, "ü", "ö"});  // both begin with the same byte
  CHECK(difference("a\xC3\xBC", "a\xC4\xBC") == TextEdit{1, "\xC3\xBC", "\xC4\xBC"});
  CHECK(difference("ü", "üü") == TextEdit{2, "", "ü"});
  std::mt19937 bits(3);
  const std::string characters[] = {"a", "ü", "ö", "\xC4\xBC", "€", "₭", "𝄞", "𝄢"};
  const auto text = [&] {
    std::string made;
    for (auto k = bits() % 6; k > 0; --k) made += characters[bits() % 8];
    return made;
  };
  const auto starts = [](const std::string& of, std::size_t at) {
    return at == of.size() || (static_cast<unsigned char>(of[at]) & 0xC0U) != 0x80U;
  };
  for (int k = 0; k < 5000; ++k) {
    const std::string from = text(), to = text();
    const TextEdit edit = difference(from, to);
    CAPTURE(from, to);
    REQUIRE(edit::made(from, {edit}) == to);
    REQUIRE(starts(from, edit.at));
    REQUIRE(starts(from, edit.at + edit.removed.size()));
    REQUIRE(starts(to, edit.at + edit.inserted.size()));
  }
}

}  // namespace
}  // namespace pliant::testing
