#include "pliant/files/boxed/run_boxed.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include <fcntl.h>
#include <sys/time.h>
#include <sys/wait.h>
#include <unistd.h>

#include "files/boxed/boxed_programs.hpp"
#include "support/catch.hpp"

using namespace pliant;
using namespace pliant::testing;
using How = BoxedEnd::How;

namespace {

using Clock = std::chrono::steady_clock;

constexpr BoxLimits ample{std::size_t{256} << 20, 60, std::size_t{1} << 20};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

class NoInput {
 public:
  NoInput() : descriptor_(open("/dev/null", O_RDONLY | O_CLOEXEC)) {}
  ~NoInput() { close(descriptor_); }
  operator int() const { return descriptor_; }

 private:
  int descriptor_;
};

Result<BoxedEnd> act(const std::string& what, const BoxLimits& limits = ample,
                     const StopRequest& should_stop = {}, const std::string& number = "0") {
  return run_boxed(misbehaving(), {"fbx", what, number}, NoInput(), limits, should_stop);
}

std::size_t open_files() {
  return static_cast<std::size_t>(std::distance(
      std::filesystem::directory_iterator("/proc/self/fd"), std::filesystem::directory_iterator()));
}

bool has_children() { return waitpid(-1, nullptr, WNOHANG) != -1 || errno != ECHILD; }

// Whether there is a process with this argument.
bool is_running(const std::string& argument) {
  std::error_code ignored;
  for (const auto& entry : std::filesystem::directory_iterator("/proc", ignored)) {
    std::ifstream file(entry.path() / "cmdline", std::ios::binary);
    const std::string line((std::istreambuf_iterator<char>(file)), {});
    if (line.find(std::string(1, '\0') + argument + '\0') != std::string::npos) return true;
  }
  return false;
}

bool becomes(bool expected, const std::function<bool()>& fact) {
  for (const auto begin = Clock::now(); seconds_since(begin) < 20;) {
    if (fact() == expected) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

}  // namespace

TEST_CASE("a boxed program's end is told", "[mesh][run_boxed]") {
  const auto check = [](const std::string& what, How how, int number) {
    CAPTURE(what);
    const auto end = act(what);
    REQUIRE(end);
    CHECK(end->how == how);
    CHECK(end->number == number);
  };
  check("nothing", How::Exited, boxed_done);
  check("give up", How::Exited, 3);
  check("crash", How::Killed, SIGSEGV);
  check("abort", How::Killed, SIGABRT);
  check("recurse", How::Killed, SIGSEGV);
  check("allocate", How::Exited, boxed_out_of_memory);
  CHECK(act("rubbish")->answer == "rubbish");
}

TEST_CASE("a boxed program that runs on is ended", "[mesh][run_boxed]") {
  const auto begin = Clock::now();
  const auto end = act("spin", {ample.memory, 0.3, ample.answer_bytes});
  REQUIRE(end);
  CHECK(end->how == How::TimedOut);
  CHECK(seconds_since(begin) < 10);
}

TEST_CASE("an answer without end is cut off", "[mesh][run_boxed]") {
  const auto end = act("flood");
  REQUIRE(end);
  CHECK(end->how == How::TooLong);
  CHECK(end->answer.size() <= ample.answer_bytes + (std::size_t{1} << 16));
}

TEST_CASE("a boxed program is ended when its caller wants to stop", "[mesh][run_boxed]") {
  const auto begin = Clock::now();
  int asked = 0;
  const auto end = act("spin", ample, [&] { return ++asked == 3; });
  REQUIRE_FALSE(end);
  CHECK(end.error().code == ErrorCode::Interrupted);
  CHECK(seconds_since(begin) < 10);
  CHECK_FALSE(has_children());
}

TEST_CASE("what should_stop throws leaves no process behind", "[mesh][run_boxed]") {
  CHECK_THROWS_AS(act("spin", ample, []() -> bool { throw std::runtime_error("stop"); }),
                  std::runtime_error);
  CHECK_FALSE(has_children());
}

TEST_CASE("a boxed program leaves no process and no open file behind", "[mesh][run_boxed]") {
  act("nothing").value();
  const std::size_t before = open_files();
  for (const std::string what : {"nothing", "crash", "rubbish", "flood", "give up"})
    act(what).value();
  CHECK(open_files() == before);
  CHECK_FALSE(has_children());
}

TEST_CASE("a boxed program reaches nothing but its input and its answer", "[mesh][run_boxed]") {
  const std::string secret = "secret";
  setenv("PLIANT_TEST_SECRET", secret.c_str(), 1);
  const int inheritable = open("/dev/null", O_RDONLY);  // as careless programs leave them open
  const auto end = act("escape");
  close(inheritable);
  unsetenv("PLIANT_TEST_SECRET");
  REQUIRE(end);
#ifdef PLIANT_SECCOMP
  CHECK_THAT(end->answer, contains_text("it stays in"));
#else
  for (const std::string held : {"reads files", "writes files", "writes its input", "has a pipe",
                                 "has an environment", "has other open files"})
    CHECK_THAT(end->answer, !contains_text(held));
#endif
  CHECK_FALSE(std::filesystem::exists("/tmp/pliant-escaped"));
}

TEST_CASE("a boxed program dies with its parent", "[mesh][run_boxed]") {
  misbehaving();
  const std::string mark = "mark-" + std::to_string(getpid());
  const pid_t parent = fork();
  if (parent == 0) {
    const auto end = act("spin", ample, {}, mark);
    _exit(end ? 0 : 1);
  }
  REQUIRE(becomes(true, [&] { return is_running(mark); }));
  kill(parent, SIGKILL);
  waitpid(parent, nullptr, 0);
  CHECK(becomes(false, [&] { return is_running(mark); }));
}

TEST_CASE("eight threads run boxed programs at once", "[mesh][run_boxed][threads]") {
  misbehaving();
  std::atomic<int> right = 0;
  std::vector<std::thread> threads;
  for (int k = 0; k < 8; ++k) {
    threads.emplace_back([&, k] {
      for (int turn = 0; turn < 5; ++turn) {
        const bool crashes = (k + turn) % 2 == 0;
        const auto end = act(crashes ? "crash" : "rubbish");
        right += end && (crashes ? end->how == How::Killed : end->answer == "rubbish");
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  CHECK(right == 40);
  CHECK_FALSE(has_children());
}

TEST_CASE("signals that come meanwhile do no harm", "[mesh][run_boxed]") {
  struct sigaction action {};
  struct sigaction before {};
  action.sa_handler = [](int) {};  // without SA_RESTART: calls end with EINTR
  sigaction(SIGALRM, &action, &before);
  const itimerval often{{0, 500}, {0, 500}}, never{};
  setitimer(ITIMER_REAL, &often, nullptr);
  for (int turn = 0; turn < 10; ++turn) CHECK(act("rubbish")->answer == "rubbish");
  setitimer(ITIMER_REAL, &never, nullptr);
  sigaction(SIGALRM, &before, nullptr);
}

TEST_CASE("a program whose children nobody waits for reads all the same", "[mesh][run_boxed]") {
  const auto before = std::signal(SIGCHLD, SIG_IGN);  // the system reaps them
  const auto end = act("rubbish");
  std::signal(SIGCHLD, before);
  REQUIRE(end);
  CHECK(end->answer == "rubbish");
}

TEST_CASE("a system that starts no process is an error", "[mesh][run_boxed]") {
  const auto end = run_boxed("no program", {"fbx", "", "0"}, NoInput(), ample, {});
  REQUIRE_FALSE(end);
  CHECK(end.error().code == ErrorCode::Unreadable);
  CHECK_THAT(end.error().message, contains_text("Exec format error"));
  const auto no_input = run_boxed(misbehaving(), {"fbx", "nothing", "0"}, -1, ample, {});
  REQUIRE_FALSE(no_input);
  CHECK_THAT(no_input.error().message, contains_text("Bad file descriptor"));
}
