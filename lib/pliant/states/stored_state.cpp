#include "pliant/states/stored_state.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <functional>
#include <vector>

#include "pliant/states/sealed_bytes.hpp"

namespace pliant {
namespace {

constexpr std::string_view magic("pliant state 2\n\0", 16);

// Nodes first, first + 1, ..., first + count - 1.
struct Run {
  std::uint64_t first = 0;
  std::uint64_t count = 0;
};

bool is_same(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

bool is_at_rest(const BodyState& state, const Field& rest, Eigen::Index node) {
  for (int component = 0; component < 3; ++component) {
    if (!is_same(state.positions(node, component), rest(node, component))) return false;
    if (!is_same(state.velocities(node, component), 0)) return false;
  }
  return state.unsettled.empty() || state.unsettled[static_cast<std::size_t>(node)] == 0;
}

// One bit for each of x, y and z of the positions, then of the velocities, set if the component of
// any node differs from rest. On a surface pushed along one axis, four of the six are at rest
// everywhere.
using Columns = std::uint64_t;

bool holds(Columns columns, int component) { return (columns >> component & 1u) != 0; }

Columns columns_away_from_rest(const BodyState& state, const Field& rest) {
  const auto is_zero = [](double number) { return is_same(number, 0); };
  Columns columns = 0;
  for (int component = 0; component < 3; ++component) {
    const auto positions = state.positions.col(component);
    const auto velocities = state.velocities.col(component);
    if (!std::equal(positions.begin(), positions.end(), rest.col(component).begin(), is_same)) {
      columns |= Columns{1} << component;
    }
    if (!std::all_of(velocities.begin(), velocities.end(), is_zero)) {
      columns |= Columns{8} << component;
    }
  }
  return columns;
}

// The runs of rows that `is_in`.
template <class IsIn>
std::vector<Run> runs_of(Eigen::Index rows, const IsIn& is_in) {
  std::vector<Run> runs;
  for (Eigen::Index row = 0; row < rows; ++row) {
    if (!is_in(row)) continue;
    const auto place = static_cast<std::uint64_t>(row);
    if (!runs.empty() && runs.back().first + runs.back().count == place) {
      ++runs.back().count;
    } else {
      runs.push_back({place, 1});
    }
  }
  return runs;
}

std::vector<Run> runs_away_from_rest(const BodyState& state, const Field& rest) {
  return runs_of(rest.rows(), [&](Eigen::Index node) { return !is_at_rest(state, rest, node); });
}

unsigned char bits_of(const ForceFacts& facts) {
  const auto& [is_too_small, is_between_nodes, is_outside, touches, is_push_awaited, pushes,
               is_lost, is_apart] = facts;
  unsigned bits = 0;
  for (const bool fact : {is_between_nodes, is_apart, is_too_small, is_outside, touches,
                          is_push_awaited, pushes, is_lost}) {
    bits = bits << 1 | (fact ? 1u : 0u);
  }
  return static_cast<unsigned char>(bits);
}

ForceFacts facts_of(unsigned bits) {
  const auto bit = [bits](int place) { return (bits >> place & 1u) != 0; };
  return {bit(5), bit(7), bit(4), bit(3), bit(2), bit(1), bit(0), bit(6)};
}

// More than any scene has.
constexpr std::uint64_t most_colliders = 1'000'000;

using Numbers = std::array<double, 12>;

Numbers numbers_of(const EdgeTangents& tangents) {
  Numbers numbers;
  int place = 0;
  for (const Vector3d& side : {tangents.su0, tangents.su1, tangents.sv0, tangents.sv1}) {
    for (int k = 0; k < 3; ++k) numbers[place++] = side[k];
  }
  return numbers;
}

EdgeTangents tangents_of(const Numbers& numbers) {
  const auto side = [&](int k) { return Vector3d(&numbers[3 * static_cast<std::size_t>(k)]); };
  return {side(0), side(1), side(2), side(3)};
}

std::vector<Run> unknown_runs(const LastPush& push) {
  return runs_of(static_cast<Eigen::Index>(push.unknowns.size()), [&](Eigen::Index node) {
    return push.unknowns[static_cast<std::size_t>(node)] != 0;
  });
}

// Those that are not 0 in all rows.
template <class Rows>
Columns columns_away_from_0(const Rows& rows) {
  Columns columns = 0;
  for (int component = 0; component < Rows::ColsAtCompileTime; ++component) {
    const auto of_component = rows.col(component);
    const bool is_zero = std::all_of(of_component.begin(), of_component.end(),
                                     [](double number) { return is_same(number, 0); });
    if (!is_zero) columns |= Columns{1} << component;
  }
  return columns;
}

// Reads runs. Null if they are not within the nodes or not ascending.
std::optional<std::vector<Run>> read_runs(ByteReader& reader, std::uint64_t node_count) {
  const std::uint64_t count = reader.number();
  if (count > reader.left() / sizeof(Run)) return {};
  std::vector<Run> runs(static_cast<std::size_t>(count));
  std::uint64_t next = 0;
  for (Run& run : runs) {
    run.first = reader.number();
    run.count = reader.number();
    if (run.first < next || run.first > node_count || run.count > node_count - run.first) return {};
    next = run.first + run.count;
  }
  return runs;
}

void append_runs(std::string& bytes, const std::vector<Run>& runs) {
  append(bytes, std::uint64_t{runs.size()});
  for (const Run& run : runs) {
    append(bytes, run.first);
    append(bytes, run.count);
  }
}

template <class Rows>
void append_rows(std::string& bytes, const Rows& field, const std::vector<Run>& runs,
                 Columns columns) {
  for (int component = 0; component < Rows::ColsAtCompileTime; ++component) {
    if (!holds(columns, component)) continue;
    for (const Run& run : runs) {
      append(bytes, field.col(component).data() + run.first, run.count * sizeof(double));
    }
  }
}

template <class Rows>
void take_rows(ByteReader& reader, Rows& field, const std::vector<Run>& runs, Columns columns) {
  for (int component = 0; component < Rows::ColsAtCompileTime; ++component) {
    if (!holds(columns, component)) continue;
    for (const Run& run : runs) {
      reader.take(field.col(component).data() + run.first, run.count * sizeof(double));
    }
  }
}

void append_push(std::string& bytes, const LastPush& push) {
  const std::vector<Run> runs = unknown_runs(push);
  const Columns columns = columns_away_from_0(push.loads);
  const Numbers numbers = numbers_of(push.tangents);
  append(bytes, numbers.data(), sizeof(numbers));
  append_runs(bytes, runs);
  append(bytes, columns);
  append_rows(bytes, push.loads, runs, columns);
}

// False if the bytes are not those of `append_push`.
bool take_push(ByteReader& reader, std::uint64_t node_count, LastPush& push) {
  Numbers numbers{};
  reader.take(numbers.data(), sizeof(numbers));
  push.tangents = tangents_of(numbers);
  const auto runs = read_runs(reader, node_count);
  if (!runs) return false;
  push.loads = Field::Zero(static_cast<Eigen::Index>(node_count), 3);
  push.unknowns.assign(static_cast<std::size_t>(node_count), 0);
  for (const Run& run : *runs) {
    std::fill_n(push.unknowns.begin() + static_cast<std::ptrdiff_t>(run.first), run.count,
                std::uint8_t{1});
  }
  take_rows(reader, push.loads, *runs, reader.number());
  return push.loads.allFinite() &&
         std::all_of(numbers.begin(), numbers.end(), [](double x) { return std::isfinite(x); });
}

void append_plastic(std::string& bytes, const PlasticField& plastic) {
  const std::vector<Run> runs = runs_of(plastic.rows(), [&](Eigen::Index row) {
    const auto numbers = plastic.row(row);
    return !std::all_of(numbers.begin(), numbers.end(), [](double x) { return is_same(x, 0); });
  });
  const Columns columns = columns_away_from_0(plastic);
  append_runs(bytes, runs);
  append(bytes, columns);
  append_rows(bytes, plastic, runs, columns);
}

// False if the bytes are not those of `append_plastic`.
bool take_plastic(ByteReader& reader, Eigen::Index rows, PlasticField& plastic) {
  const auto runs = read_runs(reader, static_cast<std::uint64_t>(rows));
  if (!runs) return false;
  plastic.setZero(rows, 9);
  take_rows(reader, plastic, *runs, reader.number());
  return plastic.allFinite();
}

void append_inside(std::string& bytes, const NodesInside& inside) {
  append(bytes, static_cast<std::uint64_t>(inside.count));
  append(bytes, &inside.depth, sizeof(double));
}

void append_contacts(std::string& bytes, const std::vector<ContactFacts>& contacts) {
  append(bytes, std::uint64_t{contacts.size()});
  for (const auto& [collider, nodes, force, touched, thrown, held, squeezed] : contacts) {
    append(bytes, static_cast<std::uint64_t>(collider));
    append(bytes, std::uint64_t{nodes.size()});
    append(bytes, nodes.data(), nodes.size() * sizeof(int));
    append(bytes, force.data(), 3 * sizeof(double));
    append(bytes, std::uint64_t{touched});
    append_inside(bytes, thrown);
    append_inside(bytes, held);
    append(bytes, std::uint64_t{squeezed.size()});
    append(bytes, squeezed.data(), squeezed.size() * sizeof(int));
  }
}

// False if it is not one of the first `count` numbers.
bool take_index(ByteReader& reader, std::uint64_t count, int& index) {
  const std::uint64_t number = reader.number();
  index = static_cast<int>(number);
  return number < count;
}

// False if the bytes are not those of ascending numbers below `end`.
bool take_indices(ByteReader& reader, std::uint64_t end, std::vector<int>& indices) {
  const std::uint64_t count = reader.number();
  if (count > reader.left() / sizeof(int)) return false;
  indices.resize(static_cast<std::size_t>(count));
  reader.take(indices.data(), indices.size() * sizeof(int));
  return std::ranges::adjacent_find(indices, std::greater_equal()) == indices.end() &&
         (indices.empty() ||
          (indices.front() >= 0 && static_cast<std::uint64_t>(indices.back()) < end));
}

bool take_inside(ByteReader& reader, std::uint64_t node_count, NodesInside& inside) {
  const bool is_count = take_index(reader, node_count + 1, inside.count);
  reader.take(&inside.depth, sizeof(double));
  return is_count && std::isfinite(inside.depth);
}

// False if the bytes are not those of `append_contacts`.
bool take_contacts(ByteReader& reader, std::uint64_t node_count,
                   std::vector<ContactFacts>& contacts) {
  const std::uint64_t count = reader.number();
  for (std::uint64_t k = 0; k < count; ++k) {
    auto& [collider, nodes, force, touched, thrown, held, squeezed] = contacts.emplace_back();
    int flag = 0;
    if (!take_index(reader, most_colliders, collider) || !take_indices(reader, node_count, nodes))
      return false;
    reader.take(force.data(), 3 * sizeof(double));
    if (!force.allFinite() || !take_index(reader, 2, flag)) return false;
    touched = flag != 0;
    if (!take_inside(reader, node_count, thrown) || !take_inside(reader, node_count, held) ||
        !take_indices(reader, most_colliders, squeezed) || !reader.is_sound()) {
      return false;
    }
  }
  return true;
}

// A node is pushed by at most three colliders.
constexpr std::size_t bytes_of_node = 9 * sizeof(double) + 1 + 3 * sizeof(int);

// The most bytes of a state besides its runs and nodes.
std::size_t most_head(std::size_t force_count) {
  return magic.size() + 2 * sizeof(Hash) + 10 * sizeof(std::uint64_t) + sizeof(Numbers) +
         force_count;
}

// An upper bound for the bytes of a state: in the worst case every other node is away from rest, or
// all are.
std::size_t most_bytes(Eigen::Index node_count, Eigen::Index plastic_count) {
  constexpr std::size_t forces = 1'000'000;  // more than any scene has, with its colliders
  const auto nodes = static_cast<std::size_t>(node_count);
  const auto places = static_cast<std::size_t>(plastic_count);
  return most_head(forces) + (nodes + 1) / 2 * 2 * sizeof(Run) + nodes * bytes_of_node +
         (places + 1) / 2 * sizeof(Run) + places * 9 * sizeof(double);
}

std::uint64_t number_of(StateLayout layout) {
  return (layout.has_marks ? 1u : 0u) | (layout.has_push ? 2u : 0u) |
         (layout.plastic_places > 0 ? 4u : 0u);
}

}  // namespace

StateLayout layout_of(const BodyState& state) {
  return {!state.unsettled.empty(), !state.last.unknowns.empty(), state.plastic.rows()};
}

std::string to_bytes(const Hash& key, const BodyState& state, const StepFacts& facts,
                     const Field& rest) {
  const std::vector<Run> runs = runs_away_from_rest(state, rest);
  const Columns columns = columns_away_from_rest(state, rest);
  std::size_t away = 0;
  for (const Run& run : runs) away += run.count;
  std::string bytes;
  bytes.reserve(most_head(facts.forces.size()) + runs.size() * sizeof(Run) +
                away * (static_cast<std::size_t>(std::popcount(columns)) * sizeof(double) + 1));
  bytes += magic;
  append(bytes, key);
  append(bytes, static_cast<std::uint64_t>(rest.rows()));
  const StateLayout layout = layout_of(state);
  append(bytes, number_of(layout));
  append(bytes, std::uint64_t{(facts.is_solved ? 1u : 0u) | (facts.is_surface ? 2u : 0u) |
                              (facts.has_loose_patch ? 4u : 0u)});
  append(bytes, std::uint64_t{facts.forces.size()});
  for (const ForceFacts& of_force : facts.forces) {
    bytes += static_cast<char>(bits_of(of_force));
  }
  append_runs(bytes, runs);
  append(bytes, columns);
  append_rows(bytes, state.positions, runs, columns);
  append_rows(bytes, state.velocities, runs, columns >> 3);
  if (!state.unsettled.empty()) {
    for (const Run& run : runs) append(bytes, state.unsettled.data() + run.first, run.count);
  }
  if (layout.has_push) append_push(bytes, state.last);
  if (layout.plastic_places > 0) append_plastic(bytes, state.plastic);
  append_contacts(bytes, state.contacts);
  append_seal(bytes);
  return bytes;
}

std::optional<StoredState> from_bytes(std::string_view bytes, const Hash& key, const Field& rest,
                                      StateLayout layout) {
  const auto held = unsealed(bytes, magic);
  if (!held) return {};
  ByteReader reader(*held);
  if (reader.hash() != key) return {};
  const auto node_count = static_cast<std::uint64_t>(rest.rows());
  if (reader.number() != node_count || reader.number() != number_of(layout)) return {};
  StoredState stored;
  const std::uint64_t flags = reader.number();
  stored.facts.is_solved = (flags & 1) != 0;
  stored.facts.is_surface = (flags & 2) != 0;
  stored.facts.has_loose_patch = (flags & 4) != 0;
  const std::uint64_t force_count = reader.number();
  if (force_count > reader.left()) return {};
  for (std::uint64_t k = 0; k < force_count; ++k) {
    unsigned char bits = 0;
    reader.take(&bits, 1);
    stored.facts.forces.push_back(facts_of(bits));
  }
  const auto runs = read_runs(reader, node_count);
  if (!runs) return {};
  BodyState& state = stored.state;
  state.positions = rest;
  state.velocities = Field::Zero(rest.rows(), 3);
  const Columns columns = reader.number();
  take_rows(reader, state.positions, *runs, columns);
  take_rows(reader, state.velocities, *runs, columns >> 3);
  if (layout.has_marks) {
    state.unsettled.assign(static_cast<std::size_t>(node_count), 0);
    for (const Run& run : *runs) reader.take(state.unsettled.data() + run.first, run.count);
  }
  if (layout.has_push && !take_push(reader, node_count, state.last)) return {};
  if (layout.plastic_places > 0 && !take_plastic(reader, layout.plastic_places, state.plastic))
    return {};
  if (!take_contacts(reader, node_count, state.contacts)) return {};
  if (!reader.is_sound() || reader.left() != 0) return {};
  if (!state.positions.allFinite() || !state.velocities.allFinite()) return {};
  return stored;
}

std::optional<StoredState> read_stored(StateStore& store, const Hash& key, const Field& rest,
                                       StateLayout layout) {
  const auto bytes = store.read(key, most_bytes(rest.rows(), layout.plastic_places));
  if (!bytes) return {};
  auto stored = from_bytes(*bytes, key, rest, layout);
  if (!stored) store.discard(key);
  return stored;
}

}  // namespace pliant
