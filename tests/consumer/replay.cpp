// A test in another program that a scene reproduces its recorded log, and that another scene does
// not.
// usage: replay SCENE LOG OTHER_LOG

#include <cstdio>
#include <string>

#include <pliant/replay/expect_replay.hpp>

int main(int count, char* arguments[]) {
  if (count != 4) return 2;
  const std::string trouble = pliant::testing::expect_replay(arguments[1], arguments[2]);
  const std::string expected_trouble = pliant::testing::expect_replay(arguments[1], arguments[3]);
  std::printf("%s\n%s", trouble.c_str(), expected_trouble.c_str());
  return trouble.empty() && !expected_trouble.empty() ? 0 : 1;
}
