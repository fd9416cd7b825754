#include "report.hpp"

#include <fmt/format.h>

namespace pliant::cli {

void print(std::FILE* stream, std::string_view text) {
  std::fwrite(text.data(), 1, text.size(), stream);
  std::fflush(stream);
}

int report(const Error& error) {
  for (const std::string& line : to_lines(error)) {
    print(stderr, (line.starts_with("error: ") ? "pliant: " : "") + line + '\n');
  }
  const bool is_input =
      error.code == ErrorCode::InvalidInput || error.code == ErrorCode::Unreadable;
  return is_input ? exit_usage : exit_failed;
}

void print_notes(const Scene& scene) {
  for (const SceneNote& note : scene.notes) {
    print(stderr, fmt::format("{}:{}: note: {}\n", scene.origin.file, note.line, note.message));
  }
}

}  // namespace pliant::cli
