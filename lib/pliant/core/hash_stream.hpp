#pragma once

#include <memory>
#include <string_view>

#include "pliant/core/hash.hpp"

struct XXH3_state_s;

namespace pliant {

/// The hash of bytes that arrive in pieces; equal to the hash of all of them at once.
class HashStream {
 public:
  HashStream();

  void add(std::string_view bytes);
  Hash hash() const;

 private:
  struct Free {
    void operator()(XXH3_state_s* state) const;
  };
  std::unique_ptr<XXH3_state_s, Free> state_;
};

}  // namespace pliant
