#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace pliant::exchange {

/// The frame rate of a unit of time such as `film` or `120fps` [1/s]; nullopt: it is none.
std::optional<double> rate_of(std::string_view unit);

/// The seconds in a unit of time; nullopt: it is not known.
std::optional<double> seconds_of(std::string_view unit);

/// The radians in a unit of angle, `deg` or `degree` and the like; nullopt: it is not known.
std::optional<double> radians_of(std::string_view unit);

/// The name of a frame rate, if Maya has it: `film` for 24.
std::optional<std::string> unit_of_rate(double fps);

}  // namespace pliant::exchange
