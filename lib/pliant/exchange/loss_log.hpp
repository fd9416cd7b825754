#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "pliant/exchange/hold.hpp"

namespace pliant::exchange {

/// Collects what became of the parts of a curve, one line for each kind of thing.
class LossLog {
 public:
  /// `thing`: "jump"; `result`: "became steps of 1/1024 frame". `keys`: that the thing became, 0:
  /// not told.
  void add(const std::string& thing, const std::string& result, double frame, std::size_t keys,
           double deviation, bool is_exact);

  /// What happens beyond the keys: a line as it is.
  void add_side(std::string message, bool is_exact);

  /// First those beyond the keys, then all others in their order.
  std::vector<Loss> take() const;

 private:
  struct Entry {
    std::size_t count = 0;
    std::size_t order = 0;
    double frame = 0;
    std::size_t keys = 0;
    double deviation = 0;
    bool is_exact = true;
  };
  std::map<std::pair<std::string, std::string>, Entry> entries_;
  std::vector<Loss> sides_;
};

}  // namespace pliant::exchange
