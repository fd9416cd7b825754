#include "pliant/exchange/curve_names.hpp"

#include <fmt/format.h>

namespace pliant::exchange {

std::string component_suffix(int component) {
  return component < 0 ? "" : fmt::format(".{}", "xyz"[component]);
}

void name_curve(FileCurve& curve, CurveNames& names) {
  const std::string group = curve.group;
  const std::string suffix = component_suffix(curve.component);
  curve.name = group + suffix;
  if (names.taken.insert(curve.name).second) return;
  int& number = names.next_numbers.try_emplace(curve.name, 2).first->second;
  do {
    curve.group = fmt::format("{}#{}", group, number++);
    curve.name = curve.group + suffix;
  } while (!names.taken.insert(curve.name).second);
}

bool jumps_at_seam(const CurveKeys<1>& keys) {
  const bool repeats = keys.before.kind == Extrapolation<1>::Kind::Repeat ||
                       keys.after.kind == Extrapolation<1>::Kind::Repeat;
  return repeats && keys.keys.front().value != keys.keys.back().value;
}

std::pair<std::string, std::string> split_channel(const std::string& channel) {
  const std::size_t dot = channel.find('.');
  if (dot == std::string::npos) return {channel, {}};
  return {channel.substr(0, dot), channel.substr(dot + 1)};
}

Error error_of(const Complaint& wrong, const std::string& name, int line) {
  if (wrong.kind == Complaint::Kind::Interrupted) return interrupted().value();
  return {.message = name.empty() ? wrong.message : fmt::format("{}: {}", name, wrong.message),
          .line = line};
}

}  // namespace pliant::exchange
