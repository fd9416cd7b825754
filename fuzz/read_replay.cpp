// Arbitrary text as a replay log. The first byte says whether each line is sealed first, as by
// someone who knows how. A log that can be read is compared with itself, with the log of a tiny
// scene, and with runs of that scene and of its own.

#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "pliant/files/read_file.hpp"
#include "pliant/replay/log_file.hpp"
#include "pliant/replay/log_line.hpp"
#include "pliant/replay/replay.hpp"
#include "tiny_scene.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

std::string tiny_log() {
  Simulation simulation = tiny_simulation().value();
  ReplayOptions options;
  options.states_every = 1;
  const std::string file =
      std::filesystem::temp_directory_path() / ("pliant-fuzz-" + std::to_string(getpid()));
  require(record_replay(simulation, file, options).has_value());
  auto text = read_file(file);
  require(text.has_value() && std::remove(file.c_str()) == 0);
  return *std::move(text);
}

/// Seals each line anew; lines without a brace at their end have no place for a seal.
std::string sealed_lines(std::string_view text) {
  constexpr std::string_view seal_member = ",\"seal\":\"";
  std::string result;
  std::string seal;
  auto lines = parts_between(text, "\n");
  if (lines.back().empty()) lines.pop_back();
  for (const std::string_view line : lines) {
    std::string json(line.substr(0, line.rfind(seal_member)));
    if (json.size() < line.size()) json += '}';
    if (!json.ends_with('}')) return result + json;
    result += replay::sealed(std::move(json), seal) + '\n';
  }
  return result;
}

/// As lines it is the same log.
void check_written(const ReplayHeader& header, const std::vector<ReplayFrame>& frames) {
  const auto again = replay::read_header(replay::to_json(header));
  require(again && *again == header);
  for (const ReplayFrame& frame : frames) {
    const auto same = replay::read_frame(replay::to_json(frame), header);
    require(same && same->number == frame.number && same->surfaces == frame.surfaces);
    require(same->states == frame.states);
  }
}

void check_verdict(const Result<ReplayVerdict>& verdict) {
  if (!verdict) return check_error(verdict.error(), any_number);
  require(verdict->holds() == (verdict->mismatches.empty() && verdict->differences.empty()));
  for (const std::string& line : verdict->lines())
    require(!line.empty() && line.find('\n') == std::string::npos);
}

/// The log's own scene, if it is tiny and names no file of the disk.
void check_own_run(const std::string& log, const ReplayHeader& header,
                   const ReplayOptions& options) {
  if (header.scene_file.find_first_not_of("abcdefghijklmnopqrstuvwxyz.") != std::string::npos)
    return;
  const auto scene = parse_scene(header.scene_text, "fuzz.xml", "");
  if (scene && is_tiny(*scene) && is_short(*scene) && header.changes.empty())
    check_verdict(verify_replay(log, {}, options));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const std::string_view text = text_of(bytes + 1, size - 1);
  const MemoryFile file(bytes[0] == 'r' ? std::string(text) : sealed_lines(text));
  auto log = ReplayLogReader::open(file.path());
  if (!log) return check_error(log.error()), 0;
  std::vector<ReplayFrame> frames;
  bool is_whole = false;
  while (!is_whole) {
    auto frame = log->next();
    if (!frame) {
      check_error(frame.error());
      break;
    }
    is_whole = !frame->has_value();
    if (!is_whole) frames.push_back(**std::move(frame));
  }
  const ReplayHeader& header = log->header();
  require(header.start <= header.end);
  if (is_whole) require(static_cast<long>(frames.size()) == header.frame_count());
  check_written(header, frames);

  int steps = 0;
  ReplayOptions options;
  options.simulation = bounded(steps);
  options.keeps_going = true;
  const auto itself = compare_replays(file.path(), file.path(), options);
  require(itself.has_value() == is_whole);
  if (itself) require(itself->holds() && itself->frame_count == header.frame_count());

  static const std::string recorded = tiny_log();
  const MemoryFile other(recorded);
  check_verdict(compare_replays(file.path(), other.path(), options));
  check_verdict(compare_replays(other.path(), file.path(), options));
  static Simulation simulation = tiny_simulation().value();
  check_verdict(verify_replay(file.path(), simulation, options));
  check_own_run(file.path(), header, options);
  return 0;
}
