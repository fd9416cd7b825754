#pragma once

namespace pliant {

/// How many arguments, the program's name among them, are for `enter_box`.
inline constexpr int box_arguments = 5;

/// The first call of a program that `run_boxed` runs: gives up, for good, what reading a file that
/// is open already does not need. Memory, time, open files, processes and what may be written are
/// bounded; with seccomp, system calls are those that compute, allocate, read what is open and
/// write the answer. The program dies with its parent.
///
/// What is not allowed is refused (EPERM) rather than punished: a library that looks for something,
/// such as a locale, gets no for an answer and goes on, and an attacker gets as little either way.
/// A kernel without seccomp is lived with: the other bounds hold there.
///
/// False, and the program must end: a bound could not be set, or the parent is gone.
bool enter_box(int count, char** arguments);

}  // namespace pliant
