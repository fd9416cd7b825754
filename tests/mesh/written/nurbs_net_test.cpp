#include "pliant/mesh/written/nurbs_net.hpp"

#include <limits>

#include "pliant/mesh/written/vertex_weights.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;

namespace {

NurbsNet flat_net() {
  NurbsNet net{.u = {.count = 5, .degree = 3}, .v = {.count = 4, .degree = 2}};
  net.points = Field::Zero(20, 3);
  return net;
}

std::string complaint(const NurbsNet& net) {
  const auto checked = check_net(net);
  REQUIRE_FALSE(checked);
  CHECK_FALSE(checked.error().part.empty());
  return checked.error().message;
}

// With these knots along u.
std::string complaint(std::vector<double> knots) {
  NurbsNet net = flat_net();
  net.u.knots = std::move(knots);
  return complaint(net);
}

bool accepts(std::vector<double> knots) {
  NurbsNet net = flat_net();
  net.u.knots = std::move(knots);
  return check_net(net).has_value();
}

const double infinite = std::numeric_limits<double>::infinity();

}  // namespace

TEST_CASE("a net knows the size of its surface", "[mesh][nurbs]") {
  NurbsNet net = flat_net();
  const WrittenSize size = check_net(net).value();
  CHECK(size.vertices == 17 * 17);
  CHECK(size.faces == 16 * 16);
  CHECK(size.weights == 17 * 17 * 12);
  net.u.is_closed = true;
  net.v.samples = 2;
  CHECK(check_net(net).value().vertices == 40 * 2);
  CHECK(check_net(net).value().faces == 40);
}

TEST_CASE("default knots are clamped and even", "[mesh][nurbs]") {
  CHECK(knots_of({.count = 6, .degree = 3}) == std::vector<double>{0, 0, 0, 0, 1, 2, 3, 3, 3, 3});
  CHECK(knots_of({.count = 3, .degree = 1}) == std::vector<double>{0, 0, 1, 2, 2});
  CHECK(knots_of({.count = 3, .degree = 2}) == std::vector<double>{0, 0, 0, 1, 1, 1});
}

TEST_CASE("counts, degrees and samples have ranges", "[mesh][nurbs]") {
  const auto with = [](const auto& change) {
    NurbsNet net = flat_net();
    change(net);
    return complaint(net);
  };
  CHECK(with([](NurbsNet& net) { net.u.count = 2; }) ==
        "columns is 2, but must be from 3 to 100000000");
  CHECK(with([](NurbsNet& net) { net.v.count = 100'000'001; }) ==
        "rows is 100000001, but must be from 3 to 100000000");
  CHECK(with([](NurbsNet& net) { net.u.degree = 0; }) ==
        "degreeU is 0, but must be from 1 to columns - 1 = 4");
  CHECK(with([](NurbsNet& net) { net.v.degree = 4; }) ==
        "degreeV is 4, but must be from 1 to rows - 1 = 3");
  CHECK(with([](NurbsNet& net) { net.u.samples = 1; }) == "samplesU is 1, but must be at least 2");
  CHECK(with([](NurbsNet& net) {
          net.v.is_closed = true;
          net.v.samples = 2;
        }) == "samplesV is 2, but must be at least 3");
}

TEST_CASE("a net has one point, and one weight, for each node", "[mesh][nurbs]") {
  NurbsNet net = flat_net();
  net.weights.assign(20, 0.5);
  CHECK(check_net(net));
  net.weights[7] = 0;
  CHECK(complaint(net) == "weight 8 is 0, but must be > 0 and finite");
  net.weights[7] = -1;
  CHECK_THAT(complaint(net), contains_text("weight 8 is -1"));
  net.weights[7] = infinite;
  CHECK_THAT(complaint(net), contains_text("weight 8 is inf"));
  net.weights[7] = std::numeric_limits<double>::quiet_NaN();
  CHECK_THAT(complaint(net), contains_text("weight 8 is nan"));
  net.weights.pop_back();
  CHECK(complaint(net) == "there are 19 weights, but columns x rows = 20 are needed");
  net.points(4, 2) = infinite;
  CHECK(complaint(net) == "point 5 has a coordinate that is not finite");
  net.points.resize(21, 3);
  CHECK(complaint(net) == "there are 21 points, but columns x rows = 20 are needed");
}

TEST_CASE("knots have the multiplicities of a surface in one piece", "[mesh][nurbs]") {
  CHECK(accepts({0, 0, 0, 0, 1, 2, 2, 2, 2}));
  CHECK(accepts({-3, -2, -1, 0, 1, 2, 3, 4, 5}));
  CHECK(accepts({0, 0, 0, 0, 1, 2, 2, 2, 5}));
  CHECK(accepts({0, 1, 1, 1, 2, 3, 3, 3, 4}));
  CHECK(complaint({0, 0, 0, 0, 0, 2, 2, 2, 2}) ==
        "knots along=\"u\": 0 occurs 5 times, but 4 is the most at an end");
  CHECK(complaint({0, 0, 0, 0, 2, 2, 2, 2, 2}) ==
        "knots along=\"u\": 2 occurs 5 times, but 4 is the most at an end");
  CHECK(complaint({0, 1, 1, 1, 1, 2, 3, 4, 5}) ==
        "knots along=\"u\": 1 occurs 4 times, but 3 is the most between the ends");
  CHECK(complaint({0, 0, 1, 2, 2, 2, 3, 4, 5}) ==
        "knots along=\"u\": the surface lies between numbers 4 and 6, which are both 2");
}

TEST_CASE("knots are as many as it takes, finite, and never fall", "[mesh][nurbs]") {
  CHECK(complaint({0, 0, 0, 0, 1, 1, 1, 1}) ==
        "knots along=\"u\": there are 8 numbers, but columns + degreeU + 1 = 9 are needed");
  CHECK(complaint({0, 0, 0, 0, 2, 1, 3, 3, 3}) ==
        "knots along=\"u\": number 6, 1, is less than the one before it, 2");
  CHECK(complaint({0, 0, 0, 0, 1, 2, 2, 2, infinite}) ==
        "knots along=\"u\": number 9 is not finite");
  CHECK(complaint({-1e308, 0, 0, 0, 1, 2, 2, 2, 1e308}) ==
        "knots along=\"u\": -1e+308 and 1e+308 lie too far apart");
  NurbsNet net = flat_net();
  net.v.is_closed = true;
  net.v.knots = {0, 0, 0, 1, 2, 2, 2};
  CHECK(complaint(net) == "knots along=\"v\": a net that wrap closes along v has none");
}

TEST_CASE("a surface that is too large is refused before it takes memory", "[mesh][nurbs]") {
  NurbsNet net = flat_net();
  net.u.samples = net.v.samples = 10'000;
  CHECK(check_net(net).value().vertices == 100'000'000);
  net.v.samples = 10'001;
  CHECK(complaint(net) ==
        "10000 x 10001 vertices would be written, but 100000000 is the most; set samplesU and "
        "samplesV");
  net.u.samples = net.v.samples = std::numeric_limits<int>::max();
  CHECK_THAT(complaint(net), contains_text("2147483647 x 2147483647 vertices"));
  net.u = net.v = {.count = 8, .degree = 7, .samples = 8000};
  net.points = Field::Zero(64, 3);
  CHECK_THAT(complaint(net), contains_text("8000 x 8000 vertices of 8 x 8 control points"));
  net.u.count = net.v.count = 10'001;
  CHECK(complaint(net) == "columns x rows is 100020001, but 100000000 is the most");
}

TEST_CASE("the splines of a net take no longer than its points allow", "[mesh][nurbs]") {
  NurbsNet net{.u = {.count = 3001, .degree = 3000}, .v = {.count = 3, .degree = 1}};
  net.points = Field::Zero(3 * 3001, 3);
  CHECK(check_net(net));
  net.u.samples = 300;
  CHECK(complaint(net) ==
        "degreeU is 3000, with 300 vertices along u: vertices x (degreeU + 1)^2 must be at most "
        "2000000000; set samplesU or lower degreeU");
}
