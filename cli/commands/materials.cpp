#include "cli/commands/materials.hpp"

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

#include <fmt/format.h>

#include "cli/terminal/rounded.hpp"

namespace pliant::cli {
namespace {

constexpr Look all_looks[] = {
    {.name = "rubber",
     .summary = "springs back, and rings for a few swings",
     .frequency = 3.5,
     .damping_ratio = 0.1,
     .poisson = 0.5,
     .ring = "rubber is quick, and loses half of its swing in each of the first ones",
     .shape = "the same along u and v; poisson 0.5, since rubber keeps its volume"},
    {.name = "jelly",
     .summary = "soft and heavy: sags deep and wobbles for seconds",
     .frequency = 2,
     .damping_ratio = 0.04,
     .softness = 1.6,
     .poisson = 0.5,
     .ring = "below 3 swings a second the eye can follow each; hardly damped, it takes ten to calm",
     .shape = "soft: the peak is 1.6 times that of the starter; poisson 0.5, since it is mostly "
              "water"},
    {.name = "metal",
     .summary = "stiff: gives little, trembles fast, and keeps a dent",
     .frequency = 7,
     .damping_ratio = 0.03,
     .softness = 0.6,
     .poisson = 0.3,
     .give = 0.35,
     .hardening = 0.1,
     .ring = "as fast as 24 frames a second can show, with ten frames for three swings; metal is "
             "hardly damped",
     .shape = "stiff: six tenths of the starter's peak; poisson 0.3 is that of steel",
     .memory =
         "it bends so far for good that the peak grows by a third, and that much of it or "
         "more stays: a dent; hardening 0.1 is that of a metal. A lower yield makes it deeper"},
    {.name = "cloth",
     .summary = "limp: gives way, swings back slowly, and does not ring",
     .frequency = 1.2,
     .damping_ratio = 0.6,
     .softness = 1.4,
     .c = 0.4,
     .poisson = 0,
     .ring = "slow, and the air brakes it: one swing too far, then it lies",
     .shape =
         "threads run along u and v and hardly resist a twist, so c is small, and bending one "
         "way does not bend the other: poisson 0. Where thin cloth would fold and wrinkle, a sheet "
         "bends and stretches"},
    {.name = "paper",
     .summary = "light: flutters shortly, and keeps a crease",
     .frequency = 5,
     .damping_ratio = 0.3,
     .softness = 0.8,
     .c = 1.7,
     .d = 0.7,
     .poisson = 0.2,
     .give = 0.12,
     .hardening = 0.5,
     .ring = "light, so it is fast, and the air brakes it within two swings",
     .shape = "the grain of the fibres runs along u: stiffer there than along v",
     .memory = "only what is bent sharply stays, a soft crease; hardening 0.5: paper resists a "
               "second bend"},
    {.name = "skin",
     .summary = "gives way, and comes back slowly without ringing",
     .frequency = 2.5,
     .damping_ratio = 0.7,
     .softness = 1.2,
     .poisson = 0.45,
     .ring = "the flesh below brakes it: one swing back and a hint of another",
     .shape = "softer than the starter; poisson 0.45, nearly that of water"},
};

// Lines of a comment, which at a depth of four blanks are at most 100 bytes long.
std::string wrapped(std::string_view text) {
  constexpr std::size_t width = 91;
  std::string lines;
  std::size_t column = 0;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (column > 0 && column + 1 + word.size() > width) {
      lines += '\n';
      column = 0;
    } else if (column > 0) {
      lines += ' ';
      ++column;
    }
    lines += word;
    column += word.size();
  }
  return lines;
}

struct Numbers {
  double density, stiffness, yield = 0;
};

// The <material>, with a comment if that is not empty.
edit::SetPart part_of(const std::string& surface, const Look& look, const Numbers& numbers,
                      std::string comment = {}) {
  edit::SetPart part{.surface = surface,
                     .part = "material",
                     .attributes = {{"density", rounded(numbers.density)},
                                    {"dampingRatio", edit::to_text(look.damping_ratio)},
                                    {"b", rounded(numbers.stiffness)},
                                    {"c", rounded(look.c * numbers.stiffness)},
                                    {"d", rounded(look.d * numbers.stiffness)},
                                    {"poisson", edit::to_text(look.poisson)}},
                     .comment = std::move(comment)};
  if (numbers.yield > 0) {
    part.attributes.emplace_back("yield", rounded(numbers.yield));
    part.attributes.emplace_back("hardening", edit::to_text(look.hardening));
  }
  return part;
}

// The text of the scene with this material instead.
Result<std::string> text_with(SceneDocument scene, const std::string& surface, const Look& look,
                              const Numbers& numbers) {
  auto changed = scene.apply({part_of(surface, look, numbers)});
  if (!changed) return fail(changed.error());
  return scene.text();
}

std::string comment_of(const Look& look, const Numbers& numbers, bool is_by_inertia) {
  const auto line = [](const std::string& text) { return '\n' + wrapped(text); };
  std::string comment = fmt::format("{}: {}.", look.name, look.summary);
  comment += line(fmt::format(
      "density, dampingRatio: {}. What moves here swings {} times a second; for f times a second "
      "the density is {} / f².",
      look.ring, look.frequency, rounded(numbers.density * look.frequency * look.frequency)));
  comment += line(fmt::format("b, c, d: {}. {}", look.shape,
                              is_by_inertia ? "With a higher density inertia pushes harder, so "
                                              "that density / b alone matters here."
                              : numbers.yield > 0
                                  ? "All of them and the density times 2, yield times 0.71: half "
                                    "the peak, the same frequency."
                                  : "All of them and the density times 2: half the peak, the same "
                                    "frequency."));
  if (numbers.yield > 0) comment += line(fmt::format("yield, hardening: {}.", look.memory));
  return comment;
}

// The yield with which the peak is as much larger than the elastic one as the look wants.
Result<double> find_yield(const SceneDocument& scene, const Look& look, const Numbers& numbers,
                          double elastic_peak, const StarterSource& source) {
  const std::string& surface = scene.scene().surfaces[source.surface].name;
  // The bend at the peak is some times `numbers.yield`: from half of that, where all flows, to
  // where nothing does. Halving the range six times leaves 5 %.
  double low = 0.5 * numbers.yield, high = 16 * numbers.yield;
  for (int k = 0; k < 6; ++k) {
    Numbers trial = numbers;
    trial.yield = std::sqrt(low * high);
    const auto text = text_with(scene, surface, look, trial);
    if (!text) return fail(text.error());
    const double most = (1 + look.give) * elastic_peak;
    const auto peak = played_peak(*text, source, most);
    if (!peak && peak.error().code != ErrorCode::SolverFailed &&
        peak.error().code != ErrorCode::NotFinite) {
      return fail(peak.error());
    }
    const bool is_too_low = !peak || *peak > most;
    (is_too_low ? low : high) = trial.yield;
  }
  return high;
}

}  // namespace

std::span<const Look> looks() { return all_looks; }

Result<StarterFacts> apply_look(SceneDocument& scene, const Look& look, const StarterFacts& own,
                                const StarterSource& source) {
  // Where it yields a dent stays, and should be round. The whole of a sheet is the same region
  // either way, and its grid is faster.
  const Surface surface = scene.scene().surfaces[source.surface];  // the scene changes
  if (look.give > 0 && std::holds_alternative<GridSheet>(surface.shape) &&
      surface.solver.region == SolvedRegion::Forces) {
    const auto changed = scene.apply({edit::Set{surface.name + ".uv", "surface"}});
    if (!changed) return fail(changed.error());
  }
  // A density and a stiffness of 1 show what others make: frequency² and peak are proportional to
  // 1/density and 1/stiffness, as long as nothing yields.
  Numbers numbers{.density = 1, .stiffness = 1};
  auto text = text_with(scene, surface.name, look, numbers);
  if (!text) return fail(text.error());
  auto facts = look_at(*text, source);
  if (!facts) return facts;
  if (auto moves = check_moves(*facts); !moves) return fail(moves.error());
  numbers.density = std::pow(facts->frequency / look.frequency, 2);
  text = text_with(scene, surface.name, look, numbers);
  if (!text) return fail(text.error());
  const auto peak = played_peak(*text, source);
  if (!peak) return fail(peak.error());
  facts->peak = *peak;
  if (!facts->is_by_inertia) {
    numbers.stiffness = facts->peak / (look.softness * own.peak);
    numbers.density *= numbers.stiffness;
    facts->peak = look.softness * own.peak;
  }
  if (look.give > 0) {
    // The stress is the curvature times √b.
    numbers.yield = facts->bend() * std::sqrt(numbers.stiffness);
    auto found = find_yield(scene, look, numbers, facts->peak, source);
    if (!found) return fail(found.error());
    numbers.yield = *found;
    facts->peak *= 1 + look.give;
  }
  const auto changed = scene.apply(
      {part_of(surface.name, look, numbers, comment_of(look, numbers, facts->is_by_inertia))});
  if (!changed) return fail(changed.error());
  return facts;
}

}  // namespace pliant::cli
