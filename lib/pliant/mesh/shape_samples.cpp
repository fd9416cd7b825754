#include "pliant/mesh/shape_samples.hpp"

#include <algorithm>
#include <utility>

namespace pliant {

ShapeSamples::ShapeSamples(std::vector<Field> samples) {
  if (!samples.empty()) samples_ = std::make_shared<const std::vector<Field>>(std::move(samples));
}

std::size_t ShapeSamples::bytes() const {
  std::size_t numbers = 0;
  for (std::size_t k = 0; k < count(); ++k)
    numbers += static_cast<std::size_t>((*samples_)[k].size());
  return numbers * sizeof(double);
}

bool operator==(const ShapeSamples& a, const ShapeSamples& b) {
  if (a.samples_ == b.samples_) return true;
  return a.count() == b.count() && std::ranges::equal(*a.samples_, *b.samples_, are_equal);
}

}  // namespace pliant
