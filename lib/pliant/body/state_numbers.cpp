#include "pliant/body/state_numbers.hpp"

namespace pliant {
namespace {

// Calls visit(field, unit) for each field of a state that is combined, with its unit of length.
template <class State, class Visit>
void for_each_field(State& state, double frame_time, const Visit& visit) {
  visit(state.positions, 1.0);
  visit(state.velocities, frame_time);
}

}  // namespace

std::size_t number_count(const BodyState& state) {
  std::size_t count = 0;
  for_each_field(state, 1, [&](const Field& field, double) {
    count += static_cast<std::size_t>(field.size());
  });
  return count;
}

std::vector<double> numbers_of(const BodyState& state, double frame_time) {
  std::vector<double> numbers;
  numbers.reserve(number_count(state));
  for_each_field(state, frame_time, [&](const Field& field, double unit) {
    for (Eigen::Index k = 0; k < field.size(); ++k) numbers.push_back(field.data()[k] * unit);
  });
  return numbers;
}

BodyState with_numbers(BodyState state, double frame_time, const std::vector<double>& numbers) {
  std::size_t place = 0;
  for_each_field(state, frame_time, [&](Field& field, double unit) {
    for (Eigen::Index k = 0; k < field.size(); ++k) field.data()[k] = numbers[place++] / unit;
  });
  return state;
}

}  // namespace pliant
