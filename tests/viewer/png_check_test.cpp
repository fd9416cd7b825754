#include "viewer/png_check.hpp"

#include <cstdint>
#include <string>
#include <vector>

#include <zlib.h>

#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::viewer;

namespace {

std::string number(std::uint32_t value) {
  std::string bytes;
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((value >> shift) & 0xFF);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& content) {
  const std::string sealed = type + content;
  const auto sum = crc32(crc32(0, nullptr, 0), reinterpret_cast<const Bytef*>(sealed.data()),
                         static_cast<uInt>(sealed.size()));
  return number(static_cast<std::uint32_t>(content.size())) + sealed +
         number(static_cast<std::uint32_t>(sum));
}

std::string packed(const std::string& rows) {
  std::vector<Bytef> bytes(compressBound(rows.size()));
  uLongf size = bytes.size();
  REQUIRE(compress(bytes.data(), &size, reinterpret_cast<const Bytef*>(rows.data()), rows.size()) ==
          Z_OK);
  return {reinterpret_cast<const char*>(bytes.data()), size};
}

constexpr PictureSize size = {7, 5};
const std::string begin("\x89PNG\r\n\x1a\n", 8);
const std::string rgba("\x08\x06\0\0\0", 5);
const std::string end = chunk("IEND", "");

// Rows with each of the five filters.
std::string rows(int count, int channels = 4) {
  std::string result;
  for (int row = 0; row < count; ++row) {
    result += static_cast<char>(row % 5);
    for (int k = 0; k < size.width * channels; ++k) {
      result += static_cast<char>((31 * row + 17 * k) & 0xFF);
    }
  }
  return result;
}

std::string header(const std::string& form = rgba) {
  return chunk("IHDR", number(size.width) + number(size.height) + form);
}

std::string picture() { return begin + header() + chunk("IDAT", packed(rows(5))) + end; }

std::string complaint(const std::string& bytes) {
  const auto checked = check_png(bytes, size);
  return checked ? "" : checked.error().message;
}

}  // namespace

TEST_CASE("a picture of a canvas passes", "[viewer][png]") {
  CHECK(complaint(picture()) == "");
  CHECK(complaint(begin + header(std::string("\x08\x02\0\0\0", 5)) +
                  chunk("IDAT", packed(rows(5, 3))) + end) == "");
  // In several chunks, one of them empty, with ancillary chunks.
  const std::string all = packed(rows(5));
  CHECK(complaint(begin + header() + chunk("sRGB", std::string(1, '\0')) +
                  chunk("IDAT", all.substr(0, 3)) + chunk("IDAT", "") +
                  chunk("IDAT", all.substr(3)) + chunk("tEXt", "a") + end) == "");
}

TEST_CASE("the check of a picture ends when asked", "[viewer][png]") {
  const PictureSize large = {1000, 1000};
  std::string lines;
  for (int row = 0; row < large.height; ++row) lines += '\0' + std::string(4000, '\7');
  // Few bytes of many rows, and many bytes.
  for (const std::string& packed_lines :
       {packed(lines), packed(lines) + std::string(8'000'000, 'x')}) {
    const std::string bytes = begin + chunk("IHDR", number(1000) + number(1000) + rgba) +
                              chunk("IDAT", packed_lines) + end;
    int asked = 0;
    (void)check_png(bytes, large, [&] { return ++asked < 0; });
    CHECK(asked > 10);
    for (int moment = 1; moment <= asked; ++moment) {
      int left = moment;
      const auto checked = check_png(bytes, large, [&] { return --left <= 0; });
      REQUIRE_FALSE(checked);
      CHECK(checked.error().code == ErrorCode::Interrupted);
      CHECK(left == 0);
    }
  }
}

TEST_CASE("a picture of more than one piece of memory passes, to its last filter",
          "[viewer][png]") {
  const PictureSize large = {500, 400};
  std::string lines;
  for (int row = 0; row < large.height; ++row) {
    lines += '\0';
    for (int k = 0; k < 4 * large.width; ++k) lines += static_cast<char>((row * k) & 0xFF);
  }
  const auto with = [&](const std::string& some) {
    return begin + chunk("IHDR", number(500) + number(400) + rgba) + chunk("IDAT", packed(some)) +
           end;
  };
  CHECK(check_png(with(lines), large).has_value());
  CHECK(with(lines).size() <= longest_png(large));
  for (const int row : {0, 1, 32, 33, 399}) {
    CAPTURE(row);
    std::string other = lines;
    other[static_cast<std::size_t>(row) * 2001] = '\5';
    CHECK_FALSE(check_png(with(other), large).has_value());
  }
}

TEST_CASE("no beginning of a picture is one, and no picture with a byte more", "[viewer][png]") {
  const std::string whole = picture();
  for (std::size_t length = 0; length < whole.size(); ++length) {
    CAPTURE(length);
    CHECK_FALSE(check_png(whole.substr(0, length), size).has_value());
  }
  CHECK(complaint(whole + '\0') == "there is data after its end");
  CHECK(complaint(whole + whole) == "there is data after its end");
}

TEST_CASE("a picture with one bit changed is none", "[viewer][png]") {
  const std::string whole = picture();
  for (std::size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    CAPTURE(bit);
    std::string other = whole;
    other[bit / 8] = static_cast<char>(other[bit / 8] ^ (1 << (bit % 8)));
    CHECK_FALSE(check_png(other, size).has_value());
  }
}

TEST_CASE("what is sealed as a picture and is none", "[viewer][png]") {
  const std::string image = chunk("IDAT", packed(rows(5)));
  struct Wrong {
    std::string bytes;
    std::string words;
  };
  const auto form = [](char depth, char colour, char last) {
    return header({depth, colour, '\0', '\0', last});
  };
  const std::vector<Wrong> all = {
      {"", "is not a PNG"},
      {"<html>", "is not a PNG"},
      {begin, "is truncated"},
      {begin + end, "no header"},
      {begin + image + header() + end, "no header"},
      {begin + chunk("IHDR", "") + image + end, "no header"},
      {begin + header() + end, "rows are missing"},
      {begin + header() + image, "is truncated"},
      {begin + header() + header() + image + end, "the unexpected chunk IHDR"},
      {begin + header() + chunk("PLTE", "abc") + image + end, "the unexpected chunk PLTE"},
      {begin + header() + image + chunk("IEND", "x"), "data after its end"},
      {begin + header() + chunk("IDAT", packed(rows(4))) + end, "rows are missing"},
      {begin + header() + chunk("IDAT", packed(rows(6))) + end, "too many rows"},
      {begin + header() + chunk("IDAT", packed(rows(5) + 'x')) + end, "too many rows"},
      {begin + header() + chunk("IDAT", "rubbish") + end, "cannot be decompressed"},
      {begin + header() + chunk("IDAT", packed(rows(5)) + 'x') + end, "data after its rows"},
      {begin + header() + image + image + end, "data after its rows"},
      {begin + header() + chunk("IDAT", packed(rows(5)).substr(0, 20)) + end, "rows are missing"},
      {begin + header() + chunk("IDAT", packed(rows(5)).substr(0, 20)) + chunk("tEXt", "a") +
           chunk("IDAT", packed(rows(5)).substr(20)) + end,
       "not consecutive"},
      {begin + form(16, 6, 0) + image + end, "not 8-bit"},
      {begin + form(8, 3, 0) + image + end, "not 8-bit"},
      {begin + form(8, 6, 1) + image + end, "not 8-bit"},
      {begin + chunk("IHDR", number(7) + number(6) + rgba) + image + end,
       "7 x 6 pixels, not 7 x 5"},
      {begin + chunk("IHDR", number(0xFFFFFFFF) + number(5) + rgba) + image + end,
       "4294967295 x 5"},
      {begin + number(0xFFFFFFFF) + "IHDR", "is truncated"},
  };
  for (const Wrong& wrong : all) {
    CAPTURE(wrong.words);
    CHECK_THAT(complaint(wrong.bytes), testing::contains_text(wrong.words));
  }
}

TEST_CASE("a small file that unpacks to much is left early", "[viewer][png]") {
  const std::string bomb = begin + header() + chunk("IDAT", packed(std::string(50'000'000, '\0')));
  CHECK(complaint(bomb + end) == "it has too many rows");
}
