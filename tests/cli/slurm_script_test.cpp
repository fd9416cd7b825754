#include "cli/sweep/slurm_script.hpp"

#include <numeric>
#include <string>
#include <vector>

#include "cli/terminal/shell_word.hpp"
#include "support/catch.hpp"

using namespace pliant::cli;

namespace {

std::string lines_of(const SlurmScript& script, const std::string& begin) {
  const std::string text = job_script(script);
  std::string found;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    const std::string line = text.substr(at, end - at);
    if (line.starts_with(begin)) found += line + '\n';
    at = end + 1;
  }
  return found;
}

}  // namespace

TEST_CASE("a list of an array has ranges, and is read back", "[cli][slurm]") {
  CHECK(array_list({}).empty());
  CHECK(array_list(std::vector<std::size_t>{0}) == "0");
  CHECK(array_list(std::vector<std::size_t>{3, 4}) == "3-4");
  const std::vector<std::size_t> scattered = {0, 5, 7, 9, 20, 21};
  CHECK(array_list(scattered, 13) == "0,5,7,9,20-21");
  CHECK(array_list(scattered, 12) == "0,5-9,20-21");
  CHECK(array_list(scattered, 10) == "0-9,20-21");
  CHECK(array_list(scattered, 8) == "0-21");
  CHECK(array_list(std::vector<std::size_t>{0, 1, 2, 5, 7, 8, 9}) == "0-2,5,7-9");
  for (unsigned pattern = 1; pattern < 1024; ++pattern) {
    std::vector<std::size_t> numbers;
    for (std::size_t k = 0; k < 10; ++k)
      if ((pattern >> k & 1U) != 0) numbers.push_back(k);
    CAPTURE(pattern);
    CHECK(read_array_list(array_list(numbers), 10) == numbers);
  }
  std::vector<std::size_t> all(4'000'001);
  std::iota(all.begin(), all.end(), std::size_t{0});
  CHECK(array_list(all) == "0-4000000");
}

TEST_CASE("a part has the root of its command", "[cli][slurm]") {
  const SlurmScript script{
      .executable = "/pliant", .folder = "/s", .name = "s", .root = "/my shots", .retries = true};
  CHECK(lines_of(script, "exec ").ends_with(" --quiet --root '/my shots' --retry\n"));
}

TEST_CASE("lists of an array as users write them", "[cli][slurm]") {
  using List = std::vector<std::size_t>;
  CHECK(read_array_list("0-9:4", 100) == List{0, 4, 8});
  CHECK(read_array_list("7,1-2,2%5", 100) == List{1, 2, 7});
  CHECK(read_array_list("5-18446744073709551615", 8) == List{5, 6, 7});
  CHECK(read_array_list("1-18446744073709551615:18446744073709551615", 8) == List{1});
  for (const char* wrong : {"", "x", "1-", "2-1", "1-2:0", "1,,2", "1 2", "-1", "1:2"}) {
    CAPTURE(wrong);
    CHECK_FALSE(read_array_list(wrong, 100));
  }
}

TEST_CASE("memory has a quarter more, and time four times the estimate", "[cli][slurm]") {
  SlurmScript script{.executable = "/bin/pliant", .folder = "/s", .name = "s", .threads = 4};
  CHECK(lines_of(script, "#SBATCH --mem").empty());
  CHECK(lines_of(script, "#SBATCH --time").empty());
  script.memory = std::size_t{100} << 20U;
  CHECK(lines_of(script, "#SBATCH --mem") == "#SBATCH --mem=125M\n");
  script.memory = *script.memory + 1;  // never less
  CHECK(lines_of(script, "#SBATCH --mem") == "#SBATCH --mem=126M\n");
  script.seconds = 0;
  CHECK(lines_of(script, "#SBATCH --time") == "#SBATCH --time=30\n");
  script.seconds = 600;
  CHECK(lines_of(script, "#SBATCH --time") == "#SBATCH --time=40\n");
  script.seconds = 601;
  CHECK(lines_of(script, "#SBATCH --time") == "#SBATCH --time=41\n");
}

TEST_CASE("names go through bash and sbatch as they are", "[cli][slurm]") {
  CHECK(shell_word("/a/b-c_d.e") == "/a/b-c_d.e");
  CHECK(shell_word("") == "''");
  CHECK(shell_word("it's $x") == "'it'\\''s $x'");
  const SlurmScript script{
      .executable = "/bin/pliant", .folder = "/a b/50%\"x\"$y", .name = "50%\"x\"$y \xc3\xa4"};
  CHECK(lines_of(script, "#SBATCH --job-name") == "#SBATCH --job-name=pliant-50__x__y___\n");
  CHECK(lines_of(script, "#SBATCH --output") ==
        "#SBATCH --output=\"/a b/50%%\\\"x\\\"$y/slurm/%A_%a.log\"\n");
  CHECK(lines_of(script, "exec") ==
        "exec /bin/pliant sweep run '/a b/50%\"x\"$y' --part $SLURM_ARRAY_TASK_ID/1 --threads "
        "$SLURM_CPUS_PER_TASK --quiet\n");
  CHECK(wrong_slurm_folder(script.folder).empty());
  CHECK_FALSE(wrong_slurm_folder("/a\nb").empty());
  CHECK_FALSE(wrong_slurm_folder("/a\tb").empty());
  CHECK_FALSE(wrong_slurm_folder("/a\\b").empty());
}
