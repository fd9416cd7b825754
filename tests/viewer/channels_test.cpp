#include "viewer/channels.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "pliant/scene/format/key_text.hpp"
#include "scene/scene_text.hpp"
#include "support/scenes.hpp"

using namespace pliant;
using namespace pliant::testing;
using viewer::Json;

namespace {

Json channels_of_text(const std::string& text) {
  const Scene scene = scene_of(text);
  return viewer::view_channels(scene, {scene.start, scene.end}).value();
}

/// The one channel of a scene with an animated magnitude.
Json told(const std::string& attributes, const std::string& keys) {
  const Json channels = channels_of_text(animate_with(attributes, keys));
  REQUIRE(channels.size() == 1);
  return channels[0];
}

std::vector<std::string> with_numbers(const std::vector<std::string>& words,
                                      const std::string& numbers) {
  std::vector<std::string> texts;
  for (const std::string& word : words) texts.push_back(word + numbers);
  return texts;
}

Json channel_of(const CurveKeys<1>& keys, int last) {
  Scene scene = testing::scene({sheet("s")}, {poke("f", {0, 0, 0})}, last);
  scene.forces[0].magnitude = Curve<1>::make(keys).value();
  return viewer::view_channels(scene, {1, last}).value().at(0);
}

}  // namespace

TEST_CASE("a key has the words of the format", "[viewer][channels]") {
  const std::string control = " control=\"0 0 1 1\"";
  for (const std::string& word : xml::interpolation_words()) {
    const Json keys = told("", fmt::format(R"(<key frame="1" value="5" interpolation="{}"{}/>
      <key frame="9" value="7" interpolation="linear"/>)",
                                           word, word == "cubicBezier" ? control : ""))["keys"];
    CHECK(keys[0]["next"] == word);
    CHECK(keys[1]["next"] == "linear");
  }
  std::vector<std::string> tangents = xml::tangent_words();
  tangents.emplace_back("-0.1");
  for (const std::string& in : tangents)
    for (const std::string& out : tangents) {
      const Json key =
          told("", fmt::format(R"(<key frame="2.5" value="7" in="{}" out="{}" inLength="3"/>)", in,
                               out))["keys"][0];
      CHECK(key == Json{{"at", {2.5, 7}}, {"next", "bezier"}, {"in", in}, {"out", out}});
    }
  const Json turned = told("tangent=\"flat\"", R"(<key frame="1" value="5" outHandle="2 1"/>)");
  CHECK(turned["keys"][0]["in"] == "flat");
  CHECK(turned["keys"][0]["out"] == "handle");
  const Json vector = channels_of_text(force_with(
      R"(<animate attribute="center"><key frame="1" value="1 2 3" in="0 -1 0.5"/></animate>)"));
  CHECK(vector[0]["components"] == 3);
  CHECK(vector[0]["keys"][0]["at"] == Json{1, 1, 2, 3});
  CHECK(vector[0]["keys"][0]["in"] == "0 -1 0.5");
}

TEST_CASE("a channel has what is outside its keys as the format says it", "[viewer][channels]") {
  const xml::ExtrapolationWords words = xml::extrapolation_words();
  std::vector<std::string> texts = words.plain;
  for (const auto& some :
       {words.loops, with_numbers(words.loops, " 3"), with_numbers(words.slopes, " -0.5")})
    texts.insert(texts.end(), some.begin(), some.end());
  const std::string keys = R"(<key frame="1" value="5"/><key frame="9" value="7"/>)";
  for (const std::string& before : texts)
    for (const std::string& after : texts) {
      const Json channel = told(fmt::format(R"(before="{}" after="{}")", before, after), keys);
      CHECK(channel["before"] == before);
      CHECK(channel["after"] == after);
      CHECK_FALSE(channel.contains("loop"));
    }
  const Json loop =
      told("", keys + R"(<loop from="1" to="12" before="2" after="1" offset="0.5"/>)")["loop"];
  CHECK(loop == Json{{"from", 1}, {"to", 12}, {"before", 2}, {"after", 1}, {"offset", {0.5}}});
}

TEST_CASE("a switch is told from a number", "[viewer][channels]") {
  const Json channels = channels_of_text(force_with(R"(
    <animate attribute="magnitude"><key frame="1" value="0"/></animate>
    <animate attribute="enabled"><key frame="1" value="true"/><key frame="5" value="false"/></animate>)"));
  for (const Json& channel : channels)
    CHECK(channel.value("isSwitch", false) == (channel["path"] == "poke.enabled"));
  const auto is_switch = [](const Json& channel) { return channel.contains("isSwitch"); };
  const auto found = std::find_if(channels.begin(), channels.end(), is_switch);
  REQUIRE(found != channels.end());
  CHECK((*found)["keys"][0]["at"] == Json{1, 1});
  CHECK((*found)["keys"][1]["at"] == Json{5, 0});
  CHECK((*found)["keys"][0]["next"] == "step");
}

TEST_CASE("both handles of each Bezier segment are told, and their sides", "[viewer][channels]") {
  using Kind = Tangent<1>::Kind;
  std::mt19937 random(3);
  for (int round = 0; round < 100; ++round) {
    CurveKeys<1> keys;
    for (int k = 0; k < 6; ++k) {
      Key<1> key{.frame = 4.0 * k, .value = {static_cast<double>(random() % 5)}};
      key.next.kind = random() % 2 ? Interpolation::Kind::Bezier : Interpolation::Kind::Linear;
      for (Tangent<1>* tangent : {&key.in, &key.out}) {
        tangent->kind = static_cast<Kind>(random() % 10);
        if (random() % 2) tangent->length = static_cast<double>(random() % 3);  // 0 as well
        tangent->handle_frames =
            (tangent == &key.in ? -1.0 : 1.0) * static_cast<double>(random() % 2);
      }
      keys.keys.push_back(key);
    }
    const Json handles = channel_of(keys, 20)["handles"];
    std::size_t next = 0;
    for (std::size_t k = 0; k + 1 < keys.keys.size(); ++k) {
      if (keys.keys[k].next.kind != Interpolation::Kind::Bezier) continue;
      for (const bool is_out : {true, false}) {
        const Key<1>& key = keys.keys[is_out ? k : k + 1];
        REQUIRE(next < handles.size());
        const Json& handle = handles[next++];
        CHECK(handle["side"] == (is_out ? "out" : "in"));
        CHECK(handle["key"] == Json{key.frame, key.value[0]});
        const double frames = handle["tip"][0].get<double>() - key.frame;
        CHECK((is_out ? frames : -frames) >= 0);
      }
    }
    CHECK(next == handles.size());
  }
}

TEST_CASE("lines between points are the curve", "[viewer][channels]") {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> number(-1, 1);
  const Interpolation::Kind kinds[] = {Interpolation::Kind::Step, Interpolation::Kind::Linear,
                                       Interpolation::Kind::Bezier};
  for (int round = 0; round < 60; ++round) {
    CurveKeys<1> keys;
    for (int k = 0; k < 12; ++k) {
      Key<1> key{.frame = 3 + 2 * k + 0.4 * number(random), .value = {number(random)}};
      if (random() % 2) key.frame = std::round(key.frame);
      key.next.kind = kinds[random() % (round % 2 ? 2 : 3)];
      keys.keys.push_back(key);
    }
    if (round % 3 == 0)
      keys.loop = Loop<1>{.from = keys.keys[2].frame, .to = keys.keys[4].frame, .after = 1};
    if (round % 4 == 0) keys.after.kind = Extrapolation<1>::Kind::Mirror;
    const Curve<1> curve = Curve<1>::make(keys).value();
    const Json points = channel_of(keys, 30)["points"];
    const auto frame = [&](std::size_t k) { return points[k][0].get<double>(); };
    const auto value = [&](std::size_t k) { return points[k][1].get<double>(); };
    const bool has_lines_only = round % 2 == 1 && !keys.loop;
    for (std::size_t k = 1; k < points.size(); ++k) {
      REQUIRE(frame(k) >= frame(k - 1));
      const bool jumps = k + 1 < points.size() && frame(k + 1) == frame(k);
      CHECK(value(k) == (jumps ? curve.left_value(frame(k)) : curve.value(frame(k)))[0]);
      // Copies by a loop may jump between points.
      const bool is_inside =
          frame(k - 1) >= keys.keys.front().frame && frame(k) <= keys.keys.back().frame;
      if (frame(k) == frame(k - 1) || !is_inside || keys.loop) continue;
      // A curve is off a line over h frames by at most h^2/8 of its second derivative, and these
      // bend by less than 40 per square frame: values to 1, slopes to 2, segments of a frame.
      const double h = frame(k) - frame(k - 1);
      const double middle = (frame(k - 1) + frame(k)) / 2;
      const double deviation = std::abs(curve.value(middle)[0] - (value(k - 1) + value(k)) / 2);
      CHECK(deviation <= (h <= 0.125 ? 40 * h * h / 8 : 1e-14));  // values to 1: rounding
    }
    // Each frame that the page shows, each key, and inside straight parts nothing else.
    const auto has = [&](double wanted) {
      return std::any_of(points.begin(), points.end(),
                         [&](const Json& point) { return point[0] == wanted; });
    };
    for (int shown = 1; shown <= 30; ++shown) CHECK(has(shown));
    for (const Key<1>& key : keys.keys) CHECK(has(key.frame));
    if (!has_lines_only) continue;
    const auto is_between = [&](const Json& point) {
      const double at = point[0];
      return at > std::ceil(keys.keys.front().frame) && at < std::floor(keys.keys.back().frame) &&
             at != std::round(at) &&
             std::none_of(keys.keys.begin(), keys.keys.end(),
                          [&](const Key<1>& key) { return key.frame == at; });
    };
    CHECK(std::none_of(points.begin(), points.end(), is_between));
  }
}
