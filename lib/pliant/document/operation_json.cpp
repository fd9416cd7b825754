#include "pliant/document/operation_json.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/shortened.hpp"
#include "pliant/core/text.hpp"
#include "pliant/document/animate_text.hpp"
#include "pliant/document/operation_rows.hpp"
#include "pliant/files/json/json_reader.hpp"
#include "pliant/scene/format/nearest.hpp"

namespace pliant {
namespace {

using edit::AnyKeys;
using Json = nlohmann::json;
using OrderedJson = nlohmann::ordered_json;

/// Whether JSON has it as an object.
template <class T>
inline constexpr bool is_described = requires {
  sizeof(Description<T>);
};

template <class T>
inline constexpr bool is_list = false;
template <class T>
inline constexpr bool is_list<std::vector<T>> = true;

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;

template <class T>
constexpr std::string_view type_of() {
  if constexpr (is_optional<T>) return type_of<typename T::value_type>();
  if constexpr (std::is_same_v<T, std::string>) return "text";
  if constexpr (std::is_same_v<T, double>) return "number";
  if constexpr (std::is_same_v<T, int>) return "integer";
  if constexpr (std::is_same_v<T, bool>) return "boolean";
  if constexpr (std::is_enum_v<T>) return "word";
  if constexpr (std::is_same_v<T, AnyKeys>) return "curve";
  if constexpr (std::is_same_v<T, std::vector<std::string>>) return "texts";
  if constexpr (std::is_same_v<T, std::vector<double>>) return "numbers";
  return "objects";
}

/// What a value of a type must be.
template <class T>
std::string rule_of(const Attribute& row) {
  if constexpr (is_optional<T>) return rule_of<typename T::value_type>(row);
  if constexpr (std::is_same_v<T, double>) return "must be a number";
  if constexpr (std::is_same_v<T, int>) return "must be a whole number";
  if constexpr (std::is_same_v<T, bool>) return "must be true or false";
  if constexpr (std::is_enum_v<T>)
    return fmt::format("must be a word: {}", fmt::join(row.words, ", "));
  if constexpr (std::is_same_v<T, AnyKeys>) return "must be the text of an <animate>";
  if constexpr (std::is_same_v<T, std::vector<std::string>>) return "must be a list of texts";
  if constexpr (std::is_same_v<T, std::vector<double>>) return "must be a list of numbers";
  if constexpr (is_list<T>) return "must be a list of objects";
  return "must be a text";
}

// Writing.

/// Writes operations. The first error is kept, and what is written after it is of no use.
class OperationWriter {
 public:
  template <class Of>
  OrderedJson operator()(const Of& operation) {
    operation_ = Description<Of>::name;
    OrderedJson json{{"op", operation_}};
    write(operation, json);
    return json;
  }

  const std::optional<std::string>& fault() const { return fault_; }

  /// A value as JSON, whatever it is.
  template <class T>
  OrderedJson value_of(const Attribute& row, const T& value) {
    if constexpr (is_optional<T>) {
      return value_of(row, *value);
    } else if constexpr (std::is_same_v<T, std::string>) {
      if (!is_utf8(value)) refuse(row, "has bytes that are not UTF-8");
      return value;
    } else if constexpr (std::is_same_v<T, double>) {
      if (!std::isfinite(value)) refuse(row, fmt::format("is {}; it must be finite", value));
      return number_of(value);
    } else if constexpr (std::is_same_v<T, AnyKeys>) {
      auto text = edit::animate_text(value, channel_);
      if (!text) refuse(row, fmt::format("cannot be written: {}", text.error().message));
      return text ? *std::move(text) : "";
    } else if constexpr (std::is_enum_v<T>) {
      const auto index = static_cast<std::size_t>(value);
      if (index < row.words.size()) return row.words[index];
      refuse(row, fmt::format("is no word: {}", fmt::join(row.words, ", ")));
      return "";
    } else if constexpr (is_list<T>) {
      OrderedJson list = OrderedJson::array();
      for (const auto& each : value) {
        if constexpr (is_described<typename T::value_type>) {
          list.push_back(OrderedJson::object());
          write(each, list.back());
        } else {
          list.push_back(value_of(row, each));
        }
      }
      return list;
    } else {
      return value;
    }
  }

 private:
  void refuse(const Attribute& row, const std::string& rule) {
    if (!fault_) fault_ = fmt::format("{} of {} {}", row.name, operation_, rule);
  }

  /// Whole numbers without a point.
  static OrderedJson number_of(double value) {
    constexpr double most = 0x1p53;
    const bool is_whole = std::fabs(value) < most && value == std::trunc(value);
    const bool is_negative_zero = value == 0 && std::signbit(value);
    if (is_whole && !is_negative_zero) return static_cast<std::int64_t>(value);
    return value;
  }

  template <class T>
  static bool is_default(const T& value, const T& standard) {
    if constexpr (is_list<T>)
      return value.empty();
    else
      return value == standard;
  }

  template <class T>
  void write(const T& thing, OrderedJson& json) {
    const T standard{};
    describe(
        [&](const Attribute& row, const auto& member, const auto& of_standard) {
          if (row.name == channel_row.name) channel_ = json_text(member);
          if (row.need == Need::Required || !is_default(member, of_standard))
            json[std::string(row.name)] = value_of(row, member);
        },
        thing, standard);
  }

  template <class T>
  static std::string json_text(const T& member) {
    if constexpr (std::is_same_v<T, std::string>) return member;
    return "";
  }

  std::string_view operation_;
  std::string channel_;
  std::optional<std::string> fault_;
};

// Reading.

/// Reads operations. The first error is kept.
class OperationReader : JsonReader {
 public:
  OperationReader(Json& root, const StopRequest& should_stop)
      : JsonReader(root, should_stop), should_stop_(should_stop) {}

  Result<std::vector<Operation>> read() {
    std::vector<Operation> operations;
    each(root_, list_name, [&](Json& json) { read_operation(json, operations); });
    if (fault_) return fault();
    return operations;
  }

  static constexpr const char* list_name = "operations";

 private:
  static constexpr std::string_view kind_name = "op";

  void read_operation(Json& json, std::vector<Operation>& operations) {
    operation_.clear();
    const Json* const op = member(json, kind_name.data());
    const auto* const name = op ? op->get_ptr<const std::string*>() : nullptr;
    if (!name)
      return refuse(kind_name,
                    op ? fmt::format("is {}; it must be the name of an operation", shown(*op))
                       : "is missing; it must be the name of an operation");
    std::vector<std::string_view> names;
    bool is_known = false;
    for_each_operation([&]<class Of>(std::type_identity<Of>) {
      names.push_back(Description<Of>::name);
      if (is_known || names.back() != *name) return;
      is_known = true;
      operation_ = " of " + *name;
      Of operation;
      read_members(json, operation, {kind_name});
      operations.emplace_back(std::move(operation));
    });
    if (!is_known)
      refuse(kind_name, fmt::format("is {}{}", in_quotes(*name), xml::hint(*name, names)));
  }

  /// Reads the members of an object. `names`: those that it has besides.
  template <class T>
  void read_members(Json& json, T& thing, std::vector<std::string_view> names = {}) {
    describe(
        [&](const Attribute& row, auto& to) {
          names.push_back(row.name);
          if (!fault_) read_member(json, row, to);
        },
        thing);
    for (const auto& [name, value] : json.items()) {
      if (fault_) return;
      if (std::ranges::find(names, name) != names.end()) continue;
      refuse("", fmt::format("has no member {}{}{}", in_quotes(name), operation_,
                             xml::hint(name, names)));
    }
  }

  template <class T>
  void read_member(Json& json, const Attribute& row, T& to) {
    Json* const value = member(json, row.name.data());
    if (value) return read_value(json, *value, row, to);
    if (row.need == Need::Required) refuse_member(row, "is missing; it " + rule_of<T>(row));
  }

  template <class T>
  void read_value([[maybe_unused]] Json& parent, Json& value, const Attribute& row, T& to) {
    if constexpr (is_optional<T>) {
      return read_value(parent, value, row, to.emplace());
    } else if constexpr (std::is_same_v<T, std::string>) {
      if (auto* const text = value.get_ptr<std::string*>()) {
        to = std::move(*text);
        if (row.name == channel_row.name) channel_ = to;
        return;
      }
    } else if constexpr (std::is_same_v<T, double>) {
      if (value.is_number()) {
        to = value.get<double>();
        return check_range(row, to);
      }
    } else if constexpr (std::is_same_v<T, int>) {
      const auto whole = to_integer(value);
      if (whole && std::in_range<int>(*whole)) {
        to = static_cast<int>(*whole);
        return check_range(row, to);
      }
    } else if constexpr (std::is_same_v<T, bool>) {
      if (value.is_boolean()) {
        to = value.get<bool>();
        return;
      }
    } else if constexpr (std::is_enum_v<T>) {
      if (const auto* const word = value.get_ptr<const std::string*>())
        return read_word(*word, row, to);
    } else if constexpr (std::is_same_v<T, AnyKeys>) {
      if (const auto* const text = value.get_ptr<const std::string*>())
        return read_curve(*text, row, to);
    } else if constexpr (is_described<typename T::value_type>) {
      if (value.is_array())
        return each(parent, row.name.data(),
                    [&](Json& each) { read_members(each, to.emplace_back()); });
    } else if (value.is_array()) {
      return read_list(value, row, to);
    }
    refuse_member(row, fmt::format("is {}; it {}", shown(value), rule_of<T>(row)));
  }

  template <class T>
  void read_list(Json& list, const Attribute& row, std::vector<T>& to) {
    for (std::size_t k = 0; k < list.size() && goes_on(); ++k) {
      Json& element = list[k];
      if constexpr (std::is_same_v<T, double>) {
        if (element.is_number()) to.push_back(element.get<double>());
      } else {
        if (auto* const text = element.get_ptr<std::string*>()) to.push_back(std::move(*text));
      }
      if (to.size() == k)
        refuse_member(row,
                      fmt::format("has {}; it {}", shown(element), rule_of<std::vector<T>>(row)));
    }
  }

  template <class T>
  void read_word(const std::string& word, const Attribute& row, T& to) {
    const auto found = std::ranges::find(row.words, word);
    if (found == row.words.end())
      return refuse_member(row,
                           fmt::format("is {}{}", in_quotes(word), xml::hint(word, row.words)));
    to = static_cast<T>(found - row.words.begin());
  }

  void read_curve(const std::string& text, const Attribute& row, AnyKeys& to) {
    auto keys = edit::keys_of_animate(text, channel_, copies_, should_stop_);
    if (keys) {
      to = *std::move(keys);
    } else if (keys.error().code == ErrorCode::Interrupted) {
      end();
    } else {
      const Error& error = keys.error();
      refuse_member(row, error.line > 0
                             ? fmt::format("is refused: line {}: {}", error.line, error.message)
                             : fmt::format("is refused: {}", error.message));
    }
  }

  void check_range(const Attribute& row, double number) {
    const double numbers[] = {number};
    if (const auto rule = row.range.broken_rule(numbers))
      refuse_member(row, fmt::format("is {}; it {}", number, *rule));
  }

  void refuse_member(const Attribute& row, const std::string& rule) {
    refuse(row.name, operation_.substr(operation_.empty() ? 0 : 1) + " " + rule);
  }

  /// A value in a message.
  static std::string shown(const Json& value) {
    if (const auto* const text = value.get_ptr<const std::string*>()) return in_quotes(*text);
    if (value.is_array()) return "a list";
    if (value.is_object()) return "an object";
    return value.dump();
  }

  StopRequest should_stop_;
  std::string operation_;  // ` of setKey`
  std::string channel_;
  std::int64_t copies_ = 0;  // of keys, by the loops of all curves
};

// The list.

template <class T>
std::vector<MemberFormat> formats_of(const T& thing) {
  std::vector<MemberFormat> formats;
  describe(
      [&]<class Member>(const Attribute& row, const Member& member) {
        MemberFormat& format =
            formats.emplace_back(MemberFormat{.name = row.name,
                                              .type = type_of<std::remove_const_t<Member>>(),
                                              .meaning = row.meaning,
                                              .unit = row.unit,
                                              .range = row.range.to_text(),
                                              .words = row.words,
                                              .is_required = row.need == Need::Required});
        if constexpr (is_list<Member>)
          if constexpr (is_described<typename Member::value_type>)
            format.members = formats_of(typename Member::value_type());
        if (format.is_required) return;
        if (!row.absent.empty())
          format.standard = fmt::format("({})", row.absent);
        else if constexpr (!is_optional<Member>)
          format.standard = OperationWriter().value_of(row, member).dump();
      },
      thing);
  return formats;
}

}  // namespace

const std::vector<OperationFormat>& operation_formats() {
  static const std::vector<OperationFormat> formats = [] {
    std::vector<OperationFormat> all;
    for_each_operation([&]<class Of>(std::type_identity<Of>) {
      all.push_back({Description<Of>::name, Description<Of>::meaning, formats_of(Of())});
    });
    return all;
  }();
  return formats;
}

Result<std::string> to_json(const std::vector<Operation>& operations) {
  OperationWriter writer;
  OrderedJson list = OrderedJson::array();
  for (const Operation& operation : operations) {
    list.push_back(std::visit(writer, operation));
    if (writer.fault())
      return invalid(
          fmt::format("{}[{}]: {}", OperationReader::list_name, list.size() - 1, *writer.fault()));
  }
  return list.dump();
}

Result<std::vector<Operation>> parse_operations(std::string_view json,
                                                const StopRequest& should_stop) {
  auto list = parse_json(json, "a list of operations", should_stop);
  if (!list) return fail(list.error());
  if (!list->is_array()) return invalid("operations must be a list");
  Json root;
  const EmptiedJson end(root);
  root[OperationReader::list_name] = std::move(*list);
  return OperationReader(root, should_stop).read();
}

}  // namespace pliant
