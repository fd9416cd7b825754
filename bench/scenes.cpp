// Measures reading and checking scenes with many keys, as `pliant validate` does, and fits the cost
// against the number of keys: the last lines of each kind, BigO and RMS, must say N with a small
// RMS.
//
//   one/KIND     a channel with all keys, of tangents of this kind
//   vector, own  keys of a vector; keys with tangents and lengths of their own
//   channels     channels of 100 keys each
//   names        a force with all surfaces as its targets: N is their number
//
// Processor time, one thread. Run: build/release/bench/scenes

#include <cstddef>
#include <string>
#include <string_view>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pliant/scene/read.hpp"
#include "pliant/simulation/simulation.hpp"

namespace {

constexpr std::string_view surface =
    "<surface name=\"{}\"><grid columns=\"3\" rows=\"3\"/></surface>\n";

std::string scene(std::string_view body) {
  return fmt::format("<scene start=\"1\" end=\"100\">\n{}{}</scene>\n",
                     fmt::format(fmt::runtime(surface), "sheet"), body);
}

// `value` and `attributes` of each key.
std::string keys(std::size_t count, std::string_view value, std::string_view attributes) {
  std::string text;
  for (std::size_t k = 0; k < count; ++k) {
    text += fmt::format("<key frame=\"{}\" value=\"{}{}\"{}/>\n", 0.01 * static_cast<double>(k),
                        k % 7, value, attributes);
  }
  return text;
}

std::string force(std::size_t number, std::string_view channel, std::string_view tangent,
                  const std::string& keys) {
  return fmt::format(
      "<point name=\"p{}\"><animate attribute=\"{}\" tangent=\"{}\">\n{}</animate></point>\n",
      number, channel, tangent, keys);
}

void check(benchmark::State& state, const std::string& text) {
  for (auto _ : state) {
    const auto read = pliant::parse_scene(text, "scene.xml", "");
    if (!read || !pliant::Simulation::check(*read)) state.SkipWithError("the scene is not valid");
  }
  state.SetComplexityN(state.range(0));
}

void one(benchmark::State& state, std::string_view tangent) {
  check(state, scene(force(0, "magnitude", tangent, keys(state.range(0), "", ""))));
}

void vector(benchmark::State& state) {
  check(state, scene(force(0, "center", "smooth", keys(state.range(0), " 1 2", ""))));
}

void own(benchmark::State& state) {
  check(state,
        scene(force(0, "magnitude", "auto",
                    keys(state.range(0), "",
                         " in=\"flat\" out=\"1.5\" inLength=\"0.002\" outLength=\"0.002\""))));
}

void channels(benchmark::State& state) {
  constexpr std::size_t each = 100;
  std::string body;
  for (std::size_t k = 0; k < static_cast<std::size_t>(state.range(0)) / each; ++k) {
    body += force(k, "magnitude", "auto", keys(each, "", ""));
  }
  check(state, scene(body));
}

void names(benchmark::State& state) {
  std::string body, targets;
  for (int k = 0; k < state.range(0); ++k) {
    const std::string name = fmt::format("s{}", k);
    body += fmt::format(fmt::runtime(surface), name);
    targets += name + ' ';
  }
  check(state, scene(body + fmt::format("<point name=\"p\" targets=\"{}\"/>", targets)));
}

void scale(benchmark::internal::Benchmark* benchmark) {
  benchmark->RangeMultiplier(10)
      ->Range(1'000, 100'000)
      ->Complexity(benchmark::oN)
      ->Unit(benchmark::kMillisecond);
}

BENCHMARK_CAPTURE(one, auto, "auto") -> Apply(scale);
BENCHMARK_CAPTURE(one, spline, "spline")->Apply(scale);
BENCHMARK_CAPTURE(one, linear, "linear")->Apply(scale);
BENCHMARK_CAPTURE(one, flat, "flat")->Apply(scale);
BENCHMARK_CAPTURE(one, clamped, "clamped")->Apply(scale);
BENCHMARK_CAPTURE(one, plateau, "plateau")->Apply(scale);
BENCHMARK_CAPTURE(one, smooth, "smooth")->Apply(scale);
BENCHMARK_CAPTURE(one, free, "free")->Apply(scale);
BENCHMARK_CAPTURE(one, slope, "0.5")->Apply(scale);
BENCHMARK(vector)->Apply(scale);
BENCHMARK(own)->Apply(scale);
BENCHMARK(channels)->Apply(scale);
BENCHMARK(names)->Apply(scale);

}  // namespace

BENCHMARK_MAIN();
