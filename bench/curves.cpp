// Measures the cost of one value of a curve, compared with an evaluator written in an hour: a
// binary search for the segment, then Newton's method for the time.
//
//   plain      that evaluator; it treats every segment as a Bézier cubic
//   curve      Curve::value, which is stateless
//   sampler    Sampler::value, which remembers the last segment
//
//   playback   1000 keys, frame after frame, about eight to a segment
//   random     the same frames in random order
//   scene      2000 curves of 20 keys, all at one frame, then all at the next
//
//   bezier     handles of random lengths and slopes
//   cubic      default lengths: time is linear in the parameter
//   vector     bezier with three components, which share one solve; nanoseconds for all three
//
// All evaluators get the same keys and frames. The repetitions run in random order, so that noise
// affects all alike. The table at the end lists the medians of the processor time per value.
// Run: build/release/bench/curves [--benchmark_min_time=SECONDS]

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include "pliant/timeline/curve.hpp"
#include "pliant/timeline/sampler.hpp"

namespace {

using namespace pliant;

constexpr double frames_per_segment = 8;  // on average

// Polynomial c[0] + c[1] u + c[2] u² + c[3] u³.
struct Polynomial {
  double c[4];

  static Polynomial through(double p0, double p1, double p2, double p3) {
    return {{p0, 3 * (p1 - p0), 3 * (p2 - 2 * p1 + p0), p3 - 3 * p2 + 3 * p1 - p0}};
  }
  double value(double u) const { return c[0] + u * (c[1] + u * (c[2] + u * c[3])); }
  double slope(double u) const { return c[1] + u * (2 * c[2] + u * (3 * c[3])); }
};

// The reference: keys in one array, cubics in another, without clever tricks and without waste.
template <int D>
class PlainEvaluator {
 public:
  explicit PlainEvaluator(const CurveKeys<D>& keys) {
    for (std::size_t k = 0; k < keys.keys.size(); ++k) {
      const Key<D>& start = keys.keys[k];
      frames_.push_back(start.frame);
      if (k + 1 == keys.keys.size()) break;
      const Key<D>& end = keys.keys[k + 1];
      const double span = end.frame - start.frame;
      const double out = start.out.length.value_or(span / 3);
      const double in = end.in.length.value_or(span / 3);
      Segment segment;
      segment.time = Polynomial::through(0, out, span - in, span);
      for (int c = 0; c < D; ++c) {
        segment.values[c] =
            Polynomial::through(start.value[c], start.value[c] + start.out.slope[c] * out,
                                end.value[c] - end.in.slope[c] * in, end.value[c]);
      }
      segments_.push_back(segment);
    }
  }

  Value<D> value(double frame) const {
    const auto after = std::upper_bound(frames_.begin(), frames_.end(), frame);
    const std::ptrdiff_t segment =
        std::clamp<std::ptrdiff_t>(after - frames_.begin() - 1, 0, segments_.size() - 1);
    const Segment& here = segments_[segment];
    const double u =
        parameter(here.time, frame - frames_[segment], frames_[segment + 1] - frames_[segment]);
    Value<D> value;
    for (int c = 0; c < D; ++c) value[c] = here.values[c].value(u);
    return value;
  }

 private:
  struct Segment {
    Polynomial time;  // from the segment's start
    Polynomial values[D];
  };

  // Newton's method within a bracket, starting from the linear estimate, until it no longer
  // changes.
  static double parameter(const Polynomial& time, double elapsed, double span) {
    double low = 0;
    double high = 1;
    double u = elapsed / span;
    for (int round = 0; round < 60; ++round) {
      const double miss = time.value(u) - elapsed;
      if (miss == 0) break;
      (miss > 0 ? high : low) = u;
      double next = u - miss / time.slope(u);
      if (!(next > low && next < high)) next = (low + high) / 2;
      const double step = std::fabs(next - u);
      u = next;
      if (step <= 1e-15) break;
    }
    return u;
  }

  std::vector<double> frames_;
  std::vector<Segment> segments_;
};

enum class Lengths { Third, Random };

// Keys at irregular frames with random values and slopes; time runs forwards as written.
template <int D>
CurveKeys<D> random_keys(int count, Lengths lengths, unsigned seed) {
  std::mt19937_64 bits(seed);
  const auto between = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(bits);
  };
  CurveKeys<D> keys;
  double span = 0;
  double frame = 0;
  for (int k = 0; k < count; ++k) {
    Key<D> key;
    key.frame = frame;
    const double span_before = span;
    span = between(0.5, 1.5) * frames_per_segment;
    frame += span;
    for (auto* side : {&key.in, &key.out}) {
      side->kind = Tangent<D>::Kind::Slope;
      for (double& each : side->slope) each = between(-1, 1);
    }
    for (double& each : key.value) each = between(-10, 10);
    if (lengths == Lengths::Random) {
      // Handles short and long, up to the whole segment.
      key.in.length = between(0.02, 1) * span_before;
      key.out.length = between(0.02, 1) * span;
    }
    keys.keys.push_back(key);
  }
  return keys;
}

template <int D>
struct Evaluators {
  CurveKeys<D> keys;
  PlainEvaluator<D> plain;
  Curve<D> curve;

  explicit Evaluators(CurveKeys<D> from)
      : keys(std::move(from)), plain(keys), curve(Curve<D>::make(keys).value()) {}
};

template <int D>
std::vector<double> frames_of(const CurveKeys<D>& keys) {
  std::vector<double> frames;
  // Between whole frames, to avoid keys: the value at a key needs no evaluation.
  for (double t = keys.keys.front().frame + 0.37; t < keys.keys.back().frame; t += 1) {
    frames.push_back(t);
  }
  return frames;
}

// Evaluates all frames repeatedly.
template <class Evaluate>
void ask(benchmark::State& state, const std::vector<double>& frames, const Evaluate& value) {
  for (auto _ : state) {
    for (const double frame : frames) benchmark::DoNotOptimize(value(frame));
  }
  state.counters["values"] = static_cast<double>(frames.size());
}

template <class Function>
void add(const std::string& row, const std::string& column, const Function& function) {
  benchmark::RegisterBenchmark((row + "/" + column).c_str(), function)
      ->Repetitions(9)
      ->ReportAggregatesOnly();
}

template <int D>
void add_single(const std::string& row, const std::shared_ptr<const Evaluators<D>>& of,
                const std::vector<double>& frames) {
  add(row, "plain", [=](benchmark::State& state) {
    ask(state, frames, [&](double t) { return of->plain.value(t); });
  });
  add(row, "curve", [=](benchmark::State& state) {
    ask(state, frames, [&](double t) { return of->curve.value(t); });
  });
  add(row, "sampler", [=](benchmark::State& state) {
    Sampler<D> sampler(of->curve);
    ask(state, frames, [&](double t) { return sampler.value(t); });
  });
}

template <int D>
void add_playback_and_random(const std::string& kind, Lengths lengths) {
  const auto of = std::make_shared<const Evaluators<D>>(random_keys<D>(1000, lengths, 1));
  std::vector<double> frames = frames_of(of->keys);
  add_single(kind + " playback", of, frames);
  std::shuffle(frames.begin(), frames.end(), std::mt19937_64(2));
  add_single(kind + " random", of, frames);
}

void add_scene(const std::string& kind, Lengths lengths) {
  std::vector<Evaluators<1>> curves;
  for (unsigned i = 0; i < 2000; ++i) curves.emplace_back(random_keys<1>(20, lengths, i));
  const auto of = std::make_shared<const std::vector<Evaluators<1>>>(std::move(curves));
  // Advances one frame each time, and starts again after the hundredth.
  const auto ask_all = [of](benchmark::State& state, const auto& value) {
    double frame = 0.37;
    for (auto _ : state) {
      for (std::size_t i = 0; i < of->size(); ++i) benchmark::DoNotOptimize(value(i, frame));
      frame = frame < 100 ? frame + 1 : 0.37;
    }
    state.counters["values"] = static_cast<double>(of->size());
  };
  const std::string row = kind + " scene";
  add(row, "plain", [=](benchmark::State& state) {
    ask_all(state, [&](std::size_t i, double t) { return (*of)[i].plain.value(t); });
  });
  add(row, "curve", [=](benchmark::State& state) {
    ask_all(state, [&](std::size_t i, double t) { return (*of)[i].curve.value(t); });
  });
  add(row, "sampler", [=](benchmark::State& state) {
    std::vector<Sampler<1>> samplers;
    for (const auto& each : *of) samplers.emplace_back(each.curve);
    ask_all(state, [&](std::size_t i, double t) { return samplers[i].value(t); });
  });
}

// Making a curve of 1000 keys; nanoseconds for each key.
void add_making(const std::string& kind, Lengths lengths) {
  add(kind + " making", "curve",
      [keys = random_keys<1>(1000, lengths, 1)](benchmark::State& state) {
        for (auto _ : state) benchmark::DoNotOptimize(Curve<1>::make(keys));
        state.counters["values"] = static_cast<double>(keys.keys.size());
      });
}

// Prints every line as usual and stores the medians.
class Medians : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs) {
      if (run.aggregate_name != "median") continue;
      nanoseconds_[run.run_name.function_name] =
          run.GetAdjustedCPUTime() / run.counters.at("values").value;
    }
  }

  double nanoseconds(const std::string& row, const std::string& column) const {
    const auto found = nanoseconds_.find(row + "/" + column);
    return found == nanoseconds_.end() ? 0 : found->second;
  }

 private:
  std::map<std::string, double> nanoseconds_;
};

void print_table(const Medians& medians) {
  fmt::print("\nnanoseconds a value, medians, and in brackets how often it fits into plain's\n");
  fmt::print("{:>18} {:>8} {:>16} {:>16}\n", "", "plain", "curve", "sampler");
  const auto cell = [](double plain, double ns) {
    return fmt::format("{:.1f} ({:.1f})", ns, plain / ns);
  };
  for (const std::string kind : {"bezier", "cubic", "vector"}) {
    for (const std::string how : {"playback", "random", "scene"}) {
      const std::string row = kind + " " + how;
      const double plain = medians.nanoseconds(row, "plain");
      const double curve = medians.nanoseconds(row, "curve");
      const double sampler = medians.nanoseconds(row, "sampler");
      if (plain == 0 || curve == 0 || sampler == 0) continue;
      fmt::print("{:>18} {:>8.1f} {:>16} {:>16}\n", row, plain, cell(plain, curve),
                 cell(plain, sampler));
    }
  }
  const double general = medians.nanoseconds("bezier playback", "plain");
  const double cubic = medians.nanoseconds("cubic playback", "sampler");
  if (general != 0 && cubic != 0) {
    fmt::print("cubic playback by sampler is {:.1f} times as fast as bezier playback by plain\n",
               general / cubic);
  }
  fmt::print("making a curve: {:.0f} ns a key (bezier), {:.0f} ns (cubic)\n",
             medians.nanoseconds("bezier making", "curve"),
             medians.nanoseconds("cubic making", "curve"));
}

}  // namespace

int main(int count, char* arguments[]) {
  add_playback_and_random<1>("bezier", Lengths::Random);
  add_playback_and_random<1>("cubic", Lengths::Third);
  add_playback_and_random<3>("vector", Lengths::Random);
  add_scene("bezier", Lengths::Random);
  add_scene("cubic", Lengths::Third);
  add_making("bezier", Lengths::Random);
  add_making("cubic", Lengths::Third);
  std::string interleaving = "--benchmark_enable_random_interleaving=true";
  std::vector<char*> all(arguments, arguments + count);
  all.insert(all.begin() + 1, interleaving.data());
  int all_count = static_cast<int>(all.size());
  all.push_back(nullptr);
  benchmark::Initialize(&all_count, all.data());
  if (benchmark::ReportUnrecognizedArguments(all_count, all.data())) return 1;
  Medians medians;
  benchmark::RunSpecifiedBenchmarks(&medians);
  print_table(medians);
  return 0;
}
