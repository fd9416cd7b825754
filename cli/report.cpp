#include "report.hpp"

namespace pliant::cli {

void print(std::FILE* stream, std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

int report(const Error& error) {
  for (const std::string& line : to_lines(error)) print(stderr, line + '\n');
  const bool is_input =
      error.code == ErrorCode::InvalidInput || error.code == ErrorCode::Unreadable;
  return is_input ? exit_usage : exit_failed;
}

}  // namespace pliant::cli
