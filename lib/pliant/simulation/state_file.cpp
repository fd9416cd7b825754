#include "pliant/simulation/state_file.hpp"

#include <utility>

#include "pliant/files/atomic_file.hpp"
#include "pliant/files/read_file.hpp"

namespace pliant {

Result<void> write_state(const std::string& file, Simulation& simulation, int frame) {
  const auto bytes = simulation.state_bytes(frame);
  if (!bytes) return fail(bytes.error());
  return write_file(file, *bytes);
}

Result<int> read_state(const std::string& file, Simulation& simulation) {
  const auto bytes = read_file(file);
  if (!bytes) return fail(bytes.error());
  auto frame = simulation.restore(*bytes);
  if (frame) return frame;
  Error error = std::move(frame.error());
  error.file = file;
  return fail(std::move(error));
}

}  // namespace pliant
