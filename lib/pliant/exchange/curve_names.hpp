#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "pliant/exchange/curve_file.hpp"

namespace pliant::exchange {

/// The names that curves of a file have so far.
struct CurveNames {
  std::set<std::string> taken;
  std::map<std::string, int> next_numbers;  ///< of names that are taken several times
};

/// `.x` to `.z`, or nothing for -1.
std::string component_suffix(int component);

/// Gives a curve its name, made of its group and component. A group that has this component already
/// gets a number: `Cube.location#2`.
void name_curve(FileCurve& curve, CurveNames& names);

/// Why keys are no curve, about `name` unless it is empty; Interrupted.
Error error_of(const Complaint& wrong, const std::string& name, int line = 0);

/// Whether copies show a jump where they meet, on whose frame programs differ.
bool jumps_at_seam(const CurveKeys<1>& keys);

/// A channel split at its first dot: the thing and what of it.
std::pair<std::string, std::string> split_channel(const std::string& channel);

}  // namespace pliant::exchange
