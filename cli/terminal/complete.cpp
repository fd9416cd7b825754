#include "cli/terminal/complete.hpp"

#include <cstdio>
#include <map>
#include <string>
#include <utility>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/terminal/report.hpp"
#include "pliant/files/writer.hpp"

namespace pliant::cli {
namespace {

// The state of a command line before the word to complete.
struct Place {
  const CLI::App* command;
  const CLI::Option* option = nullptr;  // the option whose value comes next; null: none
  bool may_end = false;                 // the option may already have all its values
  std::size_t positionals = 0;          // number already given
  bool has_dashes = false;              // after --, words are never options
};

const CLI::App* find_command(const CLI::App& parent, std::string_view name) {
  const auto found =
      parent.get_subcommands([&](const CLI::App* each) { return each->get_name() == name; });
  return found.empty() ? nullptr : found.front();
}

// The option with a name as typed, --out or -o.
const CLI::Option* find_option(const CLI::App& command, std::string_view word) {
  const std::string name(word);
  for (const CLI::Option* option : command.get_options()) {
    if (option->nonpositional() && option->check_name(name)) return option;
  }
  return nullptr;
}

bool is_option(std::string_view word) { return word.size() > 1 && word.front() == '-'; }

void pass_option(Place& place, std::string_view word) {
  const std::size_t equals = word.find('=');
  const CLI::Option* const option = find_option(*place.command, word.substr(0, equals));
  const bool takes_value = option && option->get_items_expected_max() > 0;
  place.option = takes_value && equals == std::string_view::npos ? option : nullptr;
  place.may_end = takes_value && option->get_items_expected_min() == 0;
}

void pass_word(Place& place, std::string_view word) {
  if (place.option) {
    // An option with several values continues until the next option.
    const bool takes_one =
        place.option->get_items_expected_max() == 1 || !place.option->get_allow_extra_args();
    if (takes_one) place.option = nullptr;
    place.may_end = place.option != nullptr;
    return;
  }
  if (const CLI::App* const command = find_command(*place.command, word)) {
    place = Place{command};
    return;
  }
  ++place.positionals;
}

Place place_of(const CLI::App& app, const std::vector<std::string_view>& words) {
  Place place{&app};
  for (std::size_t k = 0; k + 1 < words.size(); ++k) {
    const std::string_view word = words[k];
    if (word == "=") continue;  // Bash splits --name=value
    if (place.has_dashes || !is_option(word)) {
      pass_word(place, word);
    } else if (word == "--") {
      place.has_dashes = true;
      place.option = nullptr;
    } else {
      pass_option(place, word);
    }
  }
  return place;
}

// Prints without `printable`, since a tab separates a word from its description.
void say(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stdout); }

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

void print_words(const std::vector<std::pair<std::string, std::string>>& words) {
  std::string text = "words\n";
  for (const auto& [word, does] : words) {
    text += word;
    if (!does.empty()) text += '\t' + does;
    text += '\n';
  }
  say(text);
}

void print_options(const CLI::App& command) {
  std::vector<std::pair<std::string, std::string>> words;
  for (const CLI::Option* option : command.get_options()) {
    const std::string does = first_line(option->get_description());
    for (const std::string& name : option->get_lnames()) words.emplace_back("--" + name, does);
    for (const std::string& name : option->get_snames()) words.emplace_back("-" + name, does);
  }
  print_words(words);
}

void print_commands(const CLI::App& parent) {
  std::vector<std::pair<std::string, std::string>> words;
  for (const CLI::App* each : parent.get_subcommands([](const CLI::App*) { return true; })) {
    words.emplace_back(each->get_name(), first_line(each->get_description()));
  }
  print_words(words);
}

void print_files(const std::vector<std::string>& endings) {
  say(fmt::format("files{}{}\n", endings.empty() ? "" : " ", fmt::join(endings, " ")));
}

// The words that an option's validator allows; its description is TEXT:{world,object}.
std::vector<std::string> allowed_words(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t open = type.find('{');
  const std::size_t close = type.find('}', open);
  if (open == std::string::npos || close == std::string::npos) return {};
  return CLI::detail::split(type.substr(open + 1, close - open - 1), ',');
}

// The files that an option or argument of a command accepts. Options not listed accept none.
struct Files {
  std::vector<std::string> endings = {};  // empty: any
  bool are_folders = false;
};

// `bake`; `export curves`, since there are several commands `curves`.
std::string name_of_writer(const CLI::App& command) {
  const std::string& name = command.get_name();
  return name == "curves" && command.get_parent()->get_parent()
             ? command.get_parent()->get_name() + ' ' + name
             : name;
}

const Files* files_of(const CLI::App& command, const CLI::Option& option) {
  static const std::map<std::string, Files> any = {
      {"SCENE", {{".xml"}}},
      {"SCENE|MESH", {{".xml", ".obj", ".ply", ".gltf", ".glb", ".fbx", ".dae"}}},
      {"LOG", {{".replay"}}},
      {"A", {{".replay"}}},
      {"B", {{".replay"}}},
      {"FILE", {{".json", ".gltf", ".glb", ".anim"}}},
      {"--at", {}},
      {"--png", {{".png"}}},
      {"--cache", {{}, true}},
      {"--regions", {{".json"}}},
      {"--root", {{}, true}},
      {"--mesh", {}},
      {"--takes", {{".csv"}}},
      {"DIR", {{}, true}},
      {"SCENE|DIR", {{".xml"}}},
      {"--movie", {{".mp4", ".gif", ".webm"}}}};
  static const std::map<std::string, Files> outputs = {
      {"bake", {known_endings()}},   {"curves", {{".csv", ".svg"}}},
      {"format", {{".xml"}}},        {"new", {{".xml"}}},
      {"record", {{".replay"}}},     {"run", {{}, true}},
      {"import curves", {{".xml"}}}, {"export curves", {{".json", ".gltf", ".glb", ".anim"}}},
      {"view", {{".html"}}}};
  const std::string name = option.get_positional()       ? option.get_name(true)
                           : option.get_lnames().empty() ? ""
                                                         : "--" + option.get_lnames().front();
  const auto& table = name == "--out" ? outputs : any;
  const auto found = table.find(name == "--out" ? name_of_writer(command) : name);
  return found == table.end() ? nullptr : &found->second;
}

void print_values(const CLI::App& command, const CLI::Option& option) {
  if (const auto words = allowed_words(option); !words.empty()) {
    std::vector<std::pair<std::string, std::string>> plain;
    for (const std::string& word : words) plain.emplace_back(word, "");
    return print_words(plain);
  }
  const Files* const files = files_of(command, option);
  if (!files) return print_words({});
  if (files->are_folders) return say("folders\n");
  print_files(files->endings);
}

// The next positional argument; the last one repeats if it accepts any number of words.
const CLI::Option* next_positional(const Place& place) {
  std::size_t left = place.positionals;
  for (const CLI::Option* option : place.command->get_options()) {
    if (!option->get_positional()) continue;
    const auto most = static_cast<std::size_t>(option->get_items_expected_max());
    if (left < most) return option;
    left -= most;
  }
  return nullptr;
}

}  // namespace

int run_complete(const CLI::App& app, const std::vector<std::string_view>& words) {
  const std::string_view word = words.empty() ? "" : words.back();
  Place place = place_of(app, words);
  if (is_option(word) && !place.has_dashes && (!place.option || place.may_end)) {
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) {
      print_options(*place.command);
    } else if (const auto* option = find_option(*place.command, word.substr(0, equals))) {
      print_values(*place.command, *option);
    }
    return exit_done;
  }
  const bool is_help = place.command->get_name() == "help";
  if (place.option) {
    print_values(*place.command, *place.option);
  } else if (is_help && place.positionals == 0) {
    print_commands(app);
  } else if (!place.command->get_subcommands([](const CLI::App*) { return true; }).empty()) {
    print_commands(*place.command);
  } else if (const auto* next = next_positional(place); next && !is_help) {
    print_values(*place.command, *next);
  } else {
    print_words({});
  }
  return exit_done;
}

}  // namespace pliant::cli
