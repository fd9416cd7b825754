#include "pliant/sweep/folder.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "pliant/core/text.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/sweep/log.hpp"
#include "pliant/sweep/watch.hpp"
#include "support/catch.hpp"
#include "support/sanitized.hpp"
#include "support/scratch_folder.hpp"
#include "support/stopping.hpp"

using namespace pliant;
using namespace pliant::testing;
namespace fs = std::filesystem;

namespace {

constexpr std::string_view shot = R"(<scene version="1" start="1" end="6">
  <include file="rig.xml"/>
  <point name="poke" center="0 0 0" deformationRadius="4" forceRadius="2" magnitude="900"/>
</scene>)";
constexpr std::string_view rig = R"(<fragment>
  <surface name="sheet"><grid columns="9" rows="9" width="8" depth="8"/></surface>
</fragment>)";

// A folder with a scene, and what is asked of it.
class Place {
 public:
  Place() {
    folder_.write("shot.xml", shot);
    folder_.write("rig.xml", rig);
  }

  SweepRequest request(const std::vector<std::string>& vary = {"sheet.density=1,2,3",
                                                               "poke.magnitude*=1,2"}) const {
    return {.scenes = {folder_.file("shot.xml").string()}, .variation = {.vary = vary}};
  }
  std::string sweep() const { return folder_.file("sweep").string(); }
  std::string table() const { return read_file(folder_.file("sweep/takes.csv")).value(); }
  std::string log() const {
    std::string all;
    for (const auto& entry : fs::directory_iterator(folder_.file("sweep/log")))
      all += read_file(entry.path()).value();
    return all;
  }
  const ScratchFolder& folder() const { return folder_; }

 private:
  ScratchFolder folder_;
};

std::string finish(const Place& place, const SweepFolder& folder) {
  REQUIRE(folder.write_table(folder.status().value()));
  return place.table();
}

std::string undisturbed_table(const SweepRequest& request) {
  const ScratchFolder scratch;
  const auto folder = SweepFolder::make(scratch.file("sweep").string(), request).value();
  REQUIRE(folder.run({}));
  REQUIRE(folder.write_table(folder.status().value()));
  return read_file(scratch.file("sweep/takes.csv")).value();
}

std::string complaint_of(const Result<SweepFolder>& folder) {
  REQUIRE_FALSE(folder);
  return folder.error().message;
}

}  // namespace

TEST_CASE("the table has the same bytes whatever ran it", "[sweep][threads]") {
  const Place place;
  const SweepRequest request = place.request();
  const std::string wanted = undisturbed_table(request);
  CHECK(std::count(wanted.begin(), wanted.end(), '\n') == 7);
  const auto folder = SweepFolder::make(place.sweep(), request).value();
  const int way = GENERATE(0, 1, 2, 3);
  if (way == 0) REQUIRE(folder.run({.threads = 3}));
  if (way == 1) {  // parts, in any order
    for (const std::size_t part : {2u, 0u, 3u, 1u}) REQUIRE(folder.run({.part = {part, 4}}));
  }
  if (way == 2) {  // interrupted again and again
    for (int n = 0; n < 20 && folder.status()->missing() > 0; ++n) {
      std::atomic<int> count = 0;
      CHECK((folder.run({.threads = 2,
                         .should_stop = [&] { return count > 0; },
                         .take_done = [&](const TakeOutcome&) { ++count; }}) ||
             count > 0));
    }
  }
  if (way == 3) {  // by two that know nothing of each other
    const auto other = SweepFolder::open(place.sweep()).value();
    std::atomic<int> count = 0;
    CHECK_FALSE(folder.run({.should_stop = [&] { return count > 1; },
                            .take_done = [&](const TakeOutcome&) { ++count; }}));
    REQUIRE(other.run({}));
  }
  CHECK(finish(place, folder) == wanted);
}

TEST_CASE("takes run the text that the sweep was made of", "[sweep]") {
  const Place place;
  const SweepRequest request = place.request();
  const std::string wanted = undisturbed_table(request);
  REQUIRE(SweepFolder::make(place.sweep(), request));
  fs::remove(place.folder().file("rig.xml"));
  place.folder().write("shot.xml", "nothing");
  const auto folder = SweepFolder::open(place.sweep()).value();
  REQUIRE(folder.run({}));
  CHECK(finish(place, folder) == wanted);
}

TEST_CASE("what is no whole line counts for nothing", "[sweep]") {
  const Place place;
  const auto folder = SweepFolder::make(place.sweep(), place.request()).value();
  REQUIRE(folder.run({}));
  const std::string wanted = finish(place, folder);
  const std::string line = place.log().substr(0, place.log().find('\n') + 1);
  for (std::size_t length = 0; length < line.size(); ++length) {
    LogLine read;
    CHECK_FALSE(read_line(
        line.substr(0, length > 0 && length == line.size() - 1 ? length - 1 : length), read));
  }
  place.folder().write("sweep/log/other.jsonl", line.substr(0, line.size() / 2) + "\n\n{}\nnull\n" +
                                                    std::string(9, '\0') + "\n{\"take\":99999}\n" +
                                                    line.substr(0, 20));
  CHECK(finish(place, folder) == wanted);
  CHECK(folder.status()->is_complete());
}

TEST_CASE("a file that is no log is told by its line, however large it is", "[sweep]") {
  const Place place;
  const auto folder = SweepFolder::make(place.sweep(), place.request()).value();
  REQUIRE(folder.run({.part = {0, 2}}));
  const auto file = place.folder().file("sweep/log/other.jsonl");
  for (const std::string text : {"{}\n", ""}) {
    place.folder().write("sweep/log/other.jsonl", text);
    fs::resize_file(file, std::uintmax_t{1} << 40U);
    std::size_t calls = 0;
    const auto status = folder.status([&] { return ++calls, false; });
    REQUIRE_FALSE(status);
    CHECK(status.error().code == ErrorCode::InvalidInput);
    CHECK(status.error().file == file.string());
    CHECK(status.error().line == (text.empty() ? 1 : 2));
    CHECK_THAT(status.error().message, contains_text("the file is not the log of a sweep"));
    CHECK(calls < 20);
  }
  // Zeros that a power cut leaves at the end are no whole line.
  place.folder().write("sweep/log/other.jsonl", "{}\n" + std::string(4096, '\0'));
  CHECK(folder.status()->done == 3);
  place.folder().write("sweep/log/other.jsonl", std::string(1'000'000, '[') + "\n");
  CHECK(folder.status()->done == 3);
}

TEST_CASE("reading the log ends when asked", "[sweep]") {
  const Place place;
  const auto folder = SweepFolder::make(place.sweep(), place.request()).value();
  REQUIRE(folder.run({}));
  const auto status = folder.status([] { return true; });
  REQUIRE_FALSE(status);
  CHECK(status.error().code == ErrorCode::Interrupted);
}

TEST_CASE("making a sweep, opening it and writing its table end when asked", "[sweep]") {
  const Place place;
  SweepRequest request =
      place.request({"sheet.density=1:2", "sheet.damping=1:2", "poke.magnitude=1:2"});
  request.variation.samples = 30'000;
  const auto made = place.folder().file("over/there");
  check_stops(
      [&](const StopRequest& should_stop) {
        fs::remove_all(made.parent_path());
        return SweepFolder::make(made.string(), request, should_stop);
      },
      100, [&] { CHECK_FALSE(fs::exists(made.parent_path())); });
  const auto folder = SweepFolder::make(place.sweep(), request).value();
  constexpr int quarter = 1 << 18;
  check_stops(
      [&](const StopRequest& should_stop) { return SweepFolder::open(place.sweep(), should_stop); },
      static_cast<int>(fs::file_size(place.folder().file("sweep/sweep.json"))) / quarter);
  const auto status = folder.status().value();
  check_stops(
      [&](const StopRequest& should_stop) {
        fs::remove(place.folder().file("sweep/takes.csv"));
        return folder.write_table(status, should_stop);
      },
      2, [&] { CHECK_FALSE(fs::exists(place.folder().file("sweep/takes.csv"))); });
  std::string table = "sheet.density,poke.magnitude\n";
  for (int row = 0; row < 60'000; ++row) table += "1.5,\"2\"\n";
  check_stops(
      [&](const StopRequest& should_stop) { return Takes::make({.table = table}, should_stop); },
      2);
}

TEST_CASE("a sweep that cannot be written leaves no folder", "[sweep]") {
  const Place place;
  const SweepRequest request = place.request();
  place.folder().write("plain", "");
  for (const char* name : {"plain/over/there", "plain"}) {
    CHECK_FALSE(SweepFolder::make(place.folder().file(name).string(), request));
    CHECK(fs::is_regular_file(place.folder().file("plain")));
  }
}

TEST_CASE("an error of a take has its place, in the table without folders", "[sweep]") {
  Error error{.message = "is wrong", .file = "/over/there/shot.xml", .line = 7};
  CHECK(error_text(error, Folders::With) == "/over/there/shot.xml:7: is wrong");
  CHECK(error_text(error, Folders::Without) == "shot.xml:7: is wrong");
  error.others.push_back({.message = "cannot be read", .file = "/over/a.obj"});
  error.others.push_back({.message = "is odd"});
  CHECK(error_text(error, Folders::Without) ==
        "shot.xml:7: is wrong; a.obj: cannot be read; is odd");
  // A line of the log has a limit, and a name may have any length.
  std::string name = "x";
  while (name.size() < 300'000) name += "\u00e9";
  error.message = name;
  const std::string text = error_text(error, Folders::With);
  CHECK(text.size() <= longest_error_text);
  CHECK(text.size() > longest_error_text - 8);
  CHECK(is_utf8(text));
  LogLine line;
  REQUIRE(read_line(to_line({.take = 3, .measures = fail(error)}), line));
  CHECK(line.full_error == text);
}

TEST_CASE("different hashes of a take are found, with both hosts", "[sweep]") {
  const Place place;
  const auto folder = SweepFolder::make(place.sweep(), place.request()).value();
  REQUIRE(folder.run({}));
  const std::string wanted = finish(place, folder);
  std::string line = place.log().substr(0, place.log().find('\n') + 1);
  LogLine read;
  REQUIRE(read_line(line, read));
  const auto put = [&](std::string_view name, const std::string& value) {
    const std::string begin = "\"" + std::string(name) + "\":\"";
    const std::size_t at = line.find(begin) + begin.size();
    line.replace(at, line.find('"', at) - at, value);
  };
  put("host", "brokenhost");
  put("hash", std::string(32, 'f'));
  place.folder().write("sweep/log/z.jsonl", line);
  const auto status = folder.status().value();
  REQUIRE(status.conflicts.size() == 1);
  CHECK(status.conflicts[0].take == read.take);
  CHECK(
      (status.conflicts[0].host == "brokenhost" || status.conflicts[0].other_host == "brokenhost"));
  CHECK_FALSE(status.is_complete());
  CHECK(finish(place, folder) == wanted);
  // The same whichever line comes first.
  fs::rename(place.folder().file("sweep/log/z.jsonl"), place.folder().file("sweep/log/0.jsonl"));
  CHECK(finish(place, folder) == wanted);
}

TEST_CASE("failed takes are run again only if asked", "[sweep]") {
  const Place place;
  const auto folder =
      SweepFolder::make(place.sweep(), place.request({"sheet.c=-5,2", "sheet.d=1,9"})).value();
  REQUIRE(folder.run({}));
  CHECK(folder.status()->failed == 1);
  std::size_t count = 9;
  REQUIRE(folder.run({.begin = [&](std::size_t n) { count = n; }}));
  CHECK(count == 0);
  REQUIRE(folder.run({.retry = true, .begin = [&](std::size_t n) { count = n; }}));
  CHECK(count == 1);
  CHECK_THAT(finish(place, folder), contains_text("0,failed,-5,1,,,,,,,,,"));
}

TEST_CASE("another sweep in a folder is refused with the difference", "[sweep]") {
  const Place place;
  const SweepRequest request = place.request();
  REQUIRE(SweepFolder::make(place.sweep(), request));
  const std::string before = read_file(place.sweep() + "/sweep.json").value();
  REQUIRE(SweepFolder::make(place.sweep(), request));
  SweepRequest other = place.request({"sheet.density=1,2"});
  CHECK_THAT(complaint_of(SweepFolder::make(place.sweep(), other)),
             contains_text("it has --vary sheet.density=1,2,3 --vary poke.magnitude*=1,2, not "
                           "--vary sheet.density=1,2"));
  other = request;
  other.frames = FrameSpan{1, 3};
  CHECK_THAT(complaint_of(SweepFolder::make(place.sweep(), other)),
             contains_text("it has no --frames, not --frames 1:3"));
  other = request;
  other.write = ".npy";
  CHECK_THAT(complaint_of(SweepFolder::make(place.sweep(), other)), contains_text("--write .npy"));
  place.folder().write("rig.xml", std::string(rig) + "\n");
  CHECK_THAT(complaint_of(SweepFolder::make(place.sweep(), request)), contains_text("rig.xml"));
  CHECK(read_file(place.sweep() + "/sweep.json").value() == before);
}

TEST_CASE("a folder that is no sweep stays as it is", "[sweep]") {
  const Place place;
  fs::create_directory(place.sweep());
  place.folder().write("sweep/mine.txt", "mine");
  CHECK_THAT(complaint_of(SweepFolder::make(place.sweep(), place.request())),
             contains_text("is not empty, and no sweep"));
  CHECK(SweepFolder::open(place.sweep()).error().code == ErrorCode::Unreadable);
  fs::remove(place.folder().file("sweep/mine.txt"));
  place.folder().write("sweep/.sweep.json.1-0.part", "half");
  CHECK(SweepFolder::make(place.sweep(), place.request()));
}

TEST_CASE("a sweep.json that no sweep writes is refused in one line", "[sweep]") {
  const Place place;
  REQUIRE(SweepFolder::make(place.sweep(), place.request()));
  const std::string text = read_file(place.sweep() + "/sweep.json").value();
  const std::string deep(2'000'000, '['), closed(2'000'000, ']');
  struct Case {
    std::string from, to, part;
  };
  for (const Case& one : std::vector<Case>{
           {"\"version\"", "\"x\": " + deep + closed + ", \"version\"", "nested more than"},
           {"\"version\"", "\"version\": \"secret\", \"version\"", "two members of one name"},
           {"\"version\"", "\"x\": 1e999, \"version\"", "too large"},
           {"\"version\"", "\"x\": \"\xff\", \"version\"", "not valid JSON"},
           {"\"version\"", std::string("\"x\": \0, \"version\"", 18), "NUL"},
           {"\"count\": 3", "\"count\": -3", "axes[0].count"},
           {"\"count\": 3", "\"count\": 18446744073709551615", "do not belong together"},
           {"\"frames\":null", "\"frames\":[1, 99999999999]", "arguments.frames"},
           {"\"write\":\"\"", "\"write\":\"/../secret\"", "arguments.write"},
           {"\"sample\":null", "\"sample\":-1", "arguments.sample"},
           {"\"paths\": [0]", "\"paths\": [0.5]", "axes[0].paths"}}) {
    CAPTURE(one.to.substr(0, 60));
    std::string other = text;
    REQUIRE(other.find(one.from) != std::string::npos);
    other.replace(other.find(one.from), one.from.size(), one.to);
    place.folder().write("sweep/sweep.json", other);
    const auto opened = SweepFolder::open(place.sweep());
    REQUIRE_FALSE(opened);
    CHECK(opened.error().code == ErrorCode::InvalidInput);
    CHECK_THAT(opened.error().message, contains_text(one.part));
    CHECK(opened.error().message.find("secret") == std::string::npos);
  }
}

TEST_CASE("a damaged sweep.json is refused", "[sweep]") {
  const Place place;
  REQUIRE(SweepFolder::make(place.sweep(), place.request()));
  const std::string text = read_file(place.sweep() + "/sweep.json").value();
  for (std::size_t length = 0; length + 2 < text.size(); length += 37) {
    place.folder().write("sweep/sweep.json", text.substr(0, length));
    CHECK_FALSE(SweepFolder::open(place.sweep()));
  }
  std::string other = text;
  other.replace(other.find("\"engine\":\"") + 10, 4, "aaaa");
  place.folder().write("sweep/sweep.json", other);
  CHECK_THAT(complaint_of(SweepFolder::open(place.sweep())), contains_text("has engine"));
}

TEST_CASE("a sweep removes no file that it has not made", "[sweep]") {
  const Place place;
  const auto folder = SweepFolder::make(place.sweep(), place.request()).value();
  for (const char* const name : {"sweep/.mine.part", "sweep/.takes.csv.1-0.part"}) {
    const auto old = place.folder().write(name, "mine");
    fs::last_write_time(old, fs::file_time_type::clock::now() - std::chrono::hours(48));
    REQUIRE(folder.run({}));
    REQUIRE(folder.write_table(folder.status().value()));
    CHECK(fs::exists(old));
  }
}

TEST_CASE("takes that end in other processes are counted by what is added to the log", "[sweep]") {
  const ScratchFolder scratch;
  fs::create_directory(scratch.file("log"));
  const auto add = [&](const char* file, std::string_view text) {
    std::ofstream(scratch.file("log") / file, std::ios::app | std::ios::binary) << text;
  };
  const auto done = [](std::size_t take) {
    return to_line({.take = take, .measures = Measures()});
  };
  const auto failed = [](std::size_t take) {
    return to_line({.take = take, .measures = fail(ErrorCode::Unwritable, "it failed")});
  };
  add("a.jsonl", done(0) + failed(1) + R"({"take":2,"st)");
  auto watch =
      SweepWatch::begin(scratch.path().string(), {false, true, true, true, true, true}).value();
  const auto counts = [&] {
    REQUIRE(watch.look());
    return std::vector<std::size_t>{watch.ended(), watch.failed()};
  };
  CHECK(counts() == std::vector<std::size_t>{0, 0});  // what was there before
  add("a.jsonl", "nonsense\n" + done(2));
  add("b.jsonl", done(3) + done(0) + done(99));  // 0 is not waited for, 99 is none
  CHECK(counts() == std::vector<std::size_t>{2, 0});
  CHECK(counts() == std::vector<std::size_t>{2, 0});
  const std::string line = failed(4);
  add("b.jsonl", line.substr(0, 20));
  CHECK(counts() == std::vector<std::size_t>{2, 0});
  add("b.jsonl", line.substr(20) + done(3));
  CHECK(counts() == std::vector<std::size_t>{3, 1});
  fs::remove(scratch.file("log") / "a.jsonl");  // and another of its name
  add("a.jsonl", done(1));
  CHECK(counts() == std::vector<std::size_t>{4, 1});
  add("c.jsonl", done(5));
  CHECK_FALSE(watch.look([] { return true; }));
  CHECK(counts() == std::vector<std::size_t>{5, 1});
}
