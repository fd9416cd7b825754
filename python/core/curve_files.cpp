#include "curve_files.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <regex>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <pybind11/stl.h>

#include "call.hpp"
#include "curves.hpp"
#include "pliant/core/text.hpp"
#include "pliant/exchange/curve_file.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/output_place.hpp"
#include "pliant/scene/format/description.hpp"
#include "pliant/scene/scene.hpp"
#include "runs.hpp"

namespace pliant::python {
namespace {

constexpr const char* unit_words[] = {"number", "length", "degrees"};  // CurveUnit

py::list losses_of(const std::vector<CurveLoss>& losses) {
  py::list list;
  for (const CurveLoss& loss : losses)
    list.append(
        class_named("CurveLoss")(name_text(loss.curve), name_text(loss.message), loss.is_exact));
  return list;
}

RotateOrder order_of(const std::string& word) {
  const auto* const found = std::ranges::find(rotate_order_words, word);
  if (found == std::end(rotate_order_words))
    throw py::value_error(
        fmt::format("rotate_order \"{}\": allowed: {}", word, fmt::join(rotate_order_words, ", ")));
  return static_cast<RotateOrder>(found - std::begin(rotate_order_words));
}

void check_positive(const char* name, double number) {
  if (!(number > 0) || !std::isfinite(number))
    throw py::value_error(fmt::format("{} must be a finite number > 0", name));
}

void check_finite(const char* name, double number) {
  if (!std::isfinite(number)) throw py::value_error(fmt::format("{} must be finite", name));
}

py::object read(const std::string& file, double fps, double frame_at_zero,
                const std::string& rotate_order, double tolerance) {
  check_positive("fps", fps);
  check_positive("tolerance", tolerance);
  check_finite("frame_at_zero", frame_at_zero);
  CurveReading reading{.fps = fps,
                       .frame_at_zero = frame_at_zero,
                       .rotate_order = order_of(rotate_order),
                       .tolerance = tolerance};
  std::vector<AnyCurve> compiled;
  const CurveFile read = run_once([&](const StopRequest& should_stop) -> Result<CurveFile> {
    reading.should_stop = should_stop;
    auto own = read_curves(file, reading);
    if (!own) return own;
    for (const FileCurve& each : own->curves) {
      if (is_stopped(should_stop)) return interrupted();
      compiled.push_back({Curve<1>::make(each.keys).value()});
    }
    return own;
  });
  py::list curves;
  for (std::size_t k = 0; k < read.curves.size(); ++k) {
    const FileCurve& each = read.curves[k];
    const py::object component =
        each.component < 0 ? py::object(py::none()) : py::int_(each.component);
    curves.append(class_named("FileCurve")(name_text(each.name), name_text(each.group), component,
                                           unit_words[static_cast<std::size_t>(each.unit)],
                                           py::cast(std::move(compiled[k]))));
  }
  return class_named("CurveFile")(py::tuple(curves), py::tuple(losses_of(read.losses)), read.fps);
}

/// What the values of attributes measure, by their names in the format.
const std::map<std::string, CurveUnit, std::less<>>& attribute_units() {
  static const auto units = [] {
    std::map<std::string, CurveUnit, std::less<>> all;
    const auto add = [&](const auto& thing) {
      for_each_channel(thing, [&](const std::string& name, const Attribute& row, const auto&) {
        all.try_emplace(name, row.unit == "length"    ? CurveUnit::Length
                              : row.unit == "degrees" ? CurveUnit::Degrees
                                                      : CurveUnit::Number);
      });
    };
    add(Surface());
    add(Group());
    add(Collider());
    [&]<class... Kinds>(std::variant<Kinds...>*) {
      const auto add_kind = [&]<class Kind>(Kind kind) {
        Force force;
        force.kind = std::move(kind);
        add(force);
      };
      (add_kind(Kinds()), ...);
    }(static_cast<decltype(Force::kind)*>(nullptr));
    return all;
  }();
  return units;
}

CurveUnit unit_of(std::string_view channel) {
  const std::size_t dot = channel.find('.');
  if (dot == std::string_view::npos) return CurveUnit::Number;
  const auto found = attribute_units().find(channel.substr(dot + 1));
  return found == attribute_units().end() ? CurveUnit::Number : found->second;
}

/// Whether it is NAME.attribute, perhaps with `.progress`: what all formats can hold.
bool is_channel(const std::string& name) {
  static const std::regex pattern("[A-Za-z_][A-Za-z0-9_-]*(\\.[A-Za-z0-9_]+){1,2}");
  return std::regex_match(name, pattern);
}

/// The first and the last frame of keys.
template <int D>
std::pair<double, double> span_of(const Curve<D>& curve) {
  const auto& keys = curve.keys().keys;
  return {keys.front().frame, keys.back().frame};
}

py::list write(const py::dict& given, const std::string& file, double fps,
               const std::optional<double>& first, const std::optional<double>& last,
               double tolerance) {
  check_positive("fps", fps);
  check_positive("tolerance", tolerance);
  std::vector<ChannelCurve> curves;
  std::optional<std::pair<double, double>> span;
  for (const auto& [channel, curve] : given) {
    if (!py::isinstance<py::str>(channel) || !py::isinstance<AnyCurve>(curve))
      throw py::type_error("curves must be a dict from channels to Curve");
    const auto name = channel.cast<std::string>();
    if (!is_channel(name))
      throw py::value_error(fmt::format("\"{}\" is no channel, NAME.attribute", printable(name)));
    const auto& own = curve.cast<AnyCurve&>();
    curves.push_back({name, own.curve, unit_of(name)});
    const auto keys = std::visit([](const auto& each) { return span_of(each); }, own.curve);
    span = span ? std::pair(std::min(span->first, keys.first), std::max(span->second, keys.second))
                : keys;
  }
  if (!span) throw py::value_error("curves must have a curve");
  CurveWriting writing{.fps = fps,
                       .first = first.value_or(span->first),
                       .last = last.value_or(span->second),
                       .tolerance = tolerance,
                       .is_binary = ending_of(file) == ".glb"};
  check_finite("first", writing.first);
  check_finite("last", writing.last);
  const auto format = curve_format_of(file);
  if (!format)
    raise(Error{.code = ErrorCode::InvalidInput,
                .message = fmt::format("{}: no format of curves has the ending \"{}\"; allowed: "
                                       ".json, .gltf, .glb, .anim",
                                       printable(file), printable(ending_of(file)))});
  return losses_of(run_once([&](const StopRequest& should_stop) -> Result<std::vector<CurveLoss>> {
    writing.should_stop = should_stop;
    if (auto place = check_output_place(file); !place) return fail(place.error());
    auto text = write_curves(curves, *format, writing);
    if (!text) return fail(text.error());
    if (auto written = write_file(file, text->bytes, should_stop); !written)
      return fail(written.error());
    return std::move(text->losses);
  }));
}

}  // namespace

void add_curve_files(Module& module) {
  module.def("read_curves", &read);
  module.def("write_curves", &write);
}

}  // namespace pliant::python
