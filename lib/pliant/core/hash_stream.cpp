#include "pliant/core/hash_stream.hpp"

#include <new>

#include <xxhash.h>

namespace pliant {

void HashStream::Free::operator()(XXH3_state_s* state) const { XXH3_freeState(state); }

HashStream::HashStream() : state_(XXH3_createState()) {
  if (!state_) throw std::bad_alloc();  // as `new`
  XXH3_128bits_reset(state_.get());
}

void HashStream::add(std::string_view bytes) {
  XXH3_128bits_update(state_.get(), bytes.data(), bytes.size());
}

Hash HashStream::hash() const {
  const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
  return {hash.high64, hash.low64};
}

}  // namespace pliant
