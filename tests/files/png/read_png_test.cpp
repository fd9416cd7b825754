#include "pliant/files/png/read_png.hpp"

#include <algorithm>

#include "support/catch.hpp"
#include "support/png.hpp"

using namespace pliant;
using namespace pliant::testing;
using Catch::Matchers::Contains;

namespace {

// 3 x 2 pixels with the given number of channels; the first channel is 0, 10, 20 / 30, 40, 50.
PngMaker small(int bits, int colours, int channels) {
  PngMaker png;
  png.width = 3;
  png.height = 2;
  png.bits = bits;
  png.colours = colours;
  for (int k = 0; k < 6; ++k) {
    png.values.push_back(10 * k * (bits == 16 ? 257 : 1));
    for (int channel = 1; channel < channels; ++channel) png.values.push_back(7 * k + channel);
  }
  return png;
}

std::string problem_of(const std::string& bytes) {
  const auto picture = parse_png(bytes, "map.png");
  if (picture) return "none";
  CHECK(picture.error().file == "map.png");
  CHECK(picture.error().message.find('\n') == std::string::npos);
  return picture.error().message;
}

}  // namespace

TEST_CASE("a picture is the first channel of its pixels, of 8 or 16 bits", "[mesh][maps]") {
  const std::pair<int, int> kinds[] = {{0, 1}, {2, 3}, {4, 2}, {6, 4}};  // colour type, channels
  for (const int bits : {8, 16}) {
    for (const auto& [colours, channels] : kinds) {
      CAPTURE(bits, colours);
      const std::string bytes = small(bits, colours, channels).bytes();
      const Picture picture = parse_png(bytes, "a").value();
      CHECK(picture.width == 3);
      CHECK(picture.height == 2);
      CHECK(picture.white == (bits == 8 ? 255 : 65535));
      const int step = bits == 8 ? 10 : 2570;
      for (int k = 0; k < 6; ++k) CHECK(picture.values[static_cast<std::size_t>(k)] == k * step);
      CHECK(bytes_of_png(bytes).value() == 12);
      // The centre of the first pixel, at the top.
      CHECK(picture.at(1.0 / 6, 0.75) == 0);
      CHECK(picture.at(0.5, 0.75) == 10.0 / 255);
      CHECK(picture.at(0.5, 0.25) == Approx(40.0 / 255).epsilon(1e-15));
    }
  }
}

TEST_CASE("gamma, colour profiles and texts of a PNG change nothing", "[mesh][maps]") {
  PngMaker png = small(8, 0, 1);
  const Picture plain = parse_png(png.bytes(), "a").value();
  png.more = PngMaker::chunk("gAMA", PngMaker::big(45455)) + PngMaker::chunk("sRGB", {0}) +
             PngMaker::chunk("tEXt", std::string("Comment\0soft", 12)) +
             PngMaker::chunk("zTXt", "broken");
  CHECK(parse_png(png.bytes(), "a")->values == plain.values);
}

TEST_CASE("a picture is bilinear between the centres of pixels", "[mesh][maps]") {
  const Picture picture = parse_png(grey_png(2, 2, {0, 255, 51, 102}), "a").value();
  // v is upwards.
  CHECK(picture.at(0.25, 0.75) == 0);
  CHECK(picture.at(0.75, 0.75) == 1);
  CHECK(picture.at(0.25, 0.25) == 0.2);
  CHECK(picture.at(0.75, 0.25) == 0.4);
  CHECK(picture.at(0.5, 0.75) == 0.5);
  CHECK(picture.at(0.5, 0.5) == Approx((0 + 1 + 0.2 + 0.4) / 4).epsilon(1e-15));
  CHECK(picture.at(0.375, 0.75) == 0.25);
  // Beyond the outermost centres it is constant, also outside of 0 to 1.
  for (const double u : {0.0, 0.1, -7.0, 0.25}) {
    for (const double v : {1.0, 0.8, 9.0, 0.75}) CHECK(picture.at(u, v) == 0);
  }
  CHECK(picture.at(1, 0) == 0.4);
  CHECK(picture.at(1e300, -1e300) == 0.4);
  CHECK(picture.at(0.5, 2) == 0.5);
  const Picture one = parse_png(grey_png(1, 1, {51}), "a").value();
  for (const double u : {-1.0, 0.0, 0.3, 0.5, 1.0}) CHECK(one.at(u, 1 - u) == 0.2);
}

TEST_CASE("a linear picture is read exactly at every place between centres", "[mesh][maps]") {
  std::vector<int> values;
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) values.push_back(20 * x + 5 * y);
  const Picture picture = parse_png(grey_png(8, 8, values), "a").value();
  for (double u = 1.0 / 16; u <= 15.0 / 16; u += 0.03) {
    for (double v = 1.0 / 16; v <= 15.0 / 16; v += 0.07) {
      const double expected = (20 * (8 * u - 0.5) + 5 * (8 * (1 - v) - 0.5)) / 255;
      CHECK(picture.at(u, v) == Approx(expected).epsilon(1e-13));
    }
  }
}

TEST_CASE("PNGs that are not read say why", "[mesh][maps]") {
  CHECK_THAT(problem_of(""), Contains("no PNG"));
  CHECK_THAT(problem_of("P5 3 2 255\n"), Contains("no PNG"));
  PngMaker png = small(8, 0, 1);
  png.interlace = 1;
  CHECK_THAT(problem_of(png.bytes()), Contains("interlaced"));
  png = small(8, 0, 1);
  png.colours = 3;
  CHECK_THAT(problem_of(png.bytes()), Contains("palette"));
  png = small(4, 0, 1);
  CHECK_THAT(problem_of(png.bytes()), Contains("4 bits a channel, but must have 8 or 16"));
  png = small(8, 0, 1);
  png.width = 0;
  CHECK_THAT(problem_of(png.bytes()), Contains("0 x 2 pixels, but a side must have 1 to 16384"));
  png.width = 16385;
  CHECK_THAT(problem_of(png.bytes()), Contains("16385 x 2"));
  // No memory is taken for pixels that the file cannot contain.
  png.width = png.height = 16384;
  CHECK_THAT(problem_of(png.bytes()), Contains("cannot contain 16384 x 16384 pixels"));
  png = small(8, 0, 1);
  png.values.resize(2);
  CHECK_THAT(problem_of(png.bytes()), Contains("broken"));
  png = small(8, 5, 1);
  CHECK_THAT(problem_of(png.bytes()), Contains("broken"));
}

TEST_CASE("a PNG that ends early or has a wrong bit is refused", "[mesh][maps]") {
  const std::string whole = small(16, 2, 3).bytes();
  for (std::size_t size = 0; size < whole.size(); ++size) {
    CAPTURE(size);
    CHECK(problem_of(whole.substr(0, size)) != "none");
  }
  for (std::size_t place = 0; place < whole.size(); ++place) {
    for (const int bit : {0, 3, 7}) {
      CAPTURE(place, bit);
      std::string broken = whole;
      broken[place] = static_cast<char>(broken[place] ^ 1 << bit);
      const auto picture = parse_png(broken, "a");
      // The checksums of all chunks are checked; a flag that zlib ignores is none of them.
      if (picture) CHECK(picture->values == parse_png(whole, "a")->values);
    }
  }
}

TEST_CASE("much data after a picture's last row is refused", "[mesh][read_png]") {
  const auto cut_to_one_row = [](int rows) {
    std::string bytes =
        PngMaker{.width = 100, .height = rows, .values = std::vector<int>(100 * rows)}.bytes();
    std::string head = PngMaker::big(100) + PngMaker::big(1) + '\x08' + std::string(4, '\0');
    return bytes.replace(8, 25, PngMaker::chunk("IHDR", head));
  };
  CHECK(parse_png(cut_to_one_row(2), "a").value().values.size() == 100);
  CHECK_THAT(problem_of(cut_to_one_row(200)), Contains("more data than its picture"));
}
