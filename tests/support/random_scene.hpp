#pragma once

#include <initializer_list>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

namespace pliant::testing {

/// Choices from a fixed seed, the same on every machine.
class Chance {
 public:
  explicit Chance(unsigned seed) : random_(seed) {}

  std::size_t below(std::size_t count) { return random_() % count; }
  bool once_in(std::size_t count) { return below(count) == 0; }
  int between(int least, int most) {
    return least + static_cast<int>(below(static_cast<std::size_t>(most - least) + 1));
  }
  std::string pick(std::initializer_list<const char*> choices) {
    return *(choices.begin() + below(choices.size()));
  }
  template <class T>
  const T& of(const std::vector<T>& choices) {
    return choices[below(choices.size())];
  }
  /// A number from `least` on, as people and programs write it.
  std::string number(int least, int most) {
    const int whole = between(least, most - 1);
    switch (below(7)) {
      case 0:
        return fmt::format("{}", whole);
      case 1:
        return fmt::format("{}.0", whole);
      case 2:
        return fmt::format("{}.{}0", whole < 0 ? 0 : whole, between(0, 9));
      case 3:
        return fmt::format("{}e0", whole);
      case 4:
        return fmt::format("{:.17g}", whole + static_cast<double>(random_()) / 4294967296.0);
      case 5:
        return fmt::format("{:.3f}", whole + static_cast<double>(random_()) / 4294967296.0);
      default:
        return fmt::format("{}", whole + static_cast<double>(below(8)) / 8);
    }
  }
  std::string vector(int least, int most) {
    std::string text = number(least, most);
    for (int c = 1; c < 3; ++c) text += pick({" ", " ", "  ", "\t"}) + number(least, most);
    return text;
  }

 private:
  std::mt19937 random_;
};

/// A random scene that can be read, laid out at random: nearly all of the format, comments, line
/// ends, quotes, references, CDATA sections, and numbers in all forms.
class RandomScene {
 public:
  explicit RandomScene(unsigned seed) : chance_(seed) {
    line_ends_ = chance_.below(5) < 3 ? 0 : chance_.between(1, 2);
    is_wild_ = chance_.once_in(2);
  }

  std::string text();

 private:
  using Attributes = std::vector<std::pair<std::string, std::string>>;
  struct Node {
    std::string name;
    Attributes attributes = {};
    std::vector<Node> children = {};
    std::string content = {};  // as written
  };

  std::string name(const char* kind) { return fmt::format("{}{}", kind, ++count_); }
  bool some() { return chance_.once_in(3); }
  std::string flag() { return chance_.pick({"true", "false", " true"}); }

  // What the scene says.
  Node surface();
  Node shape();
  Node net();
  Node force(bool is_in_group);
  Node group();
  void add_channel(Node& node, const std::string& attribute, bool is_vector, bool is_positive);
  void add_position(Node& node, const std::string& attribute);
  void add_switch(Node& node);
  Node animate(const std::string& attribute, bool is_vector, bool is_positive);
  Node path(const std::string& attribute);

  // How it is written.
  void write(const Node& node, int depth);
  void write_value(const std::string& value);
  void end_line() {
    text_ += line_ends_ == 0 || (line_ends_ == 2 && chance_.once_in(2)) ? "\n" : "\r\n";
  }
  void write_gap(int depth);

  Chance chance_;
  int line_ends_ = 0;     // 0: LF, 1: CRLF, 2: both
  bool is_wild_ = false;  // or laid out as people do
  int count_ = 0;
  std::vector<std::string> surfaces_;  // that are solved
  std::string text_;
};

inline RandomScene::Node RandomScene::animate(const std::string& attribute, bool is_vector,
                                              bool is_positive) {
  Node node{"animate", {{"attribute", attribute}}};
  const auto value = [&] {
    return is_vector ? chance_.vector(1, 9) : chance_.number(is_positive ? 1 : -9, 9);
  };
  const bool is_bold = !is_positive && !is_vector;
  if (some()) node.attributes.emplace_back("after", chance_.pick({"hold", "repeat 2", "mirror"}));
  if (is_bold && some())
    node.attributes.emplace_back("before", chance_.pick({"linear", "slope 2", "repeatOffset"}));
  const bool is_linear = some();
  if (some()) node.attributes.emplace_back("tangent", chance_.pick({"flat", "linear", "auto"}));
  if (is_linear) node.attributes.emplace_back("interpolation", "linear");
  if (some() && is_bold)
    node.attributes.emplace_back("overshoot", chance_.pick({"contain", "keepStart", "limit"}));
  const int count = chance_.between(1, 6);
  std::vector<std::string> frames;
  for (int k = 0, frame = chance_.between(-3, 3); k < count; ++k) {
    frames.push_back(chance_.once_in(4) ? fmt::format("{}.5", frame < 0 ? 0 : frame)
                                        : fmt::format("{}", frame));
    if (frame < 0) frames.back() = fmt::format("{}", frame);
    Node key{"key", {{"frame", frames.back()}, {"value", value()}}};
    Attributes& given = key.attributes;
    if (is_bold && some()) {
      switch (chance_.below(7)) {
        case 0:
          given.emplace_back("tangent", chance_.pick({"flat", "spline", "smooth", "-2.50"}));
          break;
        case 1:
          given.emplace_back("in", chance_.pick({"plateau", "1.0", "free"}));
          given.emplace_back("outLength", chance_.number(1, 3));
          break;
        case 2:
          given.emplace_back("outHandle", "1.0 4");
          given.emplace_back("in", "linear");
          break;
        case 3:
          given.emplace_back("interpolation", chance_.pick({"elasticOut", "elasticIn"}));
          given.emplace_back("amplitude", "3.0");
          break;
        case 4:
          given.emplace_back("interpolation", "cubicBezier");
          given.emplace_back("control", "0.1 0  0.9 1");
          break;
        case 5:
          given.emplace_back("left", chance_.number(-3, 3));
          break;
        default:
          given.emplace_back("interpolation",
                             chance_.pick({"step", "bounceOut", "stepNext", "bezier", "quadIn"}));
      }
    }
    if (chance_.once_in(4)) std::swap(given[0], given[1]);
    node.children.push_back(std::move(key));
    frame += chance_.between(1, 6);
  }
  if (count > 2 && chance_.once_in(5) && node.attributes.size() == 1)
    node.children.push_back({"loop", {{"from", frames[0]}, {"to", frames[2]}, {"after", "2"}}});
  return node;
}

inline void RandomScene::add_channel(Node& node, const std::string& attribute, bool is_vector,
                                     bool is_positive) {
  if (some()) return;
  if (some()) return node.children.push_back(animate(attribute, is_vector, is_positive));
  const int least = is_positive ? 1 : -9;
  node.attributes.emplace_back(attribute,
                               is_vector ? chance_.vector(1, 9) : chance_.number(least, 9));
}

inline RandomScene::Node RandomScene::path(const std::string& attribute) {
  Node node{"path", {{"attribute", attribute}}};
  if (some()) node.attributes.emplace_back("closed", flag());
  const int count = chance_.between(3, 5);
  for (int k = 0; k < count; ++k)
    node.children.push_back(
        {"waypoint", {{"at", fmt::format("{} {} {}", 3 * k, k % 2, chance_.number(1, 9))}}});
  if (some()) {
    node.attributes.emplace_back("progress", "0.250");
  } else {
    Node progress{"animate", {{"attribute", "progress"}}};
    progress.children.push_back({"key", {{"frame", "1"}, {"value", "0.0"}}});
    if (some()) progress.children.push_back({"key", {{"frame", "7"}, {"value", "0.75"}}});
    node.children.push_back(progress);
  }
  return node;
}

inline void RandomScene::add_position(Node& node, const std::string& attribute) {
  if (chance_.once_in(4)) return node.children.push_back(path(attribute));
  add_channel(node, attribute, true, false);
}

inline void RandomScene::add_switch(Node& node) {
  if (!some()) return;
  if (some()) {
    node.attributes.emplace_back("enabled", flag());
    return;
  }
  Node curve{"animate", {{"attribute", "enabled"}}};
  curve.children.push_back({"key", {{"frame", "2"}, {"value", flag()}}});
  if (some())
    curve.children.push_back(
        {"key", {{"frame", "5.5"}, {"value", flag()}, {"interpolation", "stepNext"}}});
  node.children.push_back(curve);
}

inline RandomScene::Node RandomScene::net() {
  Node node{"nurbs", {{"columns", "4"}, {"rows", "3"}, {"degreeU", "2"}, {"degreeV", "1"}}};
  if (some()) node.attributes.emplace_back("samplesU", "9");
  std::string points;
  for (int k = 0; k < 12; ++k)
    points += fmt::format("{} {} {}\n", k % 4, chance_.number(1, 3), k / 4);
  if (some()) points = "<![CDATA[" + points + "]]>";
  node.children.push_back({"points", {}, {}, points});
  if (some()) node.children.push_back({"weights", {}, {}, "1 2.0 3 1 1 1 1 1 1 1 1 0.5"});
  return node;
}

inline RandomScene::Node RandomScene::shape() {
  const auto sheet = [&] {
    Node grid{"grid", {{"columns", fmt::format("{}", chance_.between(3, 9))}, {"rows", "4"}}};
    if (some()) grid.attributes.emplace_back("width", chance_.number(1, 9));
    if (some()) grid.attributes.emplace_back("faces", chance_.pick({"quads", "triangles"}));
    return grid;
  };
  switch (chance_.below(6)) {
    case 0:
      return net();
    case 1:
      return {"mesh", {{"file", "body & <soul>.obj"}, {"uvSet", "1"}, {"uv", "surface"}}};
    case 2:
      return {"subdivision", {{"levels", "2"}, {"file", "cage.obj"}}};
    default:
      return sheet();
  }
}

inline RandomScene::Node RandomScene::surface() {
  Node node{"surface", {{"name", name("sheet")}}};
  node.children.push_back(shape());
  if (!surfaces_.empty() && chance_.once_in(5)) {
    node.attributes.emplace_back("drivenBy", chance_.of(surfaces_));
    return node;
  }
  surfaces_.push_back(node.attributes[0].second);
  if (some()) node.attributes.emplace_back("enabled", flag());
  if (!some()) {
    Node part{"transform"};
    add_channel(part, "translate", true, false);
    add_channel(part, "rotate", true, false);
    if (some()) part.attributes.emplace_back("rotateOrder", "zxy");
    node.children.push_back(part);
  }
  if (!some()) {
    Node part{"material"};
    for (const char* const channel : {"density", "damping", "c"})
      add_channel(part, channel, false, true);
    if (some())
      part.children.push_back(
          {"map", {{"channel", "density"}, {"file", "a.png"}, {"low", "0.50"}}});
    node.children.push_back(part);
  }
  if (some()) {
    Node part{"tangents"};
    if (some()) part.attributes.emplace_back("su0", "0.50");
    if (some()) part.attributes.emplace_back("sv1", "0 1  0");
    node.children.push_back(part);
  }
  if (!some()) {
    Node part{"solver", {{"dt", "0.010"}}};
    if (some()) part.attributes.emplace_back("combine", chance_.pick({"box", "islands"}));
    node.children.push_back(part);
  }
  if (some()) node.children.push_back(animate("scale", true, true));
  if (chance_.once_in(4)) std::swap(node.children.front(), node.children.back());
  return node;
}

inline RandomScene::Node RandomScene::force(bool is_in_group) {
  const std::string kind = chance_.pick(
      {"point", "radial", "line", "uniform", "vortex", "noise", "inertia", "pressure", "radial"});
  Node node{kind, {{"name", name(kind.c_str())}}};
  add_switch(node);
  if (!surfaces_.empty() && some() && !is_in_group) {
    std::string targets = surfaces_.front();
    if (surfaces_.size() > 1 && some()) targets += chance_.pick({" ", "  "}) + surfaces_.back();
    node.attributes.emplace_back("targets", targets);
  }
  add_channel(node, "magnitude", false, false);
  if (!is_in_group) add_channel(node, "deformationRadius", false, true);
  add_channel(node, "forceRadius", false, true);
  if (kind == "line") {
    add_position(node, "from");
    add_position(node, "to");
  } else if (kind != "uniform" && kind != "inertia") {
    add_position(node, "center");
  }
  if (kind == "point" || kind == "uniform" || kind == "line")
    add_channel(node, "direction", true, false);
  const bool has_place = kind != "uniform" && kind != "inertia";
  const bool has_direction = has_place && kind != "radial" && kind != "pressure";
  if (has_place && !surfaces_.empty() && chance_.once_in(4))
    node.attributes.emplace_back("follow", surfaces_.back());
  if (has_direction && chance_.once_in(4)) node.attributes.emplace_back("along", "normal");
  if (kind == "vortex") add_channel(node, "pull", false, false);
  if (kind == "noise" && some()) node.attributes.emplace_back("seed", "77");
  if (some()) {
    if (some()) {
      node.attributes.emplace_back("falloff", chance_.pick({"smooth", "gaussian", "linear"}));
    } else {
      Node falloff{"falloff"};
      falloff.children.push_back({"key", {{"at", "0"}, {"value", "1.0"}}});
      falloff.children.push_back({"key", {{"at", "0.50"}, {"value", "0.5"}, {"tangent", "flat"}}});
      falloff.children.push_back({"key", {{"at", "1"}, {"value", "0"}}});
      node.children.push_back(falloff);
    }
  }
  return node;
}

inline RandomScene::Node RandomScene::group() {
  Node node{"group", {{"name", name("group")}}};
  add_switch(node);
  if (!surfaces_.empty() && some()) node.attributes.emplace_back("targets", surfaces_.back());
  add_position(node, "center");
  add_channel(node, "deformationRadius", false, true);
  for (int k = chance_.between(0, 3); k > 0; --k) node.children.push_back(force(true));
  return node;
}

inline void RandomScene::write_value(const std::string& value) {
  const char quote = chance_.once_in(3) ? '\'' : '"';
  text_ += quote;
  for (const char c : value) {
    if (c == '&')
      text_ += chance_.pick({"&amp;", "&#38;", "&#x26;"});
    else if (c == '<')
      text_ += "&lt;";
    else if (c == '>' && chance_.once_in(2))
      text_ += "&gt;";
    else if (is_wild_ && chance_.once_in(60))
      text_ += fmt::format("&#{};", static_cast<int>(c));
    else
      text_ += c;
  }
  text_ += quote;
}

inline void RandomScene::write_gap(int depth) {
  if (is_wild_ && chance_.once_in(4)) {
    text_ += chance_.pick({"", "", " ", "\t"});
    return;
  }
  if (chance_.once_in(5))
    text_ += chance_.pick({" <!-- \" trailing -->", "<!--> ' a='1' <key/> -->"});
  end_line();
  if (chance_.once_in(8)) end_line();
  const auto indent = [&] {
    if (is_wild_ && chance_.once_in(3)) {
      text_ += chance_.pick({"", "\t", "   ", "\t  "});
    } else {
      for (int k = 0; k < depth; ++k) text_ += "  ";
    }
  };
  if (chance_.once_in(8)) {
    indent();
    text_ += "<!-- two";
    end_line();
    text_ += "      lines & more: ä€😀 -->";
    end_line();
  }
  indent();
}

inline void RandomScene::write(const Node& node, int depth) {
  text_ += '<' + node.name;
  const bool has_lines = is_wild_ && chance_.once_in(5);
  for (const auto& [attribute, value] : node.attributes) {
    if (has_lines) {
      end_line();
      text_ += "      ";
    } else {
      text_ += chance_.once_in(12) ? "  " : " ";
    }
    text_ += attribute;
    text_ += is_wild_ && chance_.once_in(10) ? " = " : "=";
    write_value(value);
  }
  if (is_wild_ && chance_.once_in(6)) text_ += ' ';
  if (node.children.empty() && node.content.empty() && !chance_.once_in(8)) {
    text_ += "/>";
    return;
  }
  text_ += '>' + node.content;
  for (const Node& child : node.children) {
    write_gap(depth + 1);
    write(child, depth + 1);
  }
  if (!node.children.empty()) {
    write_gap(depth);
  } else if (node.content.empty() && chance_.once_in(2)) {
    end_line();
  }
  text_ += "</" + node.name + (is_wild_ && chance_.once_in(10) ? " >" : ">");
}

inline std::string RandomScene::text() {
  Node scene{"scene", {{"version", "1"}, {"start", "1"}, {"end", chance_.pick({"6", "12", "1"})}}};
  if (some()) scene.attributes.emplace_back("fps", chance_.pick({"24000/1001", "25.0"}));
  if (some()) scene.attributes.emplace_back("seed", "7");
  for (int k = chance_.between(0, 2); k > 0; --k) scene.children.push_back(surface());
  for (int k = chance_.between(0, 3); k > 0; --k) scene.children.push_back(force(false));
  for (int k = chance_.between(0, 2); k > 0; --k) scene.children.push_back(group());
  text_ = chance_.pick({"", "", "\xEF\xBB\xBF"});
  if (!some()) {
    text_ += chance_.pick({"<?xml version=\"1.0\" encoding=\"UTF-8\"?>", "<?xml version='1.0'?>"});
    end_line();
  }
  if (some()) text_ += "<!-- a scene -->";
  if (some()) end_line();
  write(scene, 0);
  if (!some()) end_line();
  if (some()) text_ += "<!-- the end -->";
  return text_;
}

}  // namespace pliant::testing
