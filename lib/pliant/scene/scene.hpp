#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/core/field.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/falloff.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/timeline/channel.hpp"
#include "pliant/timeline/curve.hpp"
#include "pliant/timeline/position.hpp"

namespace pliant {

/// A mesh in a file.
struct MeshFile {
  std::string path = {};    ///< as it is to be opened; its ending picks the format
  std::string object = {};  ///< the one to take when the file holds several; empty: the only one
  int uv_set = 0;           ///< which set of (u,v) is the grid, counted from 0, < max_uv_sets
  /// What the file refers to is read in this folder and below only; empty: in the file's own.
  std::string root = {};
};

/// Where a surface's rest shape comes from; a `Mesh` is one that a program made.
using SurfaceShape = std::variant<GridSheet, MeshFile, Mesh>;

/// p_world = translate + R S p, right-handed. SPEC 7.
struct TransformChannels {
  Channel<3> translate = Value<3>{0, 0, 0};  ///< [length]
  Channel<3> rotate = Value<3>{0, 0, 0};     ///< [degrees]
  Channel<3> scale = Value<3>{1, 1, 1};      ///< [1], no component 0
  RotateOrder rotate_order = RotateOrder::Xyz;
};

/// The coefficients of the plate equation. SPEC 2; thesis 5.2.1.2.
struct MaterialChannels {
  Channel<1> density = 1;  ///< rho >= 0
  Channel<1> damping = 1;  ///< eta >= 0
  Channel<1> b = 1;        ///< along u, > 0
  Channel<1> c = 2;        ///< mixed, > -2 sqrt(b d)
  Channel<1> d = 1;        ///< along v, > 0
};

/// A boundary tangent: one number for all of x, y, z, 0 by default, or three. [length/uv]
using TangentChannel = std::variant<Channel<1>, Channel<3>>;

/// The slopes prescribed on the region's edges. SPEC 3; thesis 5.2.1.2, fig. 9.
struct TangentChannels {
  TangentChannel su0 = {};  ///< d/du on the edge of smallest u
  TangentChannel su1 = {};  ///< d/du on the edge of largest u
  TangentChannel sv0 = {};  ///< d/dv on the edge of smallest v
  TangentChannel sv1 = {};  ///< d/dv on the edge of largest v
};

/// How a surface is solved.
struct SolverSettings {
  Channel<1> dt = 0.01;                 ///< [s], > 0
  std::optional<int> start_frame = {};  ///< absent: the scene's start
  Stepping stepping = Stepping::Exact;
  Reference reference = Reference::Rest;
  Measure measure = Measure::Current;
  Combine combine = Combine::Box;
  Release release = Release::Freeze;  ///< Recover only with tangents of 0
};

/// One elastic surface.
struct Surface {
  std::string name;         ///< [A-Za-z_][A-Za-z0-9_-]*, unique in the scene
  bool enabled = true;      ///< false: written at rest, not solved
  SurfaceShape shape = {};  ///< by default a `GridSheet`
  TransformChannels transform = {};
  MaterialChannels material = {};
  TangentChannels tangents = {};
  SolverSettings solver = {};
};

/// The thesis's force: a sphere that pushes along one direction.
struct PointChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]
  Channel<3> direction = Value<3>{0, 1, 0};    ///< world; normalised
};

/// Pushes away from a centre; a negative magnitude attracts.
struct RadialChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]
};

/// Acts around a segment, along `direction` or away from the segment when there is none.
struct LineChannels {
  PositionChannel from = Value<3>{0, 0, 0};  ///< world [length]
  PositionChannel to = Value<3>{1, 0, 0};    ///< world [length]
  std::optional<Channel<3>> direction = {};
};

/// The same everywhere, like gravity.
struct UniformChannels {
  Channel<3> direction = Value<3>{0, 1, 0};  ///< world; normalised
};

/// Turns about a line, by the right hand, and draws towards it.
struct VortexChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< a point of the line, world [length]
  Channel<3> axis = Value<3>{0, 1, 0};         ///< the line's direction, world; normalised
  Channel<1> pull = 0;                         ///< inward share, the turning one being 1
};

/// Wavers in space and time, on a lattice that has a corner at the centre.
struct NoiseChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]
  Channel<1> frequency = 1;                    ///< [cells/length], >= 0
  Channel<1> rate = 1;                         ///< [cells/s], >= 0; frame 0 is second 0
  std::optional<std::uint64_t> seed = {};      ///< absent: the scene's
};

/// What the motion of a surface's transform does to the surface; its magnitude is 1 as a rule.
struct InertiaChannels {};

/// When a force is asked.
struct ForceTime {
  int frame = 0;
  double seconds = 0;  ///< frame / fps
};

/// A kind of force of an embedding program's own: it answers what every kind answers (see
/// forces/force.hpp) about a position in the world, at a time.
///
/// The functions must be pure, giving the same bits for the same arguments, or else the run is not
/// reproducible; and safe to call from several threads at once, when the simulation has several.
/// They are called for each node, each frame. What they throw goes through `Simulation::at` and
/// `preview_forces` to the caller, and the simulation starts over from rest when it is next asked.
struct CustomForce {
  /// The distance that selects, >= 0, infinite where out of any reach [length]; none: 0 everywhere.
  std::function<double(const Vector3d& p, const ForceTime& time)> distance = {};
  /// The force per unit of magnitude and falloff, finite. Must be there.
  std::function<Vector3d(const Vector3d& p, const ForceTime& time)> unit_force = {};
  /// Names what the functions compute, all that they hold included: states that they had a part in
  /// are kept under it beyond one simulation. Functions that answer otherwise must have another.
  /// Empty: what follows from them is kept by no store.
  std::string key = {};
};

/// One force of a scene.
struct Force {
  std::string name;                   ///< [A-Za-z_][A-Za-z0-9_-]*, unique in the scene
  Switch enabled = true;              ///< a disabled force selects nothing
  std::vector<std::string> targets;   ///< names of surfaces; empty: all
  std::string group = {};             ///< name of the group that it is in; empty: none. The group
                                      ///< selects in its place: `deformation_radius` is not read
  Channel<1> magnitude = 0;           ///< [length b/uv^4]
  Channel<1> deformation_radius = 1;  ///< selects the region, world [length], >= 0
  Channel<1> force_radius = 1;        ///< selects the nodes that are pushed, world [length], >= 0
  Falloff falloff = Falloff::Constant;
  /// Drawn by hand over s = distance / force radius from 0 to 1, in place of `falloff`.
  std::optional<Curve<1>> falloff_curve = {};
  std::variant<PointChannels, RadialChannels, LineChannels, UniformChannels, VortexChannels,
               NoiseChannels, InertiaChannels, CustomForce>
      shape = {};  ///< by default `PointChannels`
};

/// `point`, `radial`, …: the name of its element in a scene file; `custom` has none there.
std::string_view kind_of(const Force& force);

/// One region for several forces, the thesis's multipleForce (7.). A force in a group acts when and
/// where both do.
struct Group {
  std::string name;                            ///< as of a force, unique among them too
  Switch enabled = true;                       ///< a disabled group silences its forces
  std::vector<std::string> targets = {};       ///< names of surfaces; empty: all
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]
  Channel<1> deformation_radius = 1;           ///< selects the region, world [length], >= 0
};

/// Where a scene's parts were written, for messages. Empty for a scene built in code.
struct SceneOrigin {
  std::string file;  ///< as the caller named it
  /// Of `NAME` and of `NAME.attribute`, as far as written. The empty name is the scene itself:
  /// ``, `.fps`, `.end`.
  std::map<std::string, int, std::less<>> lines;

  /// The line of a channel, else of its element, else 0.
  int line_of(const std::string& name, const std::string& attribute = {}) const;
};

/// Something legal in a scene file that its author would want to know, such as a tangent that the
/// curve rules shortened.
struct SceneNote {
  int line = 0;         ///< counted from 1
  std::string message;  ///< one line, begins with the channel: `poke.magnitude: key 12: …`

  friend bool operator==(const SceneNote&, const SceneNote&) = default;
};

/// Everything pliant is asked to compute: values only, made by `load_scene` or in code.
struct Scene {
  double fps = 24;  ///< [1/s], > 0
  int start = 1;    ///< first frame
  int end = 1;      ///< last frame, >= start, at most 10^6 frames
  std::uint64_t seed = 0;
  std::vector<Surface> surfaces;
  std::vector<Force> forces;  ///< those in groups too; they add up in this order, that of the file
  std::vector<Group> groups;
  SceneOrigin origin = {};
  std::vector<SceneNote> notes = {};  ///< found while reading, in the order of lines
};

}  // namespace pliant
