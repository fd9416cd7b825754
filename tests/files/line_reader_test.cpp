#include "pliant/files/line_reader.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "support/catch.hpp"
#include "support/scratch_folder.hpp"

using namespace pliant;
using namespace pliant::testing;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t longest = 1'000'000;

// Lines of many lengths, over several pieces.
std::vector<std::string> some_lines() {
  std::vector<std::string> lines;
  for (std::size_t k = 0; k < 300; ++k)
    lines.push_back(std::string(k % 7 == 0 ? 40'000 : k, static_cast<char>('a' + k % 26)));
  return lines;
}

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

}  // namespace

TEST_CASE("a file is its lines, from any of them on", "[core][line_reader]") {
  const ScratchFolder folder;
  const std::vector<std::string> lines = some_lines();
  const fs::path file = folder.write("a", joined(lines) + "half");
  std::uintmax_t begin = 0;
  for (const std::size_t first : {0, 1, 150, 299}) {
    begin = 0;
    for (std::size_t k = 0; k < first; ++k) begin += lines[k].size() + 1;
    auto reader = LineReader::open(file, longest, LineReader::LongLines::Refuse, begin).value();
    CHECK(reader.begins_with(std::string_view(lines[first]).substr(0, 2)).value());
    CHECK_FALSE(reader.begins_with("?").value());
    for (std::size_t k = first; k < lines.size(); ++k) {
      const auto line = reader.next().value();
      REQUIRE(line);
      REQUIRE(line->is_whole);
      REQUIRE(line->text == lines[k]);
      REQUIRE(reader.line() == static_cast<int>(k - first + 1));
      begin += lines[k].size() + 1;
      REQUIRE(reader.position() == begin);
    }
    const auto last = reader.next().value();
    REQUIRE(last);
    CHECK(last->text == "half");
    CHECK_FALSE(last->is_whole);
    CHECK(reader.position() == begin);
    CHECK_FALSE(reader.next().value());
  }
}

TEST_CASE("a line that is too long ends the reading there", "[core][line_reader]") {
  const ScratchFolder folder;
  const fs::path file = folder.write("a", "one\n" + std::string(1000, 'x') + "\n");
  CHECK(LineReader::open(file, 1000)->next());
  for (const std::size_t most : {std::size_t{999}, std::size_t{3}}) {
    auto reader = LineReader::open(file, most).value();
    REQUIRE(reader.next());
    const auto line = reader.next();
    REQUIRE_FALSE(line);
    CHECK(line.error().code == ErrorCode::InvalidInput);
    CHECK(line.error().file == file.string());
    CHECK(line.error().line == 2);
  }
}

TEST_CASE("lines that are too long can be passed over", "[core][line_reader]") {
  const ScratchFolder folder;
  const std::string text = "one\n" + std::string(700'000, 'x') + "\ntwo\n" + std::string(11, 'y') +
                           "\n" + std::string(10, 'z') + "\n" + std::string(700'000, 'x');
  const fs::path file = folder.write("a", text);
  auto reader = LineReader::open(file, 10, LineReader::LongLines::Skip).value();
  std::vector<std::string> lines;
  std::vector<int> numbers;
  for (;;) {
    const auto line = reader.next().value();
    REQUIRE(line);
    if (!line->is_whole) break;
    lines.emplace_back(line->text);
    numbers.push_back(reader.line());
    CHECK(text.substr(0, reader.position()).ends_with(lines.back() + '\n'));
  }
  CHECK(lines == std::vector<std::string>{"one", "two", std::string(10, 'z')});
  CHECK(numbers == std::vector<int>{1, 3, 5});
  CHECK(reader.position() == text.size() - 700'000);
  CHECK_FALSE(reader.next().value());
}

TEST_CASE("a hole of any size is no line, and is not read", "[core][line_reader]") {
  const ScratchFolder folder;
  const fs::path file = folder.write("a", "one\n");
  fs::resize_file(file, std::uintmax_t{1} << 40U);
  std::size_t pieces = 0;
  const StopRequest count = [&] { return ++pieces, false; };
  auto reader =
      LineReader::open(file, std::size_t{1} << 30U, LineReader::LongLines::Refuse, 0, count)
          .value();
  REQUIRE(reader.next(count));
  const auto line = reader.next(count);
  REQUIRE_FALSE(line);
  CHECK_THAT(line.error().message, contains_text("NUL"));
  CHECK(line.error().line == 2);
  CHECK(pieces < 10);
}

TEST_CASE("reading lines ends when asked, whenever that is", "[core][line_reader]") {
  const ScratchFolder folder;
  const fs::path file = folder.write("a", joined(some_lines()));
  std::size_t calls = 0;
  const auto read_all = [&](std::size_t last) -> Result<std::size_t> {
    calls = 0;
    const StopRequest should_stop = [&] { return ++calls >= last; };
    auto reader = LineReader::open(file, longest, LineReader::LongLines::Refuse, 0, should_stop);
    if (!reader) return fail(reader.error());
    for (std::size_t count = 0;; ++count) {
      const auto line = reader->next(should_stop);
      if (!line) return fail(line.error());
      if (!*line) return count;
    }
  };
  REQUIRE(read_all(SIZE_MAX).value() == 300);
  const std::size_t all = calls;
  CHECK(all > fs::file_size(file) >> 18U);
  for (std::size_t last = 1; last <= all; ++last) {
    const auto read = read_all(last);
    REQUIRE_FALSE(read);
    CHECK(read.error().code == ErrorCode::Interrupted);
    CHECK(calls == last);
  }
}
