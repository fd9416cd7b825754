#include "pliant/replay/log_line.hpp"

#include <charconv>
#include <cstdint>
#include <utility>

#include <nlohmann/json.hpp>

#include "pliant/core/hash.hpp"

namespace pliant::replay {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view seal_member = ",\"seal\":\"";
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

// The readers below return whether `json` has the expected form, and never throw.

const Json* member(const Json& json, const char* name) {
  if (!json.is_object()) return nullptr;
  const auto found = json.find(name);
  return found == json.end() ? nullptr : &*found;
}

bool read(const Json* json, std::string& text) {
  if (!json || !json->is_string()) return false;
  text = json->get<std::string>();
  return true;
}

template <class Integer>
bool read(const Json* json, Integer& number) {
  if (!json || !json->is_number_integer()) return false;
  // What is larger than an std::int64_t would wrap round.
  const bool fits = json->is_number_unsigned() ? std::in_range<Integer>(json->get<std::uint64_t>())
                                               : std::in_range<Integer>(json->get<std::int64_t>());
  if (fits) number = json->get<Integer>();
  return fits;
}

bool read(const Json* json, double& number) {
  if (!json || !json->is_number()) return false;
  number = json->get<double>();
  return true;
}

bool read(const Json* json, Hash& hash) {
  std::string text;
  if (!read(json, text)) return false;
  const auto found = to_hash(text);
  if (found) hash = *found;
  return found.has_value();
}

bool read(const Json* json, const ReplaySurface& surface, Field& field) {
  const std::size_t rows = surface.columns == 0
                               ? std::size_t(surface.nodes)
                               : std::size_t(surface.columns) * std::size_t(surface.rows);
  if (!json || !json->is_array() || json->size() != 3 * rows) return false;
  field.resize(static_cast<Eigen::Index>(rows), 3);
  std::size_t k = 0;
  for (const Json& number : *json) {
    const auto row = static_cast<Eigen::Index>(k / 3);
    if (!read(&number, field(row, static_cast<Eigen::Index>(k % 3)))) return false;
    ++k;
  }
  return true;
}

// Reads each element of an array by `read_one(element, value)`.
template <class Value, class ReadOne>
bool read_all(const Json* json, std::vector<Value>& values, const ReadOne& read_one) {
  if (!json || !json->is_array()) return false;
  for (const Json& element : *json) {
    Value value;
    if (!read_one(element, value)) return false;
    values.push_back(std::move(value));
  }
  return true;
}

Json parsed(std::string_view line) { return Json::parse(line, nullptr, false); }

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
  seal = to_text(hash_of(seal + json));
  return json + std::string(seal_member) + seal + "\"}";
}

bool is_sound(std::string_view line, std::string& seal) {
  const std::size_t place = line.rfind(seal_member);
  if (place == std::string_view::npos) return false;
  const std::string expected = to_text(hash_of(seal + std::string(line.substr(0, place))));
  if (line.substr(place + seal_member.size()) != expected + "\"}") return false;
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

std::optional<ReplayHeader> read_header(std::string_view line) {
  const Json json = parsed(line);
  ReplayHeader header;
  const auto read_file = [](const Json& element, ReplayFile& file) {
    return read(member(element, "name"), file.name) && read(member(element, "hash"), file.hash);
  };
  const auto read_surface = [](const Json& element, ReplaySurface& surface) {
    if (!read(member(element, "name"), surface.name)) return false;
    if (member(element, "grid")) {
      return read(member(element, "nodes"), surface.nodes) && surface.nodes >= 0;
    }
    return read(member(element, "columns"), surface.columns) &&
           read(member(element, "rows"), surface.rows) && surface.columns > 0 && surface.rows > 0;
  };
  const auto read_change = [](const Json& element, std::string& change) {
    return read(&element, change);
  };
  const Json* const changes = member(json, "changes");
  if (changes && !read_all(changes, header.changes, read_change)) return {};
  const bool is_header = read(member(json, "version"), header.version) &&
                         read(member(json, "scene"), header.scene_file) &&
                         read(member(json, "text"), header.scene_text) &&
                         read_all(member(json, "files"), header.files, read_file) &&
                         read(member(json, "solver"), header.solver) &&
                         read(member(json, "factors"), header.factors) &&
                         read(member(json, "start"), header.start) &&
                         read(member(json, "end"), header.end) && header.start <= header.end &&
                         read_all(member(json, "surfaces"), header.surfaces, read_surface);
  if (!is_header) return {};
  return header;
}

std::optional<ReplayFrame> read_frame(std::string_view line, const ReplayHeader& header) {
  const Json json = parsed(line);
  ReplayFrame frame;
  const auto read_surface = [&](const Json& element, SurfaceDigest& digest) {
    const bool is_digest = read(member(element, "positions"), digest.positions) &&
                           read(member(element, "velocities"), digest.velocities) &&
                           read(member(element, "region"), digest.region) &&
                           read(member(element, "peak"), digest.peak);
    const Json* const written = member(element, "state");
    if (!is_digest || !written) return is_digest;
    if (frame.states.size() >= header.surfaces.size()) return false;
    const ReplaySurface& surface = header.surfaces[frame.states.size()];
    BodyState& state = frame.states.emplace_back();
    return read(member(*written, "positions"), surface, state.positions) &&
           read(member(*written, "velocities"), surface, state.velocities);
  };
  const bool is_frame = read(member(json, "frame"), frame.number) &&
                        read_all(member(json, "surfaces"), frame.surfaces, read_surface) &&
                        frame.surfaces.size() == header.surfaces.size() &&
                        (frame.states.empty() || frame.states.size() == header.surfaces.size());
  if (!is_frame) return {};
  return frame;
}

std::optional<long> read_end(std::string_view line) {
  if (!line.starts_with(end_member)) return {};
  const Json json = parsed(line);
  long count = 0;
  if (!read(member(json, "frames"), count)) return {};
  return count;
}

}  // namespace pliant::replay
