#include "editor/journal.hpp"

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <system_error>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "pliant/core/hash.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/atomic_file.hpp"
#include "pliant/files/json/json_reader.hpp"
#include "pliant/files/read_file.hpp"
#include "pliant/scene/read.hpp"

namespace pliant::editor {
namespace {

namespace fs = std::filesystem;
using PlainJson = nlohmann::json;

std::string now() {
  const std::time_t time = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
}

// When a process began, as no other one of its number did; empty: it does not run.
std::string beginning_of(std::int64_t process) {
  const auto boot = read_file("/proc/sys/kernel/random/boot_id");
  const auto facts = read_file(fmt::format("/proc/{}/stat", process));
  if (!boot || !facts) return {};
  // Behind the name, which is in parentheses and may have any letters: the state, and eighteen
  // words later the time.
  std::istringstream words(facts->substr(std::min(facts->rfind(')') + 1, facts->size())));
  std::string state, word;
  words >> state;
  if (state == "Z" || state == "X") return {};  // it has ended
  for (int k = 0; k < 19; ++k) words >> word;
  return fmt::format("{} {} {}", boot->substr(0, boot->find('\n')), process, word);
}

}  // namespace

std::string Journal::standard_folder() {
  const auto variable = [](const char* name) {
    const char* const value = std::getenv(name);
    return std::string(value != nullptr ? value : "");
  };
  const std::string state = variable("XDG_STATE_HOME"), home = variable("HOME");
  if (fs::path(state).is_absolute()) return state + "/pliant/edit";
  return home.empty() ? "" : home + "/.local/state/pliant/edit";
}

Result<Journal> Journal::open(const std::string& folder, const std::string& document) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error || chmod(folder.c_str(), S_IRWXU) != 0)
    return fail(
        ErrorCode::Unwritable,
        fmt::format("the folder of journals {} cannot be made or is not ours", printable(folder)));
  Journal journal(fmt::format("{}/{}", folder, to_text(hash_of(document))), document);
  journal.find_left();
  return journal;
}

void Journal::find_left() {
  const fs::path stem(stem_);
  std::error_code error;
  fs::directory_iterator at(stem.parent_path(), error);
  for (; !error && at != fs::directory_iterator(); at.increment(error)) {
    std::error_code unknown;
    const bool is_ours = at->path().filename().string().starts_with(stem.filename().string());
    auto entry = is_ours && at->is_regular_file(unknown) ? read(at->path()) : std::nullopt;
    if (!entry) continue;
    left_.push_back({at->path().string(), at->last_write_time(unknown), *std::move(entry)});
  }
  std::ranges::sort(left_, {}, &Left::time);
}

// What cannot be read was not written by us, or was not finished.
std::optional<JournalEntry> Journal::read(const fs::path& file) const {
  const auto bytes = read_file(file, 8 * largest_scene_file);
  if (!bytes) return {};
  const auto json = parse_json(*bytes, "journal");
  if (!json || !json->is_object() || json->value("document", PlainJson()) != document_) return {};
  const PlainJson process = json->value("process", PlainJson()),
                  began = json->value("began", PlainJson()),
                  text = json->value("text", PlainJson()), time = json->value("time", PlainJson());
  if (!process.is_number_integer() || !began.is_string() || !text.is_string() || !time.is_string())
    return {};
  const auto number = process.get<std::int64_t>();
  const std::string beginning = beginning_of(number);
  const bool still_runs = number != getpid() && !beginning.empty() && began == beginning;
  if (still_runs) return {};
  return JournalEntry{text, time};
}

void Journal::take_left() {
  if (left_.empty()) return;
  std::error_code ignored;
  fs::remove(left_.back().file, ignored);
  forget_left();
}

void Journal::take_left(const std::string& text) {
  const auto has_text = [&](const Left& left) { return left.entry.text == text; };
  std::error_code ignored;
  for (const Left& left : left_)
    if (has_text(left)) fs::remove(left.file, ignored);
  std::erase_if(left_, has_text);
}

// The first time under a name that no other command has.
Result<void> Journal::write(const std::string& text) {
  const PlainJson json = {{"document", document_},
                          {"process", getpid()},
                          {"began", beginning_of(getpid())},
                          {"text", text},
                          {"time", now()}};
  const std::string bytes = json.dump(-1, ' ', false, PlainJson::error_handler_t::replace);
  if (!file_.empty()) return write_file(file_, bytes);
  for (int number = 1; file_.empty(); ++number) {
    const std::string file =
        number == 1 ? stem_ + ".json" : fmt::format("{}-{}.json", stem_, number);
    std::error_code unknown;
    if (fs::exists(file, unknown)) continue;
    auto output = AtomicFile::create(file);
    if (!output) return fail(output.error());
    if (auto written = output->write(bytes); !written) return written;
    const auto is_ours = output->commit_new();
    if (!is_ours) return fail(is_ours.error());
    if (*is_ours) file_ = file;
  }
  return {};
}

void Journal::clear() {
  if (file_.empty()) return;
  std::error_code ignored;
  fs::remove(file_, ignored);
  file_.clear();
}

}  // namespace pliant::editor
