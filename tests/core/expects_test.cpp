#include "pliant/core/expects.hpp"

#include <csignal>
#include <cstdlib>

#include <sys/wait.h>
#include <unistd.h>

#include "support/catch.hpp"

TEST_CASE("a broken requirement stops the program", "[core][expects]") {
  const pid_t child = fork();
  REQUIRE(child >= 0);
  if (child == 0) {
    std::signal(SIGABRT, SIG_DFL);  // Catch's handler would report the child's end as a failure
    close(STDERR_FILENO);
    pliant::contract_broken("1 == 2", "file.cpp", 3);
  }
  int status = 0;
  waitpid(child, &status, 0);
  CHECK(WIFSIGNALED(status));
}

TEST_CASE("a requirement that holds does nothing", "[core][expects]") {
  PLIANT_EXPECTS(1 + 1 == 2);
  SUCCEED();
}
