// Operations that put forces into groups, and out of them.

#include <algorithm>

#include <fmt/format.h>

#include "pliant/document/editor.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::edit {

namespace {

constexpr const char* radius = "deformationRadius";

}  // namespace

Result<void> Editor::operator()(const Group& group) {
  if (group.forces.empty()) return draft_.refuse("no forces are given for the group");
  // What a new group has from the first force that has it.
  std::vector<Given> attributes = group.attributes;
  const auto has = [&](std::string_view name) {
    return std::ranges::any_of(attributes, [&](const Given& one) { return one.first == name; });
  };
  std::vector<std::string> forces;  // in the order of the text
  std::vector<NamedElement> all = objects();
  for (const std::string& name : group.forces) {
    const auto element = force(name);
    if (!element) return fail(element.error());
    parts_.insert(name);
  }
  if (auto good = check_new(group.name); !good) return good;
  bool is_there = false;
  for (const auto& [name, element] : all) {
    is_there = is_there || (name == group.name && draft_.name(element) == "group");
    if (std::ranges::find(group.forces, name) == group.forces.end()) continue;
    forces.push_back(name);
    for (const char* const attribute : {"center", radius})
      if (const auto value = draft_.value(element, attribute); value && !has(attribute))
        attributes.emplace_back(attribute, *value);
  }
  if (is_there && !group.attributes.empty())
    return draft_.refuse(
        fmt::format("the group {} is there already; its attributes are set by themselves",
                    in_quotes(group.name)));
  parts_.insert(group.name);
  for (const std::string& name : forces) {
    auto reset = (*this)(Reset{fmt::format("{}.{}", name, radius)});
    if (!reset) return reset;
    if (auto done = draft_.commit(); !done) return done;
  }
  if (is_there) {
    for (const std::string& name : forces)
      if (auto done = move_into(name, group.name); !done) return done;
    return {};
  }

  // One behind the other, then between the tags of the group. Forces of other groups leave them.
  const auto first = object(forces.front());
  if (!first) return fail(first.error());
  if (const ElementIndex parent = draft_.place(*first).parent; parent != Draft::root)
    if (auto done = move_behind(forces.front(), name_of(parent)); !done) return done;
  for (std::size_t k = 1; k < forces.size(); ++k)
    if (auto done = move_behind(forces[k], forces[k - 1]); !done) return done;
  const auto begin = object(forces.front());
  const auto end = object(forces.back());
  if (!begin || !end) return fail(begin ? end.error() : begin.error());

  const Draft::Surroundings around = draft_.inside({.parent = Draft::root, .after = *begin});
  const std::string margin = around.is_inline ? "" : around.margin;
  std::vector<std::string> texts = {fmt::format("name={0}{1}{0}", around.layout.quote,
                                                xml::encoded(group.name, around.layout.quote))};
  for (const auto& [name, value] : attributes)
    texts.push_back(fmt::format("{}={}{}{}", name, around.layout.quote,
                                xml::encoded(value, around.layout.quote), around.layout.quote));
  const TextRange range{draft_.place(*begin).whole().begin,
                        draft_.end_with_comments(draft_.place(*end).end)};
  const std::string inner = margin + around.layout.indent;
  draft_.replace(range, xml::opening_tag("group", texts, ">", margin, around.layout) +
                            around.layout.line_end + inner +
                            draft_.reindented(range, margin, inner) + around.layout.line_end +
                            margin + "</group>");
  return {};
}

/// Moves a force to the end of a group.
Result<void> Editor::move_into(const std::string& force, const std::string& group) {
  const auto from = object(force);
  const auto to = object(group);
  if (!from || !to) return fail(from ? to.error() : from.error());
  if (draft_.place(*from).parent == *to) return {};
  Draft::Place place{.parent = *to};
  for (const ElementIndex child : draft_.children(*to)) place.after = child;
  const Draft::Surroundings around = draft_.inside(place);
  draft_.insert(std::vector{draft_.reindented(*from, draft_.margin_of(*from).value_or(""),
                                              around.is_inline ? "" : around.margin)},
                place);
  draft_.remove(*from);
  return draft_.commit();
}

/// Moves a force behind another thing of the scene, unless it stands there, but for comments.
Result<void> Editor::move_behind(const std::string& force, const std::string& other) {
  const auto from = object(force);
  const auto to = object(other);
  if (!from || !to) return fail(from ? to.error() : from.error());
  const std::vector<ElementIndex> all = draft_.children(Draft::root);
  const auto place = std::ranges::find(all, *to);
  if (place + 1 != all.end() && *(place + 1) == *from) return {};
  const std::string margin = draft_.margin_of(*to).value_or("");
  draft_.insert(std::vector{draft_.reindented(*from, draft_.margin_of(*from).value_or(""), margin)},
                {.parent = Draft::root, .after = *to});
  draft_.remove(*from);
  return draft_.commit();
}

Result<void> Editor::operator()(const Ungroup& ungroup) {
  for (const std::string& name : ungroup.groups)
    if (auto done = this->ungroup(name); !done) return done;
  return {};
}

Result<void> Editor::ungroup(const std::string& group) {
  const auto found = object(group);
  if (!found) return fail(found.error());
  if (draft_.name(*found) != "group")
    return draft_.refuse(fmt::format("{} is a <{}>, not a group",
                                     *found == Draft::root ? "the scene" : in_quotes(group),
                                     draft_.name(*found)));
  std::vector<std::string> members;
  for (const ElementIndex child : draft_.children(*found))
    if (is_force(child)) members.push_back(name_of(child));
  for (const std::string& member : members)
    if (auto done = inherit(group, member); !done) return done;

  // The tags of the group and its own curves go; what is between stays, comments too.
  const auto now = object(group);
  if (!now) return fail(now.error());
  const ElementIndex element = *now;
  parts_.insert(group);
  if (members.empty()) {
    draft_.remove(element);
    return draft_.commit();
  }
  for (const ElementIndex child : draft_.children(element))
    if (!is_force(child)) draft_.remove(child);
  if (auto done = draft_.commit(); !done) return done;
  const xml::ElementPlace whole = draft_.place(element);
  const std::string_view text = draft_.text();
  const auto closing = static_cast<std::uint32_t>(text.rfind("</", whole.end - 1));
  // From the first thing in it to the last, where the group stood.
  const auto begin = static_cast<std::uint32_t>(text.find_first_not_of(xml::blanks, whole.tag_end));
  const auto last = static_cast<std::uint32_t>(text.find_last_not_of(xml::blanks, closing - 1)) + 1;
  const std::string margin = draft_.margin_of(element).value_or("");
  const std::string inner = draft_.margin_of(draft_.children(element).front()).value_or(margin);
  draft_.replace(whole.whole(), draft_.reindented({begin, last}, inner, margin));
  return draft_.commit();
}

/// Gives a force what its group did for it.
Result<void> Editor::inherit(const std::string& group, const std::string& force) {
  parts_.insert(force);
  const auto spot_of = [&](const std::string& object, const char* attribute) {
    return spot(fmt::format("{}.{}", object, attribute));
  };
  for (const char* const attribute : {radius, "enabled"}) {
    const auto from = spot_of(group, attribute);
    const auto to = spot_of(force, attribute);
    if (!from || !to) return fail(from ? to.error() : from.error());
    const auto curve = animated(*from);
    const auto given = draft_.value(*from->element, attribute);
    if (!curve && !given) continue;
    if (attribute != radius) {
      if (given && xml::trimmed(*given) == "true") continue;
      const bool is_animated = animated(*to).has_value();
      const auto own = is_animated ? std::nullopt : draft_.value(*to->element, attribute);
      if (own && xml::trimmed(*own) == "false") continue;
      const bool is_on = !is_animated && (!own || xml::trimmed(*own) == "true");
      const bool is_group_off = given && !curve && xml::trimmed(*given) == "false";
      if (!is_on && !is_group_off)
        return draft_.refuse(fmt::format(
            "{0}.enabled and {1}.enabled are both more than true or false; one must be that before "
            "{1} can be dissolved",
            force, group));
    }
    if (!curve) {
      if (auto done = set_constant(*to, *given); !done) return done;
      continue;
    }
    draft_.remove_attribute(*to->element, attribute);
    Draft::Place place{.parent = *to->element};
    for (const ElementIndex child : draft_.children(place.parent, "animate")) place.after = child;
    const Draft::Surroundings around = draft_.inside(place);
    draft_.insert(std::vector{draft_.reindented(*curve, draft_.margin_of(*curve).value_or(""),
                                                around.is_inline ? "" : around.margin)},
                  place);
    if (auto done = draft_.commit(); !done) return done;
  }
  const auto from = object(group);
  const auto to = object(force);
  if (!from || !to) return fail(from ? to.error() : from.error());
  return inherit_targets(*from, *to);
}

Result<void> Editor::inherit_targets(ElementIndex group, ElementIndex force) {
  const auto theirs = draft_.value(group, "targets");
  if (!theirs) return {};
  const auto own = draft_.value(force, "targets");
  std::string both = *theirs;
  if (own) {
    both.clear();
    const std::vector<std::string_view> known = xml::words_of(*theirs);
    for (const std::string_view word : xml::words_of(*own))
      if (std::ranges::find(known, word) != known.end())
        both += fmt::format("{}{}", both.empty() ? "" : " ", word);
    if (both.empty())
      return draft_.refuse(
          fmt::format("{}.targets: none of them is a target of the group, so the force has no "
                      "effect; delete it, or change its targets before the group is dissolved",
                      name_of(force)));
  }
  draft_.set(force, "targets", both);
  return draft_.commit();
}

}  // namespace pliant::edit
