#pragma once

#include <cstddef>
#include <vector>

#include "pliant/body/state.hpp"

namespace pliant {

// States as lists of numbers, which the search for a cycle combines linearly. Internal to body.

/// The numbers of a state that are combined, all as lengths; what else it has is no number.
std::vector<double> numbers_of(const BodyState& state, double frame_time);

/// `state` with these numbers.
BodyState with_numbers(BodyState state, double frame_time, const std::vector<double>& numbers);

/// How many numbers `numbers_of` makes.
std::size_t number_count(const BodyState& state);

}  // namespace pliant
