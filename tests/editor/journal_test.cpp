#include "editor/journal.hpp"

#include <csignal>
#include <filesystem>
#include <string>
#include <thread>

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using editor::Journal;

namespace {

std::string only_file_in(const std::string& folder) {
  return std::filesystem::directory_iterator(folder)->path().string();
}

}  // namespace

TEST_CASE("a journal keeps the last text until it is cleared", "[editor][journal]") {
  const testing::ScratchFolder folder;
  const std::string place = folder.file("state").string();
  {
    auto journal = Journal::open(place, "/scenes/a.xml");
    REQUIRE(journal);
    CHECK_FALSE(journal->left());
    REQUIRE(journal->write("one"));
    REQUIRE(journal->write("two \"\n\xc3\xbc"));
    CHECK(only_file_in(place).ends_with(".json"));
  }
  CHECK((std::filesystem::status(place).permissions() & std::filesystem::perms::mask) ==
        std::filesystem::perms::owner_all);
  auto journal = Journal::open(place, "/scenes/a.xml");
  REQUIRE(journal);
  REQUIRE(journal->left());
  CHECK(journal->left()->text == "two \"\n\xc3\xbc");
  CHECK(journal->left()->time.size() == std::string("2026-01-01T00:00:00Z").size());
  CHECK_FALSE(Journal::open(place, "/scenes/b.xml")->left());
  journal->take_left();
  journal->clear();
  CHECK(std::filesystem::is_empty(place));
  CHECK_FALSE(Journal::open(place, "/scenes/a.xml")->left());
}

TEST_CASE("all that was left stays until it is taken, whatever is written", "[editor][journal]") {
  const testing::ScratchFolder folder;
  const auto open = [&] { return Journal::open(folder.path().string(), "a").value(); };
  // A crash after another one, and then a third.
  for (const char* text : {"first", "second", "third"}) {
    Journal journal = open();
    journal.clear();
    REQUIRE(journal.write("not yet"));
    REQUIRE(journal.write(text));
  }
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 3);
  REQUIRE(Journal::open(folder.path().string(), "b")->write("of another document"));
  {
    Journal journal = open();
    REQUIRE(journal.left());
    CHECK(journal.left()->text == "third");
    journal.take_left();
    CHECK(journal.left()->text == "second");
    journal.forget_left();
    CHECK(journal.left()->text == "first");
  }
  Journal journal = open();
  CHECK(journal.left()->text == "second");
  journal.take_left("first");
  CHECK(journal.left()->text == "second");
  journal.take_left();
  CHECK_FALSE(journal.left());
  CHECK_FALSE(open().left());
}

TEST_CASE("a command that still runs has its journal for itself", "[editor][journal]") {
  const testing::ScratchFolder folder;
  const auto open = [&] { return Journal::open(folder.path().string(), "a").value(); };
  int told[2];
  REQUIRE(pipe(told) == 0);
  const pid_t child = fork();
  if (child == 0) {
    const bool is_written = open().write("theirs").has_value();
    (void)!write(told[1], is_written ? "y" : "n", 1);
    for (;;) pause();
  }
  char answer = 0;
  REQUIRE(read(told[0], &answer, 1) == 1);
  CHECK(answer == 'y');
  {
    Journal journal = open();
    CHECK_FALSE(journal.left());
    REQUIRE(journal.write("ours"));
    CHECK(open().left()->text == "ours");
    journal.clear();
  }
  CHECK_FALSE(open().left());
  kill(child, SIGKILL);
  // Also before somebody has asked how it ended.
  while (!open().left()) std::this_thread::yield();
  waitpid(child, nullptr, 0);
  CHECK(open().left()->text == "theirs");
  close(told[0]);
  close(told[1]);
}

TEST_CASE("another process with the number of a command that ended is not that command",
          "[editor][journal]") {
  const testing::ScratchFolder folder;
  REQUIRE(Journal::open(folder.path().string(), "a")->write("text"));
  const std::string file = only_file_in(folder.path().string());
  std::string text = *read_file(file);
  const std::string own = "\"process\":" + std::to_string(getpid());
  REQUIRE(text.find(own) != std::string::npos);
  text.replace(text.find(own), own.size(), "\"process\":" + std::to_string(getppid()));
  REQUIRE(write_file(file, text));
  Journal journal = Journal::open(folder.path().string(), "a").value();
  REQUIRE(journal.left());
  CHECK(journal.left()->text == "text");
  journal.clear();
  CHECK(*read_file(file) == text);
}

TEST_CASE("a journal that is damaged or of another document is none", "[editor][journal]") {
  const testing::ScratchFolder folder;
  REQUIRE(Journal::open(folder.path().string(), "a")->write("text"));
  const std::string file = only_file_in(folder.path().string());
  const std::string whole = *read_file(file);
  for (std::size_t size = 0; size < whole.size(); ++size) {
    REQUIRE(write_file(file, whole.substr(0, size)));
    CHECK_FALSE(Journal::open(folder.path().string(), "a")->left());
  }
  for (const char* text : {R"([])", R"({})", R"(7)",
                           R"({"document":"b","process":1,"began":"b","text":"t","time":"t"})",
                           R"({"document":"a","process":"1","began":"b","text":"t","time":"t"})",
                           R"({"document":"a","process":1,"began":"b","text":7,"time":"t"})",
                           R"({"document":"a","process":1,"began":"b","text":"t"})"}) {
    REQUIRE(write_file(file, text));
    CHECK_FALSE(Journal::open(folder.path().string(), "a")->left());
  }
}

TEST_CASE("a folder that cannot be made has no journals", "[editor][journal]") {
  const testing::ScratchFolder folder;
  const auto file = folder.write("file", "");
  const auto journal = Journal::open((file / "edit").string(), "a");
  REQUIRE_FALSE(journal);
  CHECK(journal.error().code == ErrorCode::Unwritable);
}
