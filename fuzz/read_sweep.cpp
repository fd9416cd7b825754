// Arbitrary text of a sweep. The first byte says which: `j`, its sweep.json; `t`, a table --takes;
// otherwise a log. What is read becomes takes, and is written and read again.

#include <filesystem>
#include <fstream>
#include <string>
#include <utility>

#include "fuzz.hpp"
#include "pliant/scene/read.hpp"
#include "pliant/sweep/log.hpp"
#include "pliant/sweep/sweep.hpp"
#include "pliant/sweep/sweep_file.hpp"
#include "pliant/sweep/takes.hpp"
#include "pliant/sweep/values.hpp"
#include "tiny_scene.hpp"

using namespace pliant;
using namespace pliant::fuzzing;
namespace fs = std::filesystem;

namespace {

/// A folder of this process, with one for a log.
const fs::path& scratch() {
  static const fs::path folder = [] {
    const fs::path made = fs::temp_directory_path() / ("pliant-fuzz-" + std::to_string(getpid()));
    fs::create_directories(made / "log");
    std::atexit([] {
      std::error_code ignored;
      fs::remove_all(fs::temp_directory_path() / ("pliant-fuzz-" + std::to_string(getpid())),
                     ignored);
    });
    return made;
  }();
  return folder;
}

void check_takes(const Takes& takes) {
  require(takes.count() >= 1 && takes.count() <= most_takes);
  for (const std::size_t take : {std::size_t{0}, takes.count() / 2, takes.count() - 1}) {
    require(takes.scene_of(take) < takes.plan().scene_count);
    const auto texts = takes.texts(take);
    require(texts.size() == takes.paths().size());
    for (std::size_t path = 0; path < std::min<std::size_t>(texts.size(), 8); ++path)
      require(!takes.place_of(path, texts[path]).empty() || takes.table_title().empty());
  }
}

void check_file(std::string_view text) {
  const MemoryFile file(text);
  auto read = read_sweep_file(file.path());
  if (!read) return check_error(read.error());
  require(read->texts.size() == read->request.scenes.size());
  const fs::path copy = scratch() / "sweep.json";
  std::error_code ignored;
  fs::remove(copy, ignored);
  const auto written = write_sweep_file(*read, read->takes, copy);
  require(written.has_value() && *written);
  const auto again = read_sweep_file(copy);
  require(again.has_value() && difference_of(*read, *again).empty());
  require(again->takes.axes.size() == read->takes.axes.size());
  const auto takes = Takes::of(std::move(read->takes));
  if (!takes) return check_error(takes.error());
  check_takes(*takes);
}

void check_table(std::string_view text) {
  auto takes = Takes::make({.table = std::string(text), .table_name = "fuzz.csv"});
  if (!takes) return check_error(takes.error());
  check_takes(*takes);
  static const Scene scene = tiny_simulation().value().scene();
  const auto sweep = Sweep::make({scene}, *std::move(takes));
  if (!sweep) return check_error(sweep.error());
  (void)sweep->scene_of(0);
}

void check_log(std::string_view text) {
  const fs::path file = scratch() / "log" / "a.jsonl";
  std::ofstream(file, std::ios::binary) << text;
  LogReader reader(scratch() / "log");
  std::size_t count = 0;
  const auto read = reader.read([&](const LogLine& line) {
    ++count;
    require(line.error.size() <= longest_error_text && line.host.size() <= 255);
  });
  if (!read) return check_error(read.error());
  require(count <= static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n')));
  // Nothing is new.
  require(reader.read([](const LogLine&) { require(false); }).has_value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text = text_of(bytes + 1, size - 1);
  if (bytes[0] == 'j')
    check_file(text);
  else if (bytes[0] == 't')
    check_table(text);
  else
    check_log(text);
  return 0;
}
