#include "pliant/core/shelf.hpp"

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "support/catch.hpp"

using namespace pliant;

namespace {

struct Word final : Shelf::Item {
  explicit Word(std::string text) : text(std::move(text)) {}
  std::string text;
};

struct Count final : Shelf::Item {};

void keep_word(Shelf& shelf, const Hash& key, const std::string& text, std::size_t bytes) {
  shelf.keep(key, std::make_shared<const Word>(text), bytes);
}

std::shared_ptr<const Word> find_word(Shelf& shelf, const Hash& key, const std::string& text) {
  return shelf.find<Word>(key, [&](const Word& word) { return word.text == text; });
}

}  // namespace

TEST_CASE("a shelf finds what is the same, whatever has the same key", "[core][shelf]") {
  Shelf shelf(100);
  const Hash key = hash_of("key");
  shelf.keep(key, std::make_shared<const Count>(), 1);
  keep_word(shelf, key, "one", 1);
  keep_word(shelf, key, "two", 1);
  CHECK(find_word(shelf, key, "one")->text == "one");
  CHECK(find_word(shelf, key, "two")->text == "two");
  CHECK_FALSE(find_word(shelf, key, "three"));
  CHECK_FALSE(find_word(shelf, hash_of("other"), "one"));
  CHECK(shelf.find<Count>(key, [](const Count&) { return true; }));
}

TEST_CASE("a shelf keeps what was used last, within its bytes", "[core][shelf]") {
  Shelf shelf(10);
  const auto key = [](int k) { return hash_of(std::to_string(k)); };
  for (int k = 0; k < 5; ++k) keep_word(shelf, key(k), "w", 2);
  CHECK(shelf.bytes() == 10);
  const auto held = find_word(shelf, key(1), "w");
  CHECK(find_word(shelf, key(0), "w"));  // used last
  keep_word(shelf, key(5), "w", 7);
  CHECK(shelf.bytes() <= 10);
  CHECK(find_word(shelf, key(5), "w"));
  CHECK(find_word(shelf, key(0), "w"));
  for (int k = 1; k < 5; ++k) CHECK_FALSE(find_word(shelf, key(k), "w"));
  CHECK(held->text == "w");  // without the shelf
  keep_word(shelf, key(6), "w", 11);
  CHECK_FALSE(find_word(shelf, key(6), "w"));
  CHECK(shelf.bytes() == 9);
}

TEST_CASE("what changes often takes the place of its own type and key only", "[core][shelf]") {
  Shelf shelf(10);
  const Hash key = hash_of("key"), other = hash_of("other");
  shelf.keep(key, std::make_shared<const Count>(), 1);
  keep_word(shelf, other, "one", 2);
  for (const char* text : {"one", "two", "three"})
    shelf.keep_instead(key, std::make_shared<const Word>(text), 4);
  CHECK_FALSE(find_word(shelf, key, "two"));
  CHECK(find_word(shelf, key, "three"));
  CHECK(find_word(shelf, other, "one"));
  CHECK(shelf.find<Count>(key, [](const Count&) { return true; }));
  CHECK(shelf.bytes() == 7);
  shelf.keep_instead(key, std::make_shared<const Word>("large"), 11);
  CHECK(find_word(shelf, key, "three"));
}

TEST_CASE("several threads use one shelf", "[core][shelf][threads]") {
  Shelf shelf(40);
  std::vector<std::jthread> threads;
  std::vector<int> wrong(4);
  for (int thread = 0; thread < 4; ++thread) {
    threads.emplace_back([&, thread] {
      for (int k = 0; k < 2000; ++k) {
        const std::string text = std::to_string((k * (thread + 3)) % 30);
        const auto found = find_word(shelf, hash_of(text), text);
        if (found && found->text != text) ++wrong[thread];
        if (!found) keep_word(shelf, hash_of(text), text, 2);
      }
    });
  }
  threads.clear();
  CHECK(wrong == std::vector<int>(4));
  CHECK(shelf.bytes() <= 40);
}
