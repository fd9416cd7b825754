#include "pliant/scene/text/line_map.hpp"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/result.hpp"

namespace pliant {

std::string ScenePlace::told(std::string message) const {
  if (!chain.empty()) message += "; " + chain;
  return message;
}

LineMap::LineMap(std::string file) : texts_{{std::move(file)}}, runs_{{}} {}

int LineMap::add_text(std::string file, int parent, int line) {
  texts_.push_back({std::move(file), parent, line});
  return static_cast<int>(texts_.size()) - 1;
}

void LineMap::add_run(int first, int text, int line) {
  PLIANT_EXPECTS(first >= runs_.back().first);
  if (runs_.back().first == first) runs_.pop_back();
  runs_.push_back({first, text, line});
}

const LineRun& LineMap::run_of(int line) const {
  const auto after = std::upper_bound(runs_.begin(), runs_.end(), line,
                                      [](int one, const LineRun& run) { return one < run.first; });
  return after == runs_.begin() ? runs_.front() : *(after - 1);
}

int LineMap::text_of(int line) const { return run_of(line).text; }

ScenePlace LineMap::place_of(int line) const {
  if (line <= 0) return {texts_.front().file};
  const LineRun& run = run_of(line);
  return place_in(run.text, run.line + line - run.first);
}

ScenePlace LineMap::place_in(int text, int line) const {
  ScenePlace place{texts_[static_cast<std::size_t>(text)].file, line};
  for (int k = text; texts_[static_cast<std::size_t>(k)].parent != SceneText::none;) {
    const SceneText& inner = texts_[static_cast<std::size_t>(k)];
    k = inner.parent;
    place.chain += fmt::format("{}by {}:{}", place.chain.empty() ? "included " : ", ",
                               printable(texts_[static_cast<std::size_t>(k)].file), inner.line);
  }
  return place;
}

std::string LineMap::title_of(int line, int from) const {
  if (line <= 0) return title_in(0, 0, text_of(from));
  const LineRun& run = run_of(line);
  return title_in(run.text, run.line + line - run.first, text_of(from));
}

std::string LineMap::title_in(int text, int line, int from) const {
  if (text == from) return fmt::format("line {}", line);
  const ScenePlace place = place_in(text, line);
  return fmt::format("line {} of {}{}{}", place.line, printable(place.file),
                     place.chain.empty() ? "" : ", ", place.chain);
}

}  // namespace pliant
