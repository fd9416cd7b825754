#include "pliant/exchange/curve_file.hpp"

#include <cmath>
#include <new>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/text.hpp"
#include "pliant/exchange/formats.hpp"
#include "pliant/files/file_reference.hpp"
#include "pliant/files/read_file.hpp"

namespace pliant {
namespace {

Result<CurveFile> parse_as(std::string_view bytes, CurveFormat format, const CurveReading& reading,
                           const ReadCurveReference& read_reference) {
  if (format != CurveFormat::Gltf && bytes.starts_with(byte_order_mark))
    bytes.remove_prefix(byte_order_mark.size());
  switch (format) {
    case CurveFormat::Blender:
      return exchange::parse_blender(bytes, reading);
    case CurveFormat::Gltf:
      return exchange::parse_gltf_curves(bytes, reading, read_reference);
    case CurveFormat::Maya:
      return exchange::parse_maya(bytes, reading);
  }
  return CurveFile{};
}

bool is_positive(double number) { return number > 0 && std::isfinite(number); }

}  // namespace

std::optional<CurveFormat> curve_format_of(const std::filesystem::path& file) {
  const std::string ending = ending_of(file);
  if (ending == ".json") return CurveFormat::Blender;
  if (ending == ".gltf" || ending == ".glb") return CurveFormat::Gltf;
  if (ending == ".anim") return CurveFormat::Maya;
  return {};
}

Result<CurveFile> parse_curves(std::string_view bytes, CurveFormat format, const std::string& name,
                               const CurveReading& reading,
                               const ReadCurveReference& read_reference) {
  PLIANT_EXPECTS(is_positive(reading.fps) && is_positive(reading.tolerance));
  try {
    auto file = parse_as(bytes, format, reading, read_reference);
    if (!file) file.error().file = name;
    return file;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory, "the curves do not fit in memory", name);
  }
}

Result<CurveFile> read_curves(const std::filesystem::path& file, const CurveReading& reading,
                              const std::filesystem::path& root) {
  const auto format = curve_format_of(file);
  if (!format) {
    return fail(ErrorCode::InvalidInput,
                fmt::format("no format of curves has the ending \"{}\"; allowed: .json, .gltf, "
                            ".glb, .anim",
                            ending_of(file)),
                file.string());
  }
  const auto bytes = read_file(file, largest_curve_file, reading.should_stop);
  if (!bytes) return fail(bytes.error());
  const auto read = [&](const std::string& uri, std::size_t max_bytes) {
    return read_reference(uri, file, root, max_bytes);
  };
  return parse_curves(*bytes, *format, file.string(), reading, read);
}

Result<CurveText> write_curves(const std::vector<ChannelCurve>& curves, CurveFormat format,
                               const CurveWriting& writing) {
  PLIANT_EXPECTS(is_positive(writing.fps) && is_positive(writing.tolerance));
  switch (format) {
    case CurveFormat::Blender:
      return exchange::write_blender(curves, writing);
    case CurveFormat::Gltf:
      return exchange::write_gltf_curves(curves, writing);
    case CurveFormat::Maya:
      return exchange::write_maya(curves, writing);
  }
  return CurveText{};
}

}  // namespace pliant
