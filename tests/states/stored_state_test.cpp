#include "pliant/states/stored_state.hpp"

#include <cmath>
#include <limits>
#include <random>

#include "support/catch.hpp"

using namespace pliant;

namespace {

const Hash key{1, 2};
const StateLayout everything{true, true, 11};

// A state with some nodes away from rest, some only in their position, velocity or mark.
StoredState some_state(const Field& rest, StateLayout layout, double share, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> number(-1, 1);
  const auto with_chance = [&](double chance) { return number(random) < 2 * chance - 1; };
  StoredState stored{{rest, Field::Zero(rest.rows(), 3)}, {}};
  if (layout.has_marks) stored.state.unsettled.assign(static_cast<std::size_t>(rest.rows()), 0);
  LastPush& push = stored.state.last;
  if (layout.has_push) {
    push.loads = Field::Zero(rest.rows(), 3);
    push.unknowns.assign(static_cast<std::size_t>(rest.rows()), 0);
    push.tangents.sv0 = {0.5, -0.0, number(random)};
  }
  stored.state.plastic.setZero(layout.plastic_places, 9);
  for (Eigen::Index place = 0; place < layout.plastic_places; ++place) {
    if (with_chance(share)) stored.state.plastic(place, place % 7) = number(random);
  }
  for (Eigen::Index node = 0; node < rest.rows(); ++node) {
    const bool is_away = with_chance(share);
    if (is_away && with_chance(0.7)) stored.state.positions(node, node % 3) = number(random);
    if (is_away && with_chance(0.7)) stored.state.velocities(node, 1) = number(random);
    if (is_away && layout.has_marks) stored.state.unsettled[static_cast<std::size_t>(node)] = 1;
    if (!layout.has_push || !with_chance(share)) continue;
    push.unknowns[static_cast<std::size_t>(node)] = 1;
    if (with_chance(0.8)) push.loads.row(node) << 0, number(random), -0.0;
  }
  stored.facts.is_solved = with_chance(0.5);
  for (int k = 0; k < 3; ++k) {
    stored.facts.forces.push_back({with_chance(0.5), with_chance(0.5), with_chance(0.5),
                                   with_chance(0.5), with_chance(0.5), with_chance(0.5),
                                   with_chance(0.5)});
  }
  return stored;
}

Field some_rest(Eigen::Index count) {
  Field rest = Field::Zero(count, 3);
  for (Eigen::Index node = 0; node < count; ++node) rest(node, 0) = 0.1 * static_cast<double>(node);
  return rest;
}

std::string bytes_of(const StoredState& stored, const Field& rest) {
  return to_bytes(key, stored.state, stored.facts, rest);
}

}  // namespace

TEST_CASE("a state comes back from its bytes", "[states][stored]") {
  const StateLayout layout{GENERATE(false, true), GENERATE(false, true), GENERATE(0, 37, 80)};
  const double share = GENERATE(0.0, 0.1, 0.5, 1.0);
  const Field rest = some_rest(37);
  const StoredState stored = some_state(rest, layout, share, 3);
  const std::string bytes = bytes_of(stored, rest);
  const auto back = from_bytes(bytes, key, rest, layout);
  REQUIRE(back);
  CHECK(back->state == stored.state);
  CHECK(back->facts == stored.facts);
  CHECK(bytes_of(*back, rest) == bytes);
  CHECK_FALSE(from_bytes(bytes, {1, 3}, rest, layout));
  const auto [marks, push, places] = layout;
  CHECK_FALSE(from_bytes(bytes, key, rest, {!marks, push, places}));
  CHECK_FALSE(from_bytes(bytes, key, rest, {marks, !push, places}));
  CHECK_FALSE(from_bytes(bytes, key, rest, {marks, push, places > 0 ? 0 : 37}));
  CHECK_FALSE(from_bytes(bytes, key, some_rest(36), layout));
  if (share == 0)
    CHECK(bytes.size() < (layout.has_push ? 256 : 128));  // nodes at rest need no bytes
}

TEST_CASE("what no node has away from rest takes nothing", "[states][stored]") {
  const Field rest = some_rest(100);
  StoredState stored{{rest, Field::Zero(100, 3)}, {}};
  const auto size = [&] { return bytes_of(stored, rest).size(); };
  const std::size_t none = size();
  stored.state.positions.col(1).setConstant(0.5);
  const std::size_t one = size();
  CHECK(one == none + 16 + 100 * 8);
  stored.state.velocities.col(1).setConstant(-1);
  CHECK(size() == one + 100 * 8);
  stored.state.positions.setConstant(2);
  stored.state.velocities.setConstant(2);
  CHECK(size() == none + 16 + 100 * 6 * 8);
  const auto back = from_bytes(bytes_of(stored, rest), key, rest, {});
  REQUIRE(back);
  CHECK(back->state == stored.state);
}

TEST_CASE("a minus before a zero is kept", "[states][stored]") {
  const Field rest = some_rest(5);
  StoredState stored{{rest, Field::Zero(5, 3)}, {}};
  stored.state.positions(0, 1) = -0.0;
  stored.state.velocities(3, 2) = -0.0;
  const auto back = from_bytes(bytes_of(stored, rest), key, rest, {});
  REQUIRE(back);
  CHECK(std::signbit(back->state.positions(0, 1)));
  CHECK(std::signbit(back->state.velocities(3, 2)));
}

TEST_CASE("bytes that were cut or changed are no state", "[states][stored]") {
  const Field rest = some_rest(9);
  const std::string bytes = bytes_of(some_state(rest, everything, 0.5, 5), rest);
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    CHECK_FALSE(from_bytes(std::string_view(bytes).substr(0, size), key, rest, everything));
  }
  CHECK_FALSE(from_bytes(bytes + '\0', key, rest, everything));
  for (std::size_t place = 0; place < bytes.size(); ++place) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string changed = bytes;
      changed[place] = static_cast<char>(changed[place] ^ (1 << bit));
      CHECK_FALSE(from_bytes(changed, key, rest, everything));
    }
  }
}

TEST_CASE("a good seal on nonsense makes no state of it", "[states][stored]") {
  const Field rest = some_rest(9);
  const std::string bytes = bytes_of(some_state(rest, everything, 0.5, 5), rest);
  const auto sealed = [](std::string inner) {
    const Hash seal = hash_of(std::string_view(inner));
    inner.append(reinterpret_cast<const char*>(&seal.high), 8);
    inner.append(reinterpret_cast<const char*>(&seal.low), 8);
    return inner;
  };
  const std::string inner = bytes.substr(0, bytes.size() - 16);
  REQUIRE(sealed(inner) == bytes);
  for (std::size_t size = 0; size < inner.size(); ++size) {
    CHECK_FALSE(from_bytes(sealed(inner.substr(0, size)), key, rest, everything));
  }
  // Counts and runs of any size, anywhere in the head, must not cause access outside the arrays.
  for (std::size_t place = 16; place + 8 <= inner.size(); ++place) {
    for (const std::uint64_t number : {std::uint64_t{0}, std::uint64_t{10}, std::uint64_t{1} << 60,
                                       std::numeric_limits<std::uint64_t>::max()}) {
      std::string changed = inner;
      changed.replace(place, 8, reinterpret_cast<const char*>(&number), 8);
      const auto back = from_bytes(sealed(changed), key, rest, everything);
      if (back) CHECK(back->state.positions.rows() == 9);
    }
  }
}
