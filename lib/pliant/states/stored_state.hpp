#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/body/body.hpp"
#include "pliant/body/step_facts.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/states/state_store.hpp"

namespace pliant {

// One surface's state as bytes. docs/caching.md describes the layout. Internal to simulation.

/// A state, and the facts for warnings of the step that computed it.
struct StoredState {
  BodyState state;
  StepFacts facts = {};
};

/// What a state has that not every body has.
struct StateLayout {
  bool has_marks = false;           ///< `unsettled`
  bool has_push = false;            ///< `last`
  Eigen::Index plastic_places = 0;  ///< rows of `plastic`

  friend bool operator==(const StateLayout&, const StateLayout&) = default;
};

StateLayout layout_of(const BodyState& state);

/// Sealed bytes. Nodes at rest without velocity need no bytes. `rest` is #nodes x 3.
std::string to_bytes(const Hash& key, const BodyState& state, const StepFacts& facts,
                     const Field& rest);

/// The arguments of `to_bytes`, bit-identical; null if a byte has changed, or if the bytes are of
/// another key or another kind of body. `layout`: that of the body's states.
std::optional<StoredState> from_bytes(std::string_view bytes, const Hash& key, const Field& rest,
                                      StateLayout layout);

/// The state under a key of a store, as `from_bytes`; damaged bytes are discarded from the store.
std::optional<StoredState> read_stored(StateStore& store, const Hash& key, const Field& rest,
                                       StateLayout layout);

}  // namespace pliant
