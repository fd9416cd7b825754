#include "cli/terminal/usage.hpp"

#include <algorithm>
#include <optional>
#include <string_view>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/terminal/report.hpp"
#include "pliant/core/result.hpp"
#include "pliant/scene/format/nearest.hpp"

namespace pliant::cli {
namespace {

// The command as the user types it: `pliant replay record`.
std::string full_name(const CLI::App& command) {
  const CLI::App* const parent = command.get_parent();
  return (parent ? full_name(*parent) + " " : "") + command.get_name();
}

// Unlike `command.help()`, not the help of a parsed subcommand.
std::string help_text(const CLI::App& command) {
  return command.get_formatter()->make_help(&command, full_name(command),
                                            CLI::AppFormatMode::Normal);
}

std::vector<std::string> commands_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::App* each : command.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(each->get_name());
  }
  return names;
}

std::vector<std::string> options_of(const CLI::App& command) {
  std::vector<std::string> names;
  for (const CLI::Option* option : command.get_options()) {
    for (const std::string& name : option->get_lnames()) names.push_back(name);
  }
  return names;
}

// "did you mean "--resume"? ", or nothing.
std::string question(std::string_view word, const std::vector<std::string>& names,
                     std::string_view prefix) {
  const std::vector<std::string_view> candidates(names.begin(), names.end());
  const auto near = xml::nearest_word(word, candidates);
  return near ? fmt::format("did you mean \"{}{}\"? ", prefix, *near) : "";
}

int complain(const std::string& message) {
  print(stderr, fmt::format("pliant: error: {}\n", message));
  return exit_usage;
}

int no_command(const CLI::App& parent, const std::string& word) {
  const std::vector<std::string> names = commands_of(parent);
  return complain(fmt::format("{} has no command \"{}\"; {}the commands are {}", full_name(parent),
                              printable(word), question(word, names, ""), fmt::join(names, ", ")));
}

int no_option(const CLI::App& command, const std::string& argument) {
  const std::string word = argument.substr(0, argument.find('='));
  const std::string bare = word.substr(std::min(word.find_first_not_of('-'), word.size()));
  return complain(fmt::format("{} has no option \"{}\"; {}see {} --help", full_name(command),
                              printable(word), question(bare, options_of(command), "--"),
                              full_name(command)));
}

// The innermost command that was recognised.
const CLI::App& recognised(const CLI::App& app) {
  const CLI::App* command = &app;
  while (!command->get_subcommands().empty()) command = command->get_subcommands().front();
  return *command;
}

const CLI::App* find_command(const CLI::App& parent, const std::string& name) {
  const auto found =
      parent.get_subcommands([&](const CLI::App* each) { return each->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

}  // namespace

void add_help(CLI::App& app, HelpOptions& options) {
  CLI::App* help = app.add_subcommand("help", "Show all options of a command");
  help->add_option("COMMAND", options.command, "The command; the list of commands by default");
}

CLI::Validator one_of(std::vector<std::string> words) {
  const std::string type = fmt::format("{{{}}}", fmt::join(words, ","));  // completion reads it
  return CLI::Validator(
      [words = std::move(words)](const std::string& word) -> std::string {
        if (std::ranges::find(words, word) != words.end()) return {};
        return fmt::format("\"{}\": {}allowed: {}", word, question(word, words, ""),
                           fmt::join(words, ", "));
      },
      type);
}

int run_help(const CLI::App& app, const HelpOptions& options) {
  const CLI::App* command = &app;
  for (const std::string& name : options.command) {
    const CLI::App* const next = find_command(*command, name);
    if (!next) {
      if (commands_of(*command).empty()) {
        return complain(fmt::format("{} has no subcommands, but \"{}\" was given",
                                    full_name(*command), printable(name)));
      }
      return no_command(*command, name);
    }
    command = next;
  }
  print(stdout, help_text(*command));
  return exit_done;
}

int report_usage(const CLI::App& app, const CLI::ParseError& error) {
  const CLI::App& command = recognised(app);
  const std::vector<std::string> unknown = command.remaining();
  const bool awaits_command = !commands_of(command).empty();
  if (awaits_command && unknown.empty()) {
    print(stderr, help_text(command));
    return exit_usage;
  }
  const auto option = std::find_if(unknown.begin(), unknown.end(), [](const std::string& word) {
    return word.size() > 1 && word.front() == '-' && word != "--";
  });
  if (awaits_command && option != unknown.begin()) return no_command(command, unknown.front());
  if (option != unknown.end()) return no_option(command, *option);
  return complain(fmt::format("{}; see {} --help", printable(error.what()), full_name(command)));
}

}  // namespace pliant::cli
