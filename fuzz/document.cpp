// A scene and operations on it: the first part of the input, before a line of %%, is the text, and
// each line behind it an operation, by its letter and fields between bars; `u` takes one back, `~`
// drops the last one, and before an operation amends it. Whatever is done: an accepted text can be
// read, a refused operation changes nothing, and edits can be taken back and made again to the
// byte.

#include "pliant/document/document.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "pliant/core/text.hpp"
#include "pliant/document/format_scene.hpp"
#include "pliant/document/properties.hpp"
#include "pliant/scene/channels.hpp"
#include "tiny_scene.hpp"

using namespace pliant;
using namespace pliant::fuzzing;

namespace {

constexpr std::size_t most_operations = 12;

/// The fields of a line. Those that are missing are empty.
class Fields {
 public:
  Fields(std::string_view line, const Scene& scene)
      : scene_(scene), fields_(parts_between(line, "|")) {}

  std::string_view field() { return next_ < fields_.size() ? fields_[next_++] : ""; }
  std::string text() { return std::string(field()); }
  /// `@3`: a channel of the scene.
  std::string path() { return named(field()); }
  std::optional<std::string> maybe_text() {
    std::string field = text();
    return field.empty() ? std::nullopt : std::optional(std::move(field));
  }
  double number(double otherwise = 0) { return to_double(field(), otherwise); }
  std::vector<double> numbers() {
    std::vector<double> numbers;
    for (const std::string_view word : words(field(), " ")) numbers.push_back(to_double(word, 0));
    return numbers;
  }
  std::vector<std::string> paths() {
    std::vector<std::string> paths;
    for (const std::string_view word : words(field(), " ")) paths.push_back(named(word));
    return paths;
  }
  /// `a.b 1 2,c.d 3`
  std::vector<edit::KeysOf> keys() {
    std::vector<edit::KeysOf> keys;
    for (const std::string_view one : words(field(), ",")) {
      edit::KeysOf& selected = keys.emplace_back();
      for (const std::string_view word : words(one, " ")) {
        if (selected.channel.empty())
          selected.channel = named(word);
        else
          selected.frames.push_back(to_double(word, 0));
      }
    }
    return keys;
  }
  /// `1 5,2 6,8 3`: frames and values, sorted or not
  template <int D>
  CurveKeys<D> keys_of_a_curve() {
    CurveKeys<D> curve;
    for (const std::string_view one : words(field(), ",")) {
      Key<D>& key = curve.keys.emplace_back();
      std::vector<double> numbers;
      for (const std::string_view word : words(one, " ")) numbers.push_back(to_double(word, 0));
      numbers.resize(1 + D);
      key.frame = numbers[0];
      std::copy_n(numbers.begin() + 1, D, key.value.begin());
    }
    return curve;
  }
  /// `a=1,b=2`
  std::vector<edit::Given> attributes() {
    std::vector<edit::Given> attributes;
    for (const std::string_view one : words(field(), ",")) {
      const std::size_t sign = std::min(one.find('='), one.size() - 1);
      attributes.emplace_back(one.substr(0, sign), one.substr(sign + 1));
    }
    return attributes;
  }
  edit::Side side() {
    const std::string_view side = field();
    return side == "in" ? edit::Side::In : side == "out" ? edit::Side::Out : edit::Side::Both;
  }

 private:
  static double to_double(std::string_view text, double otherwise) {
    if (text == "inf") return std::numeric_limits<double>::infinity();
    if (text == "nan") return std::numeric_limits<double>::quiet_NaN();
    return to_number(text).value_or(otherwise);
  }
  static std::vector<std::string_view> words(std::string_view text, std::string_view between) {
    std::vector<std::string_view> words = parts_between(text, between);
    std::erase(words, "");
    return words;
  }
  std::string named(std::string_view word) const {
    if (!word.starts_with('@')) return std::string(word);
    const auto channels = channels_of(scene_);
    const auto index = to_integer(word.substr(1));
    if (channels.empty() || !index || *index < 0) return std::string(word);
    return channels[static_cast<std::size_t>(*index) % channels.size()].path;
  }

  const Scene& scene_;
  std::vector<std::string_view> fields_;
  std::size_t next_ = 0;
};

std::optional<double> maybe(double number) {
  return std::isnan(number) ? std::nullopt : std::optional(number);
}

/// The members of each are in the order of `operation.hpp`.
std::optional<Operation> operation_of(std::string_view line, const Scene& scene) {
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (line.empty()) return {};
  Fields in(line.substr(1), scene);
  switch (line[0]) {
    case 'S':
      return edit::Set{in.path(), in.text()};
    case 'R':
      return edit::Reset{in.path()};
    case 'A':
      return edit::Animate{in.paths(), in.number()};
    case 'F':
      return edit::Freeze{in.paths(), in.number()};
    case 'k':
      return edit::SetKey{in.path(), in.number(), in.maybe_text()};
    case 'd':
      return edit::DeleteKeys{in.keys()};
    case 'm':
      return edit::MoveKeys{in.keys(), in.number(), in.numbers(),
                            in.field() == "!" ? edit::Collision::Replace : edit::Collision::Refuse};
    case 'z':
      return edit::ScaleKeys{
          in.keys(),
          in.number(),
          in.number(1),
          in.numbers(),
          in.numbers(),
          in.number(),
          in.field() == "!" ? edit::Collision::Replace : edit::Collision::Refuse};
    case 't':
      return edit::SetTangent{in.keys(), in.side(), in.maybe_text(), in.maybe_text()};
    case 'h':
      return edit::SetHandle{in.path(), in.number(),
                             in.field() == "in" ? edit::Side::In : edit::Side::Out, in.text()};
    case 'i':
      return edit::SetInterpolation{in.keys(),       in.text(),       in.maybe_text(),
                                    in.maybe_text(), in.maybe_text(), in.maybe_text()};
    case 'x':
      return edit::SetExtrapolation{in.paths(), in.maybe_text(), in.maybe_text()};
    case 'b':
      return edit::BakeKeys{in.paths(), in.number(), in.number(), in.number(1), in.field() == "l"};
    case 's':
      return edit::SimplifyKeys{in.paths(), in.number(), maybe(in.number(none)),
                                maybe(in.number(none))};
    case 'c':
      return edit::Scale{in.paths(), in.number(1),
                         static_cast<int>(std::clamp(in.number(), 0.0, 17.0))};
    case 'C':
      return edit::SetCurve{in.path(), in.keys_of_a_curve<1>()};
    case 'V':
      return edit::SetCurve{in.path(), in.keys_of_a_curve<3>()};
    case 'l':
      return edit::Splice{in.path(), in.number(), in.number(), in.keys_of_a_curve<1>()};
    case 'L':
      return edit::Splice{in.path(), in.number(), in.number(), in.keys_of_a_curve<3>()};
    case 'p':
      return edit::SetPart{in.text(), in.text(), in.attributes(), in.text()};
    case '+':
      return edit::Add{in.text(), in.text(), in.attributes(), in.text(), in.text()};
    case '2':
      return edit::Duplicate{in.text(), in.text()};
    case '-':
      return edit::Delete{in.paths()};
    case 'N':
      return edit::Rename{in.text(), in.text()};
    case 'T':
      return edit::Target{in.paths(), in.paths()};
    case 'G':
      return edit::Group{in.paths(), in.text(), in.attributes()};
    case 'U':
      return edit::Ungroup{in.paths()};
    default:
      return {};
  }
}

/// A scene that takes no longer than it should: an operation may make it long.
Result<void> check_short(const Scene& scene) {
  if (is_short(scene)) return {};
  return fail(ErrorCode::InvalidInput, "too many frames for a fuzzer", "fuzz.xml");
}

/// The edits of the document, as texts.
using Texts = std::vector<std::string>;

void check_change(const Change& change, std::string text, const std::string& after) {
  require(!change.name.empty());
  for (const TextEdit& edit : change.edits) {
    require(text.compare(edit.at, edit.removed.size(), edit.removed) == 0);
    text.replace(edit.at, edit.removed.size(), edit.inserted);
  }
  require(text == after);
  require(std::ranges::is_sorted(change.parts));
}

void operate(SceneDocument& document, const std::vector<Operation>& operations, bool amends,
             Texts& texts) {
  const std::string before = document.text();
  const auto change = amends ? document.amend(operations) : document.apply(operations);
  if (!change) {
    check_error(change.error(), any_number);
    require(document.text() == before);
    return;
  }
  const std::string& after = document.text();
  check_change(*change, before, after);
  if (amends) texts.pop_back();
  if (after != texts.back()) texts.push_back(after);
}

void check_history(SceneDocument& document, const Texts& texts) {
  const bool was_undone = document.can_redo();
  for (std::size_t edit = texts.size(); edit-- > 1;) {
    const auto undone = document.undo();
    require(undone.has_value());
    check_change(*undone, texts[edit], texts[edit - 1]);
    require(document.text() == texts[edit - 1]);
  }
  require(!document.can_undo() && !document.undo().has_value());
  for (std::size_t edit = 1; edit < texts.size(); ++edit) {
    require(document.can_redo() && document.redo().has_value());
    require(document.text() == texts[edit]);
  }
  require(document.can_redo() == was_undone);
}

/// What was accepted can be read; another layout is the same scene, and stays.
void check_text(const SceneDocument& document) {
  require(parse_scene(document.text(), "fuzz.xml", PLIANT_FUZZ_MESHES).has_value());
  const auto formatted = format_scene(document.text(), "fuzz.xml");
  require(formatted.has_value());
  const auto again = format_scene(*formatted, "fuzz.xml");
  require(again && *again == *formatted);
  const auto read = parse_scene(*formatted, "fuzz.xml", PLIANT_FUZZ_MESHES);
  require(read.has_value());
  const auto text = to_xml(document.scene());
  const auto text_of_formatted = to_xml(*read);
  require(text.has_value() == text_of_formatted.has_value());
  if (text) require(*text == *text_of_formatted);
  require(properties_json(document).has_value());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
  const std::string_view input = text_of(bytes, size);
  const std::size_t end = std::min(input.find("\n%%\n"), input.size());
  const std::string text(input.substr(0, end));
  const auto scene = parse_scene(text, "fuzz.xml", PLIANT_FUZZ_MESHES);
  if (!scene || !is_short(*scene)) return 0;
  auto document =
      SceneDocument::from_text(text, "fuzz.xml", PLIANT_FUZZ_MESHES, {.check = check_short});
  if (!document) return check_error(document.error(), any_number), 0;
  require(document->text() == text);

  Texts texts = {text};
  auto lines = parts_between(input.substr(std::min(end + 4, input.size())), "\n");
  lines.resize(std::min(lines.size(), most_operations));
  for (std::string_view line : lines) {
    if ((line == "u" || line == "~") && document->can_undo()) {
      const auto change = line == "u" ? document->undo() : document->drop();
      require(change.has_value());
      check_change(*change, texts.back(), texts.end()[-2]);
      texts.pop_back();
      require(document->text() == texts.back());
      continue;
    }
    const bool amends = line.starts_with('~') && document->can_undo();
    if (amends) line.remove_prefix(1);
    if (const auto operation = operation_of(line, document->scene())) {
      require(!described(*operation).empty());
      operate(*document, {*operation}, amends, texts);
    }
  }
  check_text(*document);
  check_history(*document, texts);
  return 0;
}
