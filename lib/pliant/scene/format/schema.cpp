#include "pliant/scene/format/schema.hpp"

#include <algorithm>
#include <set>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/format/format.hpp"
#include "pliant/scene/format/schema_types.hpp"
#include "pliant/scene/text/tree.hpp"

namespace pliant {

using namespace xml;

namespace {

using Names = std::vector<std::string_view>;

/// An element where it stands: some have another type there than elsewhere.
struct Context {
  std::string_view element;
  bool is_in_group = false;  ///< a force in a <group>

  std::string type() const { return std::string(element) + (is_in_group ? ".inGroup" : ""); }
};

/// What holds whatever a fragment is included into.
constexpr Context in_fragment{"fragment"};
constexpr std::string_view meaning_of_fragment = "Content of a scene, to be included.";

class SchemaWriter {
 public:
  explicit SchemaWriter(const std::vector<ElementFormat>& formats) : formats_(formats) {}

  std::string write();

 private:
  const ElementFormat& format(std::string_view name) const;
  bool has_element(std::string_view name) const { return find_format(formats_, name) != nullptr; }
  bool may_contain(std::string_view element, std::string_view child) const;
  bool is_named(std::string_view element) const;
  const ElementFormat& root() const;
  Names children_of(std::string_view parent) const;
  bool is_force(std::string_view name) const;
  bool may_be_included(std::string_view name) const;
  std::vector<const AttributeFormat*> channels_of(const Context& context) const;
  std::vector<std::string> positions_of(const Context& context) const;
  KeyValues values_of(const Context& context) const;

  void write_attribute(const AttributeFormat& attribute, const std::string& type);
  void write_attributes(const ElementFormat& format, const Context& context);
  void declare(std::string_view name, const std::string& type, std::string_view bounds = {});
  void write_child(std::string_view child, const Context& context);
  void write_children(const Names& children, const Context& context, std::string_view bounds);
  void write_content(const Context& context);
  void write_any_order(std::vector<std::pair<std::string_view, int>> parts, bool is_needed);
  void write_type(const Context& context);
  void write_animate(const Context& context);
  void write_path(const Context& context);
  void write_keys(KeyValues values);
  void write_falloff();
  void write_element(std::string_view name);
  void write_unique(const std::string& name, std::string_view selector, std::string_view field);
  void write_uniques(const Context& context);
  void write_doc(std::string_view text);

  void open(std::string_view tag) {
    line("<" + std::string(tag) + ">");
    depth_ += 2;
  }
  void close(std::string_view tag) {
    depth_ -= 2;
    line("</" + std::string(tag) + ">");
  }
  void line(std::string_view text) { body_ += std::string(depth_, ' ') + std::string(text) + '\n'; }

  std::string_view meaning_of(std::string_view element) const {
    return element == in_fragment.element ? meaning_of_fragment : format(element).meaning;
  }

  const std::vector<ElementFormat>& formats_;
  SchemaTypes types_;
  std::string body_;
  std::size_t depth_ = 2;
};

const ElementFormat& SchemaWriter::format(std::string_view name) const {
  return *std::ranges::find(formats_, name, &ElementFormat::name);
}

bool has(const Names& names, std::string_view name) {
  return std::ranges::find(names, name) != names.end();
}

Names SchemaWriter::children_of(std::string_view parent) const {
  Names children;
  for (const ElementFormat& each : formats_) {
    const bool is_child =
        parent == in_fragment.element ? may_be_included(each.name) : has(each.parents, parent);
    if (is_child) children.push_back(each.name);
  }
  return children;
}

bool SchemaWriter::may_contain(std::string_view element, std::string_view child) const {
  return has_element(child) && has(format(child).parents, element);
}

/// Whether it has a name of its own, that of a channel's path.
bool SchemaWriter::is_named(std::string_view element) const {
  return std::ranges::any_of(format(element).attributes,
                             [](const AttributeFormat& each) { return each.type == "name"; });
}

const ElementFormat& SchemaWriter::root() const {
  return *std::ranges::find_if(formats_,
                               [](const ElementFormat& each) { return each.parents.empty(); });
}

bool SchemaWriter::is_force(std::string_view name) const {
  if (name == in_fragment.element || name == "include" || name == "define") return false;
  return may_contain("group", name) && may_contain("scene", name);
}

/// Whether it may stand beside an <include>.
bool SchemaWriter::may_be_included(std::string_view name) const {
  const Names& parents = format(name).parents;
  return std::ranges::any_of(parents, [&](std::string_view parent) {
    return parent != "include" && may_contain(parent, "include");
  });
}

/// The attributes that an <animate> may name there.
std::vector<const AttributeFormat*> SchemaWriter::channels_of(const Context& context) const {
  Names owners = {context.element};
  if (context.element != in_fragment.element)
    for (const ChildFormat& child : format(context.element).children)
      if (child.is_part) owners.push_back(child.names.front());
  if (context.element == in_fragment.element) {
    owners.clear();
    for (const ElementFormat& each : formats_) {
      if (each.name != "path") owners.push_back(each.name);
    }
  }
  std::vector<const AttributeFormat*> channels;
  for (const std::string_view owner : owners) {
    for (const AttributeFormat& each : format(owner).attributes) {
      const bool is_there = std::ranges::any_of(
          channels, [&](const AttributeFormat* other) { return other->name == each.name; });
      const bool is_of_group = context.is_in_group && each.name == "deformationRadius";
      if (each.is_keyable && !is_there && !is_of_group) channels.push_back(&each);
    }
  }
  return channels;
}

std::vector<std::string> SchemaWriter::positions_of(const Context& context) const {
  std::vector<std::string> positions;
  for (const AttributeFormat* each : channels_of(context)) {
    if (each->is_position) positions.emplace_back(each->name);
  }
  return positions;
}

KeyValues SchemaWriter::values_of(const Context& context) const {
  std::set<std::string> found;
  for (const AttributeFormat* each : channels_of(context)) found.insert(each->type);
  if (found == std::set<std::string>{"number"}) return KeyValues::Numbers;
  return found == std::set<std::string>{"vector"} ? KeyValues::Vectors : KeyValues::Any;
}

void SchemaWriter::write_doc(std::string_view text) {
  if (text.empty()) return;
  open("xs:annotation");
  line(fmt::format("<xs:documentation>{}</xs:documentation>", xml_text(text)));
  close("xs:annotation");
}

void SchemaWriter::write_attribute(const AttributeFormat& attribute, const std::string& type) {
  const std::string_view use = attribute.need == Need::Required ? " use=\"required\"" : "";
  open(fmt::format("xs:attribute name=\"{}\" type=\"{}\"{}", attribute.name, type, use));
  write_doc(documentation_of(attribute));
  close("xs:attribute");
}

void SchemaWriter::write_attributes(const ElementFormat& format, const Context& context) {
  for (const AttributeFormat& each : format.attributes) {
    const bool is_of_group = context.is_in_group && each.name == "deformationRadius";
    if (is_of_group || each.need == Need::Later) continue;
    AttributeFormat written = each;
    if (format.name == define_name)  // its value may be empty
      written.type = each.name == "value" ? "any text" : "definition name";
    write_attribute(each, types_.of(written, KeyValues::Numbers));
  }
}

/// An element that has this type where it stands.
void SchemaWriter::declare(std::string_view name, const std::string& type,
                           std::string_view bounds) {
  open(fmt::format("xs:element name=\"{}\" type=\"{}\"{}", name, type, bounds));
  write_doc(meaning_of(name));
  close("xs:element");
}

/// The declaration of a child. Its type depends on where it stands if its words do.
void SchemaWriter::write_child(std::string_view child, const Context& context) {
  if (child == "animate" || child == "path") {
    declare(child, fmt::format("{}.{}", child, context.type()));
  } else if (context.element == "group" && is_force(child)) {
    const Context force{child, true};
    open(fmt::format("xs:element name=\"{}\" type=\"{}\"", child, force.type()));
    write_doc(meaning_of(child));
    write_uniques(force);
    close("xs:element");
  } else if (may_be_included(child)) {
    line(fmt::format("<xs:element ref=\"{}\"/>", child));
  } else {
    declare(child, std::string(child));
  }
}

void SchemaWriter::write_children(const Names& children, const Context& context,
                                  std::string_view bounds) {
  open(fmt::format("xs:choice{}", bounds));
  for (const std::string_view child : children) write_child(child, context);
  close("xs:choice");
}

/// How often an element may stand: so many times or more.
std::string from(int least) {
  return fmt::format(" minOccurs=\"{}\" maxOccurs=\"unbounded\"", least);
}

/// Parts in any order, each at most so often; `is_needed`: the first one is still required.

void SchemaWriter::write_any_order(std::vector<std::pair<std::string_view, int>> parts,
                                   bool is_needed) {
  if (parts.empty()) return;
  open(fmt::format("xs:choice{}", is_needed ? "" : " minOccurs=\"0\""));
  for (std::size_t k = 0; k < parts.size(); ++k) {
    auto left = parts;
    if (--left[k].second == 0) left.erase(left.begin() + static_cast<std::ptrdiff_t>(k));
    open("xs:sequence");
    declare(parts[k].first, std::string(parts[k].first));
    write_any_order(std::move(left), is_needed && k > 0);
    close("xs:sequence");
  }
  close("xs:choice");
}

void SchemaWriter::write_content(const Context& context) {
  Names children = children_of(context.element);
  if (children.empty()) return;
  if (context.element == in_fragment.element) return write_children(children, context, from(0));
  const std::vector<ChildFormat>& rows = format(context.element).children;
  if (!rows.empty() && std::ranges::none_of(rows, [](const ChildFormat& row) {
        return row.row.most == unlimited;
      })) {
    std::vector<std::pair<std::string_view, int>> parts;
    for (const ChildFormat& row : rows) parts.emplace_back(row.names.front(), row.row.most);
    return write_any_order(std::move(parts), rows.front().row.least > 0);
  }
  const auto single = std::ranges::find_if(rows, [](const ChildFormat& row) {
    return row.row.most == 1 && !row.is_part && row.row.noun.empty();
  });
  if (single == rows.end()) return write_children(children, context, from(0));
  const std::string_view falloff = single->names.front();
  std::erase(children, falloff);  // at most one, among the others
  open("xs:sequence");
  write_children(children, context, from(0));
  open("xs:sequence minOccurs=\"0\"");
  write_child(falloff, context);
  write_children(children, context, from(0));
  close("xs:sequence");
  close("xs:sequence");
}

void SchemaWriter::write_type(const Context& context) {
  const ElementFormat& of = format(context.element);
  if (of.text) {
    const std::string type = types_.numbers_in(of.name, *of.text);
    open(fmt::format("xs:complexType name=\"{}\"", context.type()));
    open("xs:simpleContent");
    open(fmt::format("xs:extension base=\"{}\"", type));
    write_attributes(of, context);
    close("xs:extension");
    close("xs:simpleContent");
    return close("xs:complexType");
  }
  open(fmt::format("xs:complexType name=\"{}\"", context.type()));
  write_content(context);
  write_attributes(of, context);
  close("xs:complexType");
}

void SchemaWriter::write_animate(const Context& context) {
  const KeyValues values = values_of(context);
  std::vector<std::string> channels;
  for (const AttributeFormat* each : channels_of(context)) channels.emplace_back(each->name);
  open(fmt::format("xs:complexType name=\"animate.{}\"", context.type()));
  line(fmt::format("<xs:group ref=\"keys.{}\"/>", name_of(values)));
  for (const AttributeFormat& each : format("animate").attributes) {
    write_attribute(each, each.name == "attribute"
                              ? types_.of_words("channel." + context.type(), channels)
                              : types_.of(each, values));
  }
  close("xs:complexType");
}

void SchemaWriter::write_path(const Context& context) {
  open(fmt::format("xs:complexType name=\"path.{}\"", context.type()));
  // At least three waypoints, and at most one <animate> before, between or behind them.
  constexpr int least = 3;
  const auto animate = [&] { declare("animate", "animate.path"); };
  const auto waypoints = [&](int count) { declare("waypoint", "waypoint", from(count)); };
  for (int k = 0; k < least; ++k) {
    open("xs:choice");
    open("xs:sequence");
    animate();
    waypoints(least - k);
    close("xs:sequence");
    open("xs:sequence");
    declare("waypoint", "waypoint");
  }
  waypoints(0);
  open("xs:sequence minOccurs=\"0\"");
  animate();
  waypoints(0);
  close("xs:sequence");
  for (int k = 0; k < least; ++k) {
    close("xs:sequence");
    close("xs:choice");
  }
  for (const AttributeFormat& each : format("path").attributes) {
    write_attribute(each, each.name == "attribute"
                              ? types_.of_words("position." + context.type(), positions_of(context))
                              : types_.of(each, KeyValues::Numbers));
  }
  close("xs:complexType");
}

/// The keys of an <animate>, at least one, and at most one <loop> among them.
void SchemaWriter::write_keys(KeyValues values) {
  const std::string_view name = name_of(values);
  const auto keys = [&](int least) { declare("key", fmt::format("key.{}", name), from(least)); };
  const auto loop = [&] { declare("loop", fmt::format("loop.{}", name)); };
  open(fmt::format("xs:group name=\"keys.{}\"", name));
  open("xs:choice");
  open("xs:sequence");
  keys(1);
  open("xs:sequence minOccurs=\"0\"");
  loop();
  keys(0);
  close("xs:sequence");
  close("xs:sequence");
  open("xs:sequence");
  loop();
  keys(1);
  close("xs:sequence");
  close("xs:choice");
  close("xs:group");
  for (const std::string_view element : {"key", "loop"}) {
    open(fmt::format("xs:complexType name=\"{}.{}\"", element, name));
    for (const AttributeFormat& each : format(element).attributes) {
      if (each.name != "at") write_attribute(each, types_.of(each, values));
    }
    close("xs:complexType");
  }
}

void SchemaWriter::write_falloff() {
  open("xs:complexType name=\"key.falloff\"");
  for (const AttributeFormat& each : format("key").attributes) {
    if (each.name != "frame") write_attribute(each, types_.of(each, KeyValues::Numbers));
  }
  close("xs:complexType");
  open("xs:complexType name=\"falloff\"");
  open("xs:sequence");
  declare("key", "key.falloff", from(1));
  close("xs:sequence");
  write_attributes(format("falloff"), {"falloff"});
  close("xs:complexType");
}

void SchemaWriter::write_unique(const std::string& name, std::string_view selector,
                                std::string_view field) {
  open(fmt::format("xs:unique name=\"{}\"", name));
  line(fmt::format("<xs:selector xpath=\"{}\"/>", selector));
  line(fmt::format("<xs:field xpath=\"{}\"/>", field));
  close("xs:unique");
}

void SchemaWriter::write_uniques(const Context& context) {
  if (context.element == root().name || context.element == in_fragment.element) {
    std::string things, forces;
    for (const std::string_view each : children_of(root().name)) {
      if (is_force(each))
        forces += fmt::format("|{0}|group/{0}", each);
      else if (is_named(each))
        things += fmt::format("{}{}", things.empty() ? "" : "|", each);
    }
    write_unique(context.type() + ".names", things + forces, "@name");
  }
  if (context.element == in_fragment.element) return;
  std::string animates = "animate";
  for (const ChildFormat& child : format(context.element).children) {
    const std::string_view name = child.names.front();
    if (child.is_part && may_contain(name, "animate")) animates += fmt::format("|{}/animate", name);
    if (!child.row.unique_by.empty())
      write_unique(fmt::format("{}.{}", context.type(), name), name,
                   fmt::format("@{}", child.row.unique_by));
  }
  if (!is_named(context.element) || !may_contain(context.element, "animate")) return;
  if (!positions_of(context).empty()) animates += "|path";
  write_unique(context.type() + ".channels", animates, "@attribute");
}

void SchemaWriter::write_element(std::string_view name) {
  const bool is_contextual = name == "animate" || name == "path";
  const std::string type = std::string(name) + (is_contextual ? ".fragment" : "");
  open(fmt::format("xs:element name=\"{}\" type=\"{}\"", name, type));
  write_doc(meaning_of(name));
  if (name == in_fragment.element || !is_contextual) write_uniques({name});
  close("xs:element");
}

std::string SchemaWriter::write() {
  write_element(root().name);
  if (has_element("include")) {
    write_element(in_fragment.element);
    open("xs:complexType name=\"fragment\"");
    write_content(in_fragment);
    close("xs:complexType");
  }
  for (const ElementFormat& each : formats_) {
    if (may_be_included(each.name)) write_element(each.name);
    const bool is_own = each.name == "animate" || each.name == "path" || each.name == "key" ||
                        each.name == "loop" || each.name == "falloff";
    if (!is_own) write_type({each.name});
    if (is_force(each.name)) write_type({each.name, true});
  }
  if (has_element("falloff")) write_falloff();
  for (const ElementFormat& each : formats_) {
    for (const bool is_in_group : {false, true}) {
      const Context context{each.name, is_in_group};
      if (is_in_group && !is_force(each.name)) continue;
      if (may_contain(each.name, "animate")) write_animate(context);
      if (may_contain(each.name, "path")) write_path(context);
    }
  }
  if (has_element("include")) {
    write_animate(in_fragment);
    write_path(in_fragment);
  }
  for (const KeyValues values : {KeyValues::Numbers, KeyValues::Vectors, KeyValues::Any}) {
    write_keys(values);
  }
  return fmt::format(
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n"
      "<!-- The scene format of pliant, version 1, for editors. Made from the description of the\n"
      "     format; docs/scene-format.md, \"Schema\", says how, and which rules it cannot say. "
      "-->\n"
      "<xs:schema xmlns:xs=\"http://www.w3.org/2001/XMLSchema\">\n{}{}</xs:schema>\n",
      body_, types_.definitions());
}

}  // namespace

std::string schema_of(const std::vector<ElementFormat>& formats) {
  return SchemaWriter(formats).write();
}

std::string scene_schema() { return schema_of(scene_format()); }

}  // namespace pliant
