#include "pliant/replay/log_line.hpp"

#include <charconv>
#include <cstdint>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/core/hash.hpp"
#include "pliant/core/hash_stream.hpp"
#include "pliant/files/json/json_reader.hpp"

namespace pliant::replay {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view seal_member = ",\"seal\":\"", seal_end = "\"}";
constexpr std::string_view end_member = "{\"frames\":";  // recognised without parsing the line

// A path may be text that is not UTF-8; a scene never is.
std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Json to_json(const Field& field) {
  Json numbers = Json::array();
  for (Eigen::Index row = 0; row < field.rows(); ++row) {
    for (Eigen::Index component = 0; component < 3; ++component) {
      numbers.push_back(field(row, component));
    }
  }
  return numbers;
}

// Reads what a line has.
class LineContent : private JsonReader {
 public:
  LineContent(JsonReader::Json& root, const StopRequest& should_stop)
      : JsonReader(root, should_stop) {}

  Result<ReplayHeader> header() {
    ReplayHeader header;
    header.version = required_text(root_, "version");
    header.scene_file = required_text(root_, "scene");
    header.scene_text = required_text(root_, "text");
    header.changes = texts(root_, "changes");
    each_required(root_, "files", [&](auto& json) {
      header.files.push_back({required_text(json, "name"), required_hash(json, "hash")});
    });
    header.solver = required_text(root_, "solver");
    header.factors = required_text(root_, "factors");
    header.start = required_int(root_, "start");
    header.end = required_int(root_, "end", header.start);
    each_required(root_, "surfaces", [&](auto& json) { header.surfaces.push_back(surface(json)); });
    if (fault_) return fault();
    return header;
  }

  Result<ReplayFrame> frame(const std::vector<ReplaySurface>& surfaces) {
    ReplayFrame frame;
    frame.number = required_int(root_, "frame");
    each_required(root_, "surfaces", [&](auto& json) {
      const std::size_t k = frame.surfaces.size();
      if (k == surfaces.size()) return refuse("", "is one more than the surfaces of the log");
      frame.surfaces.push_back({required_hash(json, "positions"), required_hash(json, "velocities"),
                                required_hash(json, "region"), required_number(json, "peak")});
      JsonReader::Json* const written = part(json, "state");
      if (written ? frame.states.size() != k : !frame.states.empty())
        return refuse("state", "is there in some surfaces only");
      if (!written) return;
      BodyState& state = frame.states.emplace_back();
      within("state", [&] {
        state.positions = field(*written, "positions", surfaces[k]);
        state.velocities = field(*written, "velocities", surfaces[k]);
      });
    });
    if (frame.surfaces.size() != surfaces.size())
      refuse("surfaces", "has not as many elements as the log has surfaces");
    if (fault_) return fault();
    return frame;
  }

  Result<long> frame_count() {
    constexpr auto most = std::numeric_limits<long>::max();
    const std::int64_t count = required_integer(root_, "frames", 0, most);
    if (fault_) return fault();
    return static_cast<long>(count);
  }

 private:
  ReplaySurface surface(JsonReader::Json& json) {
    ReplaySurface surface{.name = required_text(json, "name")};
    if (member(json, "grid")) {
      surface.nodes = required_int(json, "nodes", 0);
    } else {
      surface.columns = required_int(json, "columns", 1);
      surface.rows = required_int(json, "rows", 1);
    }
    return surface;
  }

  Field field(JsonReader::Json& parent, const char* key, const ReplaySurface& surface) {
    const JsonReader::Json* const numbers = member(parent, key);
    const std::size_t rows = surface.columns == 0
                                 ? std::size_t(surface.nodes)
                                 : std::size_t(surface.columns) * std::size_t(surface.rows);
    if (!numbers || !numbers->is_array() || numbers->size() != 3 * rows) {
      refuse(key, fmt::format("is not a list of {} numbers", 3 * rows));
      return {};
    }
    Field field(static_cast<Eigen::Index>(rows), 3);
    for (std::size_t k = 0; k < numbers->size() && goes_on(); ++k) {
      const JsonReader::Json& number = (*numbers)[k];
      if (!number.is_number()) refuse(key, "has an element that is not a number");
      field(static_cast<Eigen::Index>(k / 3), static_cast<Eigen::Index>(k % 3)) =
          number.is_number() ? number.get<double>() : 0;
    }
    return field;
  }
};

Result<JsonReader::Json> parsed(std::string_view line, const StopRequest& should_stop) {
  return parse_json(line, "a replay log", should_stop, most_values);
}

Hash hash_of_line(const std::string& seal, std::string_view json) {
  HashStream stream;
  stream.add(seal);
  stream.add(json);
  return stream.hash();
}

}  // namespace

std::string to_json(const ReplayHeader& header) {
  Json json;
  json["pliant_replay"] = replay_format;
  json["version"] = header.version;
  json["scene"] = header.scene_file;
  json["text"] = header.scene_text;
  if (!header.changes.empty()) json["changes"] = header.changes;
  json["files"] = Json::array();
  for (const ReplayFile& file : header.files) {
    json["files"].push_back({{"name", file.name}, {"hash", to_text(file.hash)}});
  }
  json["solver"] = header.solver;
  json["factors"] = header.factors;
  json["start"] = header.start;
  json["end"] = header.end;
  json["surfaces"] = Json::array();
  for (const ReplaySurface& surface : header.surfaces) {
    Json& written = json["surfaces"].emplace_back();
    written["name"] = surface.name;
    if (surface.columns == 0) {
      written["grid"] = nullptr;
      written["nodes"] = surface.nodes;
    } else {
      written["columns"] = surface.columns;
      written["rows"] = surface.rows;
    }
  }
  return to_line(json);
}

std::string to_json(const ReplayFrame& frame) {
  Json json;
  json["frame"] = frame.number;
  json["surfaces"] = Json::array();
  for (std::size_t k = 0; k < frame.surfaces.size(); ++k) {
    const SurfaceDigest& digest = frame.surfaces[k];
    Json surface = {{"positions", to_text(digest.positions)},
                    {"velocities", to_text(digest.velocities)},
                    {"region", to_text(digest.region)},
                    {"peak", digest.peak}};
    if (!frame.states.empty()) {
      surface["state"] = {{"positions", to_json(frame.states[k].positions)},
                          {"velocities", to_json(frame.states[k].velocities)}};
    }
    json["surfaces"].push_back(std::move(surface));
  }
  return to_line(json);
}

std::string to_json_end(long frame_count) { return to_line(Json{{"frames", frame_count}}); }

std::string sealed(std::string json, std::string& seal) {
  json.pop_back();  // the closing brace
  seal = to_text(hash_of_line(seal, json));
  return json.append(seal_member).append(seal).append(seal_end);
}

Result<bool> is_sound(std::string_view line, std::string& seal, const StopRequest& should_stop) {
  constexpr std::size_t digits = 2 * sizeof(Hash);
  constexpr std::size_t size = seal_member.size() + digits + seal_end.size();
  if (line.size() < size) return false;
  const std::string_view json = line.substr(0, line.size() - size);
  if (is_stopped(should_stop)) return interrupted();
  const std::string expected = to_text(hash_of_line(seal, json));
  if (line.substr(json.size()) != fmt::format("{}{}{}", seal_member, expected, seal_end))
    return false;
  seal = expected;
  return true;
}

std::optional<int> format_of(std::string_view line) {
  line.remove_prefix(first_member.size());
  int format = 0;
  const auto [stop, error] = std::from_chars(line.data(), line.data() + line.size(), format);
  if (error != std::errc()) return {};
  return format;
}

bool is_end(std::string_view line) { return line.starts_with(end_member); }

Result<ReplayHeader> read_header(std::string_view line, const StopRequest& should_stop) {
  auto json = parsed(line, should_stop);
  if (!json) return fail(json.error());
  return LineContent(*json, should_stop).header();
}

Result<ReplayFrame> read_frame(std::string_view line, const ReplayHeader& header,
                               const StopRequest& should_stop) {
  auto json = parsed(line, should_stop);
  if (!json) return fail(json.error());
  return LineContent(*json, should_stop).frame(header.surfaces);
}

Result<long> read_end(std::string_view line) {
  auto json = parsed(line, {});
  if (!json) return fail(json.error());
  return LineContent(*json, {}).frame_count();
}

}  // namespace pliant::replay
