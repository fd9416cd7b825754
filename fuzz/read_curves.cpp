// Arbitrary bytes as a file of curves: the first byte says which format. What is read becomes a
// curve, goes through every format, and is joined with others.

#include <cmath>

#include "fuzz.hpp"
#include "pliant/exchange/curve_file.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

constexpr CurveFormat formats[] = {CurveFormat::Blender, CurveFormat::Gltf, CurveFormat::Maya};
constexpr std::size_t most_written = 4;  // of the curves of one input
constexpr std::size_t most_keys = 40;

void check_losses(const std::vector<CurveLoss>& losses) {
  for (const CurveLoss& loss : losses) require(!loss.message.empty() && !loss.curve.empty());
}

void check_written(const std::vector<ChannelCurve>& curves) {
  for (const CurveFormat format : formats) {
    CurveWriting writing;
    writing.first = -5;
    writing.last = 20;
    writing.tolerance = 1e-2;
    const auto text = write_curves(curves, format, writing);
    if (!text) {
      check_error(text.error());
      continue;
    }
    check_losses(text->losses);
    const auto back = parse_curves(text->bytes, format, "written", {});
    if (!back) {
      check_error(back.error());
      continue;
    }
    require(back->curves.size() >= curves.size());
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  if (size == 0) return 0;
  const CurveFormat format = formats[bytes[0] % 3];
  const auto read = [](const std::string& uri, std::size_t) -> Result<std::string> {
    return std::string(uri.size() % 200, 'x');
  };
  const auto file = parse_curves(text_of(bytes + 1, size - 1), format, "fuzz", {}, read);
  if (!file) {
    check_error(file.error());
    return 0;
  }
  check_losses(file->losses);
  std::vector<ChannelCurve> curves;
  for (const FileCurve& each : file->curves) {
    const auto curve = Curve<1>::make(each.keys);
    require(curve.has_value());
    for (const double frame : {-1e4, -3.5, 0.0, 1.0, 7.25, 1e5})
      require(!std::isnan(curve->value(frame)[0]));
    if (curves.size() < most_written && each.keys.keys.size() <= most_keys)
      curves.push_back({"thing.channel" + std::to_string(curves.size()), *curve, each.unit});
  }
  check_written(curves);
  if (curves.size() >= 3) {
    const auto keys = [&](std::size_t k) { return &std::get<Curve<1>>(curves[k].curve).keys(); };
    const auto joined = join_curves({keys(0), keys(1), keys(2)}, {}, 1e-2);
    if (!joined) check_error(joined.error());
  }
  return 0;
}
