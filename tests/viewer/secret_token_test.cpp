#include <algorithm>
#include <chrono>
#include <set>
#include <string>

#include "support/catch.hpp"
#include "viewer/gate.hpp"

using namespace pliant::viewer;

TEST_CASE("tokens have 128 bits, and no two are the same", "[viewer][token]") {
  std::set<std::string> tokens;
  std::set<char> digits;
  for (int k = 0; k < 1000; ++k) {
    const std::string token = make_token().value();
    CHECK(token.size() == 32);
    CHECK(token.find_first_not_of("0123456789abcdef") == std::string::npos);
    digits.insert(token.begin(), token.end());
    tokens.insert(token);
  }
  CHECK(tokens.size() == 1000);
  CHECK(digits.size() == 16);
}

TEST_CASE("a secret is the same text, every byte of it", "[viewer][token]") {
  const std::string secret = make_token().value();
  CHECK(is_same_secret(secret, secret));
  CHECK(is_same_secret("", ""));
  CHECK_FALSE(is_same_secret("", secret));
  CHECK_FALSE(is_same_secret(secret + '0', secret));
  CHECK_FALSE(is_same_secret(secret.substr(1), secret));
  for (std::size_t place = 0; place < secret.size(); ++place) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string other = secret;
      other[place] = static_cast<char>(other[place] ^ (1 << bit));
      CHECK_FALSE(is_same_secret(other, secret));
    }
  }
}

TEST_CASE("a comparison takes as long wherever the difference is", "[viewer][token]") {
  // Large, so that a comparison that stops early would be thousands of times as fast.
  const std::string secret(1 << 22, 'a');
  std::string early = secret, late = secret;
  early.front() = 'b';
  late.back() = 'b';
  const auto fastest = [&](const std::string& given) {
    auto best = std::chrono::nanoseconds::max();
    for (int k = 0; k < 5; ++k) {
      const auto from = std::chrono::steady_clock::now();
      CHECK_FALSE(is_same_secret(given, secret));
      best = std::min<std::chrono::nanoseconds>(best, std::chrono::steady_clock::now() - from);
    }
    return static_cast<double>(best.count());
  };
  CHECK(fastest(early) > 0.1 * fastest(late));
}
