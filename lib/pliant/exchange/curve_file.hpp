#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "pliant/core/result.hpp"
#include "pliant/core/stop_request.hpp"
#include "pliant/core/transform.hpp"
#include "pliant/timeline/curve.hpp"

namespace pliant {

/// The files of other programs that hold curves (docs/interchange.md, "Keys").
enum class CurveFormat {
  Blender,  ///< .json, F-curves as script/blender_curves.py writes and reads them
  Gltf,     ///< .gltf, .glb: animations of glTF 2
  Maya,     ///< .anim, text of animImportExport
};

/// By the ending of a file's name, in any case; nullopt: none of them.
std::optional<CurveFormat> curve_format_of(const std::filesystem::path& file);

/// What the values of a curve measure.
enum class CurveUnit { Number, Length, Degrees };

/// Something of a curve that was changed, since one side has no such thing.
struct CurveLoss {
  std::string curve;      ///< its name, or the channel
  std::string message;    ///< one line: the thing, what became of it, how much the value changed
  bool is_exact = false;  ///< the values of the curve are the same
};

/// A curve of a file, in frames.
struct FileCurve {
  /// Unique in the file: `Cube.location.z`.
  std::string name = {};
  /// Without the component: `Cube.location`.
  std::string group = {};
  int component = -1;      ///< 0 to 2: x to z; -1: not a part of a vector
  CurveKeys<1> keys = {};  ///< `Curve::make` accepts them
  CurveUnit unit = CurveUnit::Number;
};

/// What a file contains.
struct CurveFile {
  std::vector<FileCurve> curves;   ///< in the order of the file
  std::vector<CurveLoss> losses;   ///< what pliant's curves do not have
  std::optional<double> fps = {};  ///< of the file, if its curves are in frames [1/s]
};

/// How to read a file.
struct CurveReading {
  double fps = 24;                              ///< of the scene; seconds become frames by it. > 0
  double frame_at_zero = 1;                     ///< the frame at second 0 of a glTF
  RotateOrder rotate_order = RotateOrder::Xyz;  ///< of the angles that quaternions become
  double tolerance = 1e-4;  ///< largest deviation where curves are converted, as a share of their
                            ///< range; > 0
  StopRequest should_stop = {};
};

/// Returns the bytes of the file that a glTF refers to, at most `max_bytes`.
using ReadCurveReference =
    std::function<Result<std::string>(const std::string& uri, std::size_t max_bytes)>;

/// Reads the curves of a file from its bytes. `name` is the file's name in messages. Errors: the
/// first problem, with the line or the path in the JSON; a file with too many keys
/// (`most_file_keys`) or values; Interrupted. Requires: fps and tolerance positive and finite.
Result<CurveFile> parse_curves(std::string_view bytes, CurveFormat format, const std::string& name,
                               const CurveReading& reading,
                               const ReadCurveReference& read_reference = {});

/// Reads a file by its ending. What a glTF refers to must be in its own folder or, if given, in the
/// folder `root` or below. Errors: as `parse_curves`; another ending; Unreadable, also if it is
/// larger than `largest_curve_file`.
Result<CurveFile> read_curves(const std::filesystem::path& file, const CurveReading& reading,
                              const std::filesystem::path& root = {});

inline constexpr std::size_t largest_curve_file = std::size_t{1} << 30U;  ///< [bytes]

/// The most keys that a file may have.
inline constexpr std::size_t most_file_keys = 1'000'000;

/// A curve to write.
struct ChannelCurve {
  std::string channel;  ///< `NAME.attribute`
  std::variant<Curve<1>, Curve<3>> curve;
  CurveUnit unit = CurveUnit::Number;
  RotateOrder rotate_order = RotateOrder::Xyz;  ///< of `rotate` only
};

/// How to write a file.
struct CurveWriting {
  double fps = 24;          ///< > 0
  double first = 1;         ///< curves without end reach from this frame
  double last = 1;          ///< to this one
  double tolerance = 1e-4;  ///< as in CurveReading
  bool is_binary = true;    ///< glTF: as .glb
  StopRequest should_stop = {};
};

/// The content of a file.
struct CurveText {
  std::string bytes;
  std::vector<CurveLoss> losses;  ///< what the format cannot hold
};

/// Errors, naming the channel: numbers that no other program computes with; a value beyond single
/// precision, in a glTF. Interrupted. Requires: fps and tolerance positive and finite; channels are
/// unique.
Result<CurveText> write_curves(const std::vector<ChannelCurve>& curves, CurveFormat format,
                               const CurveWriting& writing);

/// Three curves of a file as one with three components, as keys of a vector channel are; null: the
/// component is `constant` there. Their keys share frames, segments and lengths in a vector: curves
/// that do not are converted, within `tolerance` of their range, and the loss is told. Errors: an
/// inner loop, an extrapolation that differs between them and has copies: which. Interrupted.
struct JoinedCurve {
  CurveKeys<3> keys;
  std::vector<std::string> losses;
};
Result<JoinedCurve> join_curves(const std::array<const CurveKeys<1>*, 3>& components,
                                const Value<3>& constant, double tolerance,
                                const StopRequest& should_stop = {});

/// One component of keys.
CurveKeys<1> component_of(const CurveKeys<3>& keys, int component);

}  // namespace pliant
