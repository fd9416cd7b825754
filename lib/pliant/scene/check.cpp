#include "pliant/scene/check.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <set>

#include <fmt/format.h>

#include "pliant/core/read_file.hpp"

namespace pliant {
namespace {

class SceneChecker {
 public:
  explicit SceneChecker(const Scene& scene) : scene_(scene) {}

  std::vector<Error> check() {
    for (const Surface& surface : scene_.surfaces) surfaces_.insert(surface.name);
    for (const Group& group : scene_.groups) groups_.insert(group.name);
    if (!(scene_.fps > 0) || !std::isfinite(scene_.fps) || !std::isfinite(1 / scene_.fps)) {
      complain("", "fps", fmt::format("fps is {}, but must be greater than 0", scene_.fps));
    }
    for (const auto& [attribute, frame] :
         {std::pair{"start", scene_.start}, std::pair{"end", scene_.end}}) {
      if (frame < -largest_frame || frame > largest_frame) {
        complain("", attribute,
                 fmt::format("{} is {}, but must be within {} frames of 0", attribute, frame,
                             largest_frame));
        return std::move(errors_);
      }
    }
    if (scene_.end < scene_.start) {
      complain("", "end",
               fmt::format("end is {}, but must not be before start, which is {}", scene_.end,
                           scene_.start));
    } else if (std::int64_t{scene_.end} - scene_.start >= max_frames) {
      complain("", "end",
               fmt::format("start {} to end {} are too many frames; at most {} are allowed",
                           scene_.start, scene_.end, max_frames));
    }
    for (const Surface& surface : scene_.surfaces) {
      check_name(surface.name);
      if (const auto* sheet = std::get_if<GridSheet>(&surface.shape))
        check_sheet(surface.name, *sheet);
    }
    for (const Force& force : scene_.forces) {
      check_name(force.name);
      check_targets("force", force.name, force.targets);
      check_group(force);
      check_function(force);
    }
    for (const Group& group : scene_.groups) {
      check_name(group.name);
      check_targets("group", group.name, group.targets);
    }
    return std::move(errors_);
  }

 private:
  void check_name(const std::string& name) {
    if (!is_name(name)) {
      complain(
          name, "name",
          fmt::format("the name \"{}\" must be a letter or _ followed by letters, digits, _ and -",
                      name));
    } else if (!names_.insert(name).second) {
      complain(name, "name", fmt::format("the name \"{}\" is given twice", name));
    }
  }

  void check_sheet(const std::string& name, const GridSheet& sheet) {
    for (const auto& [attribute, count] :
         {std::pair{"columns", sheet.columns}, std::pair{"rows", sheet.rows}}) {
      if (count < 3) {
        complain(name, attribute,
                 fmt::format("{} is {}, but must be at least 3", attribute, count));
      }
    }
    if (std::int64_t{sheet.columns} * sheet.rows > max_sheet_vertices) {
      complain(name, "columns",
               fmt::format("{} x {} vertices are too many; at most {} are allowed", sheet.columns,
                           sheet.rows, max_sheet_vertices));
    }
    for (const auto& [attribute, extent] :
         {std::pair{"width", sheet.width}, std::pair{"depth", sheet.depth}}) {
      if (!(extent > 0 && extent <= largest_extent)) {
        complain(name, attribute,
                 fmt::format("{} is {}, but must be greater than 0 and at most {}", attribute,
                             extent, largest_extent));
      }
    }
  }

  void check_targets(std::string_view what, const std::string& name,
                     const std::vector<std::string>& targets) {
    for (const std::string& target : targets) {
      if (!surfaces_.contains(target)) {
        complain(
            name, "targets",
            fmt::format("{} \"{}\" targets \"{}\", which is not a surface", what, name, target));
      }
    }
  }

  void check_group(const Force& force) {
    if (!force.group.empty() && !groups_.contains(force.group)) {
      complain(
          force.name, "group",
          fmt::format("force \"{}\" is in \"{}\", which is not a group", force.name, force.group));
    }
  }

  void check_function(const Force& force) {
    const auto* custom = std::get_if<CustomForce>(&force.shape);
    if (custom && !custom->unit_force) {
      complain(force.name, "unit_force",
               fmt::format("force \"{}\" is custom, but has no unit_force function", force.name));
    }
  }

  void complain(const std::string& name, const std::string& attribute, std::string message) {
    errors_.push_back({.code = ErrorCode::InvalidInput,
                       .message = std::move(message),
                       .file = scene_.origin.file,
                       .line = scene_.origin.line_of(name, attribute)});
  }

  const Scene& scene_;
  std::set<std::string_view> surfaces_;
  std::set<std::string_view> groups_;
  std::set<std::string> names_;
  std::vector<Error> errors_;
};

}  // namespace

bool is_name(std::string_view text) {
  const auto is_first = [](char c) {
    return c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  const auto is_later = [&](char c) { return is_first(c) || c == '-' || (c >= '0' && c <= '9'); };
  return !text.empty() && is_first(text.front()) && std::all_of(text.begin(), text.end(), is_later);
}

Result<void> check_mesh_file(const std::filesystem::path& file) {
  if (auto readable = check_readable(file); !readable) return readable;
  std::error_code status_error;
  if (std::filesystem::is_regular_file(file, status_error)) return {};
  return fail(ErrorCode::Unreadable, "cannot read the file: it is not a regular file",
              file.string());
}

Error unreadable_mesh(const Error& error, const std::string& surface, const SceneOrigin& origin) {
  return {.code = ErrorCode::Unreadable,
          .message = fmt::format("surface \"{}\": {}: {}", surface, error.file, error.message),
          .file = origin.file,
          .line = origin.line_of(surface, "file")};
}

std::vector<Error> check_scene(const Scene& scene) { return SceneChecker(scene).check(); }

}  // namespace pliant
