#include "pliant/scene/sharing/definitions.hpp"

#include <algorithm>
#include <span>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/format/nearest.hpp"
#include "pliant/scene/sharing/expand.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

constexpr std::size_t longest_definition_name = 100;
constexpr std::size_t most_numbers = 16;  // of a definition that is computed with

bool begins_definition_name(char c) {
  return c == '_' || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

/// The name at the start of a text; empty: none.
std::string_view leading_name(std::string_view text) {
  if (text.empty() || !begins_definition_name(text.front())) return {};
  const auto end = std::find_if_not(text.begin(), text.end(), [](char c) {
    return begins_definition_name(c) || (c >= '0' && c <= '9');
  });
  return text.substr(0, static_cast<std::size_t>(end - text.begin()));
}

/// `; did you mean "width"?`, or where the name is defined later.
std::string hint_of_undefined(std::string_view name, const Scope& scope) {
  if (scope.later && name != scope.defined_now) {
    if (const auto line = scope.later(name)) return fmt::format("; there is one at line {}", *line);
  }
  constexpr std::size_t most_compared = 1000;
  std::vector<std::string_view> names;
  const auto add = [&](const Definitions& definitions) {
    for (auto one = definitions.begin(); one != definitions.end() && names.size() < most_compared;
         ++one)
      names.push_back(one->first);
  };
  for (const Scope* one = &scope; one; one = one->outer) {
    add(one->own);
    if (one->given) add(*one->given);
    add(one->imported);
  }
  const auto near = nearest_word(name, names);
  return near ? fmt::format("; did you mean {}?", in_quotes(*near)) : "";
}

/// Splits a value into what is written and what is defined.
class ValueReader {
 public:
  ValueReader(std::string_view value, const Scope& scope, bool may_hint)
      : rest_(value), scope_(scope), may_hint_(may_hint) {}

  /// The parts, which refer to the value and the scope.
  Checked<std::vector<ValuePart>> read() {
    std::vector<ValuePart> parts;
    while (!rest_.empty()) {
      const std::size_t dollar = std::min(rest_.find('$'), rest_.size());
      if (dollar > 0) parts.push_back({.text = take(dollar)});
      if (rest_.empty()) break;
      take(1);
      if (rest_.starts_with('$')) {
        parts.push_back({.text = take(1)});
        continue;
      }
      auto part = definition();
      if (!part) return tl::unexpected(std::move(part.error()));
      parts.push_back(*part);
    }
    return parts;
  }

  /// Of the definitions that were read, and then of those that they were made of.
  std::vector<std::uint32_t> sources() const {
    std::vector<std::uint32_t> all = direct_;
    add_sources(all, indirect_);
    return all;
  }

 private:
  static void add_sources(std::vector<std::uint32_t>& to, std::span<const std::uint32_t> more) {
    constexpr std::size_t most = 8;  // more than are told of any value
    for (const std::uint32_t source : more)
      if (to.size() < most && std::ranges::find(to, source) == to.end()) to.push_back(source);
  }

  std::string_view take(std::size_t count) {
    const std::string_view taken = rest_.substr(0, count);
    rest_.remove_prefix(count);
    return taken;
  }

  Checked<ValuePart> definition() {
    const bool has_braces = rest_.starts_with('{');
    if (has_braces) take(1);
    const std::string_view name = take(leading_name(rest_).size());
    if (has_braces && (name.empty() || !rest_.starts_with('}')))
      return refused("\"${\" must be followed by a name and \"}\"; write $$ for a $");
    if (name.empty()) return refused("\"$\" must be followed by a name; write $$ for a $");
    if (has_braces) take(1);
    const Definition* const definition = scope_.find(name);
    if (!definition)
      return refused(fmt::format("no definition of {} comes before it{}", in_quotes(name),
                                 may_hint_ ? hint_of_undefined(name, scope_) : ""));
    if (!definition->is_sound) return refused({});
    add_sources(direct_, std::span(definition->sources).first(1));
    add_sources(indirect_, std::span(definition->sources).subspan(1));
    return ValuePart{.text = definition->text,
                     .is_definition = true,
                     .numbers = definition->numbers ? &*definition->numbers : nullptr,
                     .is_plain = definition->is_plain};
  }

  std::string_view rest_;
  const Scope& scope_;
  bool may_hint_;
  std::vector<std::uint32_t> direct_, indirect_;
};

bool has_operator(const std::vector<ValuePart>& parts) {
  return std::any_of(parts.begin(), parts.end(), [](const ValuePart& part) {
    return !part.is_definition && !trimmed(part.text).empty();
  });
}

}  // namespace

bool is_definition_name(std::string_view text) {
  return !text.empty() && text.size() <= longest_definition_name && leading_name(text) == text;
}

void Definition::set(std::string value) {
  text = std::move(value);
  is_sound = true;
  is_plain = false;
  numbers.reset();
  if (text.size() > longest_value) return;  // nothing that is made of it may be so long
  numbers = numbers_of(text, most_numbers);
  is_plain = numbers && are_plain_numbers(text);
}

const Definition* Scope::find(std::string_view name) const {
  for (const Scope* scope = this; scope; scope = scope->outer) {
    for (const Definitions* definitions : {&scope->own, scope->given, &scope->imported}) {
      if (!definitions) continue;
      const auto found = definitions->find(name);
      if (found == definitions->end()) continue;
      found->second.is_used = true;
      return &found->second;
    }
  }
  return nullptr;
}

void Scope::take(Scope included) {
  imported.merge(included.own);
  imported.merge(included.imported);
}

ExpandedValue expand_value(std::string_view value, const Scope& scope, Use use, bool may_hint) {
  if (value.size() > longest_value && value.find('$') != std::string_view::npos)
    return {refused(
        fmt::format("is longer than {} KiB, too long for definitions", longest_value >> 10U))};
  ValueReader reader(value, scope, may_hint);
  const auto parts = reader.read();
  if (!parts) return {refused(parts.error().message)};
  const auto refuse = [&](std::string message) {
    return ExpandedValue{refused(std::move(message)), reader.sources()};
  };
  const bool is_defined = std::any_of(parts->begin(), parts->end(),
                                      [](const ValuePart& part) { return part.is_definition; });
  const bool may_be_computed =
      is_defined && (use == Use::Number || (use == Use::Definition && has_operator(*parts)));
  std::string text;
  bool is_too_long = false;
  const auto computed = may_be_computed ? compute(*parts) : std::nullopt;
  const bool is_kept = computed && !*computed && use == Use::Definition &&
                       computed->error().kind == Complaint::Kind::Syntax;
  if (computed && computed->has_value()) {
    text = **computed;
  } else if (computed && !is_kept) {
    return refuse(computed->error().message);
  } else {
    for (const ValuePart& part : *parts) {
      is_too_long = is_defined && text.size() + part.text.size() > longest_value;
      if (is_too_long) break;
      text += part.text;
    }
  }
  if (is_too_long || (is_defined && text.size() > longest_value))
    return refuse(fmt::format("is longer than {} KiB with what is defined", longest_value >> 10U));
  return {std::move(text), reader.sources()};
}

}  // namespace pliant::xml
