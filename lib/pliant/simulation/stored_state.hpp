#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "pliant/body/body.hpp"
#include "pliant/core/hash.hpp"
#include "pliant/simulation/frame_store.hpp"
#include "pliant/simulation/step_facts.hpp"

namespace pliant {

// One surface's state as bytes. docs/caching.md tells the layout. Not for other rooms.

/// A state and what the step that made it leaves for warnings.
struct StoredState {
  BodyState state;
  StepFacts facts = {};
};

/// The bytes under a seal. Nodes at rest without velocity take nothing. `rest` is #nodes x 3.
std::string to_bytes(const Hash& key, const BodyState& state, const StepFacts& facts,
                     const Field& rest);

/// What `to_bytes` was given, bit for bit; nothing where a byte is another, or where these are the
/// bytes of another key or another kind of body. `has_marks` tells whether states of the body have
/// `unsettled`.
std::optional<StoredState> from_bytes(std::string_view bytes, const Hash& key, const Field& rest,
                                      bool has_marks);

/// The state under a key of a store, as `from_bytes`; what is damaged is discarded.
std::optional<StoredState> read_stored(FrameStore& store, const Hash& key, const Field& rest,
                                       bool has_marks);

}  // namespace pliant
