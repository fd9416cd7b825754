// Measures what a sweep adds to the solves of its takes, and what a million takes cost.
//
//   takes      1000 takes of a scene with other dampings, or of what --vary says, on two threads,
//   in
//              a folder: seconds, and processor time over that of playing the same scenes by
//              themselves, one simulation after the other, on two threads
//   plan       10^6 takes: two intervals sampled, all values checked, sweep.json written [s]
//   resume     the folder opened, its log of 10^6 lines read [s]
//   table      takes.csv written [s]
//   memory     the most that the process had [MB]
//
// Run: build/release/bench/sweep [--scene SCENE] [--takes N] [--vary PATH=VALUES] [--million N]

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include "measuring.hpp"
#include "pliant/pliant.hpp"
#include "pliant/sweep/folder.hpp"

namespace {

using namespace pliant;
namespace fs = std::filesystem;

constexpr int thread_count = 2;

struct Options {
  std::string scene = "examples/sheet.xml";
  int takes = 1000;
  std::string vary = {};  // empty: so many dampings
  int million = 1'000'000;
};

double most_memory() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1000;
}

// Plays every take of a sweep, and nothing else.
double play_all(const Sweep& sweep) {
  const double begin = processor_seconds();
  std::atomic<std::size_t> next = 0;
  std::vector<std::jthread> threads;
  for (int k = 0; k < thread_count; ++k) {
    threads.emplace_back([&] {
      for (std::size_t take; (take = next++) < sweep.takes().count();) {
        auto simulation = value_or_abort(
            Simulation::make(value_or_abort(sweep.scene_of(take)), {.checkpoint_bytes = 0}));
        Frame frame;
        for (const int number : simulation.frames())
          frame = value_or_abort(simulation.at(number, std::move(frame)));
      }
    });
  }
  threads.clear();
  return processor_seconds() - begin;
}

void measure_takes(const Options& options, const ScratchFolder& scratch) {
  const SweepRequest request{
      .scenes = {options.scene},
      .variation = {.vary = {options.vary.empty()
                                 ? fmt::format("sheet.damping=5:100:{}", options.takes)
                                 : options.vary}}};
  double processor = processor_seconds();
  const double wall = seconds([&] {
    const auto folder = value_or_abort(SweepFolder::make(scratch.file("takes"), request));
    if (!folder.run({.threads = thread_count})) std::abort();
    if (!folder.write_table(value_or_abort(folder.status()))) std::abort();
  });
  processor = processor_seconds() - processor;
  const double alone = play_all(value_or_abort(SweepFolder::plan(request)));
  fmt::print(
      "takes   {:8.2f} s wall, {:.2f} s of processors; played alone {:.2f} s; ratio {:.3f}\n", wall,
      processor, alone, processor / alone);
}

void measure_million(const Options& options, const ScratchFolder& scratch) {
  const SweepRequest request{.scenes = {options.scene},
                             .variation = {.vary = {"sheet.density=1:50", "sheet.damping=1:100"},
                                           .samples = static_cast<std::size_t>(options.million)}};
  const std::string name = scratch.file("million");
  double planned = seconds([&] { value_or_abort(SweepFolder::make(name, request)); });
  fs::create_directories(name + "/log");
  {
    // As two workers write it.
    std::ofstream logs[] = {std::ofstream(name + "/log/a.jsonl"),
                            std::ofstream(name + "/log/b.jsonl")};
    for (int take = 0; take < options.million; ++take)
      logs[take % 2] << fmt::format(
          "{{\"take\":{},\"status\":\"done\",\"peak\":{},\"peakFrame\":42,\"final\":{},\"rms\":{},"
          "\"speed\":{},\"energy\":{},\"settle\":96,\"hash\":\"{:032x}\",\"seconds\":0.123456,"
          "\"host\":\"node{}\",\"time\":\"2026-11-24T10:45:00.123Z\"}}\n",
          take, 1.0 / (take + 3), 1.0 / (take + 7), 1.0 / (take + 11), 24.0 / (take + 13),
          100.0 / (take + 17), take, take % 100);
  }
  std::optional<SweepFolder> folder;
  std::optional<SweepStatus> status;
  const double resumed = seconds([&] {
    folder.emplace(value_or_abort(SweepFolder::open(name)));
    if (!folder->run({})) std::abort();  // finds nothing to do
    status.emplace(value_or_abort(folder->status()));
  });
  const double tabled = seconds([&] {
    if (!folder->write_table(*status)) std::abort();
  });
  fmt::print("plan    {:8.2f} s\nresume  {:8.2f} s\ntable   {:8.2f} s\nmemory  {:8.0f} MB\n",
             planned, resumed, tabled, most_memory());
}

}  // namespace

int main(int count, char* arguments[]) {
  Options options;
  if (!read_options(count, arguments,
                    {{"--scene", &options.scene},
                     {"--takes", &options.takes},
                     {"--vary", &options.vary},
                     {"--million", &options.million}},
                    "sweep [--scene SCENE] [--takes N] [--vary PATH=VALUES] [--million N]"))
    return 2;
  const ScratchFolder scratch(fs::temp_directory_path());
  if (options.million > 0) measure_million(options, scratch);
  if (options.takes > 0) measure_takes(options, scratch);
}
