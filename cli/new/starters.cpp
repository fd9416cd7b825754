#include "cli/new/starters.hpp"

#include <algorithm>
#include <vector>

namespace pliant::cli {

using Bytes = std::span<const unsigned char>;

// The files of cli/new/starters, embedded by cli/CMakeLists.txt.
extern const Bytes starter_sheet_xml, starter_mesh_xml, starter_trampoline_xml, starter_ripple_xml,
    starter_jiggle_xml, starter_dent_xml, starter_flag_xml, starter_travelling_xml,
    starter_pudding_obj, starter_sheet_png, starter_mesh_png, starter_trampoline_png,
    starter_ripple_png, starter_jiggle_png, starter_dent_png, starter_flag_png,
    starter_travelling_png;

namespace {

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

}  // namespace

std::span<const Starter> starters() {
  static const std::vector<Starter> all = {
      {"sheet", text_of(starter_sheet_xml), {}, text_of(starter_sheet_png)},
      {"mesh", text_of(starter_mesh_xml), text_of(starter_pudding_obj), text_of(starter_mesh_png)},
      {"trampoline", text_of(starter_trampoline_xml), {}, text_of(starter_trampoline_png)},
      {"ripple", text_of(starter_ripple_xml), {}, text_of(starter_ripple_png)},
      {"jiggle", text_of(starter_jiggle_xml), text_of(starter_pudding_obj),
       text_of(starter_jiggle_png)},
      {"dent", text_of(starter_dent_xml), {}, text_of(starter_dent_png)},
      {"flag", text_of(starter_flag_xml), {}, text_of(starter_flag_png)},
      {"travelling", text_of(starter_travelling_xml), {}, text_of(starter_travelling_png)},
  };
  return all;
}

std::string_view summary_of(const Starter& starter) {
  constexpr std::string_view opening = "<!-- ";
  std::string_view text = starter.scene;
  text.remove_prefix(std::min(text.find(opening) + opening.size(), text.size()));
  text = text.substr(0, text.find('\n'));
  const std::size_t end = text.find(". ");
  return end == std::string_view::npos ? text : text.substr(0, end + 1);
}

}  // namespace pliant::cli
