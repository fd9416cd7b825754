#include "pliant/scene/sharing/arithmetic.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "pliant/scene/sharing/expand.hpp"
#include "pliant/scene/text/text.hpp"

namespace pliant::xml {
namespace {

struct Token {
  static constexpr char operand = 'n';

  char kind = operand;  // or one of + - * / ( )
  bool has_blank_before = false;
  std::vector<double> numbers = {};  // of an operand
  std::string_view written = {};     // of an operand that may be kept as it is
};

bool is_operand_end(const Token& token) {
  return token.kind == Token::operand || token.kind == ')';
}

tl::unexpected<Complaint> syntax_fault(std::string message) {
  return tl::unexpected(Complaint{.message = std::move(message), .kind = Complaint::Kind::Syntax});
}

/// An operator or parenthesis at the start of a text, and its length; 0: none.
std::pair<char, std::size_t> sign_at(std::string_view text) {
  constexpr std::pair<std::string_view, char> signs[] = {{"+", '+'}, {"-", '-'}, {"*", '*'},
                                                         {"/", '/'}, {"(", '('}, {")", ')'},
                                                         {"−", '-'}, {"×", '*'}, {"÷", '/'}};
  for (const auto& [sign, kind] : signs)
    if (text.starts_with(sign)) return {kind, sign.size()};
  return {' ', 0};
}

using Tokens = std::vector<Token>;

constexpr std::size_t any = std::numeric_limits<std::size_t>::max();

/// The tokens of a value; null: it is not arithmetic, or has more than `most` numbers for certain.
/// Fault: a number that no double can hold.
class Tokenizer {
 public:
  explicit Tokenizer(std::size_t most) : most_(most) {}

  std::optional<Checked<Tokens>> read(std::span<const ValuePart> parts) {
    for (const ValuePart& part : parts) {
      const bool is_known = part.is_definition ? add_definition(part) : add_written(part.text);
      if (!is_known) return std::nullopt;
    }
    if (fault_) return tl::unexpected(*std::move(fault_));
    return std::move(tokens_);
  }

 private:
  // Returns whether it may stand here: two operands have a blank or an operator between them.
  bool add(Token token) {
    token.has_blank_before = std::exchange(has_blank_, false);
    const bool begins_operand = token.kind == Token::operand || token.kind == '(';
    if (begins_operand && !tokens_.empty() && is_operand_end(tokens_.back())) {
      if (!token.has_blank_before) return false;
      if (open_ == 0 && ++count_ > most_) return false;
    }
    open_ += token.kind == '(' ? 1 : token.kind == ')' ? -1 : 0;
    tokens_.push_back(std::move(token));
    return true;
  }

  bool add_definition(const ValuePart& part) {
    if (!part.numbers) return false;
    if (!part.numbers->has_value()) {
      if (!fault_) fault_ = part.numbers->error();
      return add({});
    }
    return add({.numbers = **part.numbers,
                .written = part.is_plain ? trimmed(part.text) : std::string_view()});
  }

  bool add_written(std::string_view text) {
    while (!text.empty()) {
      if (blanks.find(text.front()) != std::string_view::npos) {
        has_blank_ = true;
        text.remove_prefix(1);
        continue;
      }
      if (const auto [kind, length] = sign_at(text); length > 0) {
        if (!add({.kind = kind})) return false;
        text.remove_prefix(length);
        continue;
      }
      const bool begins_number =
          (text.front() >= '0' && text.front() <= '9') || (text.front() == '.' && text.size() > 1);
      if (!begins_number) return false;
      double number = 0;
      const auto [stop, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
      if (failure == std::errc::invalid_argument) return false;
      const auto length = static_cast<std::size_t>(stop - text.data());
      if (failure == std::errc::result_out_of_range && !fault_)
        fault_ = Complaint{0, fmt::format("{} is outside the range of numbers that can be stored",
                                          in_quotes(text.substr(0, length)))};
      if (!add({.numbers = {number}, .written = text.substr(0, length)})) return false;
      text.remove_prefix(length);
    }
    return true;
  }

  std::size_t most_;
  std::size_t count_ = 1;  // of numbers that nothing joins
  int open_ = 0;           // parentheses
  Tokens tokens_;
  std::optional<Complaint> fault_;
  bool has_blank_ = false;
};

/// One of the numbers of a value.
struct Component {
  std::vector<double> numbers;
  std::string_view written;  // empty: it was computed
};

/// Evaluates tokens by recursive descent.
class Evaluator {
 public:
  explicit Evaluator(const Tokens& tokens) : tokens_(tokens) {}

  Checked<std::vector<Component>> components() {
    std::vector<Component> components;
    while (!at_end()) {
      const std::size_t first = at_;
      Numbers numbers = sum(0);
      if (!numbers) return tl::unexpected(std::move(numbers.error()));
      const std::string_view written = at_ == first + 1 ? tokens_[first].written : "";
      components.push_back({*std::move(numbers), written});
      if (!at_end() && tokens_[at_].kind == ')') return syntax_fault("a \"(\" is missing");
    }
    return components;
  }

 private:
  bool at_end() const { return at_ == tokens_.size(); }
  bool stands(char one, char other) const {
    return !at_end() && (tokens_[at_].kind == one || tokens_[at_].kind == other);
  }

  // `$x -1`: the sign belongs to the next number.
  bool begins_component() const {
    return open_ == 0 && tokens_[at_].has_blank_before && at_ + 1 < tokens_.size() &&
           !tokens_[at_ + 1].has_blank_before;
  }

  Numbers sum(int depth) {
    Numbers left = product(depth);
    while (left && stands('+', '-') && !begins_component()) {
      const char kind = tokens_[at_++].kind;
      Numbers right = product(depth);
      if (!right) return right;
      left = kind == '+' ? joined(*left, *right, "added", std::plus<>())
                         : joined(*left, *right, "subtracted", std::minus<>());
    }
    return left;
  }

  Numbers product(int depth) {
    Numbers left = factor(depth);
    while (left && stands('*', '/')) {
      const char kind = tokens_[at_++].kind;
      Numbers right = factor(depth);
      if (!right) return right;
      left = kind == '*' ? multiplied(*left, *right) : divided(*left, *right);
    }
    return left;
  }

  Numbers factor(int depth) {
    if (at_end()) return syntax_fault("a number is missing at its end");
    if (depth > deepest_arithmetic)
      return refused(
          fmt::format("its parentheses and signs are nested deeper than {}", deepest_arithmetic));
    const Token& token = tokens_[at_++];
    switch (token.kind) {
      case Token::operand:
        return token.numbers;
      case '+':
        return factor(depth + 1);
      case '-': {
        Numbers numbers = factor(depth + 1);
        if (numbers)
          for (double& number : *numbers) number = -number;
        return numbers;
      }
      case '(':
        return in_parentheses(depth);
      default:
        return syntax_fault(fmt::format("a number is missing before \"{}\"", token.kind));
    }
  }

  Numbers in_parentheses(int depth) {
    ++open_;
    Numbers numbers = sum(depth + 1);
    --open_;
    if (!numbers) return numbers;
    if (at_end()) return syntax_fault("a \")\" is missing");
    if (tokens_[at_].kind != ')')
      return syntax_fault("an operator is missing between two numbers in parentheses");
    ++at_;
    return numbers;
  }

  static Numbers checked(std::vector<double> numbers) {
    if (std::all_of(numbers.begin(), numbers.end(), [](double one) { return std::isfinite(one); }))
      return numbers;
    return refused("its result is not finite");
  }

  template <class Operation>
  static Numbers joined(const std::vector<double>& left, const std::vector<double>& right,
                        std::string_view done, Operation operation) {
    if (left.size() != right.size())
      return refused(
          fmt::format("{} and {} numbers cannot be {}", left.size(), right.size(), done));
    std::vector<double> numbers(left.size());
    std::transform(left.begin(), left.end(), right.begin(), numbers.begin(), operation);
    return checked(std::move(numbers));
  }

  static Numbers multiplied(std::vector<double> left, std::vector<double> right) {
    if (left.size() != 1 && right.size() != 1)
      return refused(
          fmt::format("{} and {} numbers cannot be multiplied; one of them must be a "
                      "single number",
                      left.size(), right.size()));
    std::vector<double>& many = left.size() == 1 ? right : left;
    const double one = left.size() == 1 ? left[0] : right[0];
    for (double& number : many) number *= one;
    return checked(std::move(many));
  }

  static Numbers divided(std::vector<double> left, const std::vector<double>& right) {
    if (right.size() != 1)
      return refused(fmt::format("it cannot be divided by {} numbers", right.size()));
    if (right[0] == 0) return refused("it is divided by 0");
    for (double& number : left) number /= right[0];
    return checked(std::move(left));
  }

  const Tokens& tokens_;
  std::size_t at_ = 0;
  int open_ = 0;  // parentheses
};

/// In as few digits as read back the same; whole numbers that an integer can hold without an
/// exponent, which integers do not have.
std::string digits_of(double number) {
  constexpr double least = -0x1p63, end = 0x1p64;
  const bool is_whole = number >= least && number < end && std::trunc(number) == number;
  return is_whole ? fmt::format("{:.0f}", number) : fmt::format("{}", number);
}

std::string digits_of(std::span<const double> numbers) {
  std::string text;
  for (const double number : numbers) text += (text.empty() ? "" : " ") + digits_of(number);
  return text;
}

using Components = Checked<std::vector<Component>>;

std::optional<Components> components_of(std::span<const ValuePart> parts, std::size_t most = any) {
  auto tokens = Tokenizer(most).read(parts);
  if (!tokens || (tokens->has_value() && (*tokens)->empty())) return std::nullopt;
  if (!tokens->has_value()) return tl::unexpected(std::move(tokens->error()));
  return Evaluator(**tokens).components();
}

}  // namespace

bool are_plain_numbers(std::string_view text) {
  const std::vector<std::string_view> words = words_of(text);
  return !words.empty() && std::all_of(words.begin(), words.end(), [](std::string_view word) {
    return parse_number(word).has_value();
  });
}

std::optional<Numbers> numbers_of(std::string_view text, std::size_t most) {
  const ValuePart part{.text = text};
  const std::optional<Components> components = components_of({&part, 1}, most);
  if (!components) return std::nullopt;
  if (!components->has_value()) return tl::unexpected(components->error());
  std::vector<double> numbers;
  for (const Component& component : **components)
    numbers.insert(numbers.end(), component.numbers.begin(), component.numbers.end());
  if (numbers.size() > most) return std::nullopt;
  return numbers;
}

std::optional<Checked<std::string>> compute(std::span<const ValuePart> parts) {
  // As written: a whole number may have more digits than a double.
  const std::optional<Components> components = components_of(parts);
  if (!components) return std::nullopt;
  if (!components->has_value()) return tl::unexpected(components->error());
  std::string text;
  for (const Component& component : **components) {
    if (text.size() > longest_value) break;  // longer than it may be
    const std::string_view gap = text.empty() ? "" : " ";
    text += gap;
    text +=
        component.written.empty() ? digits_of(component.numbers) : std::string(component.written);
  }
  return text;
}

}  // namespace pliant::xml
