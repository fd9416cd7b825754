#include "pliant/scene/text/findings.hpp"

#include <memory>
#include <string>

#include "support/catch.hpp"

namespace pliant::xml {
namespace {

using pliant::testing::contains_text;

const auto lines = std::make_shared<SourceText>(std::string(20'000, '\n'));

/// The begin of a line.
TextPlace line(std::uint32_t number) { return {0, {number - 1, number - 1}}; }

TEST_CASE("problems come in the order of lines, each once", "[scene][findings]") {
  Findings findings("plate.xml", lines);
  findings.add_problem(line(9), "ninth");
  findings.add_problem(line(2), "second, found later");
  findings.add_problem(line(9), "ninth");
  findings.add_problem(line(2), "second too");
  CHECK(findings.problem_count() == 4);
  const Error error = findings.to_error();
  CHECK(to_lines(error) == std::vector<std::string>{"plate.xml:2: error: second, found later",
                                                    "plate.xml:2: error: second too",
                                                    "plate.xml:9: error: ninth"});
  CHECK(error.code == ErrorCode::InvalidInput);
}

TEST_CASE("a flood of problems is cut off with a word about it", "[scene][findings]") {
  Findings findings("plate.xml", lines);
  for (std::uint32_t k = 1; !findings.is_over(); ++k) findings.add_problem(line(k), "bad");
  const std::size_t listed = findings.problem_count();
  findings.add_problem(line(1), "one more");
  const Error error = findings.to_error();
  CHECK(error.others.size() == listed);
  CHECK_THAT(error.others.back().message, contains_text("too many problems"));
}

TEST_CASE("notes come in the order of lines", "[scene][findings]") {
  Findings findings("plate.xml", lines);
  findings.add_note(line(5), "b");
  findings.add_note(line(3), "a");
  CHECK(findings.notes() ==
        std::vector<SceneNote>{{{3, 1, 3, 1}, "a", "plate.xml"}, {{5, 1, 5, 1}, "b", "plate.xml"}});
  CHECK(findings.problem_count() == 0);
}

}  // namespace
}  // namespace pliant::xml
