#include "editor/files.hpp"

#include <algorithm>
#include <functional>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <sys/stat.h>

#include "pliant/core/shortened.hpp"
#include "pliant/core/text.hpp"
#include "pliant/files/mesh_objects.hpp"
#include "pliant/files/read_file.hpp"

namespace pliant::editor {
namespace {

namespace fs = std::filesystem;

// Files below a folder that `is_wanted` accepts.
std::vector<std::string> files_below(const std::string& folder,
                                     const std::function<bool(const fs::path&)>& is_wanted) {
  constexpr std::size_t most_files = 200, most_seen = 20'000;
  constexpr int deepest = 3;
  std::vector<std::pair<fs::file_time_type, std::string>> found;
  std::error_code error;
  std::size_t seen = 0;
  fs::recursive_directory_iterator entry(folder, fs::directory_options::skip_permission_denied,
                                         error);
  for (; !error && entry != fs::recursive_directory_iterator() && ++seen < most_seen;
       entry.increment(error)) {
    const bool is_hidden = entry->path().filename().string().starts_with('.');
    std::error_code unknown;
    if (is_hidden || entry.depth() >= deepest) entry.disable_recursion_pending();
    if (is_hidden || !entry->is_regular_file(unknown) || !is_wanted(entry->path())) continue;
    found.emplace_back(entry->last_write_time(unknown),
                       entry->path().lexically_relative(folder).string());
  }
  std::ranges::sort(found, std::ranges::greater());
  if (found.size() > most_files) found.resize(most_files);
  std::vector<std::string> names;
  for (auto& [time, name] : found) names.push_back(std::move(name));
  return names;
}

// Whether the file begins like a scene.
bool is_scene(const fs::path& file) {
  if (ending_of(file) != ".xml") return false;
  constexpr std::size_t beginning = 4096;
  std::string begin;
  const auto read = read_pieces(file, [&](std::string_view piece) {
    begin += piece.substr(0, beginning - begin.size());
    return begin.size() < beginning;
  });
  return read && begin.find("<scene") != std::string::npos;
}

bool is_inside(const fs::path& folder, const fs::path& place) {
  const fs::path way = place.lexically_relative(folder);
  return !way.empty() && *way.begin() != "..";
}

}  // namespace

FileStamp stamp_of(const fs::path& file) {
  struct stat facts = {};
  if (stat(file.c_str(), &facts) != 0 || !S_ISREG(facts.st_mode)) return {};
  return {static_cast<std::int64_t>(facts.st_dev),
          static_cast<std::int64_t>(facts.st_ino),
          facts.st_size,
          facts.st_mtim.tv_sec,
          facts.st_mtim.tv_nsec,
          facts.st_ctim.tv_sec,
          facts.st_ctim.tv_nsec};
}

Result<fs::path> place_in(const std::string& folder, const std::string& file) {
  const fs::path wanted = (fs::path(folder) / file).lexically_normal();
  const auto is_control = [](char letter) { return letter >= '\0' && letter < ' '; };
  if (file.empty() || !wanted.has_filename() || std::ranges::any_of(file, is_control))
    return fail(ErrorCode::InvalidInput, fmt::format("{} is no name of a file", in_quotes(file)));
  std::error_code error;
  const fs::path base = fs::canonical(folder, error);
  if (!error && !fs::exists(wanted.parent_path(), error))
    return fail(ErrorCode::InvalidInput, fmt::format("there is no folder for {}", printable(file)));
  const fs::path parent = error ? fs::path() : fs::canonical(wanted.parent_path(), error);
  if (error || !is_inside(base, parent))
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} is not in the folder {}; --root names another folder",
                            printable(file), printable(folder)));
  // The file itself may be a link.
  const fs::path place = fs::weakly_canonical(parent / wanted.filename(), error);
  if (error || !is_inside(base, place))
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} leads out of the folder {}", printable(file), printable(folder)));
  const fs::file_status status = fs::status(place, error);
  if (fs::is_directory(status))
    return fail(ErrorCode::InvalidInput, fmt::format("{} is a folder", printable(file)));
  if (fs::exists(status) && !fs::is_regular_file(status))
    return fail(ErrorCode::InvalidInput,
                fmt::format("{} is a pipe or a device, not a file", printable(file)));
  return place;
}

std::vector<std::string> scenes_below(const std::string& folder) {
  return files_below(folder, &is_scene);
}

std::vector<std::string> meshes_below(const std::string& folder) {
  const std::vector<std::string> endings = mesh_endings();
  return files_below(folder, [&](const fs::path& file) {
    return std::ranges::find(endings, ending_of(file)) != endings.end();
  });
}

}  // namespace pliant::editor
