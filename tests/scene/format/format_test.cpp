#include "pliant/scene/format/format.hpp"

#include <fstream>
#include <map>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "pliant/scene/format/format_json.hpp"
#include "scene/scene_text.hpp"
#include "support/places.hpp"
#include "support/scratch_folder.hpp"

namespace pliant::testing {
namespace {

/// One row of a table of docs/scene-format.md that describes attributes.
struct Row {
  std::string element, attribute, type, unit, standard, range, keyable, meaning;
};

/// The cells of a line `| a | b |`, without blanks and backquotes; an en dash means an empty cell.
std::vector<std::string> cells_of(const std::string& line) {
  std::vector<std::string> cells;
  std::string cell;
  for (std::size_t k = 1; k < line.size(); ++k) {
    if (line[k] != '|') {
      if (line[k] != '`') cell += line[k];
      continue;
    }
    const std::size_t first = cell.find_first_not_of(' ');
    const std::size_t last = cell.find_last_not_of(' ');
    cell = first == std::string::npos ? "" : cell.substr(first, last - first + 1);
    cells.push_back(cell == "–" ? "" : cell);
    cell.clear();
  }
  return cells;
}

/// The rows below each header that starts with element and `second`.
std::vector<std::vector<std::string>> rows_below(const std::string& second) {
  std::ifstream page(testing::source_folder() / "docs/scene-format.md");
  REQUIRE(page);
  std::vector<std::vector<std::string>> rows;
  bool is_below = false;
  for (std::string line; std::getline(page, line);) {
    if (!line.starts_with('|')) {
      is_below = false;
      continue;
    }
    const std::vector<std::string> cells = cells_of(line);
    if (cells.at(0) == "element")
      is_below = cells.at(1) == second;
    else if (is_below && !cells.at(0).starts_with("--"))
      rows.push_back(cells);
  }
  return rows;
}

std::vector<Row> documented() {
  std::vector<Row> rows;
  for (const auto& cells : rows_below("attribute")) {
    CAPTURE(cells);
    REQUIRE(cells.size() == 8);  // the last one is the meaning
    CHECK_FALSE(cells[7].empty());
    rows.push_back(
        {cells[0], cells[1], cells[2], cells[3], cells[4], cells[5], cells[6], cells[7]});
  }
  return rows;
}

/// How often an element may stand in one that contains it.
std::string times_of(const ElementFormat& parent, std::string_view element) {
  for (const ChildFormat& child : parent.children) {
    if (std::ranges::find(child.names, element) == child.names.end()) continue;
    if (child.is_choice()) return fmt::format("one {}", child.row.noun);
    const int least = child.row.least, most = child.row.most;
    if (most == unlimited) return least == 0 ? "any number" : fmt::format("{} or more", least);
    return least == most ? fmt::format("{}", least) : fmt::format("at most {}", most);
  }
  return "any number";  // what is expanded before the scene is read
}

TEST_CASE("the page has one row for each element", "[scene][format]") {
  std::vector<std::string> rows, expected;
  for (const auto& cells : rows_below("stands in")) {
    CAPTURE(cells);
    REQUIRE(cells.size() == 4);
    rows.push_back(fmt::format("| {} |", fmt::join(cells, " | ")));
  }
  for (const ElementFormat& element : scene_format()) {
    std::set<std::string> times;
    for (const std::string_view parent : element.parents)
      times.insert(times_of(*find_format(scene_format(), parent), element.name));
    if (element.parents.empty()) times.insert("1");
    CAPTURE(element.name, times);
    CHECK(times.size() == 1);
    expected.push_back(fmt::format("| {} | {} | {} | {} |", element.name,
                                   fmt::join(element.parents, ", "), *times.begin(),
                                   element.meaning));
  }
  CHECK(rows == expected);
}

std::string key_of(std::string_view element, std::string_view attribute) {
  return std::string(element) + '.' + std::string(attribute);
}

TEST_CASE("the page has one row for each attribute, as the reader knows it", "[scene][format]") {
  std::map<std::string, Row> rows;
  for (const Row& row : documented()) {
    CAPTURE(row.element, row.attribute);
    CHECK(rows.emplace(key_of(row.element, row.attribute), row).second);
  }
  for (const ElementFormat& element : scene_format())
    for (const AttributeFormat& attribute : element.attributes) {
      if (attribute.need == Need::Later) continue;
      const std::string key = key_of(element.name, attribute.name);
      CAPTURE(key);
      const auto found = rows.find(key);
      REQUIRE(found != rows.end());
      CHECK(found->second.type == attribute.type);
      CHECK(found->second.unit == attribute.unit);
      CHECK(found->second.standard ==
            (attribute.need == Need::Required ? "required" : attribute.standard));
      CHECK(found->second.range == attribute.range);
      CHECK(found->second.keyable == (attribute.is_keyable ? "yes" : "no"));
      std::string meaning = attribute.meaning;
      std::erase(meaning, '`');
      CHECK(found->second.meaning == meaning);
      rows.erase(found);
    }
  for (const auto& [key, row] : rows) FAIL_CHECK("the reader does not know " << key);
}

TEST_CASE("the format as JSON is the tables of the page", "[scene][format]") {
  const auto text_of = [](const nlohmann::json& json, const char* name) {
    std::string text = json.value(name, "");
    std::erase(text, '`');
    return text;
  };
  const auto json = nlohmann::json::parse(scene_format_json());
  std::map<std::string, Row> rows;
  for (const Row& row : documented()) rows.emplace(key_of(row.element, row.attribute), row);
  std::vector<std::vector<std::string>> elements;
  for (const auto& element : json.at("elements")) {
    const std::string name = element.at("name");
    const std::vector<std::string> parents = element.at("parents");
    elements.push_back({name, fmt::format("{}", fmt::join(parents, ", ")), element.at("meaning")});
    for (const auto& attribute : element.at("attributes")) {
      const std::string key = key_of(name, attribute.at("name").get<std::string>());
      CAPTURE(key);
      REQUIRE(rows.contains(key));
      const Row& row = rows.at(key);
      CHECK(attribute.at("type") == row.type);
      CHECK(text_of(attribute, "unit") == row.unit);
      CHECK(text_of(attribute, "range") == row.range);
      CHECK(text_of(attribute, "meaning") == row.meaning);
      CHECK(attribute.at("keyable") == (row.keyable == "yes"));
      CHECK(attribute.at("required") == (row.standard == "required"));
      CHECK(text_of(attribute, "default") == (row.standard == "required" ? "" : row.standard));
      rows.erase(key);
    }
  }
  CHECK(rows.empty());
  std::vector<std::vector<std::string>> documented_elements;
  for (const auto& cells : rows_below("stands in"))
    documented_elements.push_back({cells[0], cells[1], cells[3]});
  CHECK(elements == documented_elements);
}

TEST_CASE("the format as JSON has what programs need of each row", "[scene][format]") {
  const auto json = nlohmann::json::parse(scene_format_json());
  REQUIRE(json.at("elements").size() == scene_format().size());
  std::size_t element = 0, with_words = 0;
  for (const ElementFormat& format : scene_format()) {
    const nlohmann::json& one = json.at("elements").at(element++);
    CHECK(one.at("mayInclude") == format.may_include);
    REQUIRE(one.at("children").size() == format.children.size());
    CHECK(one.contains("text") == format.text.has_value());
    for (std::size_t k = 0; k < format.children.size(); ++k) {
      const ChildFormat& child = format.children[k];
      const nlohmann::json& row = one.at("children").at(k);
      CHECK(row.at("names") == nlohmann::json(child.names));
      CHECK(row.at("least") == child.row.least);
      CHECK(row.value("most", unlimited) == child.row.most);
      CHECK(row.at("part") == child.is_part);
      CHECK(row.value("noun", "") == child.row.noun);
    }
    std::size_t attribute = 0;
    for (const AttributeFormat& of : format.attributes) {
      if (of.need == Need::Later) continue;
      const nlohmann::json& row = one.at("attributes").at(attribute++);
      CAPTURE(format.name, of.name);
      Range range;
      range.least = row.value("least", range.least);
      range.most = row.value("most", range.most);
      range.excludes_least = row.value("excludesLeast", false);
      range.excludes_zero = row.value("excludesZero", false);
      CHECK(range.to_text() == of.limits.to_text());
      CHECK(row.value("position", false) == of.is_position);
      CHECK(row.value("surfaces", false) == of.names_surfaces);
      // An <animate> names a channel of what it stands in.
      const bool is_of_words = (of.type == "word" && of.name != "attribute") ||
                               of.type == "one or four words" || of.type == "tangent" ||
                               of.type == "interpolation" || of.type == "extrapolation";
      if (of.type != "boolean") CHECK(row.contains("words") == is_of_words);
      if (of.type == "word" || !is_of_words) {
        const std::vector<std::string_view> words(of.words.begin(), of.words.end());
        CHECK(row.value("words", nlohmann::json::array()) == nlohmann::json(words));
      }
      if (!is_of_words) continue;
      ++with_words;
      // The default is one of them, or begins with one.
      const std::string standard = row.value("default", "");
      if (standard.empty() || standard.starts_with('(')) continue;
      const std::vector<std::string> words = row.at("words");
      const std::string first = standard.substr(0, standard.find(' '));
      CHECK(std::ranges::find(words, first) != words.end());
    }
    CHECK(attribute == one.at("attributes").size());
  }
  CHECK(with_words > 10);
}

/// Whether the element is a direct child of a scene with a name: a force or a group.
bool is_force(const std::string& element) {
  const std::set<std::string> forces = {"point", "radial",  "line",     "uniform", "vortex",
                                        "noise", "inertia", "pressure", "group"};
  return forces.contains(element);
}

/// A scene that contains `element` with its required attributes and `given`, which may replace one
/// of them.
std::string scene_around(const std::string& element, const std::string& attribute,
                         const std::string& value) {
  // Some attributes of a key are valid for one interpolation only.
  const std::string easing = attribute == "amplitude" || attribute == "period"
                                 ? " interpolation=\"elasticIn\""
                             : attribute == "back"    ? " interpolation=\"backIn\""
                             : attribute == "control" ? " interpolation=\"cubicBezier\""
                                                      : "";
  const auto begin = [&](const std::string& name, const std::string& needed) {
    std::string text = '<' + name;
    for (std::size_t at = 0; at < needed.size();) {  // pieces such as ` rows="3"`
      const std::size_t end = needed.find('"', needed.find('"', at) + 1) + 1;
      const std::string piece = needed.substr(at, end - at);
      if (name != element || !piece.starts_with(fmt::format(" {}=", attribute))) text += piece;
      at = end;
    }
    return name == element ? fmt::format("{} {}=\"{}\"", text, attribute, value) : text;
  };
  const std::set<std::string> solids = {"sphere", "capsule", "box", "plane"};
  if (element == "collider" || solids.contains(element)) {
    const std::string solid = solids.contains(element) ? element : "sphere";
    return fmt::format(
        "<scene start=\"1\" end=\"9\"><surface name=\"sheet\"><grid columns=\"3\" rows=\"3\"/>"
        "</surface>{}>{}/></collider></scene>",
        begin("collider", " name=\"wall\""), begin(solid, ""));
  }
  const std::set<std::string> parts = {"transform", "material", "tangents", "solver"};
  const std::set<std::string> key_parts = {"animate", "key", "loop"};
  const std::string force = is_force(element) ? element : "point";
  const std::string knots =
      element == "knots" ? begin("knots", " along=\"u\"") + ">0 0 0 1 2 2 2</knots>" : "";
  const std::string net =
      fmt::format("{}><points>{}</points>{}</nurbs>",
                  begin("nurbs", " columns=\"4\" rows=\"4\" degreeU=\"2\" degreeV=\"2\""),
                  fmt::join(std::vector(48, 0), " "), knots);
  const std::set<std::string> of_surfaces = {"unit", "axis", "border"};
  const std::string uv = of_surfaces.contains(attribute) ? " uv=\"surface\"" : "";
  const std::string shape = element == "mesh" || element == "subdivision"
                                ? begin(element, " file=\"/etc/passwd\"") + "/>"
                            : element == "nurbs" || element == "knots"
                                ? net
                                : begin("grid", " columns=\"3\" rows=\"3\"" + uv) + "/>";
  const std::string part =
      element == "map" ? fmt::format("<material>{}/></material>",
                                     begin("map", " channel=\"b\" file=\"soft.png\""))
      : element == "hold"
          ? begin(element, attribute == "vertices" ? "" : " file=\"pins.png\"") + "/>"
      // Edges are those of a whole grid.
      : attribute == "edges"    ? begin(element, " region=\"all\"") + "/>"
      : parts.contains(element) ? begin(element, "") + "/>"
                                : "";
  const std::string path =
      fmt::format("{}>{}/><waypoint at=\"1 0 0\"/><waypoint at=\"1 1 0\"/></path>",
                  begin("path", " attribute=\"center\""), begin("waypoint", " at=\"0 0 0\""));
  const std::string falloff = begin("falloff", "") + "><key value=\"1\" at=\"" +
                              (attribute == "at" && element == "key" ? value : "0") +
                              "\"/></falloff>";
  const std::string animate =
      element == "path" || element == "waypoint"                        ? path
      : element == "falloff" || (element == "key" && attribute == "at") ? falloff
      : key_parts.contains(element)
          ? fmt::format("{}>{}/>{}/></animate>", begin("animate", " attribute=\"magnitude\""),
                        begin("key", " frame=\"1\" value=\"0\"" + easing),
                        begin("loop", " from=\"1\" to=\"5\""))
          : "";
  return fmt::format("{}>{}>{}{}</surface>{}>{}</{}></scene>",
                     begin("scene", " start=\"1\" end=\"9\""), begin("surface", " name=\"sheet\""),
                     shape, part, begin(force, " name=\"poke\""), animate, force);
}

TEST_CASE("the default of each row can be written and changes nothing", "[scene][format]") {
  int written = 0;
  for (const Row& row : documented()) {
    if (row.standard.empty() || row.standard == "required" || row.standard.starts_with('('))
      continue;
    const std::string text = scene_around(row.element, row.attribute, row.standard);
    CAPTURE(text);
    CHECK(problems_of(text).empty());
    ++written;
  }
  CHECK(written > 40);
}

TEST_CASE("each word that the page allows is read", "[scene][format]") {
  for (const Row& row : documented()) {
    if (row.type != "word" || row.attribute == "attribute") continue;
    std::string words = row.range + ", ";
    for (std::size_t at = 0; at < words.size();) {
      const std::size_t end = words.find(", ", at);
      const std::string text = scene_around(row.element, row.attribute, words.substr(at, end - at));
      CAPTURE(text);
      CHECK(problems_of(text).empty());
      at = end + 2;
    }
  }
}

TEST_CASE("each row refuses what is not of its type", "[scene][format]") {
  for (const Row& row : documented()) {
    if (row.type == "path" || row.type == "text") continue;
    const std::string text = scene_around(row.element, row.attribute, "1,5 ?");
    CAPTURE(text);
    const std::vector<std::string> problems = problems_of(text);
    CAPTURE(problems);
    CHECK(problems.size() == 1);
  }
}

TEST_CASE("each row that is keyable can be animated, and no other", "[scene][format]") {
  for (const Row& row : documented()) {
    if (row.element == "animate" || row.element == "key" || row.element == "loop" ||
        row.element == "scene" || row.element == "grid" || row.element == "mesh" ||
        row.element == "subdivision" || row.element == "nurbs" || row.element == "knots" ||
        row.element == "waypoint" || row.element == "falloff")
      continue;
    const std::string value = row.type == "vector" ? "1 1 1" : row.type == "boolean" ? "true" : "1";
    const std::string animate =
        fmt::format("<animate attribute=\"{}\"><key frame=\"1\" value=\"{}\"/></animate>",
                    row.attribute, value);
    const std::string text =
        row.element == "path"
            ? force_with(
                  "<path attribute=\"center\"><waypoint at=\"0 0 0\"/><waypoint at=\"1 0 0\"/>"
                  "<waypoint at=\"1 1 0\"/>" +
                  animate + "</path>")
        : is_force(row.element)
            ? scene_with(fmt::format("<{0} name=\"f\">{1}</{0}>", row.element, animate))
        : row.element == "surface" ? surface_with(animate)
        : row.element == "collider"
            ? scene_with("<collider name=\"c\"><sphere/>" + animate + "</collider>")
        : row.element == "sphere" || row.element == "capsule" || row.element == "box"
            ? scene_with(fmt::format("<collider name=\"c\"><{0}>{1}</{0}></collider>", row.element,
                                     animate))
            : surface_with(fmt::format("<{0}>{1}</{0}>", row.element, animate));
    CAPTURE(text);
    CHECK(problems_of(text).empty() == (row.keyable == "yes"));
  }
}

TEST_CASE("what the page leaves to a later version is refused as such", "[scene][format]") {
  for (const auto& cells : rows_below("later")) {
    CAPTURE(cells);
    REQUIRE(cells.size() >= 3);
    const std::string& element = cells[0];
    std::string thing = cells[1];  // `yield`, or `region="all"`
    const std::size_t equals = thing.find('=');
    const std::string value =
        equals == std::string::npos ? "1" : thing.substr(equals + 2, thing.size() - equals - 3);
    const std::vector<std::string> problems =
        problems_of(scene_around(element, thing.substr(0, equals), value));
    REQUIRE(problems.size() == 1);
    CHECK_THAT(problems[0], contains_text("not supported by this version of pliant"));
  }
}

/// The problems of an example: a scene, or parts of a surface. An example that begins with the name
/// of a file, in a comment, is a file that the later ones include.
std::vector<std::string> problems_of_example(const std::string& example,
                                             const ScratchFolder& folder) {
  constexpr std::string_view opening = "<!-- ", ending = ".xml -->\n";
  if (example.starts_with(opening) && example.find(ending) < example.find('\n')) {
    const std::string name = example.substr(opening.size(), example.find(" -->") - opening.size());
    std::filesystem::create_directories(folder.file(name).parent_path());
    folder.write(name, example);
    return {};
  }
  const bool is_scene = example.starts_with("<?xml") || example.starts_with("<scene");
  const auto scene =
      parse_scene(is_scene ? example : surface_with(example), "page.xml", folder.path());
  return scene ? std::vector<std::string>() : to_lines(scene.error());
}

TEST_CASE("the examples of the page are read", "[scene][format]") {
  const ScratchFolder folder;
  std::ifstream page(testing::source_folder() / "docs/scene-format.md");
  REQUIRE(page);
  int examples = 0;
  std::string example;
  bool is_inside = false;
  for (std::string line; std::getline(page, line);) {
    if (line == "```xml") {
      is_inside = true;
      example.clear();
    } else if (line == "```" && is_inside) {
      is_inside = false;
      ++examples;
      CAPTURE(example);
      CHECK(problems_of_example(example, folder).empty());
    } else if (is_inside) {
      example += line + '\n';
    }
  }
  CHECK(examples == 13);
}

}  // namespace
}  // namespace pliant::testing
