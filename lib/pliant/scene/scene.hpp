#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pliant/body/settings.hpp"
#include "pliant/core/field.hpp"
#include "pliant/core/grid.hpp"
#include "pliant/core/result.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/forces/falloff.hpp"
#include "pliant/forces/position_function.hpp"
#include "pliant/mesh/grid_sheet.hpp"
#include "pliant/mesh/mesh.hpp"
#include "pliant/mesh/mesh_reading.hpp"
#include "pliant/mesh/shape_samples.hpp"
#include "pliant/mesh/written/nurbs_net.hpp"
#include "pliant/mesh/written/subdivision.hpp"
#include "pliant/scene/text/text_place.hpp"
#include "pliant/timeline/channel.hpp"
#include "pliant/timeline/curve.hpp"
#include "pliant/timeline/position.hpp"

namespace pliant {

/// A mesh in a file.
struct MeshFile {
  std::string path = {};    ///< as passed to open; its extension selects the format
  std::string object = {};  ///< the object to read; empty: the only one in the file
  int uv_set = 0;           ///< which set of (u,v) is read, counted from 0, < max_uv_sets
  /// Files that it refers to are read only from this folder and below; empty: the file's own
  /// folder.
  std::string root = {};

  friend bool operator==(const MeshFile&, const MeshFile&) = default;
};

/// An animation of a surface's rest shape, or of a collider's mesh, in a file or given by a
/// program. At most one of `path` and `samples` is not empty; neither: the shape stays as it is.
struct ShapeCache {
  std::string path = {};             ///< as passed to open: .pc2, .mdd or .npy
  std::optional<double> first = {};  ///< the frame of its first sample; none: that of a .pc2
                                     ///< itself, else the scene's start
  ShapeSamples samples = {};         ///< one frame apart, as those of a .npy

  bool is_empty() const { return path.empty() && samples.is_empty(); }

  friend bool operator==(const ShapeCache&, const ShapeCache&) = default;
};

/// The source of a surface's rest shape; a `Mesh` is made by a program.
using SurfaceShape = std::variant<GridSheet, MeshFile, Mesh, NurbsNet>;

/// p_world = translate + R S p, right-handed. SPEC 7.
struct TransformChannels {
  Channel<3> translate = Value<3>{0, 0, 0};  ///< [length]
  Channel<3> rotate = Value<3>{0, 0, 0};     ///< [degrees]
  Channel<3> scale = Value<3>{1, 1, 1};      ///< [1], no component 0
  RotateOrder rotate_order = RotateOrder::Xyz;

  Transform at(double frame) const;
  Placement placement_at(double frame) const;
  Matrix3d rotation_at(double frame) const;  ///< R alone

  friend bool operator==(const TransformChannels&, const TransformChannels&) = default;
};

/// The coefficients of the plate equation. SPEC 2; thesis 5.2.1.2.
struct MaterialChannels {
  Channel<1> density = 1;  ///< rho >= 0
  Channel<1> damping = 1;  ///< eta >= 0
  /// zeta >= 0, of the slowest vibration of each region; eta follows from it. Absent: `damping`
  /// gives eta. Both together are an error.
  std::optional<Channel<1>> damping_ratio = {};
  Channel<1> b = 1;  ///< along u, > 0
  Channel<1> c = 2;  ///< mixed, > -2 sqrt(b d)
  Channel<1> d = 1;  ///< along v, > 0
  /// Y > 0: where it bends for good. Absent: it is elastic. docs/model.md, "Plasticity".
  std::optional<Channel<1>> yield = {};
  Channel<1> hardening = 0.1;  ///< H >= 0, of a plate that yields
  /// nu: acts with a free border or edge, a map of b, c or d, or `yield`; then > -1 and < 1
  Channel<1> poisson = 0.3;
  Channel<1> goal = 0;  ///< g >= 0, pulls back to rest; 0 with Reference::None

  friend bool operator==(const MaterialChannels&, const MaterialChannels&) = default;
};

/// The channels of the material that a map may change.
enum class MapChannel { Density, Damping, B, C, D, Yield, Hardening, Goal };

/// How a channel of the material differs over a surface: at each node its value is multiplied by
/// low + (high - low) m. m is that of a picture at the node's (u,v), from black 0 to white 1; of a
/// .npy with a number for each node of a grid; of an attribute of the mesh's vertices; or given by
/// a program. Exactly one of `file`, `attribute` and `values` is not empty.
struct MaterialMap {
  MapChannel channel = MapChannel::Density;
  std::string file = {};       ///< as passed to open: .png or .npy
  std::string attribute = {};  ///< a property of a .ply's vertices, `_NAME` of a glTF, or one of
                               ///< `Mesh::attributes`
  double low = 0;              ///< the factor where m is 0 [1]
  double high = 1;             ///< the factor where m is 1 [1]
  /// m at each node of a sheet or of a net (row by row), or at each vertex of a mesh.
  std::vector<double> values = {};

  friend bool operator==(const MaterialMap&, const MaterialMap&) = default;
};

/// Nodes of a surface that stay where they are; their slopes are free. Those where the value of a
/// picture, of numbers, of an attribute or of a program, as of a `MaterialMap`, is greater than
/// `above`; or those of `vertices`. Exactly one of the four is not empty.
struct Hold {
  std::string file = {};       ///< as passed to open: .png or .npy
  std::string attribute = {};  ///< a property of a .ply's vertices, `_NAME` of a glTF, or one of
                               ///< `Mesh::attributes`
  double above = 0.5;          ///< [1]
  /// Numbers from 0 on, in the order of the surface's own file; of a net its points, of a cage its
  /// vertices.
  std::vector<int> vertices = {};
  /// At each node of a sheet or of a net (row by row), or at each vertex of a mesh.
  std::vector<double> values = {};

  friend bool operator==(const Hold&, const Hold&) = default;
};

/// A boundary tangent: one number for all of x, y, z, 0 by default, or three numbers. [length/uv]
using TangentChannel = std::variant<Channel<1>, Channel<3>>;

/// The slopes prescribed on the region's edges. SPEC 3; thesis 5.2.1.2, fig. 9.
struct TangentChannels {
  TangentChannel su0 = {};  ///< d/du on the edge of smallest u
  TangentChannel su1 = {};  ///< d/du on the edge of largest u
  TangentChannel sv0 = {};  ///< d/dv on the edge of smallest v
  TangentChannel sv1 = {};  ///< d/dv on the edge of largest v

  friend bool operator==(const TangentChannels&, const TangentChannels&) = default;
};

/// How a surface is solved.
struct SolverSettings {
  Channel<1> dt = 0.01;                 ///< [s], > 0
  Channel<1> time_scale = 1;            ///< the body's seconds in one of the scene, 0 to 1000
  std::optional<int> start_frame = {};  ///< absent: the scene's start
  int preroll = 0;                      ///< frames solved ahead of the start, 0 to 10^5
  std::optional<int> loop = {};         ///< frames of a cycle, 1 to 10^5; absent: none
  Integrator integrator = Integrator::BackwardEuler;
  Stepping stepping = Stepping::Exact;
  Reference reference = Reference::Rest;
  std::optional<Measure> measure = {};  ///< absent: current on a grid, rest on a surface
  /// All only with Reference::Rest, Combine::Box and Release::Freeze.
  SolvedRegion region = SolvedRegion::Forces;
  Edges edges = {};  ///< of a grid; others than clamped only with SolvedRegion::All
  Combine combine = Combine::Box;
  Release release = Release::Freeze;  ///< Recover only with tangents of 0

  friend bool operator==(const SolverSettings&, const SolverSettings&) = default;
};

/// One elastic surface, or one that is driven by another.
struct Surface {
  std::string name;     ///< [A-Za-z_][A-Za-z0-9_-]*, unique in the scene
  bool enabled = true;  ///< false: written at rest, not solved
  /// The surface that it follows; empty: it is solved itself. A driven surface uses its shape and
  /// transform only.
  std::string driven_by = {};
  SurfaceShape shape = {};                      ///< by default a `GridSheet`
  MeshReading reading = {};                     ///< of a sheet, or of a shape that is a mesh
  std::optional<Subdivision> subdivision = {};  ///< of a shape that is a mesh: it is a cage
  ShapeCache cache = {};                        ///< of a sheet, or of a shape that is a mesh
  TransformChannels transform = {};
  MaterialChannels material = {};
  std::vector<MaterialMap> maps = {};  ///< at most one of each channel
  std::vector<Hold> holds = {};        ///< together; not with Reference::None or Combine::Union
  TangentChannels tangents = {};
  SolverSettings solver = {};

  bool is_driven() const { return !driven_by.empty(); }
  bool is_animated() const { return !cache.is_empty(); }  ///< its shape at rest moves

  friend bool operator==(const Surface&, const Surface&) = default;
};

/// The thesis's force: a sphere that pushes along one direction.
struct PointChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]
  Channel<3> direction = Value<3>{0, 1, 0};    ///< world; normalised

  friend bool operator==(const PointChannels&, const PointChannels&) = default;
};

/// Pushes away from a centre; a negative magnitude attracts.
struct RadialChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]

  friend bool operator==(const RadialChannels&, const RadialChannels&) = default;
};

/// Acts around a line segment, along `direction`, or away from the segment if that is null.
struct LineChannels {
  PositionChannel from = Value<3>{0, 0, 0};  ///< world [length]
  PositionChannel to = Value<3>{1, 0, 0};    ///< world [length]
  std::optional<Channel<3>> direction = {};

  friend bool operator==(const LineChannels&, const LineChannels&) = default;
};

/// The same everywhere, like gravity.
struct UniformChannels {
  Channel<3> direction = Value<3>{0, 1, 0};  ///< world; normalised

  friend bool operator==(const UniformChannels&, const UniformChannels&) = default;
};

/// Pushes along the normals of the surface: inflates it; a negative magnitude sucks it in.
struct PressureChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]

  friend bool operator==(const PressureChannels&, const PressureChannels&) = default;
};

/// Turns about a line by the right-hand rule, and pulls towards it.
struct VortexChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< a point of the line, world [length]
  Channel<3> axis = Value<3>{0, 1, 0};         ///< the line's direction, world; normalised
  Channel<1> pull = 0;                         ///< inward part, relative to a turning part of 1

  friend bool operator==(const VortexChannels&, const VortexChannels&) = default;
};

/// Smooth noise in space and time, on a lattice with a corner at the centre.
struct NoiseChannels {
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]
  Channel<1> frequency = 1;                    ///< [cells/length]; < 0: mirrored
  Channel<1> rate = 1;                         ///< [cells/s]; < 0: backwards; frame 0 is second 0
  std::optional<std::uint64_t> seed = {};      ///< absent: the scene's seed

  friend bool operator==(const NoiseChannels&, const NoiseChannels&) = default;
};

/// The inertial force that the motion of a surface's transform causes; its magnitude is usually 1.
struct InertiaChannels {
  friend bool operator==(const InertiaChannels&, const InertiaChannels&) = default;
};

/// The time at which a force is evaluated.
struct ForceTime {
  int frame = 0;
  double seconds = 0;  ///< frame / fps
};

/// A kind of force that an embedding program defines: like every kind (see forces/force.hpp), a
/// distance and a unit force at a position in the world and a time. Each is a function of one
/// position, (p, time) -> value, or of many, (points, time, values); see `PositionFunction`.
///
/// The functions must be pure: the same arguments give the same bits, or the run is not
/// reproducible. They must be thread-safe if the simulation has several threads. Their exceptions
/// pass through `Simulation::at` and `preview_forces` to the caller; the simulation starts again
/// from rest at the next call.
///
/// A frame calls those of many positions a few times for a surface, with up to 65536 of the nodes
/// that are looked at: on a grid `distance` for all nodes, to select the region; both for 32 nodes,
/// to see whether the force pushes, or for more if it pushes none of these; and both for the load
/// of each patch. A place that they leave without a value is NotFinite.
struct CustomForce {
  /// The distance compared with the radii, >= 0, infinite where the force never reaches [length];
  /// null: 0 everywhere.
  PositionFunction<double, const ForceTime&> distance = {};
  /// The force per unit of magnitude and falloff, finite. Must not be null.
  PositionFunction<Vector3d, const ForceTime&> unit_force = {};
  /// Identifies the functions and all values they capture. States that depend on the functions are
  /// stored under this key beyond one simulation, so functions with other results must have another
  /// key. Empty: such states are not stored.
  std::string key = {};

  /// The same key, which is not empty: functions cannot be compared.
  friend bool operator==(const CustomForce& a, const CustomForce& b) {
    return a.key == b.key && !a.key.empty();
  }
};

/// What of a force pushes a node: all of it, or its part along the node's normal.
enum class PushAlong { Free, Normal };

/// One force of a scene.
struct Force {
  std::string name;                  ///< [A-Za-z_][A-Za-z0-9_-]*, unique in the scene
  Switch enabled = true;             ///< a disabled force selects no nodes
  std::vector<std::string> targets;  ///< names of surfaces; empty: all
  std::string group = {};            ///< name of its group; empty: none. In a group, the group
                                     ///< selects the region and `deformation_radius` is not used
  /// The surface in whose object space its places and directions are; empty: the world. Of a kind
  /// with a place.
  std::string follow = {};
  PushAlong along = PushAlong::Free;  ///< of a kind with directions
  Channel<1> magnitude = 0;           ///< [length b/uv^4]
  Channel<1> deformation_radius = 1;  ///< selects the region, world [length], >= 0
  Channel<1> force_radius = 1;        ///< selects the nodes that are pushed, world [length], >= 0
  Falloff falloff = Falloff::Constant;
  /// A curve over s = distance / force radius, from 0 to 1, used instead of `falloff`.
  std::optional<Curve<1>> falloff_curve = {};
  std::variant<PointChannels, RadialChannels, LineChannels, UniformChannels, VortexChannels,
               NoiseChannels, InertiaChannels, PressureChannels, CustomForce>
      kind = {};  ///< by default `PointChannels`

  friend bool operator==(const Force&, const Force&) = default;
};

/// `point`, `radial`, …: the name of its element in a scene file; `custom` has no element.
std::string_view kind_of(const Force& force);

/// One region for several forces, the thesis's multipleForce (7.). A force in a group acts only
/// when and where the group does too.
struct Group {
  std::string name;                            ///< same rules as for a force; no force has the same
                                               ///< name
  Switch enabled = true;                       ///< a disabled group silences its forces
  std::vector<std::string> targets = {};       ///< names of surfaces; empty: all
  std::string follow = {};                     ///< as of a force
  PositionChannel center = Value<3>{0, 0, 0};  ///< world [length]
  Channel<1> deformation_radius = 1;           ///< selects the region, world [length], >= 0

  friend bool operator==(const Group&, const Group&) = default;
};

/// A ball round the origin of its collider.
struct SphereChannels {
  Channel<1> radius = 1;  ///< > 0 [length]

  friend bool operator==(const SphereChannels&, const SphereChannels&) = default;
};

/// What is nearer than a radius to an axis along y, with the origin in its middle.
struct CapsuleChannels {
  Channel<1> radius = 0.5;  ///< > 0 [length]
  Channel<1> length = 1;    ///< of its axis, >= 0 [length]

  friend bool operator==(const CapsuleChannels&, const CapsuleChannels&) = default;
};

/// A box round the origin.
struct BoxChannels {
  Channel<3> size = Value<3>{1, 1, 1};  ///< > 0 [length]
  Channel<1> round = 0;                 ///< radius of its edges, 0 to half the least size [length]

  friend bool operator==(const BoxChannels&, const BoxChannels&) = default;
};

/// All that is not above y = 0.
struct PlaneChannels {
  friend bool operator==(const PlaneChannels&, const PlaneChannels&) = default;
};

/// What a closed mesh encloses: each edge has two faces, which run through it in opposite
/// directions. It is turned outwards by its volume.
struct ClosedMesh {
  MeshFile mesh = {};             ///< without a set of UVs
  ShapeCache cache = {};          ///< of its vertices
  std::optional<Mesh> made = {};  ///< the mesh, made by a program; then `mesh` names no file

  friend bool operator==(const ClosedMesh&, const ClosedMesh&) = default;
};

/// A solid that surfaces meet: no node enters it. docs/model.md, "Contact".
struct Collider {
  std::string name;                       ///< same rules as for a force; no force has the same name
  Switch enabled = true;                  ///< a disabled one selects and stops nothing
  std::vector<std::string> targets = {};  ///< names of surfaces; empty: all
  Channel<1> deformation_radius = 1;      ///< selects the region, world [length], >= 0
  Channel<1> offset = 0;                  ///< that nodes keep from it, >= 0, world [length]
  Channel<1> friction = 0;                ///< mu >= 0 [1]
  Switch stick = false;                   ///< what touches is held
  std::variant<SphereChannels, CapsuleChannels, BoxChannels, PlaneChannels, ClosedMesh> shape =
      {};  ///< by default `SphereChannels`
  /// Its scale multiplies the lengths of the shape but for `round`; that of a sphere or capsule is
  /// the same along all axes, up to signs.
  TransformChannels transform = {};

  friend bool operator==(const Collider&, const Collider&) = default;
};

/// `sphere`, `capsule`, …: the name of the element of its shape.
std::string_view shape_of(const Collider& collider);

/// The most bytes of a scene file.
inline constexpr std::size_t largest_scene_file = std::size_t{256} << 20U;

/// The most characters of a name: messages and paths of channels repeat it.
inline constexpr std::size_t longest_object_name = 1000;

/// Whether a name matches [A-Za-z_][A-Za-z0-9_-]* and is no longer than that.
bool is_name(std::string_view text);

class SourceMap;

/// A part of a scene that its file contains.
struct ScenePart {
  std::string name;  ///< `NAME` or `NAME.attribute`; the scene itself: ``, `.fps`, `.end`
  TextPlace place;

  friend bool operator==(const ScenePart&, const ScenePart&) = default;
};

/// The places of a scene's parts in its file and those that it includes, for messages. Empty for a
/// scene built in code.
struct SceneOrigin {
  std::string file;                               ///< the name given by the caller
  std::vector<ScenePart> parts = {};              ///< in the order of names, each once
  std::shared_ptr<const SourceMap> sources = {};  ///< null: built in code
  /// The folder that must contain all files that the scene leads to, whenever they are opened;
  /// empty: they may be anywhere.
  std::string root = {};

  /// The scene's own file has another name from now on.
  void rename(const std::string& name);

  /// The place of `NAME.attribute`, otherwise of `NAME`; unknown: neither is in a file.
  TextPlace at(const std::string& name, const std::string& attribute = {}) const;

  /// The last of the places of these attributes.
  TextPlace last_of(const std::string& name, const std::vector<std::string>& attributes) const;

  ScenePlace place_of(const TextPlace& place) const;
  ScenePlace place_of(const std::string& name, const std::string& attribute = {}) const {
    return place_of(at(name, attribute));
  }

  /// Whether it stands in the scene's own file, not in one that is included.
  bool is_own(const std::string& name, const std::string& attribute = {}) const;

  /// The error at a place; at the end of the message, how its file was included.
  Error located(Error error, const TextPlace& place) const;

  /// Whether the file gives the attribute.
  bool gives(const std::string& name, const std::string& attribute) const;
};

/// A remark on valid content of a scene file, such as a tangent that the curve rules shortened.
struct SceneNote : TextSpan {
  std::string message;    ///< one line, begins with the channel: `poke.magnitude: key 12: …`
  std::string file = {};  ///< the scene's, or one that is included

  friend bool operator==(const SceneNote&, const SceneNote&) = default;
};

struct Scene;

/// The length of a frame in a surface's own time [s]. 0: it is halted. So it is if a frame would be
/// shorter than 10^-30 s, in which nothing moves.
double frame_length(const Scene& scene, const Surface& surface, int frame);

/// The first frame at which an enabled surface is solved: its start, or `preroll` frames ahead of
/// it. Up to there it is at rest.
int first_solved_frame(const Scene& scene, const Surface& surface);

/// Frames, both ends included.
struct FrameSpan {
  int first = 0;
  int last = 0;

  int count() const { return last - first + 1; }
};

/// The frames at which the channels of a surface are sampled: those of the scene, and those ahead
/// of it or after it in which it is solved.
FrameSpan sampled_frames(const Scene& scene, const Surface& surface);

/// The same of all surfaces together.
FrameSpan sampled_frames(const Scene& scene);

/// A complete scene: values only, made by `load_scene` or in code.
struct Scene {
  double fps = 24;  ///< [1/s], > 0
  int start = 1;    ///< first frame
  int end = 1;      ///< last frame, >= start, at most 10^6 frames
  std::uint64_t seed = 0;
  std::vector<Surface> surfaces;
  std::vector<Force> forces;  ///< including those in groups; summed in this order, the order of the
                              ///< file
  std::vector<Group> groups;
  std::vector<Collider> colliders = {};  ///< met in this order, the order of the file
  SceneOrigin origin = {};
  std::vector<SceneNote> notes = {};  ///< found while reading, in the order of lines

  /// The same values, wherever they come from: `origin` and `notes` do not count.
  friend bool operator==(const Scene& a, const Scene& b);
};

}  // namespace pliant
