#include "pliant/feedback/suggestion_subject.hpp"

#include <algorithm>
#include <string_view>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "pliant/feedback/surface_previewer.hpp"

namespace pliant {
namespace {

std::vector<std::string> names_of(const Scene& scene, const std::vector<std::size_t>& surfaces) {
  std::vector<std::string> names;
  for (const std::size_t k : surfaces) names.push_back(scene.surfaces[k].name);
  return names;
}

std::string nothing_named(std::string_view what, const std::string& name,
                          const std::vector<std::string>& names) {
  return fmt::format("there is no {} \"{}\"; {}", what, printable(name),
                     names.empty() ? "there is none at all"
                                   : fmt::format("there are: {}", fmt::join(names, ", ")));
}

// Finds the surface, and the case of the forces on it.
class SubjectFinder {
 public:
  SubjectFinder(const Scene& scene, std::span<const RestShape> rest_shapes,
                const MotionGoals& goals)
      : scene_(scene), rest_shapes_(rest_shapes), goals_(goals) {}

  Result<Subject> find() {
    Subject subject;
    if (!goals_.force.empty()) {
      if (auto known = find_force(subject); !known) return fail(known.error());
    }
    const auto surface = find_surface(subject);
    if (!surface) return fail(surface.error());
    subject.surface = *surface;
    return subject;
  }

 private:
  // Whether the case is that of the force, the group, or of all.
  static bool is_of(const PreviewCase& one, const Subject& subject) {
    return one.preview.of == subject.of && one.preview.index == subject.index;
  }

  Result<void> find_force(Subject& subject) const {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < scene_.forces.size(); ++k) {
      names.push_back(scene_.forces[k].name);
      if (names.back() != goals_.force) continue;
      subject.of = Preview::Of::Force;
      subject.index = k;
      return {};
    }
    for (std::size_t k = 0; k < scene_.groups.size(); ++k) {
      names.push_back(scene_.groups[k].name);
      if (names.back() != goals_.force) continue;
      subject.of = Preview::Of::Group;
      subject.index = k;
      return {};
    }
    return invalid(nothing_named("force", goals_.force, names));
  }

  Result<std::size_t> find_surface(const Subject& subject) const {
    std::vector<std::string> names;
    std::vector<std::size_t> solved, moved;
    for (std::size_t k = 0; k < scene_.surfaces.size(); ++k) {
      const Surface& surface = scene_.surfaces[k];
      names.push_back(surface.name);
      const bool is_solved = surface.enabled && !surface.is_driven();
      if (surface.name == goals_.surface) {
        if (!is_solved) {
          return invalid(fmt::format(
              "surface \"{}\" is {}", surface.name,
              surface.enabled ? "driven by " + surface.driven_by : std::string("not enabled")));
        }
        if (!has_case(k, subject)) return invalid(untouched(surface.name));
        return k;
      }
      if (!is_solved) continue;
      solved.push_back(k);
      if (has_case(k, subject)) moved.push_back(k);
    }
    if (!goals_.surface.empty()) return invalid(nothing_named("surface", goals_.surface, names));
    if (moved.size() == 1) return moved.front();
    if (moved.empty() && solved.size() == 1) return invalid(untouched(names_of(scene_, solved)[0]));
    if (moved.empty()) return invalid("no surface is solved on which a force acts");
    return invalid(fmt::format("several surfaces move: {}; name one of them",
                               fmt::join(names_of(scene_, moved), ", ")));
  }

  std::string untouched(const std::string& surface) const {
    return goals_.force.empty()
               ? fmt::format("no force acts on surface \"{}\"", surface)
               : fmt::format("\"{}\" does not act on surface \"{}\"", goals_.force, surface);
  }

  bool has_case(std::size_t surface, const Subject& subject) const {
    const auto cases = cases_of(scene_, rest_shapes_[surface], surface);
    return std::any_of(cases.begin(), cases.end(),
                       [&](const PreviewCase& one) { return is_of(one, subject); });
  }

  const Scene& scene_;
  std::span<const RestShape> rest_shapes_;
  const MotionGoals& goals_;
};

}  // namespace

Result<Subject> find_subject(const Scene& scene, std::span<const RestShape> rest_shapes,
                             const MotionGoals& goals) {
  return SubjectFinder(scene, rest_shapes, goals).find();
}

}  // namespace pliant
