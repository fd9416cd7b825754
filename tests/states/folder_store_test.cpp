#include "pliant/states/folder_store.hpp"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <random>
#include <thread>
#include <vector>

#include <sys/stat.h>
#include <unistd.h>

#include "pliant/files/read_file.hpp"
#include "support/catch.hpp"
#include "support/moving_scene.hpp"
#include "support/scratch_folder.hpp"
#include "support/shared_store.hpp"

using namespace pliant;
using namespace pliant::testing;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t plenty_on_disk = 1'000'000'000;
constexpr std::size_t page = 4096;

std::unique_ptr<FolderStateStore> open(const fs::path& folder,
                                       std::size_t budget = plenty_on_disk) {
  return FolderStateStore::open(folder, budget).value();
}

Hash some_key(std::uint64_t number) {
  const std::string text = std::to_string(number);
  return hash_of(std::string_view(text));
}

// Bakes a scene with the store.
FrameCounts run(const Scene& scene, StateStore& store, std::vector<std::string>& states) {
  auto simulation = Simulation::make(scene, {.checkpoint_bytes = 0, .store = &store}).value();
  states.clear();
  for (const int frame : simulation.frames()) states.push_back(state_at(simulation, frame));
  return simulation.frame_counts();
}

void set_age(const fs::path& file, std::chrono::seconds age) {
  fs::last_write_time(file, fs::file_time_type::clock::now() - age);
}

std::vector<fs::path> files_in(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::directory_iterator(folder)) files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::size_t bytes_in(const fs::path& folder) {
  std::size_t bytes = 0;
  for (const fs::path& file : files_in(folder)) {
    bytes += (fs::file_size(file) + page - 1) / page * page;
  }
  return bytes;
}

}  // namespace

TEST_CASE("a folder gives back what was put there, to any process", "[states][store]") {
  const ScratchFolder scratch;
  const fs::path folder = scratch.file("a/b");
  auto store = open(folder);
  CHECK_FALSE(store->holds(some_key(1)));
  CHECK_FALSE(store->read(some_key(1), 100));
  store->write(some_key(1), "one");
  store->write(some_key(2), "");
  for (auto* reader : {store.get(), open(folder).release()}) {
    const std::unique_ptr<FolderStateStore> owner(reader == store.get() ? nullptr : reader);
    CHECK(reader->holds(some_key(1)));
    CHECK(reader->read(some_key(1), 100) == "one");
    CHECK(reader->read(some_key(2), 100) == "");
    CHECK(reader->read(some_key(1), 2) == "on");  // truncated: its seal detects this
  }
  store->discard(some_key(1));
  CHECK_FALSE(store->holds(some_key(1)));
  CHECK(store->damaged_count() == 1);
  CHECK(store->trouble().empty());
}

TEST_CASE("a folder makes a second run read what the first one solved", "[states][store]") {
  const ScratchFolder scratch;
  const Scene s = moving_scene();
  const auto expected = all_states(s);
  std::vector<std::string> states;
  auto store = open(scratch.path());
  CHECK(run(s, *store, states).solved == s.end - s.start);
  CHECK(states == expected);
  store = open(scratch.path());
  CHECK(run(s, *store, states).solved == 0);
  CHECK(states == expected);
}

TEST_CASE("a file that was cut or changed is solved again, and whole after that",
          "[states][store]") {
  const ScratchFolder scratch;
  const Scene s = scene({sheet("s", 7)}, {poke("f", {0, 0, 0})}, 8);
  const auto expected = all_states(s);
  std::vector<std::string> states;
  run(s, *open(scratch.path()), states);
  std::mt19937 random(3);
  for (const fs::path& file : files_in(scratch.path())) {
    const std::string whole = read_file(file).value();
    for (int n = 0; n < 12; ++n) {
      std::string bytes = whole;
      if (n % 2 == 0) {
        bytes.resize(random() % bytes.size());
      } else {
        bytes[random() % bytes.size()] ^= static_cast<char>(1 << random() % 8);
      }
      std::ofstream(file, std::ios::binary) << bytes;
      auto store = open(scratch.path());
      CHECK(run(s, *store, states).solved == 1);
      CHECK(states == expected);
      CHECK(store->damaged_count() == 1);
      CHECK(read_file(file).value() == whole);
    }
  }
}

TEST_CASE("one state under the name of another is found out", "[states][store]") {
  const ScratchFolder scratch;
  const Scene s = scene({sheet("s", 7)}, {poke("f", {0, 0, 0})}, 8);
  const auto expected = all_states(s);
  std::vector<std::string> states;
  run(s, *open(scratch.path()), states);
  const auto files = files_in(scratch.path());
  REQUIRE(files.size() == 7);
  for (std::size_t k = 1; k < files.size(); ++k) {
    fs::copy_file(files[0], files[k], fs::copy_options::overwrite_existing);
  }
  CHECK(run(s, *open(scratch.path()), states).solved == 6);
  CHECK(states == expected);
}

TEST_CASE("what else lies in the folder is left alone", "[states][store]") {
  const ScratchFolder scratch;
  const std::string name = to_text(some_key(1)) + ".state";
  scratch.write("notes.txt", "mine");
  scratch.write(to_text(some_key(2)), "mine");
  scratch.write("x" + name, "mine");
  scratch.write(".mine.part", "mine");
  fs::create_directory(scratch.file(name));
  const std::string link = to_text(some_key(3)) + ".state", pipe = to_text(some_key(4)) + ".state";
  fs::create_symlink(scratch.file("notes.txt"), scratch.file(link));
  REQUIRE(mkfifo(scratch.file(pipe).c_str(), 0600) == 0);
  auto store = open(scratch.path(), 3 * page);
  for (const std::uint64_t number : {1, 3, 4}) {
    CHECK_FALSE(store->holds(some_key(number)));
    CHECK_FALSE(store->read(some_key(number), 100));  // it does not wait for a writer either
  }
  for (std::uint64_t number = 10; number < 50; ++number) store->write(some_key(number), "text");
  for (const std::string& there : {std::string("notes.txt"), to_text(some_key(2)), "x" + name,
                                   std::string(".mine.part"), name, link, pipe}) {
    CHECK(fs::exists(fs::symlink_status(scratch.file(there))));
  }
  CHECK(read_file(scratch.file("notes.txt")).value() == "mine");
  CHECK(scratch.entry_count() <= 7 + 3);
}

TEST_CASE("the budget of disk space is kept", "[states][store]") {
  const ScratchFolder scratch;
  const std::size_t budget = GENERATE(0u, 1u, 4u, 20u, 70u) * page;
  const std::string bytes(page + 1, 'x');  // two pages each
  for (int run = 0; run < 2; ++run) {
    auto store = open(scratch.path(), budget);
    for (std::uint64_t number = 0; number < 100; ++number) {
      store->write(some_key(number), bytes);
      REQUIRE(bytes_in(scratch.path()) <= budget);
    }
    CHECK(store->trouble().empty());
  }
  // Most of the budget is used.
  CHECK(bytes_in(scratch.path()) >= budget / 2 / (2 * page) * (2 * page));
}

TEST_CASE("what was not used for long goes first", "[states][store]") {
  const ScratchFolder scratch;
  {
    auto before = open(scratch.path());
    for (std::uint64_t number = 0; number < 20; ++number) before->write(some_key(number), "text");
  }
  for (const fs::path& file : files_in(scratch.path())) set_age(file, std::chrono::hours(5));
  set_age(scratch.file(to_text(some_key(7)) + ".state"), std::chrono::hours(9));
  auto store = open(scratch.path(), 20 * page);
  CHECK(store->read(some_key(3), 100) == "text");
  store->write(some_key(100), "text");
  CHECK_FALSE(store->holds(some_key(7)));
  for (std::uint64_t number = 101; number < 115; ++number) store->write(some_key(number), "text");
  CHECK(store->holds(some_key(3)));
  for (std::uint64_t number = 100; number < 115; ++number) CHECK(store->holds(some_key(number)));
}

TEST_CASE("a run that is larger than the budget keeps states all over it", "[states][store]") {
  const ScratchFolder scratch;
  auto store = open(scratch.path(), 64 * page);
  for (std::uint64_t number = 0; number < 512; ++number) store->write(some_key(number), "text");
  const auto kept_of = [&](std::uint64_t first, std::uint64_t last) {
    int kept = 0;
    for (std::uint64_t number = first; number < last; ++number) {
      kept += store->holds(some_key(number)) ? 1 : 0;
    }
    return kept;
  };
  CHECK(kept_of(0, 128) >= 4);
  CHECK(kept_of(128, 256) >= 4);
  CHECK(kept_of(256, 512) >= 8);
}

TEST_CASE("what a killed process left half written goes after a while", "[states][store]") {
  const ScratchFolder scratch;
  const std::string part = "." + to_text(some_key(1)) + ".state.123-0.part";
  const std::string fresh = "." + to_text(some_key(2)) + ".state.123-0.part";
  set_age(scratch.write(part, "half"), std::chrono::hours(1));
  scratch.write(fresh, "half");
  auto store = open(scratch.path());
  CHECK_FALSE(store->holds(some_key(1)));
  store->write(some_key(3), "text");
  CHECK_FALSE(fs::exists(scratch.file(part)));
  CHECK(fs::exists(scratch.file(fresh)));  // another process may be writing it
}

TEST_CASE("a folder that cannot be one is an error", "[states][store]") {
  const ScratchFolder scratch;
  const auto file = FolderStateStore::open(scratch.write("file", "text"), plenty_on_disk);
  REQUIRE_FALSE(file);
  CHECK(file.error().code == ErrorCode::InvalidInput);
  const auto below = FolderStateStore::open(scratch.file("file/below"), plenty_on_disk);
  REQUIRE_FALSE(below);
  CHECK(below.error().code == ErrorCode::Unwritable);
}

TEST_CASE("a folder that is gone ends the keeping, not the run", "[states][store]") {
  const ScratchFolder scratch;
  const Scene s = moving_scene();
  auto store = open(scratch.file("cache"));
  fs::remove_all(scratch.file("cache"));
  std::vector<std::string> states;
  CHECK(run(s, *store, states).solved == s.end - s.start);
  CHECK(states == all_states(s));
  CHECK_THAT(store->trouble(), contains_text("No such file"));
}

TEST_CASE("threads share a folder's store", "[states][store][threads]") {
  const ScratchFolder scratch;
  SECTION("with room for all") {
    const auto store = open(scratch.path());
    CHECK(share(*store) == shared_states);
    CHECK(store->trouble().empty());
  }
  SECTION("with room for a third") {
    const auto store = open(scratch.path(), 200'000);
    CHECK(share(*store) > 0);
    CHECK(store->trouble().empty());
  }
}

TEST_CASE("runs share a folder at the same time", "[states][store][threads]") {
  const ScratchFolder scratch;
  const Scene s = moving_scene();
  const auto expected = all_states(s);
  // With room for all, and with so little that they evict each other's states.
  const std::size_t budget = GENERATE(plenty_on_disk, std::size_t{100'000});
  std::atomic<int> wrong = 0;
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 3; ++thread) {
    threads.emplace_back([&] {
      auto store = open(scratch.path(), budget);
      std::vector<std::string> states;
      for (int n = 0; n < 2; ++n) {
        run(s, *store, states);
        if (states != expected) ++wrong;
      }
      if (store->damaged_count() > 0 || !store->trouble().empty()) ++wrong;
    });
  }
  threads.clear();
  CHECK(wrong == 0);
}
