#include "pliant/replay/log_file.hpp"

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>

#include "pliant/files/read_file.hpp"
#include "pliant/replay/log_line.hpp"
#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

ReplayHeader small_header() {
  ReplayHeader header;
  header.version = "1.2.3";
  header.scene_file = "../a scene.xml";
  header.scene_text = "<scene>\n\t\"quoted\" \\ ü\n</scene>\n";
  header.files = {{"head.obj", hash_of("head")}};
  header.solver = "auto";
  header.factors = "supernodal";
  header.start = -1;
  header.end = 1;
  header.surfaces = {{"sheet", 2, 2}, {"other", 1, 1}};
  return header;
}

// Numbers for which a round trip through text is difficult.
ReplayFrame small_frame(int number, bool has_states) {
  ReplayFrame frame;
  frame.number = number;
  for (const char* name : {"sheet", "other"}) {
    frame.surfaces.push_back(
        {hash_of(name + std::to_string(number)), hash_of(name), hash_of(""), 0.1});
  }
  if (!has_states) return frame;
  for (const int rows : {4, 1}) {
    BodyState state;
    state.positions = Field::Constant(rows, 3, 0.1 + number);
    state.velocities = Field::Constant(rows, 3, -1.0 / 3);
    state.positions(0, 0) = -0.0;
    state.positions(0, 1) = 5e-324;
    state.positions(0, 2) = std::numeric_limits<double>::max();
    frame.states.push_back(state);
  }
  return frame;
}

std::string write_small_log(const std::filesystem::path& file) {
  auto log = ReplayLogWriter::create(file, small_header());
  REQUIRE(log);
  for (int number = -1; number <= 1; ++number) {
    REQUIRE(log->write(small_frame(number, number == 0)));
  }
  REQUIRE(log->finish());
  return read_file(file).value();
}

// The first error in reading the whole log; nullopt: the log is sound.
std::optional<Error> trouble_in(const std::filesystem::path& file) {
  auto log = ReplayLogReader::open(file);
  if (!log) return log.error();
  while (true) {
    const auto frame = log->next();
    if (!frame) return frame.error();
    if (!*frame) return {};
  }
}

std::optional<Error> trouble_in(const ScratchFolder& folder, const std::string& bytes) {
  const auto file = folder.file("changed.replay");
  std::ofstream(file, std::ios::binary) << bytes;
  return trouble_in(file);
}

bool has_same_bits(const Field& a, const Field& b) {
  return a.rows() == b.rows() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line + '\n');
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line;
  return text;
}

}  // namespace

TEST_CASE("a log is read as it was written", "[replay]") {
  const ScratchFolder folder;
  const auto file = folder.file("a.replay");
  write_small_log(file);
  auto log = ReplayLogReader::open(file);
  REQUIRE(log);
  CHECK((log->header() == small_header()));
  for (int number = -1; number <= 1; ++number) {
    const auto frame = log->next();
    REQUIRE(frame);
    REQUIRE(frame->has_value());
    const ReplayFrame written = small_frame(number, number == 0);
    CHECK((*frame)->number == number);
    CHECK((*frame)->surfaces == written.surfaces);
    REQUIRE((*frame)->states.size() == written.states.size());
    for (std::size_t k = 0; k < written.states.size(); ++k) {
      CHECK(has_same_bits((*frame)->states[k].positions, written.states[k].positions));
      CHECK(has_same_bits((*frame)->states[k].velocities, written.states[k].velocities));
    }
  }
  for (int again = 0; again < 2; ++again) {
    const auto end = log->next();
    REQUIRE(end);
    CHECK_FALSE(end->has_value());
  }
}

TEST_CASE("a flipped bit is found in every byte of a log", "[replay]") {
  const ScratchFolder folder;
  const std::string sound = write_small_log(folder.file("a.replay"));
  REQUIRE_FALSE(trouble_in(folder, sound));
  for (std::size_t byte = 0; byte < sound.size(); ++byte) {
    std::string changed = sound;
    changed[byte] = static_cast<char>(changed[byte] ^ (1 << (byte % 8)));
    CAPTURE(byte);
    const auto trouble = trouble_in(folder, changed);
    REQUIRE(trouble);
    REQUIRE(trouble->code == ErrorCode::InvalidInput);
  }
}

TEST_CASE("a log that is cut short anywhere is told apart", "[replay]") {
  const ScratchFolder folder;
  const std::string sound = write_small_log(folder.file("a.replay"));
  for (std::size_t size = 0; size < sound.size(); ++size) {
    CAPTURE(size);
    const auto trouble = trouble_in(folder, sound.substr(0, size));
    REQUIRE(trouble);
    if (size > 16) REQUIRE_THAT(trouble->message, Contains("is truncated"));
  }
  const auto lines = lines_of(sound);
  const auto trouble = trouble_in(folder, lines[0] + lines[1] + lines[2]);
  REQUIRE(trouble);
  CHECK(trouble->line == 4);
  CHECK_THAT(trouble->message, Contains("2 of 3 frames"));
}

TEST_CASE("lines that are lost, repeated, moved or added are found", "[replay]") {
  const ScratchFolder folder;
  const auto lines = lines_of(write_small_log(folder.file("a.replay")));
  REQUIRE(lines.size() == 5);
  for (std::size_t k = 0; k < lines.size(); ++k) {
    auto lost = lines;
    lost.erase(lost.begin() + static_cast<std::ptrdiff_t>(k));
    CHECK(trouble_in(folder, joined(lost)));
    auto repeated = lines;
    repeated.insert(repeated.begin() + static_cast<std::ptrdiff_t>(k), lines[k]);
    CHECK(trouble_in(folder, joined(repeated)));
    if (k == 0) continue;
    auto moved = lines;
    std::swap(moved[k], moved[k - 1]);
    CHECK(trouble_in(folder, joined(moved)));
  }
  CHECK(trouble_in(folder, joined(lines) + "\n"));
}

TEST_CASE("what is no log, or a later one, is told apart", "[replay]") {
  const ScratchFolder folder;
  for (const std::string bytes : {"", "<scene/>", "{\"pliant\":1}\n", "\0\0\0\0"}) {
    const auto trouble = trouble_in(folder, bytes);
    REQUIRE(trouble);
    CHECK_THAT(trouble->message, Contains("this is not a replay log"));
  }
  const auto later = trouble_in(folder, "{\"pliant_replay\":2,\"more\":\"then\"}\n");
  REQUIRE(later);
  CHECK(later->line == 1);
  CHECK_THAT(later->message, Contains("format 2") && Contains("reads format 1"));
  const auto missing = trouble_in(folder.file("missing.replay"));
  REQUIRE(missing);
  CHECK(missing->code == ErrorCode::Unreadable);
}

TEST_CASE("a log with a hole of any size is refused unread", "[replay]") {
  const ScratchFolder folder;
  const auto file = folder.file("a.replay");
  write_small_log(file);
  const auto size = std::filesystem::file_size(file);
  for (const auto& [keep, part] : {std::pair{size, "NUL bytes"}, std::pair{size / 2, "NUL bytes"},
                                   std::pair{std::uintmax_t{0}, "not a replay log"},
                                   std::pair{std::uintmax_t{30}, "NUL bytes"}}) {
    write_small_log(file);
    std::filesystem::resize_file(file, keep);
    std::filesystem::resize_file(file, std::uintmax_t{1} << 40U);
    CAPTURE(keep);
    const auto trouble = trouble_in(file);
    REQUIRE(trouble);
    CHECK(trouble->code == ErrorCode::InvalidInput);
    CHECK_THAT(trouble->message, Contains(part));
  }
}

TEST_CASE("reading a log ends when asked", "[replay]") {
  const ScratchFolder folder;
  const auto file = folder.file("a.replay");
  write_small_log(file);
  std::size_t calls = 0;
  const auto read_all = [&](std::size_t last) -> Result<void> {
    calls = 0;
    const StopRequest should_stop = [&] { return ++calls >= last; };
    auto log = ReplayLogReader::open(file, should_stop);
    if (!log) return fail(log.error());
    for (;;) {
      const auto frame = log->next(should_stop);
      if (!frame) return fail(frame.error());
      if (!*frame) return {};
    }
  };
  REQUIRE(read_all(SIZE_MAX));
  const std::size_t all = calls;
  CHECK(all >= 5);  // lines
  for (std::size_t last = 1; last <= all; ++last) {
    const auto read = read_all(last);
    REQUIRE_FALSE(read);
    CHECK(read.error().code == ErrorCode::Interrupted);
    CHECK(calls == last);
  }
}

TEST_CASE("what is larger than a line of a log is not written", "[replay]") {
  const ScratchFolder folder;
  ReplayHeader header = small_header();
  header.surfaces = {{"sheet", 4000, 4000}};
  auto log = ReplayLogWriter::create(folder.file("a.replay"), header).value();
  ReplayFrame frame = small_frame(-1, false);
  frame.surfaces.pop_back();
  BodyState& state = frame.states.emplace_back();
  state.positions = state.velocities = Field::Zero(4000 * 4000, 3);
  const auto written = log.write(frame);
  REQUIRE_FALSE(written);
  CHECK(written.error().code == ErrorCode::InvalidInput);
  CHECK_THAT(written.error().message, Contains("record fewer states"));
}

TEST_CASE("sealed nonsense is an error with its line", "[replay]") {
  const ScratchFolder folder;
  const auto lines = lines_of(write_small_log(folder.file("a.replay")));
  const auto seal_of = [](const std::string& line) { return line.substr(line.size() - 35, 32); };
  const auto resealed = [](const std::string& json, std::string seal) {
    return replay::sealed(json, seal) + '\n';
  };
  for (const std::string first :
       {R"({"pliant_replay":1})", R"({"pliant_replay":1,"version":3})", R"({"pliant_replay":1,[]})",
        R"({"pliant_replay":99999999999999999999})", R"({"pliant_replay":1,"text":"\ud800"})"}) {
    CAPTURE(first);
    const auto trouble = trouble_in(folder, resealed(first, "") + joined(lines));
    REQUIRE(trouble);
    CHECK(trouble->line == 1);
  }
  ReplayHeader backwards = small_header();
  std::swap(backwards.start, backwards.end);
  CHECK(trouble_in(folder, resealed(replay::to_json(backwards), ""))->line == 1);
  // 2^64 - 1 is not -1, and a grid has columns.
  for (const auto& [from, to] : {std::pair{R"("start":-1)", R"("start":18446744073709551615)"},
                                 std::pair{R"("columns":2)", R"("columns":0)"}}) {
    std::string header = replay::to_json(small_header());
    REQUIRE(header.find(from) != std::string::npos);
    header.replace(header.find(from), std::string_view(from).size(), to);
    CAPTURE(header);
    const auto trouble = trouble_in(folder, resealed(header, ""));
    REQUIRE(trouble);
    CHECK(trouble->line == 1);
    CHECK_THAT(trouble->message, Contains("first line"));
  }

  const std::string hash = to_text(hash_of(""));
  const std::string digest = R"({"positions":")" + hash + R"(","velocities":")" + hash +
                             R"(","region":")" + hash + R"(","peak":1)";
  ReplayFrame three = small_frame(-1, true);  // the header has two surfaces
  three.surfaces.push_back(three.surfaces.back());
  three.states.push_back(three.states.back());
  const std::vector<std::string> nonsense = {
      replay::to_json(three), R"({"frame":-1})", R"({"frame":-1,"surfaces":[]})",
      R"({"frame":1e999,"surfaces":[]})",
      R"({"frame":0,"surfaces":[)" + digest + "}," + digest + "}]}",
      R"({"frame":18446744073709551615,"surfaces":[)" + digest + "}," + digest + "}]}",
      R"({"frame":-1,"surfaces":[)" + digest + "}]}",
      R"({"frame":-1,"surfaces":[)" + digest + R"(,"state":{}},)" + digest + "}]}",
      R"({"frame":-1,"surfaces":[)" + digest +
          R"(,"state":{"positions":[1,2,3],"velocities":[]}},)" + digest + "}]}",
      R"({"frames":0})", R"({"frames":-3})", R"({"frame":)" + std::string(100000, '[') + "}",
      // brackets that are closed, in millions
      R"({"frame":-1,"x":)" + std::string(3'000'000, '[') + std::string(3'000'000, ']') + "}",
      R"({"frame":-1,"frame":-1,"surfaces":[)" + digest + "}," + digest + "}]}",
      R"({"frame":-1,"x":1e999,"surfaces":[)" + digest + "}," + digest + "}]}",
      R"({"frame":-1,"x":"\xff","surfaces":[)" + digest + "}," + digest + "}]}",
      R"({"frame":-1,"x":"\ud800","surfaces":[)" + digest + "}," + digest + "}]}",
      std::string("{\"frame\":-1,\"\0\":1}", 19),
      R"({"frame":-1,"surfaces":[)" + digest + R"(,"state":{"positions":[)" + std::string(11, '0') +
          "],\"velocities\":[]}}," + digest + "}]}",
      "{}", "nul}"};
  for (const std::string& second : nonsense) {
    CAPTURE(second.substr(0, 200));
    const auto trouble = trouble_in(folder, lines[0] + resealed(second, seal_of(lines[0])));
    REQUIRE(trouble);
    CHECK(trouble->code == ErrorCode::InvalidInput);
    CHECK(trouble->line == 2);
  }
  // The same line with the right content is accepted; the log is then truncated in line 3.
  CHECK(trouble_in(folder, lines[0] + resealed(R"({"frame":-1,"surfaces":[)" + digest + "}," +
                                                   digest + "}]}",
                                               seal_of(lines[0])))
            ->line == 3);
}
