#include "pliant/document/operation.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "pliant/scene/elements/curve_text.hpp"

namespace pliant {

namespace edit {

std::string to_text(double number) { return fmt::format("{}", number); }

std::string literal_text(std::string_view text) { return xml::with_doubled_dollars(text); }

std::string to_text(const std::vector<double>& numbers) {
  return fmt::format("{}", fmt::join(numbers, " "));
}

namespace {

/// `poke.center`, `poke.center and pull.center`, `3 channels`.
std::string listed(const std::vector<std::string>& names, std::string_view several) {
  if (names.size() == 1) return names[0];
  if (names.size() == 2) return fmt::format("{} and {}", names[0], names[1]);
  return fmt::format("{} {}", names.size(), several);
}

std::string channels(const std::vector<std::string>& names) { return listed(names, "channels"); }
std::string objects(const std::vector<std::string>& names) { return listed(names, "objects"); }

/// `3 keys of poke.center`.
std::string keys(const std::vector<KeysOf>& keys) {
  std::size_t count = 0;
  std::vector<std::string> names;
  for (const KeysOf& some : keys) {
    count += some.frames.size();
    names.push_back(some.channel);
  }
  return fmt::format("{} {} of {}", count, count == 1 ? "key" : "keys", channels(names));
}

/// What an operation does.
struct Describe {
  std::string operator()(const Set& of) const { return fmt::format("set {}", of.path); }
  std::string operator()(const Reset& of) const { return fmt::format("reset {}", of.path); }
  std::string operator()(const Animate& of) const {
    return fmt::format("animate {}", channels(of.channels));
  }
  std::string operator()(const Freeze& of) const {
    return fmt::format("freeze {}", channels(of.channels));
  }
  std::string operator()(const SetKey& of) const {
    return fmt::format("set key {} of {}", of.frame, of.channel);
  }
  std::string operator()(const DeleteKeys& of) const {
    return fmt::format("delete {}", keys(of.keys));
  }
  std::string operator()(const MoveKeys& of) const { return fmt::format("move {}", keys(of.keys)); }
  std::string operator()(const ScaleKeys& of) const {
    return fmt::format("scale {}", keys(of.keys));
  }
  std::string operator()(const SetTangent& of) const {
    return fmt::format("set tangent of {}", keys(of.keys));
  }
  std::string operator()(const SetHandle& of) const {
    return fmt::format("set handle of key {} of {}", of.frame, of.channel);
  }
  std::string operator()(const SetInterpolation& of) const {
    return fmt::format("set interpolation of {}", keys(of.keys));
  }
  std::string operator()(const SetExtrapolation& of) const {
    return fmt::format("set extrapolation of {}", channels(of.channels));
  }
  std::string operator()(const BakeKeys& of) const {
    return fmt::format("bake keys of {}", channels(of.channels));
  }
  std::string operator()(const SimplifyKeys& of) const {
    return fmt::format("simplify keys of {}", channels(of.channels));
  }
  std::string operator()(const Scale& of) const {
    return fmt::format("scale {}", channels(of.channels));
  }
  std::string operator()(const SetCurve& of) const {
    return fmt::format("set curve of {}", of.channel);
  }
  std::string operator()(const Splice& of) const { return fmt::format("splice {}", of.channel); }
  std::string operator()(const SetPart& of) const {
    return fmt::format("set {} of {}", of.part, of.surface);
  }
  std::string operator()(const Add& of) const { return fmt::format("add {}", of.name); }
  std::string operator()(const Duplicate& of) const {
    return fmt::format("duplicate {} as {}", of.object, of.name);
  }
  std::string operator()(const Delete& of) const {
    return fmt::format("delete {}", objects(of.objects));
  }
  std::string operator()(const Rename& of) const {
    return fmt::format("rename {} to {}", of.object, of.name);
  }
  std::string operator()(const Target& of) const {
    return fmt::format("set targets of {}", objects(of.objects));
  }
  std::string operator()(const Group& of) const {
    return fmt::format("group {} in {}", objects(of.forces), of.name);
  }
  std::string operator()(const Ungroup& of) const {
    return fmt::format("ungroup {}", objects(of.groups));
  }
};

}  // namespace

}  // namespace edit

std::string described(const Operation& operation) {
  return std::visit(edit::Describe(), operation);
}

}  // namespace pliant
