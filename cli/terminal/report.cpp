#include "cli/terminal/report.hpp"

#include <string>

#include <fmt/format.h>
#include <unistd.h>

namespace pliant::cli {

void print(std::FILE* stream, std::string_view text) {
  std::string lines;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    lines += printable(text.substr(0, end));
    if (end == std::string_view::npos) break;
    lines += '\n';
    text.remove_prefix(end + 1);
  }
  std::fwrite(lines.data(), 1, lines.size(), stream);
  std::fflush(stream);
}

void print_bytes(std::FILE* stream, std::string_view bytes) {
  if (isatty(fileno(stream)) != 0) return print(stream, bytes);
  std::fwrite(bytes.data(), 1, bytes.size(), stream);
}

std::string counted(std::int64_t count, std::string_view one, std::string_view many) {
  if (count == 1) return fmt::format("1 {}", one);
  return many.empty() ? fmt::format("{} {}s", count, one) : fmt::format("{} {}", count, many);
}

int exit_code(const Error& error) {
  const bool is_input =
      error.code == ErrorCode::InvalidInput || error.code == ErrorCode::Unreadable;
  return is_input ? exit_usage : exit_failed;
}

int exit_code_after_output(int code) {
  const bool is_flushed = std::fflush(stdout) == 0;
  if (is_flushed && std::ferror(stdout) == 0) return code;
  print(stderr, "pliant: error: cannot write to the standard output\n");
  return code == exit_done ? exit_failed : code;
}

int report(const Error& error) {
  for (const std::string& line : to_lines(error)) {
    print(stderr, (line.starts_with("error: ") ? "pliant: " : "") + line + '\n');
  }
  return exit_code(error);
}

void print_notes(std::span<const SceneNote> notes) {
  for (const SceneNote& note : notes) {
    print(stderr, fmt::format("{}:{}: note: {}\n", printable(note.file), note.line,
                              printable(note.message)));
  }
}

void print_warning(const ScenePlace& place, const std::string& message) {
  print(stderr, fmt::format("{}:{}: warning: {}\n", printable(place.file), place.line,
                            printable(place.told(message))));
}

void print_warnings(std::span<const Warning> warnings, const SceneOrigin& origin) {
  for (const Warning& warning : warnings) {
    print_warning(place_of(warning, origin), warning.message());
  }
}

void print_warnings(const Simulation& simulation) {
  print_warnings(simulation.warnings(), simulation.scene().origin);
}

}  // namespace pliant::cli
