#include <cmath>
#include <string>

#include "exchange/round_trips.hpp"
#include "pliant/exchange/formats.hpp"

namespace pliant {
namespace {

using namespace testing;

std::string document(const std::string& keys, const std::string& more = "") {
  return R"({"format": "blender-curves", "version": 1, "fps": 24, "curves": [
 {"owner": "Cube", "data_path": "location", "index": 2, "unit": "LENGTH", )" +
         more + "\"keys\": [\n" + keys + "]}]}\n";
}

std::string point(double frame, double value, const std::string& more) {
  return fmt::format("{{\"co\": [{}, {}], {}}}", frame, value, more);
}

Result<CurveFile> read_fcurves(const std::string& text) {
  return parse_curves(text, CurveFormat::Blender, "cube.json", {});
}

Curve<1> fcurve_in(const std::string& text) {
  const auto file = read_fcurves(text);
  INFO((file ? "" : file.error().message));
  REQUIRE(file.has_value());
  REQUIRE(file->curves.size() == 1);
  return make(file->curves[0].keys);
}

TEST_CASE("F-curves are read with their handles", "[exchange][blender]") {
  const std::string text = document(
      point(1, 0, R"("left": [-3, 0], "right": [5, 2], "interpolation": "BEZIER")") + "," +
      point(13, 6, R"("left": [9, 7], "right": [17, 6], "interpolation": "CONSTANT")") + "," +
      point(25, 1, R"("left": [21, 1], "right": [29, 1], "interpolation": "LINEAR")") + "," +
      point(37, 4, R"("left": [33, 4], "right": [41, 4])"));
  const auto file = read_fcurves(text);
  REQUIRE(file.has_value());
  CHECK(file->losses.empty());
  CHECK(file->fps == 24.0);
  CHECK(file->curves[0].name == "Cube.location.z");
  CHECK(file->curves[0].component == 2);
  const Curve<1> curve = make(file->curves[0].keys);
  // Control points 0, 2, 7, 6 with handles of a third.
  CHECK_THAT(curve.value(7)[0], WithinAbs((0 + 3 * 2 + 3 * 7 + 6) / 8.0, 1e-12));
  CHECK(curve.value(20)[0] == 6);
  CHECK(curve.value(31)[0] == 2.5);
}

TEST_CASE("handles are shortened as Blender does", "[exchange][blender]") {
  // Each may be as long as the segment; one on the wrong side keeps its height above the key.
  const std::string text = document(point(0, 0, R"("left": [-1, 0], "right": [20, 10])") + "," +
                                    point(10, 6, R"("left": [12, 9], "right": [14, 6])"));
  const Curve<1> curve = fcurve_in(text);
  REQUIRE(curve.handles().size() == 2);
  CHECK(curve.handles()[0].frame == 10);
  CHECK(curve.handles()[0].value[0] == 5);
  CHECK(curve.handles()[1].frame == 10);
  CHECK(curve.handles()[1].value[0] == 9);
}

TEST_CASE("lines beyond the keys follow the interpolation of the end key", "[exchange][blender]") {
  const auto curve = [&](const std::string& first, const std::string& last) {
    return fcurve_in(document(
        point(0, 1, R"("left": [-2, 0], "right": [3, 1], "interpolation": ")" + first + '"') + "," +
            point(10, 4, R"("left": [7, 4], "right": [12, 5], "interpolation": ")" + last + '"'),
        R"("extrapolation": "LINEAR", )"));
  };
  CHECK(curve("BEZIER", "BEZIER").value(-4)[0] == -1);
  CHECK(curve("BEZIER", "BEZIER").value(14)[0] == 6);
  CHECK(curve("CONSTANT", "CONSTANT").value(-4)[0] == 1);
  CHECK(curve("CONSTANT", "CONSTANT").value(14)[0] == 4);
  CHECK_THAT(curve("LINEAR", "LINEAR").value(-10)[0], WithinAbs(-2, 1e-12));
  CHECK_THAT(curve("SINE", "LINEAR").value(20)[0], WithinAbs(7, 1e-12));
}

const std::string two_keys = point(0, 1, R"("left": [-2, 1], "right": [3, 1])") + "," +
                             point(10, 4, R"("left": [7, 4], "right": [13, 4])");

TEST_CASE("copies that end as pliant's stay copies", "[exchange][blender]") {
  const auto curve = [&](const std::string& mode, int count) {
    return fcurve_in(
        document(two_keys, fmt::format(R"("cycles": {{"before": "NONE", "after": "{}", )"
                                       R"("after_count": {}}}, )",
                                       mode, count)));
  };
  CHECK(curve("REPEAT", 0).keys().after.kind == OutsideKind::Repeat);
  CHECK(curve("REPEAT", 3).keys().after.count == 3.0);
  CHECK(curve("REPEAT", 3).value(1000)[0] == 4);
  CHECK(curve("MIRROR", 2).value(1000)[0] == 4);
  CHECK(curve("REPEAT_OFFSET", 0).value(30)[0] == 10);
}

TEST_CASE("copies after which Blender returns to the end key become keys", "[exchange][blender]") {
  const auto check = [&](const std::string& mode, int count, double joint) {
    const auto file = read_fcurves(
        document(two_keys, fmt::format(R"("cycles": {{"before": "{0}", "before_count": {1}, )"
                                       R"("after": "{0}", "after_count": {1}}}, )",
                                       mode, count)));
    REQUIRE(file.has_value());
    REQUIRE(file->losses.size() == 1);
    CHECK_THAT(file->losses[0].message, contains_text("became"));
    const Curve<1> curve = make(file->curves[0].keys);
    const double end = 10 + 10 * count;
    CHECK(curve.value(end)[0] == joint);     // of the last copy
    CHECK(curve.value(end + 1e-6)[0] == 4);  // of the last key
    CHECK(curve.value(end + 500)[0] == 4);
    CHECK(curve.value(-10 * count - 1e-6)[0] == 1);
    CHECK(curve.value(-900)[0] == 1);
  };
  check("REPEAT_OFFSET", 2, 10);
  check("MIRROR", 3, 1);
}

TEST_CASE("easings have Blender's own sides", "[exchange][blender]") {
  const auto next = [&](const std::string& interpolation) {
    return fcurve_in(document(point(0, 1, interpolation) + "," + point(10, 4, "\"left\": [9, 4]")))
        .keys()
        .keys[0]
        .next;
  };
  CHECK(next(R"("interpolation": "SINE", "easing": "AUTO")").side == EaseSide::In);
  CHECK(next(R"("interpolation": "BOUNCE", "easing": "AUTO")").side == EaseSide::Out);
  CHECK(next(R"("interpolation": "QUINT", "easing": "EASE_IN_OUT")").side == EaseSide::InOut);
  CHECK(next(R"("interpolation": "BACK", "easing": "EASE_IN", "back": 2.5)").back == 2.5);
  const Interpolation elastic =
      next(R"("interpolation": "ELASTIC", "amplitude": 0.8, "period": 4.1)");
  CHECK(elastic.amplitude == 0.8);
  CHECK(elastic.period == 4.1);
  CHECK(elastic.side == EaseSide::Out);
}

/// BLI_easing_elastic_ease_out, easing.c, in double precision.
double elastic_out(double time, double begin, double change, double duration, double amplitude,
                   double period) {
  const double s = period / (2 * M_PI) * std::asin(change / amplitude);
  const double t = -time / duration;
  return amplitude * std::pow(2, 10 * t) * std::sin((t * duration - s) * 2 * M_PI / period) +
         change + begin;
}

TEST_CASE("an elastic that falls by less than its amplitude is Blender's", "[exchange][blender]") {
  const double fall = GENERATE(5, 0.25, 0);
  const auto file = read_fcurves(document(
      point(2, 9,
            R"("interpolation": "ELASTIC", "easing": "EASE_OUT", "amplitude": 7, "period": 5)") +
      "," + point(26, 9 - fall, "\"left\": [20, 4]")));
  REQUIRE(file.has_value());
  REQUIRE(file->losses.size() == 1);
  CHECK_THAT(file->losses[0].message, contains_text("1 elastic easing of Blender"));
  const Curve<1> curve = make(file->curves[0].keys);
  for (int k = 0; k <= 240; ++k) {
    const double time = k / 10.0;
    const double exact = k == 0 ? 9 : k == 240 ? 9 - fall : elastic_out(time, 9, -fall, 24, 7, 5);
    CHECK(std::fabs(curve.value(2 + time)[0] - exact) <= 1e-4 * 12);
  }
}

TEST_CASE("an elastic between equal values swings in Blender alone", "[exchange][blender]") {
  Key<1> first{.frame = 2, .value = {9}};
  first.next = {.kind = Interpolation::Kind::Easing, .ease = Ease::Elastic, .amplitude = 7};
  const Curve<1> level = Curve<1>::make({.keys = {first, {.frame = 26, .value = {9}}}}).value();
  const auto written =
      write_curves({{"poke.magnitude", level}}, CurveFormat::Blender, {.last = 26});
  REQUIRE(written.has_value());
  CHECK(written->losses.empty());
  const auto back = read_fcurves(written->bytes);
  REQUIRE(back.has_value());
  CHECK(back->losses.empty());
  const Curve<1> curve = make(back->curves[0].keys);
  for (int frame = 2; frame <= 26; ++frame) CHECK(curve.value(frame)[0] == 9);
}

TEST_CASE("angles of Blender are radians", "[exchange][blender]") {
  std::string text =
      document(point(0, 0, "\"right\": [3, 0]") + "," + point(10, M_PI, "\"left\": [7, 3]"));
  text.replace(text.find("LENGTH"), 6, "ROTATION");
  CHECK_THAT(fcurve_in(text).value(10)[0], WithinAbs(180, 1e-12));
  const Curve<3> turn =
      Curve<3>::make({.keys = {{.frame = 1}, {.frame = 9, .value = {90, 0, -45}}}}).value();
  const auto written =
      write_curves({{"sheet.rotate", turn, CurveUnit::Degrees}}, CurveFormat::Blender, {.last = 9});
  REQUIRE(written.has_value());
  CHECK_THAT(written->bytes, contains_text(fmt::format("\"co\": [9, {}]", M_PI / 180 * 90)));
  const auto back = read_fcurves(written->bytes);
  REQUIRE(back.has_value());
  CHECK(back->curves[2].name == "sheet.rotate.z");
  CHECK_THAT(make(back->curves[2].keys).value(9)[0], WithinAbs(-45, 1e-12));
}

TEST_CASE("what of an F-curve is left out is told", "[exchange][blender]") {
  const auto file = read_fcurves(document(two_keys, R"("modifiers": ["NOISE"], )"));
  REQUIRE(file.has_value());
  REQUIRE(file->losses.size() == 1);
  CHECK(file->losses[0].curve == "Cube.location.z");
  CHECK_THAT(file->losses[0].message, contains_text("\"NOISE\""));
  CHECK(fcurve_in(document(two_keys, R"("discrete": true, )")).value(9.9)[0] == 1);
}

TEST_CASE("problems of curves of Blender name the path, the value and the rule",
          "[exchange][blender]") {
  const auto problem = [](const std::string& text) {
    const auto file = read_fcurves(text);
    return file ? "" : to_lines(file.error())[0];
  };
  CHECK_THAT(problem("{}"), contains_text("its format is not \"blender-curves\""));
  CHECK_THAT(problem("[1, 2"), contains_text("cube.json:1: error: the file is not JSON"));
  CHECK(problem(document("{\"co\": [1]}")) ==
        "cube.json: error: curves[0].keys[0].co is not a list of 2 numbers");
  CHECK_THAT(problem(document("{\"left\": [1, 2]}")),
             contains_text("curves[0].keys[0].co is missing"));
  CHECK_THAT(problem(document(point(1, 2, R"("interpolation": "WOBBLE")"))),
             contains_text("interpolation is \"WOBBLE\", but must be one of CONSTANT"));
  CHECK_THAT(
      problem(document(point(5, 2, "\"left\": [4, 2]") + "," + point(1, 2, "\"left\": [0, 2]"))),
      contains_text("frame 1 is not after frame 5"));
  CHECK_THAT(problem(document(two_keys, R"("extrapolation": "ROUND", )")),
             contains_text("must be one of CONSTANT, LINEAR"));
  CHECK_THAT(
      problem(document(two_keys, R"("cycles": {"after": "MIRROR", "after_count": 99999999}, )")),
      contains_text("curves[0].cycles has too many copies"));
  CHECK_THAT(problem(document(point(1, 1e200, "\"left\": [0, 2]"))),
             contains_text("must not exceed"));
}

TEST_CASE("curves of Blender that have one name are numbered", "[exchange][blender]") {
  const std::string one = document(two_keys);
  const std::size_t begin = one.find("{\"owner\""), end = one.rfind("]}]}") + 2;
  const std::string curve = one.substr(begin, end - begin);
  std::string again = curve;
  again.replace(again.find("location"), 8, "location#3");
  std::string all = curve;
  for (const std::string& next : {again, curve, curve, curve}) all += "," + next;
  const auto file = read_fcurves(one.substr(0, begin) + all + one.substr(end));
  REQUIRE(file.has_value());
  std::vector<std::string> names;
  for (const FileCurve& each : file->curves) names.push_back(each.name);
  CHECK(names == std::vector<std::string>{"Cube.location.z", "Cube.location#3.z",
                                          "Cube.location#2.z", "Cube.location#4.z",
                                          "Cube.location#5.z"});
}

TEST_CASE("a small file of Blender does not become endless keys", "[exchange][blender]") {
  const std::string one =
      document(two_keys, R"("cycles": {"after": "REPEAT_OFFSET", "after_count": 400000}, )");
  CHECK(read_fcurves(one).has_value());
  const std::size_t begin = one.find("{\"owner\""), end = one.rfind("]}]}") + 2;
  const std::string curve = one.substr(begin, end - begin);
  std::string all = curve;
  for (int k = 0; k < 3; ++k) all += "," + curve;
  const auto file = read_fcurves(one.substr(0, begin) + all + one.substr(end));
  REQUIRE_FALSE(file.has_value());
  CHECK_THAT(file.error().message, contains_text("is one of more than 1000000 keys"));
}

TEST_CASE("every beginning of curves of Blender is a problem", "[exchange][blender]") {
  const std::string text = document(two_keys, R"("cycles": {"after": "MIRROR"}, )");
  REQUIRE(read_fcurves(text).has_value());
  for (std::size_t size = 0; size + 2 < text.size(); ++size) {
    const auto file = read_fcurves(text.substr(0, size));
    REQUIRE_FALSE(file.has_value());
    CHECK(to_lines(file.error()).size() == 1);
  }
}

}  // namespace
}  // namespace pliant
