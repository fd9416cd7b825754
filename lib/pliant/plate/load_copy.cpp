#include "pliant/plate/load_copy.hpp"

#include <fmt/format.h>

namespace pliant {

Result<void> LoadCopy::take(const PlateProblem& problem) {
  if (nodes_.rows() != problem.load.rows()) {
    const auto bytes = static_cast<std::size_t>(problem.load.size()) * sizeof(double);
    nodes_.resize(0, 3);
    if (!memory_.try_resize(bytes)) {
      return fail(ErrorCode::OutOfMemory,
                  fmt::format("a copy of the load on {} nodes {}", problem.load.rows(),
                              memory_.complaint(bytes)));
    }
  }
  nodes_ = problem.load;
  return {};
}

}  // namespace pliant
