#include "inputs.hpp"

#include <system_error>
#include <variant>

namespace pliant::cli {

bool name_one_file(const std::filesystem::path& a, const std::filesystem::path& b) {
  std::error_code ignored;
  // Absolute first: of a relative name that is not there nothing would be resolved.
  const auto place = [&](const std::filesystem::path& path) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(path, ignored), ignored);
  };
  return std::filesystem::equivalent(a, b, ignored) || place(a) == place(b);
}

std::string_view input_named(const std::filesystem::path& file, const Scene& scene) {
  if (name_one_file(file, scene.origin.file)) return "it is the scene";
  for (const Surface& surface : scene.surfaces) {
    const auto* const mesh = std::get_if<MeshFile>(&surface.shape);
    if (mesh && name_one_file(file, mesh->path)) return "it is a mesh of the scene";
  }
  return {};
}

}  // namespace pliant::cli
