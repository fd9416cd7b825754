#include "pliant/feedback/warnings.hpp"

#include <fmt/format.h>

#include "pliant/core/shortened.hpp"

namespace pliant {

namespace {

// `"a", "b" and "c"`, or `"a", "b", … and 7 more`.
std::string names_text(const std::string& first, const std::vector<std::string>& others) {
  constexpr std::size_t most = 6;
  std::vector<std::string> told = {fmt::format("\"{}\"", first)};
  for (const std::string& other : others) told.push_back(fmt::format("\"{}\"", other));
  if (told.size() <= most) return in_words(told);
  const std::size_t more = told.size() - most;
  told.resize(most);
  return fmt::format("{} and {} more", fmt::join(told, ", "), more);
}

std::string nodes_text(int count) { return fmt::format("{} node{}", count, count == 1 ? "" : "s"); }

// Authors do not read longer lists.
constexpr std::size_t most_ranges = 8;

TextPlace text_place_of(const Warning& warning, const SceneOrigin& origin) {
  if (!warning.channel.empty()) {
    const std::size_t dot = warning.channel.find('.');
    return origin.at(warning.channel.substr(0, dot), warning.channel.substr(dot + 1));
  }
  if (warning.kind == Warning::Kind::RadiusExceeds) return origin.at(warning.force, "forceRadius");
  if (warning.kind == Warning::Kind::RadiusUnused)
    return origin.at(warning.force, "deformationRadius");
  if (warning.kind == Warning::Kind::FrozenMoving) return origin.at(warning.surface, "release");
  if (!warning.force.empty()) return origin.at(warning.force);
  if (warning.kind == Warning::Kind::FacesLeftOut || warning.kind == Warning::Kind::FileLeftOut ||
      warning.kind == Warning::Kind::LoosePatch) {
    return origin.at(warning.surface, "file");
  }
  if (warning.kind == Warning::Kind::CacheOutside) {
    return origin.at(warning.surface, "cache");
  }
  if (warning.kind == Warning::Kind::NeverStarts) {
    return origin.at(warning.surface, "startFrame");
  }
  if (warning.kind == Warning::Kind::AllHeld) return origin.at(warning.surface, "region");
  for (const char* tangent : {"su0", "su1", "sv0", "sv1"}) {
    if (origin.gives(warning.surface, tangent)) return origin.at(warning.surface, tangent);
  }
  return origin.at(warning.surface);
}

}  // namespace

std::string Warning::message() const {
  return is_still ? own_message() + "; nothing moved" : own_message();
}

std::string Warning::own_message() const {
  const std::string_view noun = is_group ? "group" : "force";
  const bool is_single = frames.ranges().size() == 1 &&
                         frames.ranges().front().first == frames.ranges().front().second;
  const std::string when = (is_single ? "at frame " : "at frames ") +
                           frames.to_string(most_ranges) +
                           (is_of_part ? ", of those that were played" : "");
  switch (kind) {
    case Kind::RegionTooSmall:
      return fmt::format("{} \"{}\" selects fewer than 3 x 3 nodes of \"{}\" {}: too few to solve",
                         noun, force, surface, when);
    case Kind::LostNodes:
      return fmt::format(
          "{} \"{}\" lost its own nodes on \"{}\" {}: they are out of its reach; "
          "measure=\"rest\" measures on the rest mesh",
          noun, force, surface, when);
    case Kind::OutsideRegion:
      return fmt::format(
          "the force box of \"{}\" is outside the region solved on \"{}\" {}: it pushes no node",
          force, surface, when);
    case Kind::SelectsNothing:
      return fmt::format(
          "{} \"{}\" selects no node of {} {}: no node is nearer than its deformationRadius", noun,
          force, surface.empty() ? "any surface" : fmt::format("\"{}\"", surface), when);
    case Kind::PushesNothing:
      return fmt::format(
          "the magnitude of \"{}\" has no effect on {} {}: no node that moves is in its force box, "
          "or its direction or falloff is 0 there",
          force, surface.empty() ? "any surface" : fmt::format("\"{}\"", surface), when);
    case Kind::NeverStarts:
      return fmt::format("surface \"{}\" is not solved {}: its startFrame is later", surface, when);
    case Kind::TangentsUnused:
      return fmt::format("the tangents of \"{}\" have no effect {}: no force selects a region",
                         surface, when);
    case Kind::ForcesApart:
      return fmt::format(
          "{} select boxes of \"{}\" that do not all meet {}: one region around all of them is "
          "solved, in which each force moves the surface more than alone; combine=\"islands\" "
          "solves each box by itself, combine=\"box\" in the scene keeps one region without this "
          "warning",
          names_text(force, others), surface, when);
    case Kind::AllHeld:
      if (force.empty())
        return fmt::format(
            "all nodes of \"{}\" are held {}: none can move, although region=\"all\" solves it",
            surface, when);
      return fmt::format("all nodes of \"{}\" that {} \"{}\" selects {} are held: none can move",
                         surface, noun, force, when);
    case Kind::BetweenNodes:
      return fmt::format(
          "{} \"{}\" reaches \"{}\" {}, but no node is nearer than its deformationRadius: the mesh "
          "is too coarse; subdivide it, or press a finer proxy that drives it (drivenBy)",
          noun, force, surface, when);
    case Kind::LoosePatch:
      return fmt::format(
          "a piece of \"{}\" lies wholly in the forces' spheres {}: nothing holds it, so it does "
          "not move",
          surface, when);
    case Kind::FacesLeftOut:
      return fmt::format(
          "{} face{} of \"{}\" take{} no part: fewer than three different corners, a corner twice, "
          "or the corners of another face",
          faces, faces == 1 ? "" : "s", surface, faces == 1 ? "s" : "");
    case Kind::CacheOutside:
      return fmt::format(
          "the cache of \"{}\" has no sample within the scene: they are outside the frames, all {} "
          "its frames, at frames {:.6g} to {:.6g}, so the surface keeps the shape of one of them; "
          "cacheStart moves them",
          surface, is_cache_late ? "after" : "before", cache->first, cache->last);
    case Kind::FileLeftOut:
      return left_out_text(surface, left_out);
    case Kind::NothingMoved:
      return fmt::format("nothing moved {} of {}", when, told);
    case Kind::KeysOutside:
      return fmt::format("the keys of {} are {}", channel, told);
    case Kind::Drifts:
      return fmt::format(
          "{} \"{}\" drifts over \"{}\" {}: it stays in its place, while the surface moves by more "
          "than its {}; follow=\"{}\" takes it along, and keys of its place move it too",
          noun, force, surface, when, told, surface);
    case Kind::FliesAway:
      return fmt::format(
          "\"{}\" flies away {}: nothing holds it, or a piece of it, which has moved by more than "
          "the size of the surface; hold its border or edges, give it a goal, or push less",
          surface, when);
    case Kind::FrozenMoving:
      return fmt::format(
          "\"{}\" is frozen while it moves {}: nodes leave the region of the forces and stop where "
          "they are, away from rest; keep the force enabled, with a magnitude of 0, until they are "
          "at rest, or let them go back with release=\"recover\", or solve all with region=\"all\"",
          surface, when);
    case Kind::RadiusExceeds:
      return fmt::format(
          "the forceRadius of \"{}\" exceeds deformationRadius {}: nothing moves beyond "
          "deformationRadius, so that its push ends there at once; make deformationRadius larger",
          force, when);
    case Kind::RadiusUnused:
      return fmt::format(
          "{} \"{}\": deformationRadius has no effect, because region=\"all\" solves the whole of "
          "{}; remove it",
          noun, force, told);
    case Kind::NeverMoves:
      return fmt::format(
          "inertia \"{}\" has no effect on {}, which never moves: its transform is the same {}, "
          "and it has no cache; key translate or rotate",
          force, told, when);
    case Kind::MapOutside:
      return fmt::format("{} is a map outside 0 to 1: {}", channel, told);
    case Kind::BeginsInside:
      return fmt::format(
          "{} of \"{}\" begin{} inside \"{}\" {}, up to {:.3g} deep, and {} thrown out at once; "
          "grow offset from 0 instead, or begin outside",
          nodes_text(inside.count), surface, inside.count == 1 ? "s" : "", force, when,
          inside.depth, inside.count == 1 ? "is" : "are");
    case Kind::HeldInside:
      return fmt::format(
          "{} of \"{}\" {} inside \"{}\" {}, up to {:.3g} deep: {} held, or outside the solved "
          "region, which wins over a collider; move it, let them go, or select more by a larger "
          "deformationRadius",
          nodes_text(inside.count), surface, inside.count == 1 ? "is" : "are", force, when,
          inside.depth, inside.count == 1 ? "it is" : "they are");
    case Kind::Squeezed:
      return fmt::format(
          "\"{}\" presses nodes of \"{}\" against \"{}\" {}: the collider that they touched first "
          "holds them, and the other one goes through them; leave room between the two",
          force, surface, others.front(), when);
    case Kind::PassesBetween:
      return fmt::format(
          "\"{}\" may pass between the nodes of \"{}\": {}; subdivide the mesh, or make the "
          "collider larger",
          force, surface, told);
  }
  return {};
}

std::string_view word_of(Warning::Kind kind) {
  using Kind = Warning::Kind;
  switch (kind) {
    case Kind::RegionTooSmall:
      return "regionTooSmall";
    case Kind::LostNodes:
      return "lostNodes";
    case Kind::OutsideRegion:
      return "outsideRegion";
    case Kind::SelectsNothing:
      return "selectsNothing";
    case Kind::PushesNothing:
      return "pushesNothing";
    case Kind::NeverStarts:
      return "neverStarts";
    case Kind::TangentsUnused:
      return "tangentsUnused";
    case Kind::ForcesApart:
      return "forcesApart";
    case Kind::AllHeld:
      return "allHeld";
    case Kind::BetweenNodes:
      return "betweenNodes";
    case Kind::LoosePatch:
      return "loosePatch";
    case Kind::FacesLeftOut:
      return "facesLeftOut";
    case Kind::CacheOutside:
      return "cacheOutside";
    case Kind::FileLeftOut:
      return "fileLeftOut";
    case Kind::NothingMoved:
      return "nothingMoved";
    case Kind::KeysOutside:
      return "keysOutside";
    case Kind::Drifts:
      return "drifts";
    case Kind::FliesAway:
      return "fliesAway";
    case Kind::FrozenMoving:
      return "frozenMoving";
    case Kind::RadiusExceeds:
      return "radiusExceeds";
    case Kind::RadiusUnused:
      return "radiusUnused";
    case Kind::NeverMoves:
      return "neverMoves";
    case Kind::MapOutside:
      return "mapOutside";
    case Kind::BeginsInside:
      return "beginsInside";
    case Kind::HeldInside:
      return "heldInside";
    case Kind::Squeezed:
      return "squeezed";
    case Kind::PassesBetween:
      return "passesBetween";
  }
  return {};
}

ScenePlace place_of(const Warning& warning, const SceneOrigin& origin) {
  return origin.place_of(text_place_of(warning, origin));
}

}  // namespace pliant
