#include "pliant/scene/sharing/arithmetic.hpp"

#include <charconv>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "support/catch.hpp"

namespace pliant::xml {
namespace {

using pliant::testing::contains_text;

/// Parts that definitions and their texts make, for `compute`.
class WrittenValue {
 public:
  WrittenValue& text(std::string_view written) {
    parts_.push_back({.text = written});
    return *this;
  }
  WrittenValue& definition(const std::string& stands_for) {
    auto& kept = kept_.emplace_back(std::make_unique<Kept>());
    kept->text = stands_for;
    kept->numbers = numbers_of(stands_for);
    parts_.push_back({.text = kept->text,
                      .is_definition = true,
                      .numbers = kept->numbers ? &*kept->numbers : nullptr,
                      .is_plain = are_plain_numbers(stands_for)});
    return *this;
  }
  auto result() const { return compute(parts_); }

 private:
  struct Kept {
    std::string text;
    std::optional<Numbers> numbers;
  };
  std::vector<std::unique_ptr<Kept>> kept_;
  std::vector<ValuePart> parts_;
};

/// What `written` becomes; `no` if it is not arithmetic, or the fault.
std::string computed(std::string_view written) {
  const auto result = WrittenValue().text(written).result();
  if (!result) return "no";
  return result->has_value() ? **result : "fault: " + result->error().message;
}

TEST_CASE("arithmetic in a value", "[scene][arithmetic]") {
  struct Row {
    std::string_view written, result;
  };
  const Row rows[] = {
      {"1 + 2 * 3", "7"},
      {"(1 + 2) * 3", "9"},
      {"7 - 2 - 3", "2"},
      {"16 / 4 / 2", "2"},
      {"2 * -3", "-6"},
      {"--3", "3"},
      {"-(2)", "-2"},
      {"+(2)", "2"},
      {"1/3", "0.3333333333333333"},
      {"0.1 + 0.2", "0.30000000000000004"},
      {"2 × 3 − 4 ÷ 8", "5.5"},
      {"1e3*2", "2000"},
      {".5 * 2", "1"},
      {"1 -2", "1 -2"},       // two numbers
      {"1 - 2", "-1"},        // one
      {"1-2", "-1"},          //
      {"1- 2", "-1"},         //
      {"(1 -2)", "-1"},       // in parentheses blanks separate nothing
      {"1 -2 +3", "1 -2 3"},  //
      {"1 - -2", "3"},        //
      {"(1) (2)", "1 2"},     //
      {"1 * 2 3 / 4 -(5)", "2 0.75 -5"},
      {"0 1.50 1e2", "0 1.50 1e2"},  // kept as written
      {"18446744073709551615", "18446744073709551615"},
      {"2 * 1e16", "20000000000000000"},  // as integers are written
      {"0.5 * 18446744073709549568", "9223372036854774784"},
      {"1 * 1e20", "1e+20"},
      {"0 * -1", "-0"},  // the edges of double
      {"5e-324 * 1", "5e-324"},
      {"2.2250738585072014e-308 / 2", "1.1125369292536007e-308"},
      {"1.7976931348623157e308 * 1", "1.7976931348623157e+308"},
      {"-1.7976931348623157e308 - 1", "-1.7976931348623157e+308"},
      {"", "no"},
      {"  ", "no"},
      {"abc", "no"},
      {"2px", "no"},
      {"0x10", "no"},
      {"1,5", "no"},
      {"1.2.3", "no"},
      {"2(3)", "no"},
      {"(2)3", "no"},
      {"nan", "no"},
      {"1 % 2", "no"},
      {"1 / 0", "fault: it is divided by 0"},
      {"1 / (2 - 2)", "fault: it is divided by 0"},
      {"1e308 * 10", "fault: its result is not finite"},
      {"1e308 + 1e308", "fault: its result is not finite"},
      {"1e999", "fault: \"1e999\" is outside the range of numbers that can be stored"},
      {"1e-999 * 1", "fault: \"1e-999\" is outside the range of numbers that can be stored"},
      {"1 +", "fault: a number is missing at its end"},
      {"* 2", "fault: a number is missing before \"*\""},
      {"(1", "fault: a \")\" is missing"},
      {"1)", "fault: a \"(\" is missing"},
      {"()", "fault: a number is missing before \")\""},
      {"(1 2)", "fault: an operator is missing between two numbers in parentheses"},
  };
  for (const Row& row : rows) {
    CAPTURE(row.written);
    CHECK(computed(row.written) == row.result);
  }
}

TEST_CASE("definitions in arithmetic", "[scene][arithmetic]") {
  const auto text_of = [](const WrittenValue& value) {
    const auto result = value.result();
    if (!result) return std::string("no");
    return result->has_value() ? **result : "fault: " + result->error().message;
  };
  CHECK(text_of(WrittenValue().definition("2").text(" * 3")) == "6");
  CHECK(text_of(WrittenValue().text("-").definition("2")) == "-2");
  CHECK(text_of(WrittenValue().definition("2").text(" -").definition("2")) == "2 -2");
  CHECK(text_of(WrittenValue().definition("2").text("-").definition("3")) == "-1");
  CHECK(text_of(WrittenValue().definition("1 + 2").text(" * 2")) ==
        "6");  // a value, not characters
  CHECK(text_of(WrittenValue().definition("1/4")) == "0.25");
  CHECK(text_of(WrittenValue().definition("0001")) == "0001");  // a plain number is kept
  CHECK(text_of(WrittenValue().definition(" -0.50 ")) == "-0.50");
  CHECK(text_of(WrittenValue().definition("1 2 3").text(" * 2")) == "2 4 6");
  CHECK(text_of(WrittenValue().text("2 * ").definition("1 2 3").text(" - ").definition("1 1 1")) ==
        "1 3 5");
  CHECK(text_of(WrittenValue().text("-").definition("1 2 3").text(" / 2")) == "-0.5 -1 -1.5");
  CHECK(text_of(WrittenValue().definition("1 2 3").text(" 4")) == "1 2 3 4");
  CHECK(text_of(WrittenValue().definition("rig").text(" * 3")) == "no");
  CHECK(text_of(WrittenValue().definition("1").definition("2")) == "no");  // 12, as text
  CHECK(text_of(WrittenValue().definition("1").text(".5")) == "no");
  CHECK(text_of(WrittenValue().definition("1 2 3").text(" * ").definition("1 2 3")) ==
        "fault: 3 and 3 numbers cannot be multiplied; one of them must be a single number");
  CHECK(text_of(WrittenValue().definition("1 2 3").text(" + 1")) ==
        "fault: 3 and 1 numbers cannot be added");
  CHECK(text_of(WrittenValue().definition("1 2 3").text(" - ").definition("1 2")) ==
        "fault: 3 and 2 numbers cannot be subtracted");
  CHECK(text_of(WrittenValue().text("1 / ").definition("1 2 3")) ==
        "fault: it cannot be divided by 3 numbers");
  CHECK(text_of(WrittenValue().text("1 / ").definition("0")) == "fault: it is divided by 0");
  CHECK(text_of(WrittenValue().text("1 + ").definition("1/0")) == "fault: it is divided by 0");
}

TEST_CASE("parentheses and signs are nested so deep", "[scene][arithmetic]") {
  const auto nested = [](int depth, char open, const char* close) {
    std::string text(static_cast<std::size_t>(depth), open);
    text += '1';
    for (int k = 0; k < depth; ++k) text += close;
    return computed(text);
  };
  CHECK(nested(deepest_arithmetic, '(', ")") == "1");
  CHECK(nested(deepest_arithmetic, '-', "") == "1");
  for (const int depth : {deepest_arithmetic + 1, 100'000}) {
    CHECK_THAT(nested(depth, '(', ")"), contains_text("nested deeper than 64"));
    CHECK_THAT(nested(depth, '-', ""), contains_text("nested deeper than 64"));
  }
}

// A second implementation, by the shunting-yard algorithm, of one number without blanks.
class ShuntingYard {
 public:
  double value_of(std::string_view text) {
    bool wants_operand = true;
    for (std::size_t at = 0; at < text.size();) {
      const char c = text[at];
      if ((c >= '0' && c <= '9') || c == '.') {
        double number = 0;
        const auto [stop, failure] =
            std::from_chars(text.data() + at, text.data() + text.size(), number);
        numbers_.push_back(number);
        at = static_cast<std::size_t>(stop - text.data());
        wants_operand = false;
        continue;
      }
      ++at;
      if (c == ' ') continue;
      if (c == '(') {
        signs_.push_back('(');
      } else if (c == ')') {
        while (signs_.back() != '(') reduce();
        signs_.pop_back();
      } else if (wants_operand) {
        signs_.push_back(c == '-' ? '~' : '#');  // signs bind most
      } else {
        while (!signs_.empty() && strength(signs_.back()) >= strength(c)) reduce();
        signs_.push_back(c);
        wants_operand = true;
      }
    }
    while (!signs_.empty()) reduce();
    return numbers_.back();
  }

 private:
  static int strength(char sign) {
    switch (sign) {
      case '~':
      case '#':
        return 3;
      case '*':
      case '/':
        return 2;
      case '+':
      case '-':
        return 1;
      default:
        return 0;
    }
  }
  void reduce() {
    const char sign = signs_.back();
    signs_.pop_back();
    double right = numbers_.back();
    if (sign == '#') return;
    if (sign == '~') {
      numbers_.back() = -right;
      return;
    }
    numbers_.pop_back();
    double& left = numbers_.back();
    left = sign == '+'   ? left + right
           : sign == '-' ? left - right
           : sign == '*' ? left * right
                         : left / right;
  }
  std::vector<double> numbers_;
  std::vector<char> signs_;
};

/// A random expression. A binary sign has a blank on both sides or on none, so that it is one
/// number.
std::string random_expression(std::mt19937& random, int depth) {
  const auto upto = [&](unsigned most) { return random() % (most + 1); };
  if (depth == 0 || upto(4) == 0) {
    switch (upto(3)) {
      case 0:
        return fmt::format("{}", upto(20));
      case 1:
        return fmt::format("{}.{}", upto(9), upto(999));
      case 2:
        return fmt::format("{}e{}", 1 + upto(8), static_cast<int>(upto(40)) - 20);
      default:
        return fmt::format("{}", static_cast<double>(random()) / 977);
    }
  }
  const std::string left = random_expression(random, depth - 1);
  switch (upto(6)) {
    case 0:
      return '(' + left + ')';
    case 1:
      return '-' + left;
    default:
      break;
  }
  const std::string right = random_expression(random, depth - 1);
  const char sign = "+-*/"[upto(3)];
  return upto(1) == 0 ? fmt::format("{} {} {}", left, sign, right)
                      : fmt::format("{}{}{}", left, sign, right);
}

TEST_CASE("arithmetic agrees with a second implementation", "[scene][arithmetic]") {
  std::mt19937 random(20);
  int finite = 0, faults = 0;
  for (int k = 0; k < 20'000; ++k) {
    const std::string text = random_expression(random, 1 + k % 6);
    CAPTURE(text);
    const double expected = ShuntingYard().value_of(text);
    const std::optional<Numbers> numbers = numbers_of(text);
    REQUIRE(numbers);
    if (!numbers->has_value()) {
      // Also where an infinity between would vanish, as in 1 / (1 / 0).
      CHECK_THAT(numbers->error().message,
                 contains_text("divided by 0") || contains_text("not finite"));
      ++faults;
      continue;
    }
    ++finite;
    REQUIRE((*numbers)->size() == 1);
    CHECK((*numbers)->front() == expected);
    const std::string written = computed(text);
    double again = 0;
    std::from_chars(written.data(), written.data() + written.size(), again);
    CHECK(again == expected);
    CHECK(std::signbit(again) == std::signbit(expected));
  }
  CHECK(finite > 15'000);
  CHECK(faults > 10);
}

}  // namespace
}  // namespace pliant::xml
