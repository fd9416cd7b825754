#pragma once

namespace pliant {

/// Number of arguments for `enter_box`, including the program's name.
inline constexpr int box_arguments = 5;

/// The first call of a program that `run_boxed` runs: gives up permanently all rights that reading
/// an open file does not need. Limits memory, time, open files, processes and output; with seccomp,
/// the only system calls are those that compute, allocate, read open files and write the answer.
/// The program dies with its parent.
///
/// Other calls are refused (EPERM) instead of killing the program: a library that looks for
/// something, such as a locale, gets an error and continues, and an attacker gains as little either
/// way. A kernel without seccomp is accepted: the other limits still apply.
///
/// Returns false if a limit could not be set, or the parent is gone; the program must then end.
bool enter_box(int count, char** arguments);

}  // namespace pliant
