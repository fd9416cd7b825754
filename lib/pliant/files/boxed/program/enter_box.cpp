#include "pliant/files/boxed/program/enter_box.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <string>

#include <fcntl.h>
#include <malloc.h>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#ifdef PLIANT_SECCOMP
#include <seccomp.h>
#endif

#include "pliant/files/boxed/run_boxed.hpp"

namespace pliant {
namespace {

constexpr rlim_t stack_bytes = rlim_t{64} << 20;

// A limit may be lower already; it cannot be raised.
bool limit(__rlimit_resource resource, rlim_t most) {
  rlimit now{};
  if (getrlimit(resource, &now) != 0) return false;
  const rlim_t lowest = std::min(most, now.rlim_max);
  const rlimit then{lowest, lowest};
  return setrlimit(resource, &then) == 0;
}

bool set_limits(rlim_t memory, rlim_t seconds) {
  return limit(RLIMIT_AS, memory) && limit(RLIMIT_CPU, seconds) &&
         limit(RLIMIT_STACK, stack_bytes) && limit(RLIMIT_NOFILE, boxed_answer + 1) &&
         limit(RLIMIT_FSIZE, 0) && limit(RLIMIT_CORE, 0) && limit(RLIMIT_NPROC, 0);
}

#ifdef PLIANT_SECCOMP

class Filter {
 public:
  Filter() : context_(seccomp_init(SCMP_ACT_ERRNO(EPERM))), is_sound_(context_ != nullptr) {}
  Filter(const Filter&) = delete;
  Filter& operator=(const Filter&) = delete;
  ~Filter() {
    if (context_) seccomp_release(context_);
  }

  template <class... Conditions>
  void allow(int call, Conditions... conditions) {
    is_sound_ = is_sound_ && seccomp_rule_add(context_, SCMP_ACT_ALLOW, call, sizeof...(conditions),
                                              conditions...) == 0;
  }
  bool is_sound() const { return is_sound_; }

  // True if the filter is loaded, or the kernel does not support it.
  bool load() const {
    const int error = -seccomp_load(context_);
    return error == 0 || error == ENOSYS || error == EINVAL || error == EOPNOTSUPP;
  }

 private:
  scmp_filter_ctx context_;
  bool is_sound_;
};

bool filter_calls() {
  Filter filter;
  const auto not_executable = [](unsigned argument) {
    return scmp_arg_cmp{argument, SCMP_CMP_MASKED_EQ, PROT_EXEC, 0};
  };
  filter.allow(SCMP_SYS(mmap), not_executable(2));
  filter.allow(SCMP_SYS(mprotect), not_executable(2));
  // abort() sends itself a signal; it must work, so that a crash is reported as one.
  filter.allow(SCMP_SYS(tgkill),
               scmp_arg_cmp{0, SCMP_CMP_EQ, static_cast<scmp_datum_t>(getpid()), 0});
  for (const int call : {SCMP_SYS(read),
                         SCMP_SYS(pread64),
                         SCMP_SYS(write),
                         SCMP_SYS(munmap),
                         SCMP_SYS(mremap),
                         SCMP_SYS(madvise),
                         SCMP_SYS(brk),
                         SCMP_SYS(futex),
                         SCMP_SYS(exit),
                         SCMP_SYS(exit_group),
                         SCMP_SYS(fstat),
                         SCMP_SYS(lseek),
                         SCMP_SYS(clock_gettime),
                         SCMP_SYS(gettimeofday),
                         SCMP_SYS(time),
                         SCMP_SYS(getrandom),
                         SCMP_SYS(getpid),
                         SCMP_SYS(gettid),
                         SCMP_SYS(rt_sigprocmask),
                         SCMP_SYS(rt_sigreturn),
                         SCMP_SYS(sched_yield)})
    filter.allow(call);
  return filter.is_sound() && filter.load();
}

#else

bool filter_calls() { return true; }

#endif

}  // namespace

bool enter_box(int count, char** arguments) {
  if (count < box_arguments) return false;
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (std::to_string(getppid()) != arguments[1]) return false;  // it died before that
  prctl(PR_SET_DUMPABLE, 0);
  close(boxed_program);
  mallopt(M_PERTURB, std::atoi(arguments[4]));
  return prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) == 0 &&
         set_limits(std::strtoull(arguments[2], nullptr, 10),
                    std::strtoull(arguments[3], nullptr, 10)) &&
         filter_calls();
}

}  // namespace pliant
