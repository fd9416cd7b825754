#include "pliant/core/text.hpp"

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

TEST_CASE("a decimal reads back the double it was written from", "[core][number]") {
  std::mt19937_64 random(11);
  for (int trial = 0; trial < 2000; ++trial) {
    const double number =
        std::ldexp(static_cast<double>(random()) - 9e18, static_cast<int>(random() % 200) - 160);
    char text[40];
    std::snprintf(text, sizeof text, "%.17g", number);
    CAPTURE(text);
    REQUIRE(to_number(text) == number);
  }
}

TEST_CASE("what is no finite decimal number is none", "[core][number]") {
  const std::string text = GENERATE(as<std::string>{}, "", " ", "nan", "NaN", "inf", "-inf", "1,5",
                                    "0x10", "1e999", "1e-999", "1.5abc", "1 2", "+-1", "++1", "+",
                                    "-", ".", "e5", "1e", " 1", "1 ", "--1", "1.2.3");
  CAPTURE(text);
  CHECK_FALSE(to_number(text));
}

TEST_CASE("a number is rounded to significant digits", "[core][number]") {
  CHECK(with_digits(1234.5678, 3) == 1230);
  CHECK(with_digits(-0.0012345, 2) == -0.0012);
  CHECK(with_digits(9.99e200, 1) == 1e201);
  CHECK(with_digits(1.0 / 3, 0) == 1.0 / 3);
  CHECK(with_digits(1.0 / 3, 17) == 1.0 / 3);
  CHECK(with_digits(1.0 / 3, 99) == 1.0 / 3);
  CHECK(with_digits(0, 3) == 0);
  CHECK(std::isinf(with_digits(std::numeric_limits<double>::infinity(), 3)));
  CHECK(with_digits(1.79e308, 1) == 1.79e308);  // 2e308 is none
}

TEST_CASE("usual spellings of numbers are read", "[core][number]") {
  CHECK(to_number("+1.5") == 1.5);
  CHECK(to_number(".5") == 0.5);
  CHECK(to_number("5.") == 5.0);
  CHECK(to_number("-1E+3") == -1000.0);
  CHECK(to_number("0.375") == 0.375);
}

TEST_CASE("whole numbers are whole and in range", "[core][number]") {
  CHECK(to_integer("+12") == 12);
  CHECK(to_integer("-2147483648") == -2147483647 - 1);
  for (const char* text : {"", "1.0", "1e3", "2147483648", "12a", "+-1", " 1"}) {
    CAPTURE(text);
    CHECK_FALSE(to_integer(text));
  }
}

TEST_CASE("trimming takes blanks from the ends only", "[core][trim]") {
  CHECK(trim(" \ta b\t ", " \t") == "a b");
  CHECK(trim("a", " ") == "a");
  CHECK(trim(" \t ", " \t").empty());
  CHECK(trim("", " ").empty());
  CHECK(trim("\na ", " ") == "\na");
}

TEST_CASE("words are what stands between blanks", "[core][text]") {
  const std::vector<std::string_view> words = {"a", "b#1", ",", "\xc3\xa4"};
  for (const std::string_view blank : {" ", "\t\t", " \r\n"}) {
    for (const std::string_view end : {std::string_view(), blank}) {
      std::string text(end);
      for (std::size_t k = 0; k < words.size(); ++k)
        text.append(k > 0 ? blank : "").append(words[k]);
      text += end;
      CHECK(words_of(text, ascii_blanks) == words);
      std::string_view rest = text;
      for (const std::string_view word : words) CHECK(next_word(rest, ascii_blanks) == word);
      CHECK(next_word(rest, ascii_blanks).empty());
      CHECK(rest.empty());
    }
  }
  CHECK(words_of(" \n", ascii_blanks).empty());
  CHECK(words_of("a\vb", " ") == std::vector<std::string_view>{"a\vb"});
}

TEST_CASE("an ending is that of the name, in lower case", "[core][file_ending]") {
  CHECK(ending_of("Head.OBJ") == ".obj");
  CHECK(ending_of("a.b/c.0001.Ply") == ".ply");
  CHECK(ending_of("a.obj/c").empty());
  CHECK(ending_of(".npy").empty());  // a hidden file's name
}

TEST_CASE("a file's name from a folder leads to it", "[core][text]") {
  namespace fs = std::filesystem;
  CHECK(path_from("", "a.obj") == "a.obj");
  CHECK(path_from("shots", "shots/b/a.obj") == "b/a.obj");
  CHECK(path_from("/x/y", "/x/y/a.obj") == "a.obj");
  for (const char* folder : {"", ".", "..", "shots", "../out", "shots/../out", "/other", "/"}) {
    for (const char* file : {"a.obj", "shots/m.obj", "../m.obj", "/other/m.obj"}) {
      CAPTURE(folder, file);
      const fs::path name = path_from(folder, file);
      CHECK(fs::weakly_canonical(fs::absolute(folder[0] == 0 ? "." : folder) / name) ==
            fs::weakly_canonical(fs::absolute(file)));
    }
  }
}

TEST_CASE("UTF-8 is told from other bytes", "[core][text]") {
  for (const char* text : {"", "plain", "\u00e9\u20ac\U0001f600", "a\x7f\n"}) CHECK(is_utf8(text));
  for (const char* text : {"\xe9", "a\xc3", "\xc0\x80", "\xed\xa0\x80", "\xf4\x90\x80\x80", "\x80"})
    CHECK_FALSE(is_utf8(text));
}
