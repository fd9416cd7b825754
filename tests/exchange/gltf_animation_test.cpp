#include <cmath>
#include <string>

#include "exchange/round_trips.hpp"
#include "pliant/core/base64.hpp"
#include "pliant/exchange/rotations.hpp"
#include "pliant/files/raw_bytes.hpp"

namespace pliant {
namespace {

using namespace testing;

std::string base64(const std::vector<float>& numbers) {
  return pliant::base64(bytes_of(std::span<const float>(numbers)));
}

/// A glTF with one sampler that animates `path` of a node.
std::string gltf_of(const std::string& path, const std::string& interpolation,
                    const std::vector<float>& times, const std::vector<float>& values,
                    const std::string& type, std::size_t count) {
  std::vector<float> all = times;
  all.insert(all.end(), values.begin(), values.end());
  return fmt::format(
      R"({{"asset": {{"version": "2.0"}}, "nodes": [{{"name": "Ball"}}],
"animations": [{{"name": "Take", "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "{}"}}}}],
"samplers": [{{"input": 0, "output": 1, "interpolation": "{}"}}]}}],
"accessors": [{{"bufferView": 0, "componentType": 5126, "count": {}, "type": "SCALAR"}},
{{"bufferView": 1, "componentType": 5126, "count": {}, "type": "{}"}}],
"bufferViews": [{{"buffer": 0, "byteLength": {}}}, {{"buffer": 0, "byteOffset": {}, "byteLength": {}}}],
"buffers": [{{"byteLength": {}, "uri": "data:application/octet-stream;base64,{}"}}]}})",
      path, interpolation, times.size(), count, type, 4 * times.size(), 4 * times.size(),
      4 * values.size(), 4 * all.size(), base64(all));
}

Result<CurveFile> read_gltf_text(const std::string& text, const CurveReading& reading = {}) {
  return parse_curves(text, CurveFormat::Gltf, "ball.gltf", reading);
}

TEST_CASE("translations by LINEAR, STEP and CUBICSPLINE", "[exchange][gltf]") {
  const std::vector<float> times{0, 0.5F, 1};
  const std::vector<float> values{0, 0, 0, 1, 2, 3, 0.1F, 0, 0};
  const auto linear = read_gltf_text(gltf_of("translation", "LINEAR", times, values, "VEC3", 3));
  REQUIRE(linear.has_value());
  REQUIRE(linear->curves.size() == 3);
  CHECK(linear->curves[1].name == "Ball.translation.y");
  CHECK(linear->curves[0].keys.keys[2].value[0] == 0.1);
  const Curve<1> y = make(linear->curves[1].keys);
  CHECK(y.keys().keys[1].frame == 13);  // second 0 is frame 1
  CHECK(y.value(7)[0] == 1);
  const auto steps = read_gltf_text(gltf_of("scale", "STEP", times, values, "VEC3", 3));
  REQUIRE(steps.has_value());
  CHECK(make(steps->curves[2].keys).value(20)[0] == 3);
  // In-tangent, value, out-tangent, per second.
  std::vector<float> spline(27, 0);
  spline[3] = 0;
  spline[6] = 4.0F;   // out of key 0, x
  spline[9] = 2.0F;   // into key 1, x
  spline[12] = 3.0F;  // x of key 1
  const auto cubic =
      read_gltf_text(gltf_of("translation", "CUBICSPLINE", times, spline, "VEC3", 9));
  REQUIRE(cubic.has_value());
  const Curve<1> x = make(cubic->curves[0].keys);
  CHECK(x.velocity(1)[0] == 4.0 / 24);
  // The formula of the specification, appendix C.5, at the middle.
  CHECK_THAT(x.value(7)[0], WithinAbs(0.5 * 3 + 0.5 * 0.125 * 4 - 0.5 * 0.125 * 2, 1e-12));
}

TEST_CASE("weights are curves of their own", "[exchange][gltf]") {
  const auto file =
      read_gltf_text(gltf_of("weights", "LINEAR", {0, 1}, {0, 0.25F, 1, 0.75F}, "SCALAR", 4));
  REQUIRE(file.has_value());
  REQUIRE(file->curves.size() == 2);
  CHECK(file->curves[1].name == "Ball.weights[1]");
  CHECK(make(file->curves[1].keys).value(13)[0] == 0.5);
}

TEST_CASE("rotations become angles that turn alike", "[exchange][gltf]") {
  const auto order = GENERATE(RotateOrder::Xyz, RotateOrder::Zxy, RotateOrder::Yxz);
  const std::string interpolation = GENERATE("LINEAR", "CUBICSPLINE");
  const std::vector<float> times{0, 1, 2.5F};
  const std::vector<exchange::Quaternion> turns{
      {0, 0, 0, 1}, {0.5, -0.5, 0.1, 0.7}, {0.1, 0.9, -0.2, 0.1}};
  std::vector<float> values;
  for (const exchange::Quaternion& turn : turns) {
    double length = 0;
    for (const double each : turn) length += each * each;
    const bool is_cubic = interpolation == "CUBICSPLINE";
    if (is_cubic) values.insert(values.end(), {0.1F, 0.2F, 0, -0.1F});
    for (const double each : turn) values.push_back(static_cast<float>(each / std::sqrt(length)));
    if (is_cubic) values.insert(values.end(), {0.1F, 0.2F, 0, -0.1F});
  }
  CurveReading reading;
  reading.rotate_order = order;
  const auto file = read_gltf_text(
      gltf_of("rotation", interpolation, times, values, "VEC4", interpolation == "LINEAR" ? 3 : 9),
      reading);
  INFO((file ? "" : file.error().message));
  REQUIRE(file.has_value());
  REQUIRE(file->curves.size() == 3);
  CHECK(file->curves[0].unit == CurveUnit::Degrees);
  REQUIRE(file->losses.size() == 1);
  CHECK_THAT(file->losses[0].message, contains_text("its quaternions became angles"));
  if (interpolation != "LINEAR") return;
  std::vector<Curve<1>> angles;
  for (const FileCurve& curve : file->curves) angles.push_back(make(curve.keys));
  for (int k = 0; k <= 100; ++k) {
    const double frame = 1 + 24 * k / 100.0;
    const exchange::Quaternion exact = exchange::slerp(turns[0], turns[1], k / 100.0);
    const exchange::Quaternion own = exchange::quaternion_near(
        {angles[0].value(frame)[0], angles[1].value(frame)[0], angles[2].value(frame)[0]}, order,
        exact);
    double dot = 0;
    for (std::size_t c = 0; c < 4; ++c) dot += exact[c] * own[c];
    CHECK(2 * std::acos(std::min(1.0, dot)) * 180 / M_PI < 0.05);
  }
}

TEST_CASE("a rotation that does not change has few keys", "[exchange][gltf]") {
  const Curve<3> still = Curve<3>::make({.keys = {{.frame = 1, .value = {30, 40, 50}},
                                                  {.frame = 101, .value = {30, 40, 50}},
                                                  {.frame = 150, .value = {30, 40, 50.5}}}})
                             .value();
  const auto text =
      write_curves({{"sheet.rotate", still, CurveUnit::Degrees}}, CurveFormat::Gltf, {.last = 150});
  REQUIRE(text.has_value());
  const auto file = parse_curves(text->bytes, CurveFormat::Gltf, "sheet.glb", {});
  REQUIRE(file.has_value());
  CHECK(file->curves[2].keys.keys.size() < 40);
  // The last one looks along an axis at which angles are not sure.
  for (const exchange::Quaternion& turn : {exchange::Quaternion{0.1, 0.2, 0.3, 0.9274},
                                           exchange::Quaternion{0, 0.7071068, 0, 0.7071068}}) {
    std::vector<float> values;
    for (int k = 0; k < 2; ++k)
      for (const double each : turn) values.push_back(static_cast<float>(each));
    const auto own = read_gltf_text(gltf_of("rotation", "LINEAR", {0, 4}, values, "VEC4", 2));
    REQUIRE(own.has_value());
    for (const FileCurve& curve : own->curves) CHECK(curve.keys.keys.size() == 2);
  }
}

TEST_CASE("rotations come back from a file", "[exchange][gltf]") {
  const auto order = static_cast<RotateOrder>(GENERATE(range(0, 6)));
  const Curve<3> turn = Curve<3>::make({.keys = {{.frame = 1},
                                                 {.frame = 20, .value = {80, 10, -30}},
                                                 {.frame = 48, .value = {400, 35, 70}}}})
                            .value();
  const auto text = write_curves({{"sheet.rotate", turn, CurveUnit::Degrees, order}},
                                 CurveFormat::Gltf, {.last = 48});
  REQUIRE(text.has_value());
  CurveReading reading;
  reading.rotate_order = order;
  const auto file = parse_curves(text->bytes, CurveFormat::Gltf, "sheet.glb", reading);
  REQUIRE(file.has_value());
  REQUIRE(file->curves.size() == 3);
  for (std::size_t c = 0; c < 3; ++c) {
    const Curve<1> own = make(file->curves[c].keys);
    for (double frame = 1; frame <= 48; frame += 0.37) {
      CAPTURE(c, frame);
      CHECK(std::fabs(own.value(frame)[0] - turn.value(frame)[c]) < 3e-4 * 400);
    }
  }
}

TEST_CASE("a vector is one sampler, a number a node of its own", "[exchange][gltf]") {
  const Curve<3> center =
      Curve<3>::make({.keys = {{.frame = 1}, {.frame = 25, .value = {1, 2, 3}}}}).value();
  const Curve<1> magnitude = make({key(1, 0), key(13, 100), key(25, 5)});
  const auto text = write_curves({{"poke.center", center}, {"poke.magnitude", magnitude}},
                                 CurveFormat::Gltf, {.last = 25, .is_binary = false});
  REQUIRE(text.has_value());
  CHECK(text->losses.empty());
  const auto file = read_gltf_text(text->bytes);
  REQUIRE(file.has_value());
  REQUIRE(file->curves.size() == 6);
  CHECK(file->curves[0].name == "poke.translation.x");
  CHECK(file->curves[3].name == "poke.magnitude.translation.x");
  CHECK(disagreement(magnitude, make(file->curves[3].keys), 1, 25, {1e-5, 1e-4}) == 0);
}

TEST_CASE("the largest value goes out and comes back", "[exchange][gltf]") {
  for (const double largest : {1e30, -1e30}) {
    const auto text = write_curves({{"poke.magnitude", make({key(1, 0), key(13, largest)})}},
                                   CurveFormat::Gltf, {.last = 25});
    REQUIRE(text.has_value());
    const auto file = parse_curves(text->bytes, CurveFormat::Gltf, "large.glb", {});
    REQUIRE(file.has_value());
    CHECK(file->curves[0].keys.keys[1].value[0] == largest);
  }
}

TEST_CASE("keys before the first frame move second 0", "[exchange][gltf]") {
  const Curve<1> early = make({key(-11, 3), key(13, 100)});
  const auto text = write_curves({{"poke.magnitude", early}}, CurveFormat::Gltf, {.last = 25});
  REQUIRE(text.has_value());
  REQUIRE(text->losses.size() == 1);
  CHECK(text->losses[0].is_exact);
  CHECK_THAT(text->losses[0].message, contains_text("second 0 is frame -11"));
  const auto file = parse_curves(text->bytes, CurveFormat::Gltf, "early.glb", {});
  REQUIRE(file.has_value());
  CHECK(file->curves[0].keys.keys[0].frame == -11);
}

TEST_CASE("problems of an animation name the channel and the rule", "[exchange][gltf]") {
  const auto problem = [](const std::string& text) {
    const auto file = read_gltf_text(text);
    return file ? "" : file.error().message;
  };
  const std::vector<float> two{0, 1};
  CHECK_THAT(problem(gltf_of("translation", "LINEAR", {1, 0.5F}, {0, 0, 0, 1, 1, 1}, "VEC3", 2)),
             contains_text(
                 "Ball.translation has a key at 0.5 s after one at frame 25; times must increase"));
  CHECK_THAT(problem(gltf_of("translation", "LINEAR", two, {0, 0, 0}, "VEC3", 1)),
             contains_text("has 3 numbers for 2 keys"));
  CHECK_THAT(problem(gltf_of("translation", "WARP", two, {0, 0, 0, 1, 1, 1}, "VEC3", 2)),
             contains_text("samplers[0].interpolation is \"WARP\""));
  CHECK_THAT(problem(gltf_of("rotation", "LINEAR", two, {0, 0, 0, 0, 0, 0, 0, 1}, "VEC4", 2)),
             contains_text("quaternion of length 0 at frame 1"));
  CHECK_THAT(problem(gltf_of("translation", "LINEAR", {0, 1e30F}, {0, 0, 0, 1, 1, 1}, "VEC3", 2)),
             contains_text("at most 10000000 frames"));
  CHECK_THAT(problem(gltf_of("rotation", "LINEAR", two, {0, 0, 0, 1, 1, 1}, "VEC3", 2)),
             contains_text("is of type \"VEC3\", not VEC4"));
  const auto pointer = read_gltf_text(gltf_of("pointer", "LINEAR", two, {0, 1}, "SCALAR", 2));
  REQUIRE(pointer.has_value());
  CHECK(pointer->curves.empty());
  CHECK_THAT(pointer->losses.at(0).message, contains_text("by an extension"));
}

TEST_CASE("every beginning of an animation is a problem", "[exchange][gltf]") {
  const Curve<1> curve = make({key(1, 0), key(13, 100)});
  for (const bool is_binary : {true, false}) {
    const auto text = write_curves({{"poke.magnitude", curve}}, CurveFormat::Gltf,
                                   {.last = 25, .is_binary = is_binary});
    REQUIRE(text.has_value());
    for (std::size_t size = 0; size < text->bytes.size(); ++size)
      CHECK_FALSE(read_gltf_text(text->bytes.substr(0, size)).has_value());
  }
}

}  // namespace
}  // namespace pliant
