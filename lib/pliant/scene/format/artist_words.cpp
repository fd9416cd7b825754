#include "pliant/scene/format/artist_words.hpp"

#include <algorithm>
#include <optional>

#include <fmt/format.h>

#include "pliant/scene/format/format.hpp"
#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

constexpr std::string_view force_elements =
    "point radial line uniform vortex noise inertia pressure";
constexpr std::string_view selecting_elements =
    "point radial line uniform vortex noise inertia pressure group";
constexpr std::string_view centred_elements = "point radial vortex noise pressure group";
constexpr std::string_view mesh_elements = "mesh subdivision";

// A word is in the first row that has it for the element. The names are those of Maya, Houdini,
// Blender, Cinema 4D, After Effects and of physics.
constexpr ArtistWords known_words[] = {
    {"material",
     "stiffness elasticity rigidity bend bending bendstiffness bendingstiffness young "
     "youngsmodulus springs tension",
     "b c d"},
    {"material", "mass weight rho surfacedensity massdensity heaviness thickness", "density"},
    {"material", "drag friction viscosity eta damp dampen resistance airdrag", "damping"},
    {"material", "zeta dampratio ratio", "dampingRatio"},
    {"material", "plasticity plastic yieldstress yieldstrength threshold", "yield"},
    {"material", "nu poissonratio poissonsratio", "poisson"},
    {"material", "goalstrength goalspring foundation winkler shapematching retain", "goal"},
    {"surface", "stiffness elasticity rigidity bend bending", "b@material c@material d@material"},
    {"surface", "mass weight density", "density@material"},
    {"surface", "drag friction viscosity damping", "damping@material"},
    {"surface", "position location translation translate pos offset origin center",
     "translate@transform"},
    {"surface", "rotation rotate orientation rot euler", "rotate@transform"},
    {"surface", "scale scaling size", "scale@transform"},
    {"surface", "file filename path mesh src source geometry obj", "file@mesh"},
    {"surface", "dt timestep step", "dt@solver"},
    {"surface", "id label title", "name"},
    {"surface", "active on visible mute simulate", "enabled"},
    {"surface", "driver parent follows target", "drivenBy"},
    {"transform", "position location translation pos offset origin center t", "translate"},
    {"transform", "rotation orientation rot euler angles r", "rotate"},
    {"transform", "scaling size s", "scale"},
    {"transform", "order rotationorder eulerorder", "rotateOrder"},
    {force_elements,
     "strength force intensity power amplitude amount weight gain speed velocity value",
     "magnitude"},
    {selecting_elements, "id label title", "name"},
    {selecting_elements, "active on visible mute", "enabled"},
    {selecting_elements, "surfaces surface affects objects object meshes mesh", "targets"},
    {force_elements, "radius size falloffradius range maxdistance distance reach influence radii",
     "deformationRadius forceRadius"},
    {"group", "radius size falloffradius range maxdistance distance reach influence",
     "deformationRadius"},
    {"point radial line vortex noise pressure group",
     "parent attach attachto stick carrier ride rideon", "follow"},
    {force_elements, "decay attenuation profile curve ramp softness", "falloff"},
    {centred_elements, "position location translation translate pos origin place at offset",
     "center"},
    {"line", "position location translation translate pos origin center place at offset points",
     "from to"},
    {"line", "start begin a", "from"},
    {"line", "finish b", "to"},
    {"point line uniform", "rotation rotate orientation angle normal vector dir axis aim",
     "direction"},
    {"vortex", "rotation rotate orientation angle normal vector dir direction aim", "axis"},
    {"vortex", "swirl spin twist", "magnitude"},
    {"vortex", "inward suction attraction radial", "pull"},
    {"noise", "scale detail turbulencescale", "frequency"},
    {"noise", "rotation rotate evolution evolutionspeed animationspeed", "rate"},
    {"noise", "randomseed", "seed"},
    {"scene", "framerate framespersecond rate frames timeunit playbackspeed", "fps"},
    {"scene", "first startframe firstframe from framestart begin in", "start"},
    {"scene", "last endframe lastframe to frameend finish out duration length", "end"},
    {"scene", "randomseed", "seed"},
    {"grid", "size scale", "width depth"},
    {"grid", "height length", "depth"},
    {"grid", "segments subdivisions divisions resolution samples", "columns rows"},
    {"grid", "position location translation translate center", "translate@transform"},
    {"grid", "rotation rotate", "rotate@transform"},
    {"grid", "type", "faces"},
    {mesh_elements, "path filename src source url href geometry", "file"},
    {mesh_elements, "name node shape part", "object"},
    {mesh_elements, "uvmap uvchannel uvlayer", "uvSet"},
    {mesh_elements, "position location translation translate center", "translate@transform"},
    {mesh_elements, "rotation rotate orientation", "rotate@transform"},
    {mesh_elements, "scale size", "scale@transform"},
    {"subdivision", "iterations subdivisions depth steps", "levels"},
    {"subdivision", "type method", "scheme"},
    {"solver", "timestep step stepsize delta substep", "dt"},
    {"solver", "speed rate timefactor", "timeScale"},
    {"solver", "first start firstframe begin", "startFrame"},
    {"solver", "type method scheme", "integrator"},
    {"solver", "warmup prerun runup presimulate", "preroll"},
    {"solver", "cycle period", "loop"},
    {"map", "texture image path picture src", "file"},
    {"map", "type property target name", "channel"},
    {"map", "vertexattribute vertexcolor vertexgroup weights", "attribute"},
    {"map", "min black", "low"},
    {"map", "max white", "high"},
    {"hold", "texture image path picture src", "file"},
    {"hold", "vertexattribute vertexcolor vertexgroup weights", "attribute"},
    {"hold", "threshold limit minimum", "above"},
    {"hold", "vertex points indices ids nodes", "vertices"},
    {"animate", "channel property target name path", "attribute"},
    {"animate", "pre preinfinity extrapolatebefore", "before"},
    {"animate", "post postinfinity extrapolateafter loop cycle", "after"},
    {"animate falloff key", "ease easing type mode", "interpolation"},
    {"key", "time t", "frame"},
    {"key", "v y", "value"},
    {"key", "intangent tangentin", "in"},
    {"key", "outtangent tangentout", "out"},
    {"loop", "first start begin", "from"},
    {"loop", "last end finish", "to"},
    {"loop", "count repeat times", "after"},
    {"path", "channel property target name", "attribute"},
    {"path", "cyclic loop", "closed"},
    {"path", "position time u t percent", "progress"},
    {"waypoint", "position location point pos center translate value", "at"},
};

constexpr ElementWords known_elements[] = {
    {"wind breeze gust gusts airflow", "<uniform> for a steady push, with <noise> for gusts"},
    {"gravity weight fall", "<uniform direction=\"0 -1 0\">"},
    {"turbulence turbulent jitter wobble", "<noise>"},
    {"explosion blast bomb attractor attract magnet repel repulsor repulsion implode explode",
     "<radial>, which pushes away from its centre, or pulls with a negative magnitude"},
    {"swirl whirl tornado twist twirl whirlpool", "<vortex>"},
    {"inflate inflation balloon blow puff", "<pressure>"},
    {"force forces poke push press touch finger locator deformer softmod cluster",
     "<point>, which pushes along one direction"},
    {"segment stroke", "<line>"},
    {"ball", "<radial> for a force, <collider> with a <sphere> for a solid"},
    {"collision rigidbody obstacle ground floor solid", "<collider>"},
    {"jiggle inertial motion", "<inertia>"},
    {"drag friction viscosity", "<material damping=\"…\"> in a <surface>"},
    {"forcegroup multipleforce set", "<group>"},
    {"object geometry body cloth softbody model", "<surface> with a <mesh> or a <grid>"},
    {"sheet patch lattice", "<grid> in a <surface>"},
    {"obj file import ply gltf fbx", "<mesh file=\"…\"> in a <surface>"},
    {"cage subdiv subsurf subdivide", "<subdivision>"},
    {"position translate rotate scale xform location", "<transform> in a <surface>"},
    {"physics properties elasticity stiffness dynamics", "<material> in a <surface>"},
    {"simulation settings integrator stepping", "<solver> in a <surface>"},
    {"texture weightmap paint", "<map> in a <material>"},
    {"pin pins pinning anchor attach constraint", "<hold> in a <surface>"},
    {"keyframe keyframes keys curve fcurve animation anim timeline",
     "<animate attribute=\"…\"> with a <key> for each frame"},
    {"pointcache alembic", "cache=\"…\" of <mesh>"},
    {"variable constant parameter var", "<define>"},
};

constexpr std::size_t longest_artist_word = 30;  // of both tables

bool has_word(std::string_view list, std::string_view word) {
  const std::vector<std::string_view> words = words_of(list);
  return std::find(words.begin(), words.end(), word) != words.end();
}

/// As in the table.
std::string plain_word(std::string_view word) {
  std::string text;
  for (const char c : word) {
    if (c == '_' || c == '-') continue;
    text += c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return text;
}

/// The elements whose attributes one has, its parts first.
std::vector<std::string_view> elements_of(std::string_view element) {
  std::vector<std::string_view> elements;
  const ElementFormat* const format = find_format(scene_format(), element);
  for (const ChildFormat& child : format ? format->children : std::vector<ChildFormat>())
    if (child.is_part || child.is_choice())
      elements.insert(elements.end(), child.names.begin(), child.names.end());
  elements.push_back(element);
  return elements;
}

}  // namespace

std::span<const ArtistWords> artist_words() { return known_words; }

std::span<const ElementWords> element_words() { return known_elements; }

std::string_view meant_by_element(std::string_view word) {
  const std::string wanted = word.size() <= longest_artist_word ? plain_word(word) : "";
  const auto found = std::ranges::find_if(
      known_elements, [&](const ElementWords& row) { return has_word(row.words, wanted); });
  return found == std::end(known_elements) ? std::string_view() : found->meant;
}

std::string attribute_hint(std::string_view element, std::string_view word,
                           std::span<const std::string_view> allowed,
                           std::vector<std::string_view>& own) {
  const std::string wanted = word.size() <= longest_artist_word ? plain_word(word) : "";
  const auto found =
      std::find_if(std::begin(known_words), std::end(known_words), [&](const ArtistWords& row) {
        return has_word(row.elements, element) && has_word(row.words, wanted);
      });
  std::vector<std::string> meant;
  if (found != std::end(known_words)) {
    for (const std::string_view target : words_of(found->meant)) {
      const std::string_view attribute = target.substr(0, target.find('@'));
      if (attribute.size() < target.size()) {
        meant.push_back(
            fmt::format("{} of <{}>", in_quotes(attribute), target.substr(attribute.size() + 1)));
      } else if (std::find(allowed.begin(), allowed.end(), attribute) != allowed.end()) {
        own.push_back(attribute);
        meant.push_back(in_quotes(attribute));
      }
    }
  }
  if (!meant.empty())
    return fmt::format("; did you mean {}? allowed: {}", in_words(meant), listed(allowed));
  if (const auto near = nearest_word(word, allowed)) own.push_back(*near);
  return hint(word, allowed);
}

std::string attribute_hint(std::span<const std::string_view> elements, std::string_view word,
                           std::span<const std::string_view> allowed,
                           std::vector<std::string_view>& own) {
  std::string meant;
  for (const std::string_view element : elements)
    if (own.empty()) meant = attribute_hint(element, word, allowed, own);
  return meant;
}

std::string channel_hint(std::string_view element, std::string_view word,
                         std::span<const std::string_view> allowed) {
  std::vector<std::string_view> own;
  return attribute_hint(elements_of(element), word, allowed, own);
}

}  // namespace pliant::xml
