#include "editor/takes.hpp"

#include <algorithm>
#include <bit>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "pliant/core/base64.hpp"
#include "pliant/core/byte_order.hpp"
#include "pliant/core/text.hpp"
#include "viewer/png_check.hpp"

namespace pliant::editor {
namespace {

constexpr std::size_t most_takes = 64, longest_name = 200;
constexpr std::size_t most_picture_bytes = 262'144;
constexpr std::uint32_t most_pixels = 512;  // along a side

Result<void> check_name(const std::string& name) {
  const auto is_control = [](char letter) { return letter >= '\0' && letter < ' '; };
  if (name.empty() || name.size() > longest_name || std::ranges::any_of(name, is_control))
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("the name of a take must have 1 to {} bytes, in one line", longest_name));
  return {};
}

std::size_t bytes_of(const Take& take) {
  return take.text.size() + (take.picture ? take.picture->size() : 0);
}

// What the header of a PNG says; null: it is shorter, or the size is none that we take.
std::optional<viewer::PictureSize> size_in(std::string_view bytes) {
  constexpr std::size_t width_at = 16, height_at = 20, end = 24;
  if (bytes.size() < end) return {};
  const auto number = [&](std::size_t at) {
    return number_from<std::uint32_t>(bytes.data() + at, std::endian::big);
  };
  const auto [least, most] = std::minmax({number(width_at), number(height_at)});
  if (least == 0 || most > most_pixels) return {};
  return viewer::PictureSize{.width = static_cast<int>(number(width_at)),
                             .height = static_cast<int>(number(height_at))};
}

}  // namespace

Result<std::int64_t> Takes::keep(std::string name, std::string text, std::string picture) {
  if (takes_.size() >= most_takes)
    return fail(ErrorCode::InvalidInput,
                fmt::format("there are {} takes already; delete one", most_takes));
  if (name.empty()) name = fmt::format("Take {}", last_id_ + 1);
  if (auto sound = check_name(name); !sound) return fail(sound.error());
  Take take{.id = last_id_ + 1, .name = std::move(name), .text = std::move(text)};
  if (!picture.empty()) take.picture = std::make_shared<const std::string>(std::move(picture));
  std::size_t bytes = bytes_of(take);
  for (const Take& other : takes_) bytes += bytes_of(other);
  if (bytes > max_bytes_)
    return fail(
        ErrorCode::InvalidInput,
        fmt::format("the takes would have {} bytes, more than {}; delete some", bytes, max_bytes_));
  takes_.push_back(std::move(take));
  return ++last_id_;
}

const Take* Takes::find(std::int64_t id) const {
  const auto found = std::ranges::find(takes_, id, &Take::id);
  return found == takes_.end() ? nullptr : &*found;
}

Result<void> Takes::rename(std::int64_t id, std::string name) {
  if (auto sound = check_name(name); !sound) return sound;
  std::ranges::find(takes_, id, &Take::id)->name = std::move(name);
  return {};
}

void Takes::remove(std::int64_t id) {
  std::erase_if(takes_, [id](const Take& take) { return take.id == id; });
}

Result<std::string> picture_from(std::string_view text, const StopRequest& should_stop) {
  if (text.empty()) return {};
  constexpr std::size_t most_digits = most_picture_bytes / 3 * 4;
  StopPoll poll(should_stop);
  const auto bytes = text.size() <= most_digits ? from_base64(text, poll) : std::nullopt;
  const auto size = bytes ? size_in(*bytes) : std::nullopt;
  if (!size)
    return fail(ErrorCode::InvalidInput,
                fmt::format("the picture must be a PNG of at most {} x {} pixels and {} bytes, in "
                            "base 64",
                            most_pixels, most_pixels, most_picture_bytes));
  if (auto checked = viewer::check_png(*bytes, *size, should_stop); !checked) {
    Error error = checked.error();
    error.message = "the picture: " + error.message;
    return fail(std::move(error));
  }
  return *bytes;
}

}  // namespace pliant::editor
