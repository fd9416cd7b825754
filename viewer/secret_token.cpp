#include "viewer/secret_token.hpp"

#include <array>
#include <cerrno>

#include <fmt/format.h>
#include <sys/random.h>

namespace pliant::viewer {

Result<std::string> make_token() {
  std::array<unsigned char, 16> bytes = {};
  std::size_t count = 0;
  while (count < bytes.size()) {
    const ssize_t got = getrandom(bytes.data() + count, bytes.size() - count, 0);
    if (got < 0 && errno == EINTR) continue;  // a signal while the system still collects entropy
    if (got <= 0) return fail(ErrorCode::Unreadable, "cannot get random bytes from the system");
    count += static_cast<std::size_t>(got);
  }
  std::string token;
  for (const unsigned char byte : bytes) token += fmt::format("{:02x}", byte);
  return token;
}

bool is_same_secret(std::string_view given, std::string_view secret) {
  if (given.size() != secret.size()) return false;
  // Volatile, since otherwise a compiler may leave the loop at the first difference.
  volatile unsigned char difference = 0;
  for (std::size_t k = 0; k < secret.size(); ++k) {
    const unsigned char here = static_cast<unsigned char>(given[k] ^ secret[k]);
    difference = static_cast<unsigned char>(difference | here);
  }
  return difference == 0;
}

}  // namespace pliant::viewer
