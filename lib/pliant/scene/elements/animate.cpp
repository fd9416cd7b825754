#include <algorithm>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/elements/read_elements.hpp"
#include "pliant/scene/format/artist_words.hpp"
#include "pliant/scene/format/nearest.hpp"

namespace pliant::xml {
namespace {

/// Why `name` cannot be animated here.
std::string no_channel(const Element& animate, std::span<Slot* const> rows, std::string_view name) {
  const std::string parent = tag(animate.parent());
  std::vector<std::string_view> channels;
  bool is_known = false;
  for (const Slot* row : rows) {
    if (row->attribute.name == name && row->attribute.need == Need::Later)
      return value_problem(animate, "attribute", name, not_supported());
    is_known = is_known || row->attribute.name == name;
    if (is_channel(row->place)) channels.push_back(row->attribute.name);
  }
  if (is_known)
    return value_problem(animate, "attribute", name,
                         fmt::format("cannot be animated; the channels of {} are: {}", parent,
                                     channels.empty() ? "none" : listed(channels)));
  return value_problem(animate, "attribute", name,
                       fmt::format("{} has no such channel{}", parent,
                                   channel_hint(animate.parent().name(), name, channels)));
}

/// The largest number of components among the values of the keys.
std::size_t value_width(const Element& animate, Findings& findings) {
  constexpr std::size_t parts_of_key = 64;
  std::size_t width = 0;
  for (auto key = animate.first_child(); key && !findings.is_over(parts_of_key);
       key = key->next()) {
    const auto value = key->name() == "key" ? key->attribute("value") : std::nullopt;
    if (value) width = std::max(width, words_of(value->value).size());
  }
  return width;
}

bool has_boolean_values(const Element& animate) {
  auto key = animate.first_child();
  while (key && key->name() != "key") key = key->next();
  const auto value = key ? key->attribute("value") : std::nullopt;
  return value && parse_boolean(value->value).has_value();
}

/// Reads a curve with D components and passes it to `store`, unless there was a problem.
template <int D>
void read_into(const Element& animate, ValueKind kind, const std::string& path, Findings& findings,
               auto&& store) {
  if (std::optional<Curve<D>> curve = read_curve<D>(animate, KeyAxis::Frame, kind, path, findings))
    store(std::move(*curve));
}

struct CurveOfChannel {
  const Element& animate;
  const std::string& path;
  Findings& findings;

  /// An unknown channel: the keys are still read, to report their own problems.
  template <class Other>
  void operator()(const Other&) const {
    if (has_boolean_values(animate))
      read_into<1>(animate, ValueKind::Boolean, path, findings, [](auto&&) {});
    else if (value_width(animate, findings) > 1)
      read_into<3>(animate, ValueKind::Widened, path, findings, [](auto&&) {});
    else
      read_into<1>(animate, ValueKind::Number, path, findings, [](auto&&) {});
  }
  void operator()(Channel<1>* place) const {
    read_into<1>(animate, ValueKind::Number, path, findings,
                 [&](Curve<1> curve) { *place = Channel<1>(std::move(curve)); });
  }
  void operator()(Channel<3>* place) const {
    read_into<3>(animate, ValueKind::Vector, path, findings,
                 [&](Curve<3> curve) { *place = Channel<3>(std::move(curve)); });
  }
  void operator()(std::optional<Channel<1>>* place) const {
    read_into<1>(animate, ValueKind::Number, path, findings,
                 [&](Curve<1> curve) { *place = Channel<1>(std::move(curve)); });
  }
  void operator()(std::optional<Channel<3>>* place) const {
    read_into<3>(animate, ValueKind::Vector, path, findings,
                 [&](Curve<3> curve) { *place = Channel<3>(std::move(curve)); });
  }
  void operator()(PositionChannel* place) const {
    read_into<3>(animate, ValueKind::Vector, path, findings,
                 [&](Curve<3> curve) { *place = PositionChannel(std::move(curve)); });
  }
  /// One number or three. If any key has three, the curve has three, and a single number stands for
  /// all three.
  void operator()(TangentChannel* place) const {
    if (value_width(animate, findings) > 1)
      read_into<3>(animate, ValueKind::Widened, path, findings,
                   [&](Curve<3> curve) { *place = Channel<3>(std::move(curve)); });
    else
      read_into<1>(animate, ValueKind::Number, path, findings,
                   [&](Curve<1> curve) { *place = Channel<1>(std::move(curve)); });
  }
  void operator()(Switch* place) const {
    read_into<1>(animate, ValueKind::Boolean, path, findings,
                 [&](Curve<1> curve) { *place = Switch(std::move(curve)); });
  }
};

}  // namespace

void read_animate(const Element& animate, std::span<Slot* const> rows, const std::string& owner,
                  Findings& findings) {
  const std::optional<GivenAttribute> given = animate.attribute("attribute");
  const std::string name(given ? trimmed(given->value) : "");
  const auto found = std::find_if(rows.begin(), rows.end(), [&](const Slot* row) {
    return row->attribute.name == name && is_channel(row->place);
  });
  Place place;
  const std::size_t problems = findings.problem_count();
  if (found != rows.end()) {
    Slot& row = **found;
    place = row.place;
    take_over(animate, *given, row, findings);
  } else if (given && !given->is_unknown) {
    findings.add_problem(given->value_place(), no_channel(animate, rows, name));
  }
  std::visit(CurveOfChannel{animate, owner + '.' + name, findings}, place);
  if (found != rows.end() && findings.problem_count() != problems) (*found)->is_sound = false;
}

}  // namespace pliant::xml
