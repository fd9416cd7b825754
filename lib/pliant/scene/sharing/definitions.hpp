#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pliant/scene/sharing/arithmetic.hpp"
#include "pliant/scene/text/text_place.hpp"

namespace pliant::xml {

/// Whether a name may be defined: a letter or _, then letters, digits and _. It has no -, so that
/// `$a-1` is a difference.
bool is_definition_name(std::string_view text);

/// What a <define> gives a name.
struct Definition {
  std::string text = {};
  std::optional<Numbers> numbers = {};  ///< that it stands for; null: none
  bool is_plain = false;                ///< a number, or several between blanks
  bool is_sound = false;                ///< false: a problem with it has been reported
  TextPlace place = {};                 ///< of the <define>
  /// Of its value, in the map of sources: where the value is from, and then those that it was made
  /// of.
  std::vector<std::uint32_t> sources = {};
  mutable bool is_used = false;

  void set(std::string value);
};

using Definitions = std::map<std::string, Definition, std::less<>>;

/// The definitions that hold at a place of a text.
struct Scope {
  const Scope* outer = nullptr;        ///< at the <include> of the text
  const Definitions* given = nullptr;  ///< in the <include>; they replace those of the text
  Definitions own = {};
  Definitions imported = {};  ///< from files that the text includes
  /// The line of a later definition in the text; null: there is none.
  std::function<std::optional<int>(std::string_view name)> later = {};

  /// The name that is being defined; it is not what comes later.
  mutable std::string_view defined_now = {};

  /// The definition of a name, its own before one that is imported before one from outside; null:
  /// there is none. Marks it as used.
  const Definition* find(std::string_view name) const;

  /// Takes over what an included file has defined, except for names that are there.
  void take(Scope included);
};

/// What a value is used as.
enum class Use {
  Number,      ///< or several; a text if it is not arithmetic
  Text,        ///< is not computed
  Definition,  ///< as Number, but kept if it has no operator, or wrong syntax
};

/// A value in which definitions are used.
struct ExpandedValue {
  /// The words of a complaint follow `<grid> width="$w": `; if they are empty, the problem is
  /// reported already.
  Checked<std::string> text;
  std::vector<std::uint32_t> sources = {};  ///< of the definitions that it is made of, or was to be
};

/// A value, decoded, with `$NAME` and `${NAME}` replaced and `$$` as `$`; computed if it is
/// arithmetic (`compute`). `may_hint`: whether the complaint about an undefined name has the
/// nearest one.
ExpandedValue expand_value(std::string_view value, const Scope& scope, Use use,
                           bool may_hint = true);

}  // namespace pliant::xml
