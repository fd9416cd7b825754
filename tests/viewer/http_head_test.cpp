#include "viewer/http_head.hpp"

#include <string>
#include <utility>

#include "support/catch.hpp"

using namespace pliant::viewer;
using State = HeadScanner::State;

namespace {

// The state after the last byte that was scanned, and the number of scanned bytes.
std::pair<State, std::size_t> scan(const std::string& text, std::size_t bytes = 1000,
                                   std::size_t lines = 10) {
  HeadScanner scanner(bytes, lines);
  std::size_t count = 0;
  State state = State::More;
  while (state == State::More && count < text.size()) state = scanner.take(text[count++]);
  CHECK(scanner.text() == text.substr(0, scanner.text().size()));
  return {state, count};
}

const std::string head = "GET /a HTTP/1.1\r\nHost: b\r\nX:\tc d\r\n\r\n";

}  // namespace

TEST_CASE("a head ends at its empty line", "[viewer][http]") {
  CHECK(scan(head) == std::pair(State::Complete, head.size()));
  CHECK(scan(head + head) == std::pair(State::Complete, head.size()));
  for (std::size_t length = 0; length < head.size(); ++length) {
    CHECK(scan(head.substr(0, length)).first == State::More);
  }
}

TEST_CASE("every byte but printable ones and tabs is refused where it stands", "[viewer][http]") {
  for (int byte = 0; byte < 256; ++byte) {
    if ((byte >= ' ' && byte <= '~') || byte == '\t' || byte == '\r') continue;
    CAPTURE(byte);
    const std::string ahead = "GET /a";
    CHECK(scan(ahead + static_cast<char>(byte) + head) ==
          std::pair(State::Malformed, ahead.size() + 1));
  }
}

TEST_CASE("lines end in CR LF, and do not go on in the next", "[viewer][http]") {
  for (const char* text : {"GET /a HTTP/1.1\n", "GET /a HTTP/1.1\rH", "GET /a HTTP/1.1\r\r", "\r\n",
                           "GET /a HTTP/1.0\r\n", "GET /a\r\n", "PRI * HTTP/2.0\r\n", " ",
                           "GET /a HTTP/1.1\r\nA: b\r\n ", "GET /a HTTP/1.1\r\nA: b\r\n\t"}) {
    CAPTURE(text);
    CHECK(scan(text) == std::pair(State::Malformed, std::string(text).size()));
  }
}

TEST_CASE("a head has so many bytes and lines", "[viewer][http]") {
  CHECK(scan(head, head.size()).first == State::Complete);
  CHECK(scan(head, head.size() - 1).first == State::TooLarge);
  CHECK(scan(std::string(2000, 'a')) == std::pair(State::TooLarge, std::size_t{1001}));
  CHECK(scan(head, 1000, 3).first == State::Complete);
  CHECK(scan(head, 1000, 2).first == State::TooLarge);
}
