#pragma once

#include <optional>
#include <string>

#include "cli/commands/scene_input.hpp"
#include "cli/terminal/command_line.hpp"
#include "cli/terminal/resources.hpp"

namespace pliant::cli {

/// Options of `pliant suggest`. Empty goals are not given.
struct SuggestOptions {
  std::string scene;
  std::string peak;
  std::string settle;
  std::string ring;
  std::string force;
  std::string surface;
  bool writes = false;
  bool is_json = false;
  bool is_quiet = false;
  Root root = {};
  ResourceOptions resources;
};

/// A time: seconds, or frames.
struct Duration {
  double amount = 0;
  bool is_in_frames = false;

  double seconds(double fps) const { return is_in_frames ? amount / fps : amount; }
};

/// `1s`, `500 ms`, `24f` or `24 frames`; null: another text, or not greater than 0.
std::optional<Duration> to_duration(std::string_view text);

/// `2Hz`, `2 hz` or `2` [Hz]; null: another text, or not greater than 0.
std::optional<double> to_frequency(std::string_view text);

void add_suggest(CLI::App& app, SuggestOptions& options);

/// Prints numbers for a scene, and writes them into it if asked to. Returns the exit code.
int run_suggest(const SuggestOptions& options);

}  // namespace pliant::cli
