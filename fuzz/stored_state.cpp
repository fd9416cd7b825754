// Arbitrary bytes as the stored state of a surface of 9 nodes: the first one says which parts its
// body has and whether the others are sealed first, behind the right key.

#include "pliant/states/stored_state.hpp"

#include <array>
#include <cmath>

#include "fuzz.hpp"
#include "pliant/states/sealed_bytes.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

constexpr Eigen::Index node_count = 9;
constexpr Hash key{1, 2};

Field rest_of_sheet() {
  Field rest(node_count, 3);
  for (Eigen::Index node = 0; node < node_count; ++node)
    rest.row(node) << 0.1 * static_cast<double>(node), -0.0, 1;
  return rest;
}

// What a store could contain if it were written by someone who knows how to seal.
std::string sealed(std::string_view content) {
  std::string bytes(std::string_view("pliant state 1\n\0", 16));
  append(bytes, key);
  bytes += content;
  append_seal(bytes);
  return bytes;
}

void check_state(const StoredState& stored, const Field& rest, StateParts parts) {
  const BodyState& state = stored.state;
  require(parts_of(state) == parts);
  require(state.positions.rows() == node_count && state.positions.allFinite());
  require(state.velocities.rows() == node_count && state.velocities.allFinite());
  require(state.plastic.allFinite());
  if (parts.has_push) require(state.last.loads.allFinite());
  const std::string bytes = to_bytes(key, state, stored.facts, rest);
  const auto again = from_bytes(bytes, key, rest, parts);
  require(again && again->state == state && again->facts == stored.facts);
  require(to_bytes(key, again->state, again->facts, rest) == bytes);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const StateParts parts{(bytes[0] & 1) != 0, (bytes[0] & 2) != 0, (bytes[0] & 4) != 0 ? 11 : 0};
  const bool is_raw = (bytes[0] & 8) != 0;
  const std::string_view content = text_of(bytes + 1, size - 1);
  const std::string file = is_raw ? std::string(content) : sealed(content);
  const Field rest = rest_of_sheet();
  const auto stored = from_bytes(file, key, rest, parts);
  if (stored) check_state(*stored, rest, parts);

  // A store forgets what is no state.
  MemoryStateStore store(std::size_t{1} << 20);
  store.write(key, file);
  if (!store.holds(key)) return 0;
  const auto read = read_stored(store, key, rest, parts);
  if (read) require(stored && read->state == stored->state && read->facts == stored->facts);
  if (!stored) require(!read && !store.holds(key));
  return 0;
}
