#include "pliant/io/writer.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/file_ending.hpp"
#include "pliant/io/npy.hpp"
#include "pliant/io/obj.hpp"
#include "pliant/io/ply.hpp"

namespace pliant {

std::vector<std::string> known_endings() { return {".npy", ".obj", ".ply"}; }

Result<void> check_ending(const std::filesystem::path& file) {
  const std::vector<std::string> endings = known_endings();
  const std::string ending = ending_of(file);
  if (std::find(endings.begin(), endings.end(), ending) != endings.end()) return {};
  return fail(ErrorCode::InvalidInput,
              fmt::format("{}: no format has the ending \"{}\"; allowed: {}", file.string(), ending,
                          fmt::join(endings, ", ")));
}

Result<std::unique_ptr<AnimationWriter>> make_writer(const AnimationPlan& plan) {
  PLIANT_EXPECTS(plan.mesh && plan.first_frame <= plan.last_frame);
  if (auto known = check_ending(plan.file); !known) return fail(known.error());
  const std::string ending = ending_of(plan.file);
  if (ending == ".npy") return make_npy_writer(plan);
  if (ending == ".obj") return make_obj_writer(plan);
  return make_ply_writer(plan);
}

}  // namespace pliant
