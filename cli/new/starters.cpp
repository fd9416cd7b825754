#include "cli/new/starters.hpp"

#include <algorithm>
#include <vector>

namespace pliant::cli {

using Bytes = std::span<const unsigned char>;

// The files of cli/new/starters, embedded by cli/CMakeLists.txt.
extern const Bytes starter_sheet, starter_mesh, starter_trampoline, starter_ripple, starter_jiggle,
    starter_dent, starter_flag, starter_travelling, starter_pudding;

namespace {

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::span<const Starter> starters() {
  static const std::vector<Starter> all = {
      {"sheet", text_of(starter_sheet)},
      {"mesh", text_of(starter_mesh), text_of(starter_pudding)},
      {"trampoline", text_of(starter_trampoline)},
      {"ripple", text_of(starter_ripple)},
      {"jiggle", text_of(starter_jiggle), text_of(starter_pudding)},
      {"dent", text_of(starter_dent)},
      {"flag", text_of(starter_flag)},
      {"travelling", text_of(starter_travelling)},
  };
  return all;
}

std::string_view summary_of(const Starter& starter) {
  constexpr std::string_view opening = "<!-- ";
  std::string_view text = starter.scene;
  text.remove_prefix(std::min(text.find(opening) + opening.size(), text.size()));
  return text.substr(0, text.find('\n'));
}

}  // namespace pliant::cli
