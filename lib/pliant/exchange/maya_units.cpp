#include "pliant/exchange/maya_units.hpp"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/text.hpp"

namespace pliant::exchange {
namespace {

struct NamedRate {
  std::string_view name;
  double fps;
};

constexpr NamedRate named_rates[] = {
    {"game", 15},
    {"film", 24},
    {"pal", 25},
    {"ntsc", 30},
    {"show", 48},
    {"palf", 50},
    {"ntscf", 60},
    {"23.976fps", 24000.0 / 1001},
    {"29.97fps", 30000.0 / 1001},
    {"29.97df", 30000.0 / 1001},
    {"47.952fps", 48000.0 / 1001},
    {"59.94fps", 60000.0 / 1001},
};

// Other rates that Maya has, as `120fps`. Source: its command currentUnit, flag time.
constexpr double plain_rates[] = {
    2,   3,   4,   5,   6,   8,   10,  12,  16,  20,  40,   75,   80,   90,   100,  120,   125,
    150, 200, 240, 250, 300, 375, 400, 500, 600, 750, 1200, 1500, 2000, 3000, 6000, 44100, 48000};

}  // namespace

std::optional<double> rate_of(std::string_view unit) {
  for (const NamedRate& rate : named_rates)
    if (unit == rate.name) return rate.fps;
  if (!unit.ends_with("fps")) return {};
  const auto rate = to_number(unit.substr(0, unit.size() - 3));
  if (!rate || !(*rate >= 1e-3 && *rate <= 1e6)) return {};
  return rate;
}

std::optional<double> seconds_of(std::string_view unit) {
  if (const auto rate = rate_of(unit)) return 1 / *rate;
  if (unit == "hour") return 3600;
  if (unit == "min") return 60;
  if (unit == "sec") return 1;
  if (unit == "millisec") return 1e-3;
  return {};
}

std::optional<double> radians_of(std::string_view unit) {
  constexpr double degree = std::numbers::pi / 180;
  if (unit == "deg" || unit == "degree") return degree;
  if (unit == "rad" || unit == "radian") return 1;
  if (unit == "min" || unit == "minute") return degree / 60;
  if (unit == "sec" || unit == "second") return degree / 3600;
  return {};
}

std::optional<std::string> unit_of_rate(double fps) {
  for (const NamedRate& rate : named_rates)
    if (std::fabs(fps - rate.fps) <= 1e-9 * fps) return std::string(rate.name);
  for (const double rate : plain_rates)
    if (fps == rate) return fmt::format("{}fps", rate);
  return {};
}

}  // namespace pliant::exchange
