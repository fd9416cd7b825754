#include "pliant/scene/text/markup.hpp"

#include <algorithm>
#include <charconv>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/expects.hpp"
#include "pliant/core/text.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

// Far above any real scene. Readers compare each attribute of an element with all others.
constexpr std::size_t longest_name = 100;
constexpr std::size_t most_attributes = 100;  // per element
constexpr std::size_t longest_attribute = std::size_t{4} << 20U;

constexpr std::size_t stretch = std::size_t{1} << 16U;  // bytes that are looked at without asking

/// Where a text breaks the rules of UTF-8 or XML, and how.
struct EncodingFault {
  std::size_t at = 0;  ///< byte offset
  std::string message;
};

/// The first byte that is not valid UTF-8, or the first control character that XML does not allow.
std::optional<EncodingFault> find_encoding_fault(std::string_view text, Findings& findings) {
  if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
    return EncodingFault{0, "the file is UTF-16; save it as UTF-8"};
  for (std::size_t at = 0, asked = 0; at < text.size();) {
    if (at - asked >= stretch) {
      if (findings.is_over(at - asked)) return std::nullopt;
      asked = at;
    }
    const auto byte = static_cast<unsigned char>(text[at]);
    if (byte >= 0x20 && byte < 0x80) {
      ++at;
      continue;
    }
    if (byte == 0)
      return EncodingFault{at, "the file contains a NUL byte; a scene must be text in UTF-8"};
    if (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r')
      return EncodingFault{
          at,
          fmt::format("the file contains the control character 0x{:02X}, which XML does not allow",
                      byte)};
    const std::size_t length = length_of_character(text.substr(at));
    if (length == 0)
      return EncodingFault{
          at, fmt::format("the byte 0x{:02X} is not UTF-8; save the file as UTF-8", byte)};
    at += length;
  }
  return std::nullopt;
}

/// Whether XML allows this code point in a document.
bool is_xml_character(char32_t code_point) {
  return code_point == '\t' || code_point == '\n' || code_point == '\r' ||
         (code_point >= 0x20 && code_point <= 0xD7FF) ||
         (code_point >= 0xE000 && code_point <= 0xFFFD) ||
         (code_point >= 0x10000 && code_point <= 0x10FFFF);
}

bool begins_name(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || c == ':' ||
         static_cast<unsigned char>(c) >= 0x80;
}

bool continues_name(char c) {
  return begins_name(c) || (c >= '0' && c <= '9') || c == '-' || c == '.';
}

/// Whether `&…;` without its & and ; stands for a character.
bool is_reference(std::string_view name) {
  if (!name.starts_with('#'))
    return name == "amp" || name == "lt" || name == "gt" || name == "quot" || name == "apos";
  const bool is_hex = name.starts_with("#x");
  const std::string_view digits = name.substr(is_hex ? 2 : 1);
  std::uint32_t code_point = 0;
  const auto [stop, failure] =
      std::from_chars(digits.data(), digits.data() + digits.size(), code_point, is_hex ? 16 : 10);
  return failure == std::errc() && stop == digits.data() + digits.size() &&
         is_xml_character(code_point);
}

/// Scans a text once, tag by tag. Places are offsets.
class MarkupScanner {
 public:
  MarkupScanner(Findings& findings, int text, std::size_t most,
                std::span<const std::string_view> roots)
      : text_(findings.sources().text(text)),
        findings_(findings),
        index_(text),
        most_(most),
        roots_(roots) {
    if (stands(byte_order_mark)) at_ = byte_order_mark.size();
  }

  Markup scan();

 private:
  void scan_text();
  void scan_comment();
  void scan_cdata();
  void scan_doctype();
  void scan_instruction();
  void scan_closing_tag();
  void scan_opening_tag();
  bool scan_attribute();
  void check_references(std::string_view text);
  void finish();

  bool at_end() const { return at_ == text_.size(); }
  char next() const { return text_[at_]; }
  bool stands(std::string_view ahead) const { return text_.substr(at_).starts_with(ahead); }
  void skip_blanks();
  std::string_view take(std::size_t count);
  std::string_view take_name();
  /// The text before `end`, then skips `end`; a problem if the file ends first.
  std::string_view take_until(std::string_view end, std::string_view what);

  std::size_t offset_of(std::string_view part) const { return part.data() - text_.data(); }
  TextRange range_of(std::string_view part) const {
    const auto begin = static_cast<std::uint32_t>(offset_of(part));
    return {begin, begin + static_cast<std::uint32_t>(part.size())};
  }

  bool has_root() const { return !markup_.elements.empty(); }
  bool may_be_root(std::string_view name) const {
    if (roots_.empty()) return name == "scene";
    return std::find(roots_.begin(), roots_.end(), name) != roots_.end();
  }
  std::string_view root() const { return roots_.empty() ? "<scene>" : "root element"; }
  std::string_view one_root() const {
    return roots_.empty() ? "; a scene file must contain one <scene>"
                          : "; a file that is included must contain one element";
  }
  ElementPlace& innermost() { return markup_.elements[open_.back()]; }
  std::string_view name_of(const ElementPlace& element) const { return element.name.of(text_); }
  /// Whether there are too many elements and attributes, the last one at `where`; if so, stops.
  bool is_over_limit(std::size_t where) {
    if (markup_.elements.size() + markup_.attributes.size() <= most_) return false;
    stop(where, fmt::format("the file has more than {} elements and attributes", most_));
    return true;
  }
  /// `<name> of line 3`.
  std::string title(const ElementPlace& element) const {
    return fmt::format("<{}> of line {}", name_of(element), line_of(element.name.begin));
  }

  /// From an offset to the end of the tag or line.
  TextPlace place_of(std::size_t where) const {
    constexpr std::size_t longest = 200;
    std::string_view part = text_.substr(where, longest);
    part = part.substr(0, part.find_first_of("\r\n"));
    part = part.substr(0, std::min(part.find('>'), part.size() - 1) + 1);
    return {index_, range_of(part)};
  }
  int line_of(std::size_t where) const {
    return findings_.sources().place_of(place_of(where)).line;
  }

  // Messages do not quote a file that is probably not a scene.
  void add(std::size_t where, std::string_view message) {
    const bool is_other = has_root() && !may_be_root(name_of(markup_.elements.front()));
    if (is_other && is_stopped_) return;
    findings_.add_problem(place_of(where),
                          is_other ? fmt::format("malformed XML, and the root element is not {}",
                                                 roots_.empty() ? "<scene>" : "one of a scene")
                                   : fmt::format("malformed XML: {}", message));
    is_stopped_ = is_stopped_ || is_other;
  }
  /// Whether to end, after the work of some bytes; stops then.
  bool asks_to_end(std::size_t bytes) {
    is_stopped_ = is_stopped_ || findings_.is_over(bytes);
    return is_stopped_;
  }
  /// Adds a problem after which the rest cannot be parsed, and stops.
  void stop(std::size_t where, std::string_view message) {
    if (is_stopped_) return;
    add(where, message);
    is_stopped_ = true;
  }

  std::string_view text_;
  Findings& findings_;
  int index_;                                // of the text
  std::size_t most_;                         // elements and attributes
  std::span<const std::string_view> roots_;  // empty: a scene
  std::size_t at_ = 0;
  Markup markup_;
  std::vector<std::uint32_t> open_;  // indices of elements, from the root inwards
  bool is_prologue_ = true;          // only the declaration and other instructions so far
  bool is_stopped_ = false;
};

std::string_view MarkupScanner::take(std::size_t count) {
  const std::string_view taken = text_.substr(at_, count);
  at_ += taken.size();
  return taken;
}

void MarkupScanner::skip_blanks() { at_ = first_not_blank(text_, at_, findings_); }

std::string_view MarkupScanner::take_name() {
  std::size_t end = at_;
  if (end < text_.size() && begins_name(text_[end]))
    while (end < text_.size() && continues_name(text_[end]) && end - at_ <= longest_name) ++end;
  if (end - at_ > longest_name)
    stop(at_, fmt::format("the name {} has more than {} bytes",
                          in_quotes(text_.substr(at_, end - at_)), longest_name));
  return take(end - at_);
}

std::string_view MarkupScanner::take_until(std::string_view end, std::string_view what) {
  const std::size_t found = find_from(text_, end, at_, findings_);
  if (found == std::string_view::npos) {
    stop(text_.size(),
         fmt::format("the file ends inside {} that begins at line {}", what, line_of(at_)));
    return {};
  }
  const std::string_view taken = take(found - at_);
  take(end.size());
  return taken;
}

Markup MarkupScanner::scan() {
  if (const auto fault = find_encoding_fault(text_.substr(at_), findings_)) {
    findings_.add_problem(place_of(at_ + fault->at), fault->message);
    is_stopped_ = true;
  }
  constexpr std::size_t parts_of_mark = 64;  // besides those of its bytes
  for (std::size_t before = at_; !at_end() && !is_stopped_;) {
    if (asks_to_end(at_ - before + parts_of_mark)) break;
    before = at_;
    if (next() != '<')
      scan_text();
    else if (stands("<!--"))
      scan_comment();
    else if (stands("<![CDATA["))
      scan_cdata();
    else if (stands("<!DOCTYPE"))
      scan_doctype();
    else if (stands("<?"))
      scan_instruction();
    else if (stands("</"))
      scan_closing_tag();
    else
      scan_opening_tag();
  }
  if (!is_stopped_) finish();
  return std::move(markup_);
}

void MarkupScanner::finish() {
  if (!open_.empty())
    return stop(at_,
                fmt::format("the file ends inside {}, which is not closed", title(innermost())));
  if (has_root()) return;
  if (text_.find('<') == std::string_view::npos)
    return findings_.add_problem(place_of(0), fmt::format("the file is empty{}", one_root()));
  stop(at_, fmt::format("the file contains no element{}", one_root()));
}

void MarkupScanner::scan_text() {
  if (open_.empty()) skip_blanks();
  const std::string_view text = take(std::min(text_.find('<', at_), text_.size()) - at_);
  check_references(text);
  if (open_.empty() && !text.empty())
    stop(offset_of(text),
         has_root() ? fmt::format("the text {} is outside the {}", in_quotes(trimmed(text)), root())
                    : fmt::format("there is text before the {}{}", root(), one_root()));
}

void MarkupScanner::scan_comment() {
  is_prologue_ = false;
  take(4);
  take_until("-->", "a comment");
}

void MarkupScanner::scan_cdata() {
  if (open_.empty()) return stop(at_, fmt::format("a CDATA section is outside the {}", root()));
  take(9);
  take_until("]]>", "a CDATA section");
}

void MarkupScanner::scan_doctype() {
  const std::size_t start = at_;
  is_prologue_ = false;
  if (has_root())
    return stop(start, fmt::format("a DOCTYPE is allowed only before the {}", root()));
  const std::string_view text = take_until(">", "a DOCTYPE");
  if (text.find('[') != std::string_view::npos)
    stop(start,
         "a DOCTYPE with declarations of its own [...] is not supported: its entities "
         "would not be read");
}

void MarkupScanner::scan_instruction() {
  const std::size_t start = at_;
  if (!is_prologue_)
    return stop(start,
                "the XML declaration and processing instructions must come before everything else");
  take(2);
  const std::string_view name = take_name();
  const std::string_view text = take_until("?>", "an XML declaration or processing instruction");
  if (is_stopped_ || name != "xml") return;
  const std::size_t encoding = text.find("encoding");
  const std::size_t quote = text.find_first_of("\"'", encoding);
  if (encoding == std::string_view::npos || quote == std::string_view::npos) return;
  const std::string_view value =
      text.substr(quote + 1, text.find(text[quote], quote + 1) - quote - 1);
  std::string upper(value);
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  if (upper == "UTF-8" || upper == "US-ASCII" || upper == "ASCII") return;
  // The text may be of any file: only names of encodings are told.
  bool is_known = false;
  for (const std::string_view family : {"UTF-", "ISO-8859-", "WINDOWS-", "LATIN", "LATIN-"}) {
    is_known =
        is_known || (upper.starts_with(family) &&
                     upper.find_first_not_of("0123456789", family.size()) == std::string::npos);
  }
  stop(start, fmt::format("the encoding {}is not supported; save the file as UTF-8",
                          is_known ? in_quotes(value) + ' ' : std::string()));
}

void MarkupScanner::scan_closing_tag() {
  const std::size_t start = at_;
  take(2);
  const std::string_view name = take_name();
  skip_blanks();
  if (at_end()) return stop(at_, "the file ends inside a closing tag");
  if (name.empty() || next() != '>')
    return stop(start, fmt::format("a closing tag must be </name>, not {}",
                                   in_quotes(fmt::format("</{}{}", name, next()))));
  take(1);
  if (open_.empty()) {
    return stop(start, has_root() ? fmt::format("</{}> has no opening tag", name)
                                  : fmt::format("there is a closing tag before the {}", root()));
  }
  if (name_of(innermost()) != name)
    return stop(start, fmt::format("</{}> comes before {} is closed", name, title(innermost())));
  innermost().end = static_cast<std::uint32_t>(at_);
  open_.pop_back();
}

void MarkupScanner::scan_opening_tag() {
  const std::size_t start = at_;
  is_prologue_ = false;
  take(1);
  const std::string_view name = take_name();
  if (name.empty())
    return stop(start, at_end() ? std::string("the file ends inside a tag")
                                : fmt::format("{} does not begin a tag; write a literal < as &lt;",
                                              in_quotes(fmt::format("<{}", next()))));
  if (open_.empty() && has_root())
    return stop(start, fmt::format("<{}> is outside the root element; a file must contain one {}",
                                   name, roots_.empty() ? "<scene>" : "element"));
  const auto index = static_cast<std::uint32_t>(markup_.elements.size());
  markup_.elements.push_back(
      {.name = range_of(name),
       .parent = open_.empty() ? ElementPlace::no_parent : open_.back(),
       .first_attribute = static_cast<std::uint32_t>(markup_.attributes.size())});
  if (open_.size() >= deepest_element) return stop(start, nested_too_deep(name));
  if (is_over_limit(start)) return;

  ElementPlace& element = markup_.elements.back();
  for (;;) {
    const std::size_t before = at_;
    skip_blanks();
    if (at_end()) return stop(at_, fmt::format("the file ends inside the tag {}", title(element)));
    const bool closes_itself = stands("/>");
    if (closes_itself || next() == '>') {
      take(closes_itself ? 2 : 1);
      element.tag_end = element.end = static_cast<std::uint32_t>(at_);
      if (!closes_itself) open_.push_back(index);
      return;
    }
    if (at_ == before && markup_.attributes.size() > element.first_attribute && begins_name(next()))
      return stop(at_, fmt::format("a space is missing after the value of {} in <{}>",
                                   in_quotes(markup_.attributes.back().name.of(text_)), name));
    if (!scan_attribute()) return;
  }
}

/// Reads one `name="value"` of the last element. Returns whether the rest of the tag can be read.
bool MarkupScanner::scan_attribute() {
  const std::size_t start = at_;
  const ElementPlace& element = markup_.elements.back();
  const std::string_view owner = name_of(element);
  const std::string_view name = take_name();
  const auto refuse = [&](std::size_t where, std::string_view message) {
    stop(where, message);
    return false;
  };
  const auto ends = [&] {
    return refuse(at_, fmt::format("the file ends inside the tag {}", title(element)));
  };
  if (name.empty())
    return refuse(start,
                  fmt::format("{} in <{}> is not an attribute; a quote or > is missing before it",
                              in_quotes(text_.substr(at_, 1)), owner));
  skip_blanks();
  if (at_end()) return ends();
  if (next() != '=')
    return refuse(start, fmt::format("the attribute {} of <{}> has no value; write {}=\"…\"",
                                     in_quotes(name), owner, name));
  take(1);
  skip_blanks();
  if (at_end()) return ends();
  const char quote = next();
  if (quote != '"' && quote != '\'')
    return refuse(start,
                  fmt::format("the value of {} in <{}> is not in quotes", in_quotes(name), owner));
  take(1);
  const std::size_t closing = text_.find(quote, at_);
  const std::string_view value = text_.substr(at_, closing - at_);
  if (value.find('<') != std::string_view::npos)
    return refuse(start, fmt::format("the value of {} in <{}> has no closing quote before the next "
                                     "<; write a literal < as &lt;",
                                     in_quotes(name), owner));
  if (closing == std::string_view::npos)
    return refuse(text_.size(),
                  fmt::format("the file ends inside the value of {} in <{}> of line {}",
                              in_quotes(name), owner, line_of(start)));
  if (value.size() > longest_attribute)
    return refuse(start, fmt::format("the value of {} in <{}> has more than {} MiB",
                                     in_quotes(name), owner, longest_attribute >> 20U));
  check_references(value);
  take(value.size() + 1);
  const std::span<const AttributePlace> others = markup_.attributes_of(markup_.elements.size() - 1);
  if (std::any_of(others.begin(), others.end(),
                  [&](const AttributePlace& other) { return other.name.of(text_) == name; }))
    add(start, fmt::format("<{}> has the attribute {} twice", owner, in_quotes(name)));
  if (others.size() == most_attributes)
    return refuse(start, fmt::format("<{}> has more than {} attributes", owner, most_attributes));
  markup_.attributes.push_back({range_of(name), range_of(value)});
  return !is_over_limit(start);
}

void MarkupScanner::check_references(std::string_view text) {
  constexpr std::size_t longest = 12;  // enough for &#x10FFFF; with a few leading zeros
  for (std::size_t at = text.find('&'); at != std::string_view::npos; at = text.find('&', at + 1)) {
    if (asks_to_end(longest)) return;
    const std::size_t where = offset_of(text) + at;
    const std::size_t end = text.substr(at, longest).find(';');
    if (end == std::string_view::npos)
      add(where, "\"&\" does not begin an entity; write a literal & as &amp;");
    else if (!is_reference(text.substr(at + 1, end - 1)))
      add(where, fmt::format("{} is not a known entity; write a literal & as &amp;",
                             in_quotes(text.substr(at, end + 1))));
  }
}

}  // namespace

std::span<const AttributePlace> Markup::attributes_of(std::size_t element) const {
  const std::size_t first = elements[element].first_attribute;
  const std::size_t last =
      element + 1 < elements.size() ? elements[element + 1].first_attribute : attributes.size();
  return std::span(attributes).subspan(first, last - first);
}

const AttributePlace* Markup::attribute_of(std::size_t element, std::string_view name,
                                           std::string_view text) const {
  const std::span<const AttributePlace> own = attributes_of(element);
  const auto found =
      std::ranges::find_if(own, [&](const auto& one) { return one.name.of(text) == name; });
  return found == own.end() ? nullptr : &*found;
}

std::string nested_too_deep(std::string_view element) {
  return fmt::format("<{}> is nested deeper than {} elements", element, deepest_element);
}

std::size_t Markup::after(std::size_t element) const {
  const std::size_t next = element + 1;
  const std::uint32_t end = elements[element].end;
  if (next == elements.size() || end <= elements[next].name.begin) return next;
  const auto found = std::upper_bound(
      elements.begin() + static_cast<std::ptrdiff_t>(next), elements.end(), end,
      [](std::uint32_t at, const ElementPlace& other) { return at <= other.name.begin; });
  return static_cast<std::size_t>(found - elements.begin());
}

std::optional<Markup> scan_markup(Findings& findings, int text, std::size_t most,
                                  std::span<const std::string_view> roots) {
  PLIANT_EXPECTS(findings.sources().text(text).size() < ElementPlace::no_parent);
  const std::size_t problems_before = findings.problem_count();
  Markup markup = MarkupScanner(findings, text, most, roots).scan();
  if (findings.problem_count() != problems_before) return std::nullopt;
  return markup;
}

Result<Markup> markup_of(std::string_view text, const std::string& name,
                         const StopRequest& should_stop) {
  if (text.size() > largest_scene_file)
    return fail(ErrorCode::InvalidInput,
                fmt::format("the scene would be larger than {} MiB", largest_scene_file >> 20U),
                name);
  Findings findings(name, SourceText::of(text), should_stop);
  auto markup = scan_markup(findings);
  if (!markup) return fail(findings.to_error());
  return *std::move(markup);
}

}  // namespace pliant::xml
