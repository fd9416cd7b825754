#pragma once

#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/exchange/curve_file.hpp"
#include "pliant/scene/scene.hpp"

namespace pliant {

/// The animated channels of a scene as curves to write: those with these paths, in their order, or
/// all if there are none. Errors: a path that the scene does not have, or that is constant.
Result<std::vector<ChannelCurve>> curves_of(const Scene& scene,
                                            const std::vector<std::string>& paths = {});

/// Where a curve of a file goes: `Cube.location.z=poke.magnitude*100`.
struct CurveMapping {
  std::string source;   ///< the name or the group of curves of the file
  std::string channel;  ///< `NAME.attribute`
  int component = -1;   ///< of the channel; -1: all of it
  double factor = 1;    ///< of values
};

/// Parses `SOURCE=CHANNEL[.x|.y|.z][*FACTOR]`. A source may contain `=`. Errors: what is missing.
Result<CurveMapping> parse_mapping(std::string_view text);

/// The mappings that the names in a file ask for: of those that name channels of the scene, as
/// files by `write_curves` do.
std::vector<CurveMapping> mappings_by_name(const CurveFile& file, const Scene& scene);

/// Finds curves of a file, which must outlive it, by their names.
class CurveIndex {
 public:
  explicit CurveIndex(const CurveFile& file);

  /// The curve of a name, or, if there is none, the components of a vector, in their order; empty:
  /// neither is there.
  std::vector<const FileCurve*> find(const std::string& source) const;

 private:
  std::unordered_map<std::string, std::vector<const FileCurve*>> by_name_, by_group_;
};

/// Whether a mapping takes a vector of the file as a whole: a group of curves, or, of mappings by
/// name, a component for the same one.
bool is_of_vector(const CurveMapping& mapping, const CurveIndex& curves);

/// Mappings of a file in whose space z is up: of vectors that are taken as a whole (x, y, z)
/// becomes (x, z, -y), of a scale (x, z, y). Angles are then those of the order xzy if they were
/// those of xyz.
std::vector<CurveMapping> with_z_up(const std::vector<CurveMapping>& mappings,
                                    const CurveFile& file);

/// A curve for a channel.
struct PlacedCurve {
  std::string channel;
  std::variant<CurveKeys<1>, CurveKeys<3>> keys;
  bool is_switch = false;  ///< values are true and false
};

/// The curves for channels, in the order of their first mapping.
struct PlacedCurves {
  std::vector<PlacedCurve> curves;
  std::vector<CurveLoss> losses;
};

/// Where the values of components come from that no mapping gives: the scene's own at its start.
/// `offset`: added to all frames. `tolerance` as in CurveReading. Null scene: any channel is one; a
/// vector if a component or three curves are given, and other components are 0.
///
/// Errors, naming the mapping: no such curve or channel; a component of a number, or a number for a
/// vector; twice the same; values other than 0 and 1 for a switch; those of `join_curves`.
/// Interrupted.
Result<PlacedCurves> place_curves(const CurveFile& file, const std::vector<CurveMapping>& mappings,
                                  const Scene* scene, double offset, double tolerance,
                                  const StopRequest& should_stop = {});

/// The text of a scene file with these curves in place of what its channels have: nothing else
/// changes. `name`: of the file, in messages. Errors: as `parse_scene`, of the text before or
/// after; a channel whose element is not in the text, or that follows a path; Interrupted.
Result<std::string> with_curves(std::string_view text, const std::string& name,
                                const std::string& folder, const std::string& root,
                                const PlacedCurves& curves, const StopRequest& should_stop = {});

/// The curves as <animate> elements, those of each thing after a comment with its name. Not all of
/// them if the caller wants it to stop.
std::string animate_elements(const PlacedCurves& curves, const StopRequest& should_stop = {});

}  // namespace pliant
