#include "pliant/files/json/json_reader.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include <fmt/format.h>

namespace pliant {
namespace {

using JsonValue = nlohmann::json;

// How far a text is parsed.
struct Progress {
  const char* at;
  StopPoll stop;
};

// The characters of a text; they end early if that is asked for.
class StoppingText {
 public:
  using iterator_category = std::input_iterator_tag;
  using value_type = char;
  using difference_type = std::ptrdiff_t;
  using pointer = const char*;
  using reference = const char&;

  StoppingText(const char* at, const char* end, Progress& progress)
      : at_(at), end_(end), progress_(&progress) {}

  const char& operator*() const { return *at_; }
  StoppingText& operator++() {
    progress_->at = ++at_;
    if (progress_->stop.after()) at_ = end_;
    return *this;
  }
  StoppingText operator++(int) {
    StoppingText before = *this;
    ++*this;
    return before;
  }
  bool operator==(const StoppingText& other) const { return at_ == other.at_; }

 private:
  const char* at_;
  const char* end_;
  Progress* progress_;
};

void empty(JsonValue& value) {
  if (auto* const list = value.get_ptr<JsonValue::array_t*>()) {
    for (JsonValue& inner : *list) empty(inner);
    list->clear();
  }
  if (auto* const members = value.get_ptr<JsonValue::object_t*>()) {
    for (auto& [name, inner] : *members) empty(inner);
    members->clear();
  }
}

// Puts the values together as the parser of nlohmann-json meets them: its own does not know of
// limits, and keeps the last of several members of one name. Each function returns whether to go
// on.
class JsonBuilder {
 public:
  JsonBuilder(std::string_view text, std::string_view kind, std::size_t most_values,
              const TakeJsonText& take_text, const Progress& progress)
      : text_(text),
        kind_(kind),
        most_values_(most_values),
        take_text_(take_text),
        progress_(progress) {}

  bool null() { return add(nullptr); }
  bool boolean(bool value) { return add(value); }
  bool number_integer(std::int64_t value) { return add(value); }
  bool number_unsigned(std::uint64_t value) { return add(value); }
  bool number_float(double value, const std::string& /*text*/) { return add(value); }
  bool binary(JsonValue::binary_t& /*value*/) { return false; }  // JSON has none

  bool string(std::string& value) {
    if (take_text_ && !way_.empty() && way_.back().is_list) {
      const auto taken = take_text_(way_, value);
      if (!taken) return refuse(taken.error());
      if (*taken) return pass_on();
    }
    return add(std::move(value));
  }

  bool start_object(std::size_t /*size*/) { return open(JsonValue::object(), false); }
  bool start_array(std::size_t /*size*/) { return open(JsonValue::array(), true); }
  bool end_object() { return close(); }
  bool end_array() { return close(); }

  bool key(std::string& name) {
    auto& members = open_.back()->get_ref<JsonValue::object_t&>();
    const auto [member, is_new] = members.try_emplace(std::move(name));
    const auto byte = static_cast<std::size_t>(progress_.at - text_.data());
    if (!is_new) return refuse("the file's JSON has two members of one name", line_at(byte));
    member_ = &member->second;
    way_.back().key = member->first;
    return true;
  }

  // Its own messages quote the text, which may be that of any file.
  bool parse_error(std::size_t byte, const std::string& /*token*/,
                   const nlohmann::detail::exception& error) {
    constexpr int number_is_too_large = 406;
    if (error.id == number_is_too_large)
      return refuse(
          fmt::format("the file is not {}: its JSON has a number that is too large", kind_));
    return refuse(fmt::format("the file is not {}: it is not valid JSON from here on", kind_),
                  line_at(byte > 0 ? byte - 1 : 0));
  }

  const Error& error() const { return error_; }
  JsonValue take() { return std::move(root_); }

 private:
  int line_at(std::size_t byte) const {
    const std::string_view before = text_.substr(0, byte);
    return static_cast<int>(1 + std::count(before.begin(), before.end(), '\n'));
  }

  bool refuse(Error error) {
    error_ = std::move(error);
    return false;
  }
  bool refuse(std::string message, int line = 0) {
    return refuse(invalid(std::move(message), line).value());
  }

  bool count() {
    if (++value_count_ <= most_values_) return true;
    return refuse(fmt::format("the file's JSON has more than {} values", most_values_));
  }

  // Where the next value belongs.
  JsonValue& place() {
    if (open_.empty()) return root_;
    if (!way_.back().is_list) return *member_;
    return open_.back()->get_ref<JsonValue::array_t&>().emplace_back();
  }

  bool pass_on() {
    if (!way_.empty() && way_.back().is_list) ++way_.back().index;
    return true;
  }

  bool add(JsonValue value) {
    if (!count()) return false;
    place() = std::move(value);
    return pass_on();
  }

  bool open(JsonValue empty, bool is_list) {
    if (open_.size() == deepest_json)
      return refuse(fmt::format("the file's JSON is nested more than {} deep", deepest_json));
    if (!count()) return false;
    JsonValue& value = place();
    value = std::move(empty);
    open_.push_back(&value);
    way_.push_back({.is_list = is_list});
    return true;
  }

  bool close() {
    open_.pop_back();
    way_.pop_back();
    return pass_on();
  }

  std::string_view text_, kind_;
  std::size_t most_values_;
  const TakeJsonText& take_text_;
  const Progress& progress_;
  JsonValue root_;
  EmptiedJson end_{root_};
  std::vector<JsonValue*> open_;  // objects and lists, the innermost last: the one that grows
  std::vector<JsonStep> way_;     // in each of them, to the next value
  JsonValue* member_ = nullptr;   // the value of the last key
  std::size_t value_count_ = 0;
  Error error_;
};

}  // namespace

EmptiedJson::~EmptiedJson() { empty(value_); }

Result<JsonValue> parse_json(std::string_view text, std::string_view kind,
                             const StopRequest& should_stop, std::size_t most_values,
                             const TakeJsonText& take_text) {
  // The parser takes a NUL for the end of the text. Some writers of glTF fill up with them.
  constexpr std::size_t most_filled = 3;
  const std::size_t end = std::min(text.find('\0'), text.size());
  if (text.size() - end > most_filled ||
      text.find_first_not_of('\0', end) != std::string_view::npos)
    return invalid(fmt::format("the file is not {}: it has a NUL byte", kind));
  text = text.substr(0, end);
  Progress progress{text.data(), StopPoll(should_stop)};
  JsonBuilder builder(text, kind, most_values, take_text, progress);
  const char* const last = text.data() + text.size();
  const bool is_parsed = JsonValue::sax_parse(StoppingText(text.data(), last, progress),
                                              StoppingText(last, last, progress), &builder);
  if (progress.stop.after(0)) return interrupted();
  if (!is_parsed) return fail(builder.error());
  return builder.take();
}

std::string JsonReader::place() const {
  std::string text;
  for (const auto& [key, index] : place_) {
    text += fmt::format("{}{}", text.empty() ? "" : ".", key);
    if (index) text += fmt::format("[{}]", *index);
  }
  return text;
}

void JsonReader::refuse(std::string_view key, std::string_view rule) {
  if (fault_) return;
  const std::string at = place();
  fault_ = fmt::format("{}{}{} {}", at, at.empty() || key.empty() ? "" : ".", key, rule);
}

tl::unexpected<Error> JsonReader::fault() {
  if (is_interrupted_) return interrupted();
  return invalid(*fault_);
}

bool JsonReader::goes_on() {
  constexpr std::size_t parts_of_element = 64;
  if (stop_.after(parts_of_element)) end();
  return !fault_;
}

JsonReader::Json* JsonReader::member(JsonValue& object, const char* key) {
  const auto found = object.find(key);
  return found == object.end() ? nullptr : &*found;
}

JsonReader::Json* JsonReader::part(JsonValue& parent, const char* key) {
  JsonValue* const json = member(parent, key);
  if (!json || json->is_object()) return json;
  refuse(key, "is not an object");
  return nullptr;
}

JsonReader::Json* JsonReader::required_part(JsonValue& parent, const char* key) {
  if (!member(parent, key)) refuse(key, "is missing");
  return part(parent, key);
}

std::optional<std::string> JsonReader::text(JsonValue& parent, const char* key) {
  JsonValue* const json = member(parent, key);
  if (!json) return {};
  if (auto* const written = json->get_ptr<std::string*>()) return std::move(*written);
  refuse(key, "is not text");
  return {};
}

std::string JsonReader::required_text(JsonValue& parent, const char* key) {
  if (!member(parent, key)) refuse(key, "is missing");
  return text(parent, key).value_or("");
}

std::vector<std::string> JsonReader::texts(JsonValue& parent, const char* key) {
  std::vector<std::string> texts;
  JsonValue* const list = member(parent, key);
  if (!list) return texts;
  if (!list->is_array()) refuse(key, "is not a list");
  for (std::size_t k = 0; k < list->size() && goes_on(); ++k) {
    auto* const written = (*list)[k].get_ptr<std::string*>();
    if (!written) refuse(key, "has an element that is not text");
    if (written) texts.push_back(std::move(*written));
  }
  return texts;
}

std::vector<std::string> JsonReader::required_texts(JsonValue& parent, const char* key) {
  if (!member(parent, key)) refuse(key, "is missing");
  return texts(parent, key);
}

Hash JsonReader::required_hash(JsonValue& parent, const char* key) {
  const auto hash = to_hash(required_text(parent, key));
  if (!hash) refuse(key, "is not a hash");
  return hash.value_or(Hash());
}

std::optional<std::uint64_t> JsonReader::to_whole(const JsonValue& json) {
  return json.is_number_unsigned() ? std::optional(json.get<std::uint64_t>()) : std::nullopt;
}

std::optional<std::uint64_t> JsonReader::whole(JsonValue& parent, const char* key) {
  const JsonValue* const json = member(parent, key);
  if (!json) return {};
  const auto number = to_whole(*json);
  if (!number) refuse(key, "is not a whole number of at least 0");
  return number;
}

std::uint64_t JsonReader::required_whole(JsonValue& parent, const char* key) {
  if (!member(parent, key)) refuse(key, "is missing");
  return whole(parent, key).value_or(0);
}

std::vector<std::uint64_t> JsonReader::wholes(JsonValue& parent, const char* key) {
  std::vector<std::uint64_t> numbers;
  const JsonValue* const list = member(parent, key);
  if (!list) return numbers;
  if (!list->is_array()) refuse(key, "is not a list");
  for (std::size_t k = 0; k < list->size() && goes_on(); ++k) {
    const auto number = to_whole((*list)[k]);
    if (!number) refuse(key, "has an element that is not a whole number of at least 0");
    if (number) numbers.push_back(*number);
  }
  return numbers;
}

std::int64_t JsonReader::required_integer(JsonValue& parent, const char* key, std::int64_t least,
                                          std::int64_t most) {
  const JsonValue* const json = member(parent, key);
  if (!json) refuse(key, "is missing");
  const auto number = json ? to_integer(*json) : std::nullopt;
  if (!number || *number < least || *number > most)
    refuse(key, fmt::format("is not a whole number from {} to {}", least, most));
  return number.value_or(0);
}

int JsonReader::required_int(JsonValue& parent, const char* key, int least) {
  return static_cast<int>(required_integer(parent, key, least, std::numeric_limits<int>::max()));
}

// As an std::int64_t a number that is too large would wrap round.
std::optional<std::int64_t> JsonReader::to_integer(const JsonValue& json) {
  const auto whole = to_whole(json);
  if (whole && !std::in_range<std::int64_t>(*whole)) return {};
  return json.is_number_integer() ? std::optional(json.get<std::int64_t>()) : std::nullopt;
}

double JsonReader::required_number(JsonValue& parent, const char* key) {
  const JsonValue* const json = member(parent, key);
  if (!json || !json->is_number()) refuse(key, json ? "is not a number" : "is missing");
  return json && json->is_number() ? json->get<double>() : 0;
}

std::optional<std::vector<double>> JsonReader::numbers(JsonValue& parent, const char* key,
                                                       std::size_t count) {
  const JsonValue* const list = member(parent, key);
  if (!list) return {};
  std::vector<double> values(count);
  bool is_sound = list->is_array() && list->size() == count;
  for (std::size_t k = 0; is_sound && k < count; ++k) {
    const JsonValue& number = (*list)[k];
    is_sound = number.is_number();
    if (is_sound) values[k] = number.get<double>();
  }
  if (!is_sound) refuse(key, fmt::format("is not a list of {} numbers", count));
  return values;
}

std::size_t JsonReader::list_size(const char* key) const {
  const JsonValue* const list = member(root_, key);
  return list && list->is_array() ? list->size() : 0;
}

}  // namespace pliant
