#include "pliant/scene/checks/rules.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include "pliant/core/text.hpp"
#include "pliant/mesh/written/vertex_weights.hpp"
#include "pliant/scene/checks/check.hpp"
#include "pliant/scene/checks/collider_rules.hpp"
#include "pliant/scene/elements/read_elements.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/format/format.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

/// `sheet.width`; of the scene itself: `fps`.
std::string path_of(const std::string& name, std::string_view attribute) {
  return fmt::format("{}{}{}", name, name.empty() ? "" : ".", attribute);
}

/// Whether it is the element of a force or a group.
bool is_force_element(std::string_view element) {
  return element != Description<Surface>::element && find_format(scene_format(), element);
}

// Of the work for each, see StopPoll.
constexpr std::size_t parts_of_object = 2048, parts_of_target = 128;

class WholeChecker {
 public:
  WholeChecker(const Scene& scene, std::span<const Named> named, const ChannelFilter& is_sound,
               Findings& findings)
      : scene_(scene), named_(named), is_sound_(is_sound), findings_(findings) {}

  void check() {
    for (const Group& group : scene_.groups) groups_.insert(group.name);
    for (const Surface& surface : scene_.surfaces) surfaces_.emplace(surface.name, &surface);
    check_ranges("", scene_);
    check_frames();
    check_names();
    for (const Surface& surface : scene_.surfaces) {
      if (findings_.is_over(parts_of_object)) return;
      check(surface);
    }
    for (const Force& force : scene_.forces) {
      if (findings_.is_over(parts_of_object)) return;
      check(force);
    }
    for (const Group& group : scene_.groups) {
      if (findings_.is_over(parts_of_object)) return;
      check_follow(group);
    }
    check_targets();
    for (const Collider& collider : scene_.colliders) {
      if (findings_.is_over(parts_of_object)) return;
      if (const auto* const closed = std::get_if<ClosedMesh>(&collider.shape))
        check(collider.name, *closed);
    }
    check_colliders(scene_, is_sound_, findings_);
  }

 private:
  /// Numbers that are no channels.
  template <class Thing>
  void check_ranges(const std::string& name, const Thing& thing) {
    describe([&](const Attribute& attribute,
                 const auto&... member) { (check_range(name, attribute, member), ...); },
             thing);
  }

  template <class T>
  void check_range(const std::string& name, const Attribute& attribute, const T& member) {
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, int>) {
      const double number = member;
      auto rule = attribute.range.broken_rule({&number, 1});
      if (!rule && !std::isfinite(number)) rule = "must be finite";
      if (!rule && attribute.syntax == Syntax::Rate && !std::isfinite(1 / number))
        rule = "must have a finite inverse";
      if (rule)
        complain(name, attribute.name,
                 fmt::format("{} is {}, but {}", path_of(name, attribute.name), member, *rule));
    }
  }
  template <std::size_t D>
  void check_range(const std::string& name, const Attribute& attribute,
                   const std::array<double, D>& member) {
    for (const double number : member) check_range(name, attribute, number);
  }
  template <class T>
  void check_range(const std::string& name, const Attribute& attribute,
                   const std::optional<T>& member) {
    if (member) check_range(name, attribute, *member);
  }

  void check_frames() {
    if (!is_sound("", "start") || !is_sound("", "end")) return;
    for (const double frame : {double(scene_.start), double(scene_.end)})
      if (frame_range.broken_rule({&frame, 1})) return;
    const std::int64_t frames = std::int64_t{scene_.end} - scene_.start + 1;
    if (frames < 1)
      complain("", "end",
               fmt::format("end is {}, but must not be before start, which is {}", scene_.end,
                           scene_.start));
    else if (frames > max_frames)
      complain("", "end",
               fmt::format("{} frames from start {} to end {} are too many; at most {} are allowed",
                           frames, scene_.start, scene_.end, max_frames));
  }

  void check(const Surface& surface) {
    for_each_part(surface, [&](const auto& part) { check_ranges(surface.name, part); });
    if (const auto* const mesh = std::get_if<MeshFile>(&surface.shape))
      check_ranges(surface.name, *mesh);
    check_reading(surface);
    check_subdivision(surface);
    check_driver(surface);
    check_whole_body(surface);
    check_cache(surface);
    check_time(surface);
    check_damping(surface);
    check_yield(surface);
    check_maps(surface);
    check_holds(surface);
    if (const auto* const net = std::get_if<NurbsNet>(&surface.shape)) check(surface, *net);
    const auto* const sheet = std::get_if<GridSheet>(&surface.shape);
    if (!sheet) return;
    check_ranges(surface.name, *sheet);
    const std::int64_t vertices = std::int64_t{sheet->columns} * sheet->rows;
    if (is_sound(surface.name, "columns") && is_sound(surface.name, "rows") &&
        vertices > max_sheet_vertices)
      findings_.add_problem(
          scene_.origin.last_of(surface.name, {"columns", "rows"}),
          fmt::format("surface \"{}\" has {} x {} = {} vertices; at most {} are allowed",
                      surface.name, sheet->columns, sheet->rows, vertices, max_sheet_vertices));
  }

  void check(const Surface& surface, const NurbsNet& net) {
    for (const char* part : {"columns", "rows", "degreeU", "degreeV", "samplesU", "samplesV",
                             "wrap", "points", "weights", "knots.u", "knots.v"})
      if (surface.name.empty() || !is_sound(surface.name, part)) return;
    if (const auto checked = check_net(net); !checked)
      complain(surface.name, checked.error().part,
               fmt::format("surface \"{}\": {}", surface.name, checked.error().message));
  }

  void check_subdivision(const Surface& surface) {
    if (!surface.subdivision) return;
    check_ranges(surface.name, *surface.subdivision);
    if (std::holds_alternative<MeshFile>(surface.shape) ||
        std::holds_alternative<Mesh>(surface.shape))
      return;
    complain(surface.name, "levels",
             fmt::format("surface \"{}\" has a subdivision, but only a mesh is subdivided",
                         surface.name));
  }

  void check_whole_body(const Surface& surface) {
    const SolverSettings& solver = surface.solver;
    const bool has_edges =
        !solver.edges.are_clamped() || scene_.origin.gives(surface.name, "edges");
    const bool is_surface = std::holds_alternative<GridSheet>(surface.shape) &&
                            surface.reading.uv == UvReading::Surface;
    if (is_surface && has_edges)
      findings_.add_problem(
          scene_.origin.last_of(surface.name, {"uv", "edges"}),
          fmt::format("{0}.edges: edges are those of a grid, but {0}.uv is \"surface\"; border is "
                      "what holds a surface",
                      surface.name));
    if (solver.region != SolvedRegion::All) {
      if (has_edges && !is_surface)
        findings_.add_problem(
            scene_.origin.last_of(surface.name, {"region", "edges"}),
            fmt::format("{0}.edges: edges need region=\"all\", but "
                        "{0}.region is \"forces\": the edges of a force's region are clamped",
                        surface.name));
      return;
    }
    const auto refuse = [&](const char* attribute, std::string_view given,
                            std::string_view needed) {
      findings_.add_problem(
          scene_.origin.last_of(surface.name, {"region", attribute}),
          fmt::format("{0}.{1}: region=\"all\" solves the whole surface as one region about its "
                      "rest shape, with {1}=\"{2}\", but {1} is \"{3}\"",
                      surface.name, attribute, needed, given));
    };
    if (solver.reference != Reference::Rest) refuse("reference", "none", "rest");
    if (solver.combine != Combine::Box)
      refuse("combine", combine_words[static_cast<std::size_t>(solver.combine)], "box");
    if (solver.release != Release::Freeze) refuse("release", "recover", "freeze");
  }

  void check_cache(const Surface& surface) {
    check_ranges(surface.name, surface.cache);
    check_source(surface.name, surface.cache);
    if (!surface.is_animated()) return;
    if (std::holds_alternative<NurbsNet>(surface.shape))
      complain(
          surface.name, "cache",
          fmt::format("surface \"{}\" is a net, but a cache is of a grid or a mesh", surface.name));
    if (surface.is_driven())
      complain(surface.name, "cache",
               fmt::format("{0}.cache: {0} is driven by {1} and follows the cache of that",
                           surface.name, in_quotes(surface.driven_by)));
    if (surface.solver.reference == Reference::None)
      findings_.add_problem(
          scene_.origin.last_of(surface.name, {"cache", "reference"}),
          fmt::format("{}.reference: a cache moves the shape at rest, but reference=\"none\" has "
                      "none",
                      surface.name));
  }

  void check(const std::string& name, const ClosedMesh& closed) {
    check_ranges(name, closed);
    check_source(name, closed.cache);
    if (closed.made && !closed.mesh.path.empty())
      complain(name, "file",
               fmt::format("{}.file: the mesh is of a file and of a program, but must be of one of "
                           "them",
                           name));
  }

  void check_source(const std::string& name, const ShapeCache& cache) {
    if (cache.is_empty() && cache.first && is_sound(name, "cache"))
      complain(name, "cacheStart", fmt::format("{}.cacheStart is given, but no cache", name));
    if (!cache.path.empty() && !cache.samples.is_empty())
      complain(name, "cache",
               fmt::format("{}.cache has a file and samples of a program, but must have one of "
                           "them",
                           name));
  }

  void check_time(const Surface& surface) {
    const auto& [preroll, loop] = std::tie(surface.solver.preroll, surface.solver.loop);
    if (preroll == 0 || !loop) return;
    findings_.add_problem(
        scene_.origin.last_of(surface.name, {"preroll", "loop"}),
        fmt::format("{0}.preroll is {1} and {0}.loop is {2}, but a cycle has no frame ahead of its "
                    "start; remove one of them",
                    surface.name, preroll, *loop));
  }

  void check_damping(const Surface& surface) {
    const MaterialChannels& material = surface.material;
    if (!material.damping_ratio || !is_sound(surface.name, "damping")) return;
    const Channel<1> standard = MaterialChannels().damping;
    const bool is_given = scene_.origin.gives(surface.name, "damping") ||
                          material.damping.is_animated() ||
                          material.damping.at(0) != standard.at(0);
    if (!is_given) return;
    findings_.add_problem(
        scene_.origin.last_of(surface.name, {"damping", "dampingRatio"}),
        fmt::format("{0}.damping and {0}.dampingRatio are both given, but the damping follows from "
                    "the ratio; remove one of them",
                    surface.name));
  }

  void check_yield(const Surface& surface) {
    if (!surface.material.yield) return;
    const SolverSettings& solver = surface.solver;
    const auto refuse = [&](const char* attribute, std::string_view given,
                            std::string_view reason) {
      findings_.add_problem(scene_.origin.last_of(surface.name, {"yield", attribute}),
                            fmt::format("{0}.yield: {0}.{1} is \"{2}\", but {3}", surface.name,
                                        attribute, given, reason));
    };
    if (solver.integrator == Integrator::Exact)
      refuse("integrator", "exact", "only an elastic surface has a solution in closed form");
    if (solver.reference == Reference::None)
      refuse("reference", "none", "a surface yields by how far it is bent from its rest shape");
    if (solver.combine == Combine::Union)
      refuse("combine", "union", "a plate that yields needs rectangles: \"box\" or \"islands\"");
    if (solver.release == Release::Recover)
      refuse("release", "recover", "what has yielded does not go back to rest");
    if (solver.loop)
      refuse("loop", fmt::format("{}", *solver.loop),
             "what yields in a round does not come back to where it began");
  }

  static bool has_goal(const Surface& surface) {
    const Channel<1>& goal = surface.material.goal;
    return goal.is_animated() || goal.at(0)[0] != 0;
  }

  void check_maps(const Surface& surface) {
    for (auto map = surface.maps.begin(); map != surface.maps.end(); ++map) {
      const std::string channel = name_of(map->channel);
      const std::string name = fmt::format("{}.{}", surface.name, channel);
      check_ranges(name, *map);
      const auto refuse = [&](const char* attribute, std::string_view reason) {
        complain(name, attribute, fmt::format("{}: {}", name, reason));
      };
      if (std::ranges::find(surface.maps.begin(), map, map->channel, &MaterialMap::channel) != map)
        refuse("", "the channel has a map already");
      const bool has_file = !map->file.empty(), has_attribute = !map->attribute.empty();
      const int sources = has_file + has_attribute + !map->values.empty();
      if (sources == 0) refuse("", "a map needs a file or an attribute");
      if (sources > 1)
        refuse("attribute", "a map has a file or an attribute, but this one has both");
      const std::string ending = ending_of(map->file);
      if (has_file && ending != ".png" && ending != ".npy")
        refuse("file", fmt::format("the file is {}, but its name must end in .png or .npy",
                                   in_quotes(map->file)));
      const bool has_vertices = std::holds_alternative<MeshFile>(surface.shape) ||
                                std::holds_alternative<Mesh>(surface.shape);
      if (has_attribute && !has_vertices)
        refuse("attribute", fmt::format("the attribute {} is one of a mesh's vertices, but the "
                                        "surface is no <mesh> and no <subdivision>",
                                        in_quotes(map->attribute)));
      if (map->channel == MapChannel::Damping && surface.material.damping_ratio)
        findings_.add_problem(
            scene_.origin.last_of(surface.name, {"dampingRatio", channel}),
            fmt::format(
                "{0}: {1}.dampingRatio gives the damping by the density of each node; remove "
                "one of them",
                name, surface.name));
      const bool is_plastic =
          map->channel == MapChannel::Yield || map->channel == MapChannel::Hardening;
      if (is_plastic && !surface.material.yield && is_sound(surface.name, "yield"))
        findings_.add_note(scene_.origin.at(name, ""),
                           fmt::format("{}: the map has no effect: {}.yield is not given, so that "
                                       "nothing yields",
                                       name, surface.name));
      if (map->channel == MapChannel::Goal && !has_goal(surface) && is_sound(surface.name, "goal"))
        findings_.add_note(
            scene_.origin.at(name, ""),
            fmt::format("{}: the map has no effect: {}.goal is 0", name, surface.name));
      const bool is_stiffness = map->channel == MapChannel::B || map->channel == MapChannel::C ||
                                map->channel == MapChannel::D;
      if (is_stiffness && surface.solver.combine == Combine::Union)
        findings_.add_problem(
            scene_.origin.last_of(surface.name, {"combine", channel}),
            fmt::format("{}: a map of b, c or d needs rectangles, but {}.combine is \"union\"; "
                        "\"box\" and \"islands\" have them",
                        name, surface.name));
    }
  }

  void check_holds(const Surface& surface) {
    const bool has_vertices = std::holds_alternative<MeshFile>(surface.shape) ||
                              std::holds_alternative<Mesh>(surface.shape);
    for (std::size_t k = 0; k < surface.holds.size(); ++k) {
      const Hold& hold = surface.holds[k];
      const std::string part = name_of_hold(k), name = fmt::format("{}.{}", surface.name, part);
      if (!is_sound(name, "file") || !is_sound(name, "attribute") || !is_sound(name, "vertices"))
        continue;
      const auto refuse = [&](const char* attribute, std::string_view reason) {
        complain(name, attribute, fmt::format("{}: {}", name, reason));
      };
      check_ranges(name, hold);
      const bool has_file = !hold.file.empty(), has_attribute = !hold.attribute.empty();
      const bool has_above = hold.above != Hold().above || scene_.origin.gives(name, "above");
      const int sources = has_file + has_attribute + !hold.vertices.empty() + !hold.values.empty();
      if (sources == 0) refuse("", "a hold needs a file, an attribute or vertices");
      if (!hold.vertices.empty() && (sources > 1 || has_above))
        refuse("vertices", fmt::format("a hold of vertices has no {}", has_file        ? "file"
                                                                       : has_attribute ? "attribute"
                                                                       : has_above     ? "\"above\""
                                                                                       : "values"));
      else if (sources > 1)
        refuse("attribute", "a hold has a file or an attribute, but this one has both");
      const std::string ending = ending_of(hold.file);
      if (has_file && ending != ".png" && ending != ".npy")
        refuse("file", fmt::format("the file is {}, but its name must end in .png or .npy",
                                   in_quotes(hold.file)));
      if (sources == 1 && has_attribute && !has_vertices)
        refuse("attribute", fmt::format("the attribute {} is one of a mesh's vertices, but the "
                                        "surface is no <mesh> and no <subdivision>",
                                        in_quotes(hold.attribute)));
      const auto conflict = [&](const char* attribute, std::string_view reason) {
        findings_.add_problem(scene_.origin.last_of(surface.name, {part, attribute}),
                              fmt::format("{}: {}", name, reason));
      };
      if (surface.solver.combine == Combine::Union)
        conflict("combine",
                 fmt::format("a <hold> needs rectangles, but {}.combine is \"union\"; \"box\" and "
                             "\"islands\" have them",
                             surface.name));
      if (surface.solver.reference == Reference::None)
        conflict("reference",
                 fmt::format("a node is held at its place at rest, but {}.reference is "
                             "\"none\", which has none",
                             surface.name));
      if (surface.is_driven() && scene_.origin.file.empty())
        refuse("", fmt::format("{} is driven by {} and has no <hold>", surface.name,
                               in_quotes(surface.driven_by)));
    }
  }

  void check_driver(const Surface& surface) {
    if (!surface.is_driven() || !is_sound(surface.name, "drivenBy")) return;
    const auto refuse = [&](std::string_view reason) {
      complain(surface.name, "drivenBy", fmt::format("{}.drivenBy: {}", surface.name, reason));
    };
    if (surface.driven_by == surface.name) return refuse("a surface cannot drive itself");
    if (const auto found = surfaces_.find(surface.driven_by); found != surfaces_.end()) {
      const Surface& other = *found->second;
      if (other.is_driven())
        refuse(fmt::format("{} is driven itself, by {}", in_quotes(other.name),
                           in_quotes(other.driven_by)));
      return;
    }
    if (surfaces_.contains("")) return;  // it may be the one that is meant
    refuse(fmt::format("no surface is named {}{}", in_quotes(surface.driven_by),
                       hint_among(surface.driven_by, solved_surfaces(surface.name))));
  }

  void check_reading(const Surface& surface) {
    const MeshReading& reading = surface.reading;
    check_ranges(surface.name, reading);
    if (std::holds_alternative<NurbsNet>(surface.shape) &&
        (reading.asks_for_surface() || reading.wrap != Wrap::None))
      complain(surface.name, "uv",
               fmt::format("surface \"{}\" is a net, which is not read as a mesh", surface.name));
    if (reading.axis == std::array{0.0, 0.0, 0.0})
      complain(surface.name, "axis",
               fmt::format("{}.axis is 0 0 0, but must have a direction", surface.name));
    const bool is_closed = reading.wrap != Wrap::None;
    const bool is_sheet = std::holds_alternative<GridSheet>(surface.shape);
    if (is_sheet) {
      for (const auto& [attribute, is_given] :
           {std::pair("wrap", is_closed), std::pair("weld", reading.weld.has_value())}) {
        if (is_given)
          complain(surface.name, attribute,
                   fmt::format("{}.{} is for a mesh, but the surface is a sheet", surface.name,
                               attribute));
      }
      if (reading.uv == UvReading::Surface) return;
    }
    if (is_closed && reading.uv == UvReading::Surface)
      complain(
          surface.name, "wrap",
          fmt::format("{}.wrap is for a mesh that is read as a grid, but uv=\"surface\" reads this "
                      "one as a surface, which closes by itself",
                      surface.name));
    if (reading.uv != UvReading::Grid && !is_closed && !is_sheet) return;
    const auto refuse = [&](const char* attribute, bool is_given) {
      if (!is_given) return;
      complain(
          surface.name, attribute,
          is_sheet
              ? fmt::format("{}.{} is for a sheet that is read as a surface; uv=\"surface\" reads "
                            "it so",
                            surface.name, attribute)
              : fmt::format("{}.{} is for a mesh that is read as a surface, but {} reads this one "
                            "as a grid",
                            surface.name, attribute, is_closed ? "wrap" : "uv=\"grid\""));
    };
    refuse("unit", reading.unit.has_value());
    refuse("axis", reading.axis.has_value());
    refuse("border", reading.border.has_value());
    if (!is_sheet) refuse("weld", reading.weld.has_value());
  }

  // Also of a group.
  template <class Follower>
  void check_follow(const Follower& follower) {
    if (follower.follow.empty() || !is_sound(follower.name, "follow")) return;
    const auto refuse = [&](std::string_view reason) {
      complain(follower.name, "follow", fmt::format("{}.follow: {}", follower.name, reason));
    };
    if (const auto found = surfaces_.find(follower.follow); found != surfaces_.end()) {
      if (found->second->is_driven())
        refuse(fmt::format("{} is driven by {}; follow that one", in_quotes(follower.follow),
                           in_quotes(found->second->driven_by)));
      return;
    }
    if (surfaces_.contains("")) return;  // it may be the one that is meant
    refuse(fmt::format("no surface is named {}{}", in_quotes(follower.follow),
                       hint_among(follower.follow, solved_surfaces(""))));
  }

  // Those that others may be driven by or follow, but for one; none if names are not compared.
  std::vector<std::string_view> solved_surfaces(std::string_view without) {
    std::vector<std::string_view> names;
    for (const Surface& surface : scene_.surfaces) {
      if (!findings_.may_compare_names()) break;
      if (!surface.is_driven() && surface.name != without) names.push_back(surface.name);
    }
    return names;
  }

  void check(const Force& force) {
    if (!force.group.empty() && !groups_.contains(force.group))
      complain(
          force.name, "group",
          fmt::format("force \"{}\" is in \"{}\", which is not a group", force.name, force.group));
    check_follow(force);
    std::visit(
        [&]<class Kind>(const Kind&) {
          const auto has_no = [&](std::string_view attribute, std::string_view what) {
            complain(force.name, attribute,
                     fmt::format("{}.{}: a force of kind {} has no {}", force.name, attribute,
                                 Description<Kind>::element, what));
          };
          if constexpr (!requires { Description<Kind>::has_place; })
            if (!force.follow.empty()) has_no("follow", "place");
          if constexpr (!requires { Description<Kind>::has_direction; })
            if (force.along != PushAlong::Free) has_no("along", "direction");
        },
        force.kind);
    const auto* const custom = std::get_if<CustomForce>(&force.kind);
    if (custom && !custom->unit_force)
      complain(force.name, "unit_force",
               fmt::format("force \"{}\" is custom, but has no unit_force function", force.name));
  }

  void check_names() {
    std::map<std::string_view, TextPlace> first_places;
    for (const auto& [element, name, at] : named_) {
      if (findings_.is_over(parts_of_object)) return;
      if (!is_name(name)) {
        findings_.add_problem(at, fmt::format("the name {} must be a letter or _ followed by "
                                              "letters, digits, _ and -",
                                              in_quotes(name)));
        continue;
      }
      const auto [first, is_new] = first_places.emplace(name, at);
      if (is_new) continue;
      const std::string place =
          first->second.is_known()
              ? fmt::format(" at {}", findings_.sources().title_of(first->second, at))
              : "";
      findings_.add_problem(
          at, fmt::format("<{}> name={}: the name is already used{}; surfaces, forces, groups and "
                          "colliders must have different names",
                          element, in_quotes(name), place));
    }
  }

  void check_targets() {
    if (surfaces_.contains("")) return;      // a target may mean a surface with an unreadable name
    std::vector<std::string_view> surfaces;  // each once, in the order of the scene
    for (const Surface& surface : scene_.surfaces)
      if (surfaces_.at(surface.name) == &surface) surfaces.push_back(surface.name);
    std::map<std::string_view, std::string_view> driven;
    for (const Surface& surface : scene_.surfaces)
      if (surface.is_driven()) driven.emplace(surface.name, surface.driven_by);
    std::map<std::string_view, std::string_view> elements;
    for (const Named& one : named_) elements.emplace(one.name, one.element);

    const auto check = [&](const auto& acting) {
      for (const std::string& target : acting.targets) {
        if (findings_.is_over(parts_of_target)) return;
        if (driven.contains(target)) {
          complain(
              acting.name, "targets",
              fmt::format("{}.targets: {} is driven by {}, and feels the forces that act on it",
                          acting.name, in_quotes(target), in_quotes(driven[target])));
        }
        if (surfaces_.contains(target)) continue;
        const auto found = elements.find(target);
        const bool is_named = found != elements.end();
        const bool is_force = is_named && is_force_element(found->second);
        if (is_named && !is_force) continue;
        complain(acting.name, "targets",
                 fmt::format("{}.targets: {}{}", acting.name,
                             is_force ? fmt::format("{} is a <{}>, not a surface",
                                                    in_quotes(target), found->second)
                                      : fmt::format("no surface is named {}", in_quotes(target)),
                             hint_among(target, surfaces)));
      }
    };
    for (const Force& force : scene_.forces) check(force);
    for (const Group& group : scene_.groups) check(group);
    for (const Collider& collider : scene_.colliders) check(collider);
  }

  /// The nearest of the names of a scene, and the first of them.
  std::string hint_among(std::string_view name, std::span<const std::string_view> names) const {
    return findings_.may_compare_names() ? hint(name, names) : "";
  }

  bool is_sound(const std::string& name, std::string_view attribute) const {
    return !is_sound_ || is_sound_(name, attribute);
  }

  void complain(const std::string& name, std::string_view attribute, std::string message) {
    findings_.add_problem(scene_.origin.at(name, std::string(attribute)), std::move(message));
  }

  const Scene& scene_;
  std::span<const Named> named_;
  const ChannelFilter& is_sound_;
  Findings& findings_;
  std::set<std::string_view> groups_;
  std::map<std::string_view, const Surface*> surfaces_;  // the first of each name
};

}  // namespace

void check_whole(const Scene& scene, std::span<const Named> named, const ChannelFilter& is_sound,
                 Findings& findings) {
  WholeChecker(scene, named, is_sound, findings).check();
}

void note_idle_targets(const Scene& scene, Findings& findings) {
  std::map<std::string_view, std::set<std::string_view>> targets_of;  // of groups
  for (const Group& group : scene.groups)
    targets_of.try_emplace(group.name, group.targets.begin(), group.targets.end());
  for (const Force& force : scene.forces) {
    const auto group = targets_of.find(force.group);
    if (findings.is_over(parts_of_target)) return;
    if (group == targets_of.end() || group->second.empty()) continue;
    for (const std::string& target : force.targets)
      if (!findings.is_over(parts_of_target) && !group->second.contains(target))
        findings.add_note(
            scene.origin.at(force.name, "targets"),
            fmt::format(
                "{}.targets: {} is not a target of the group {}: the force has no effect there",
                force.name, in_quotes(target), in_quotes(force.group)));
  }
}

}  // namespace pliant::xml
