#include <cmath>
#include <string>

#include "exchange/round_trips.hpp"

namespace pliant {
namespace {

using namespace testing;

const std::string head =
    "animVersion 1.1;\nmayaVersion 2022;\ntimeUnit film;\nlinearUnit cm;\nangularUnit deg;\n"
    "startTime 1;\nendTime 48;\n";

std::string anim_of(const std::string& keys, const std::string& more = "") {
  return head +
         "anim translate.translateY translateY pSphere1 0 1 1;\nanimData {\n  input time;\n"
         "  output linear;\n  weighted 0;\n  preInfinity constant;\n  postInfinity constant;\n" +
         more + "  keys {\n" + keys + "  }\n}\n";
}

Result<CurveFile> read_anim(const std::string& text) {
  return parse_curves(text, CurveFormat::Maya, "walk.anim", {});
}

Curve<1> anim_curve_in(const std::string& text) {
  const auto file = read_anim(text);
  INFO((file ? "" : file.error().message));
  REQUIRE(file.has_value());
  REQUIRE(file->curves.size() == 1);
  return make(file->curves[0].keys);
}

TEST_CASE("slopes that are too steep for an angle are told", "[exchange][maya]") {
  for (const double rise : {1.0, 1e6, 1e15, 1e20}) {
    CAPTURE(rise);
    const Curve<1> curve =
        make(CurveKeys<1>{.keys = {key(1, 0), key(10, rise), key(20, 3 * rise), key(30, 0)}});
    const auto text = write_curves({{"poke.magnitude", curve}}, CurveFormat::Maya, {.last = 30});
    REQUIRE(text.has_value());
    REQUIRE(text->losses.empty() == (rise < 1e9));
    if (rise > 1e9) CHECK_THAT(text->losses[0].message, contains_text("became angles"));
  }
}

TEST_CASE("an .anim as Maya writes it", "[exchange][maya]") {
  // 45 degrees: one unit per frame. The weight of a curve without weights is not used.
  const std::string text = anim_of(
      "    1 0 fixed fixed 1 0 0 45 1 45 1;\n"
      "    13 4 auto auto 1 0 0;\n"
      "    25 4 flat step 0 0 0;\n"
      "    37 -2 linear linear 1 0 0;\n"
      "    49 6 linear stepnext 1 0 0;\n");
  const auto file = read_anim(text);
  REQUIRE(file.has_value());
  CHECK(file->fps == 24.0);
  const FileCurve& curve = file->curves.at(0);
  CHECK(curve.name == "pSphere1.translate.y");
  CHECK(curve.group == "pSphere1.translate");
  CHECK(curve.component == 1);
  CHECK(curve.unit == CurveUnit::Length);
  const Curve<1> made = make(curve.keys);
  CHECK_THAT(made.velocity(1)[0], WithinAbs(1, 1e-12));
  CHECK(made.value(13)[0] == 4);
  CHECK(made.left_velocity(13)[0] == 0);  // level with its neighbour
  CHECK(made.value(30)[0] == 4);
  CHECK(made.value(43)[0] == 2);
  CHECK(made.value(60)[0] == 6);
  // Hermite of slopes 1 and 0 at the middle.
  CHECK_THAT(made.value(7)[0], WithinAbs(2 + 12.0 / 8, 1e-12));
}

TEST_CASE("weights are the lengths of handles", "[exchange][maya]") {
  const std::string keys = "    1 0 flat fixed 1 0 0 30 4;\n    13 5 fixed flat 1 0 0 -60 2;\n";
  std::string text = anim_of(keys);
  text.replace(text.find("weighted 0"), 10, "weighted 1");
  const Curve<1> curve = anim_curve_in(text);
  REQUIRE(curve.handles().size() == 2);
  CHECK_THAT(curve.handles()[0].frame, WithinAbs(1 + 4 * std::cos(M_PI / 6), 1e-12));
  CHECK_THAT(curve.handles()[0].value[0], WithinAbs(2, 1e-12));
  CHECK_THAT(curve.handles()[1].frame, WithinAbs(13 - 1, 1e-12));
  CHECK_THAT(curve.handles()[1].value[0], WithinAbs(5 + 2 * std::sin(M_PI / 3), 1e-12));
  CHECK(curve.keys().overshoot == Overshoot::KeepStart);
}

TEST_CASE("units of time and angle", "[exchange][maya]") {
  std::string text = anim_of("    0 0 linear fixed 1 0 0 45 1;\n    2 90 linear linear 1 0 0;\n");
  text.replace(text.find("timeUnit film"), 13, "timeUnit sec");
  const Curve<1> curve = anim_curve_in(text);
  CHECK(curve.keys().keys[1].frame == 48);
  CHECK_THAT(curve.velocity(0)[0], WithinAbs(1.0 / 24, 1e-14));
  // Radians become degrees; an angle is one of the file's units, too.
  text.replace(text.find("angularUnit deg"), 15, "angularUnit rad");
  text.replace(text.find("output linear"), 13, "output angular");
  text.replace(text.find(" 45 1;"), 6, " 0.5 1;");
  text.replace(text.find("2 90 "), 5, "2 1 ");
  const Curve<1> turned = anim_curve_in(text);
  CHECK_THAT(turned.value(48)[0], WithinAbs(180 / M_PI, 1e-12));
  CHECK_THAT(turned.velocity(0)[0], WithinAbs(std::tan(0.5) / 24 * 180 / M_PI, 1e-12));
}

TEST_CASE("what Maya does outside the keys", "[exchange][maya]") {
  const std::string keys =
      "    1 0 spline spline 1 0 0;\n    9 8 spline spline 1 0 0;\n    17 2 spline spline 1 0 0;\n";
  const auto with = [&](const std::string& word) {
    std::string text = anim_of(keys);
    text.replace(text.find("postInfinity constant"), 21, "postInfinity " + word);
    return anim_curve_in(text);
  };
  CHECK(with("constant").value(33)[0] == 2);
  CHECK_THAT(with("linear").value(19)[0], WithinAbs(2 - 2 * 0.75, 1e-12));
  CHECK(with("cycle").value(25)[0] == 8);
  CHECK(with("cycleRelative").value(25)[0] == 10);
  CHECK(with("oscillate").value(25)[0] == 8);
  // The tangents at the ends know nothing of the copies.
  CHECK(with("cycleRelative").velocity(1)[0] == with("constant").velocity(1)[0]);
}

TEST_CASE("curves that are not of time, and placeholders", "[exchange][maya]") {
  std::string text = anim_of("    1 0 auto auto 1 0 0;\n");
  text.replace(text.find("input time"), 10, "input unitless");
  const auto file = read_anim(text + "anim pCube1 0 0 0;\n# a comment\n// another\n");
  REQUIRE(file.has_value());
  CHECK(file->curves.empty());
  REQUIRE(file->losses.size() == 1);
  CHECK_THAT(file->losses[0].message, contains_text("not by time"));
}

TEST_CASE("problems of an .anim name the line, the value and the rule", "[exchange][maya]") {
  const auto problem = [](const std::string& text) {
    const auto file = read_anim(text);
    return file ? "" : to_lines(file.error())[0];
  };
  CHECK(problem("hello") ==
        "walk.anim:1: error: the file is not a Maya .anim: it does not begin with animVersion");
  CHECK_THAT(problem(""), contains_text("has no animVersion"));
  CHECK(problem(anim_of("    1 0 fixed auto 1 0 0 45;\n")) ==
        "walk.anim:16: error: the weight of a fixed tangent \";\" is not a finite number");
  CHECK_THAT(
      problem(anim_of("    1 0 bouncy auto 1 0 0;\n")),
      contains_text("walk.anim:16: error: tangent \"bouncy\" is not known; it must be global"));
  CHECK_THAT(problem(anim_of("    1 nan auto auto 1 0 0;\n")),
             contains_text("is not a finite number"));
  CHECK_THAT(problem(anim_of("    1 0 auto auto 1 0 2;\n")),
             contains_text("breakdown is 2, but must be 0 or 1"));
  CHECK_THAT(
      problem(anim_of("    9 0 auto auto 1 0 0;\n    8 0 auto auto 1 0 0;\n")),
      contains_text("walk.anim:17: error: pSphere1.translate.y: frame 8 is not after frame 9"));
  CHECK_THAT(problem(anim_of("    1 0 auto auto 1 0 0 7;\n")), contains_text("it must end with ;"));
  CHECK_THAT(problem(anim_of("", "  colour blue;\n")),
             contains_text("keyword \"colour\" is not known"));
  CHECK_THAT(problem(anim_of("    1 0 fixed auto 1 0 0 45 -1;\n")),
             contains_text("must not be negative"));
  std::string old = anim_of("    1 0 auto auto 1 0 0;\n");
  old.replace(old.find("mayaVersion 2022"), 16, "mayaVersion 2.5 ");
  CHECK_THAT(problem(old), contains_text("is before 3"));
}

TEST_CASE("every beginning of an .anim is a file or a problem", "[exchange][maya]") {
  const std::string text =
      anim_of("    1 0 fixed fixed 1 0 0 45 1 45 1;\n    5 2 step stepnext 1 0 0;\n");
  REQUIRE(read_anim(text).has_value());
  for (std::size_t size = 0; size < text.size(); ++size) {
    const auto file = read_anim(text.substr(0, size));
    if (file)
      CHECK(file->curves.size() <= 1);
    else
      CHECK_FALSE(file.error().message.empty());
  }
}

TEST_CASE("an .anim that we write is laid out as Maya's", "[exchange][maya]") {
  const Curve<1> curve = make({key(1, 0, of_segment(SegmentKind::Linear)),
                               key(13, 5, of_segment(SegmentKind::Step)), key(24, 2)});
  const auto text = write_curves({{"poke.magnitude", curve}}, CurveFormat::Maya, {.last = 24});
  REQUIRE(text.has_value());
  CHECK(text->losses.empty());
  CHECK(text->bytes ==
        "animVersion 1.1;\nmayaVersion 2022;\ntimeUnit film;\nlinearUnit cm;\n"
        "angularUnit deg;\nstartTime 1;\nendTime 24;\n"
        "anim magnitude magnitude poke 0 0 0;\nanimData {\n  input time;\n"
        "  output unitless;\n  weighted 0;\n  preInfinity constant;\n"
        "  postInfinity constant;\n  keys {\n    1 0 flat linear 1 0 0;\n"
        "    13 5 linear step 1 0 0;\n    24 2 flat flat 1 0 0;\n  }\n}\n");
}

}  // namespace
}  // namespace pliant
