// Arbitrary bytes as the stored state of a surface of 9 nodes: the first one says which parts its
// body has and whether the others are sealed first, behind the right key. A simulation continues
// from such a state, whatever it is.

#include "pliant/states/stored_state.hpp"

#include <map>
#include <optional>
#include <utility>

#include "pliant/states/sealed_bytes.hpp"
#include "tiny_scene.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

constexpr Eigen::Index node_count = 9;
constexpr Hash key{1, 2};
constexpr std::string_view state_magic("pliant state 2\n\0", 16);

Field rest_of_sheet() {
  Field rest(node_count, 3);
  for (Eigen::Index node = 0; node < node_count; ++node)
    rest.row(node) << 0.1 * static_cast<double>(node), -0.0, 1;
  return rest;
}

// What a store could contain if it were written by someone who knows how to seal.
std::string sealed(std::string_view content, const Hash& of_state) {
  std::string bytes(state_magic);
  append(bytes, of_state);
  bytes += content;
  append_seal(bytes);
  return bytes;
}

void check_state(const StoredState& stored, const Field& rest, StateLayout layout) {
  const BodyState& state = stored.state;
  require(layout_of(state) == layout);
  require(state.positions.rows() == node_count && state.positions.allFinite());
  require(state.velocities.rows() == node_count && state.velocities.allFinite());
  require(state.plastic.allFinite());
  if (layout.has_push) require(state.last.loads.allFinite());
  const std::string bytes = to_bytes(key, state, stored.facts, rest);
  const auto again = from_bytes(bytes, key, rest, layout);
  require(again && again->state == state && again->facts == stored.facts);
  require(to_bytes(key, again->state, again->facts, rest) == bytes);
}

/// A simulation whose bodies have these parts, and the key of its state at frame 2.
struct Continued {
  Simulation simulation;
  Hash of_state;
};

std::optional<Continued> continued(StateLayout layout) {
  std::string solver;
  if (layout.has_marks) solver += R"( release="recover")";
  if (layout.has_push) solver += R"( integrator="exact")";
  auto made = tiny_simulation(solver, layout.plastic_places > 0);
  if (!made) return {};  // some parts exclude others
  const auto bytes = made->state_bytes(2);
  require(bytes.has_value());
  const std::size_t state = bytes->find(state_magic);
  require(state != std::string::npos && layout_of(made->state(0)) == layout);
  ByteReader reader(std::string_view(*bytes).substr(state + state_magic.size()));
  const Hash of_state = reader.hash();
  return Continued{*std::move(made), of_state};
}

/// As if it were the state of frame 2: the other frames are finite, or errors.
void check_run(Continued& run, std::string_view content) {
  const std::string state = sealed(content, run.of_state);
  std::string bytes = "pliant checkpoint 1\n";
  append(bytes, std::uint64_t{2});
  append(bytes, std::uint64_t{1});
  append(bytes, std::uint64_t{state.size()});
  bytes += state;
  append_seal(bytes);
  const auto restored = run.simulation.restore(bytes);
  if (!restored) return check_error(restored.error());
  for (const int number : {2, 3}) {
    const auto frame = run.simulation.at(number);
    if (!frame) {
      check_error(frame.error());
      continue;
    }
    require(frame->surfaces()[0].object_positions().allFinite());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const StateLayout layout{(bytes[0] & 1) != 0, (bytes[0] & 2) != 0,
                           (bytes[0] & 4) != 0 ? node_count : 0};
  const bool is_raw = (bytes[0] & 8) != 0;
  const std::string_view content = text_of(bytes + 1, size - 1);
  const std::string file = is_raw ? std::string(content) : sealed(content, key);
  const Field rest = rest_of_sheet();
  const auto stored = from_bytes(file, key, rest, layout);
  if (stored) check_state(*stored, rest, layout);

  static std::map<int, std::optional<Continued>> runs;
  const int body = bytes[0] & 7;
  if (!runs.contains(body)) runs.emplace(body, continued(layout));
  if (runs.at(body)) check_run(*runs.at(body), content);

  // A store forgets what is no state.
  MemoryStateStore store(std::size_t{1} << 20);
  store.write(key, file);
  if (!store.holds(key)) return 0;
  const auto read = read_stored(store, key, rest, layout);
  if (read) require(stored && read->state == stored->state && read->facts == stored->facts);
  if (!stored) require(!read && !store.holds(key));
  return 0;
}
