#include "pliant/files/png/read_png.hpp"

#include <algorithm>
#include <cmath>
#include <csetjmp>
#include <cstring>
#include <limits>
#include <new>
#include <utility>

#include <fmt/format.h>
#include <png.h>

#include "pliant/core/byte_order.hpp"
#include "pliant/files/file_object.hpp"

namespace pliant {
namespace {

// What the first chunk of a PNG says.
struct PngHead {
  int width = 0, height = 0;
  int bits = 8;  // of a channel
  int channels = 1;

  std::size_t row_bytes() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(channels * bits / 8);
  }
  std::size_t value_count() const {
    return static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
  }
};

Result<PngHead> read_head(std::string_view bytes) {
  constexpr std::string_view begin("\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR", 16);
  constexpr std::size_t size = 33;  // with the checksum
  if (bytes.substr(0, begin.size()) != begin)
    return invalid("the file is no PNG: it does not begin as one");
  if (bytes.size() < size) return invalid("the file is truncated: it ends within its head");
  const auto width = number_from<std::uint32_t>(bytes.data() + 16, std::endian::big);
  const auto height = number_from<std::uint32_t>(bytes.data() + 20, std::endian::big);
  for (const std::uint32_t side : {width, height}) {
    if (side < 1 || side > longest_picture_side)
      return invalid(fmt::format("the picture has {} x {} pixels, but a side must have 1 to {}",
                                 width, height, longest_picture_side));
  }
  const int bits = static_cast<unsigned char>(bytes[24]);
  const int colours = static_cast<unsigned char>(bytes[25]);
  if (colours == PNG_COLOR_TYPE_PALETTE)
    return invalid("the picture has a palette, but must be grey or have colours of its own");
  if (bits != 8 && bits != 16)
    return invalid(fmt::format("the picture has {} bits a channel, but must have 8 or 16", bits));
  int channels = 1;
  if (colours == PNG_COLOR_TYPE_GRAY_ALPHA) channels = 2;
  if (colours == PNG_COLOR_TYPE_RGB) channels = 3;
  if (colours == PNG_COLOR_TYPE_RGB_ALPHA) channels = 4;
  if (bytes[28] != PNG_INTERLACE_NONE)
    return invalid("the picture is interlaced, which is not read; save it without");
  const PngHead head{static_cast<int>(width), static_cast<int>(height), bits, channels};
  // zlib makes at most 1032 bytes of one, so that a small file cannot ask for much memory.
  constexpr std::size_t most_per_byte = 1032;
  if ((head.row_bytes() + 1) * height / most_per_byte > bytes.size())
    return invalid(fmt::format("the file is truncated: {} bytes cannot contain {} x {} pixels",
                               bytes.size(), width, height));
  return head;
}

// Where libpng reads from, and how it failed.
struct PngSource {
  const char* next = nullptr;
  std::size_t left = 0;
  StopPoll poll;
  std::size_t idat_left = std::numeric_limits<std::size_t>::max();  // of compressed bytes
  char complaint[120] = {};
};

// Ends libpng if the work has to end.
void end_if_stopped(png_structp png, PngSource& source, std::size_t parts) {
  constexpr std::size_t parts_of_call = 100;
  if (source.poll.after(parts_of_call + parts)) png_error(png, "interrupted");
}

// libpng inflates what follows the last row too, a thousand bytes of each, only to drop it.
void end_if_surplus(png_structp png, PngSource& source, std::size_t count) {
  constexpr png_uint_32 idat = 0x49444154;
  if (png_get_io_chunk_type(png) != idat) return;
  if (count > source.idat_left) png_error(png, "it has more data than its picture");
  source.idat_left -= count;
}

void read_from_source(png_structp png, png_bytep to, std::size_t count) {
  auto* const source = static_cast<PngSource*>(png_get_io_ptr(png));
  if (count > source->left) png_error(png, "the file is truncated");
  constexpr std::size_t parts_of_byte = 64;  // of a compressed one
  end_if_stopped(png, *source, parts_of_byte * count);
  end_if_surplus(png, *source, count);
  std::memcpy(to, source->next, count);
  source->next += count;
  source->left -= count;
}

[[noreturn]] void give_up(png_structp png, png_const_charp message) {
  auto* const source = static_cast<PngSource*>(png_get_error_ptr(png));
  std::strncpy(source->complaint, message, sizeof(source->complaint) - 1);
  png_longjmp(png, 1);
}

void ignore_warning(png_structp, png_const_charp) {}

void read_rows(png_structp png, png_infop info, const PngHead& head, png_bytep row,
               std::vector<std::uint16_t>& values) {
  png_set_user_limits(png, longest_picture_side, longest_picture_side);
  // Only what pixels need is read: no colour profiles, texts and the like.
  png_set_keep_unknown_chunks(png, PNG_HANDLE_CHUNK_NEVER, nullptr, -1);
  png_read_info(png, info);
  const std::size_t step = static_cast<std::size_t>(head.channels * head.bits / 8);
  if (png_get_rowbytes(png, info) != head.row_bytes()) png_error(png, "its head is given twice");
  auto* const source = static_cast<PngSource*>(png_get_io_ptr(png));
  for (int y = 0; y < head.height; ++y) {
    // More than a row that cannot be compressed, the end of the stream, and what lies between.
    if (y + 1 == head.height) source->idat_left = head.row_bytes() + head.row_bytes() / 8 + 1024;
    png_read_row(png, row, nullptr);
    end_if_stopped(png, *source, 4 * head.row_bytes());
    for (int x = 0; x < head.width; ++x) {
      const png_byte* const pixel = row + static_cast<std::size_t>(x) * step;
      values.push_back(
          static_cast<std::uint16_t>(head.bits == 8 ? pixel[0] : pixel[0] << 8 | pixel[1]));
    }
  }
  png_read_end(png, nullptr);
}

// Whether all rows were read. If libpng gives up, it jumps here from within `read_rows`, so nothing
// there has a destructor.
bool could_read_rows(png_structp png, png_infop info, const PngHead& head, png_bytep row,
                     std::vector<std::uint16_t>& values) {
  if (setjmp(png_jmpbuf(png)) != 0) return false;
  read_rows(png, info, head, row, values);
  return true;
}

Result<Picture> decode(std::string_view bytes, const PngHead& head,
                       const StopRequest& should_stop) {
  Picture picture{
      .width = head.width, .height = head.height, .white = head.bits == 8 ? 255 : 65535};
  picture.values.reserve(head.value_count());  // used as rows come, whatever the head promises
  std::vector<png_byte> row(head.row_bytes());
  PngSource source{.next = bytes.data(), .left = bytes.size(), .poll = StopPoll(should_stop)};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &source, give_up, ignore_warning);
  png_infop info = png ? png_create_info_struct(png) : nullptr;
  bool is_read = false;
  if (info) {
    png_set_read_fn(png, &source, read_from_source);
    is_read = could_read_rows(png, info, head, row.data(), picture.values);
  }
  png_destroy_read_struct(&png, &info, nullptr);
  if (is_read) return picture;
  if (source.poll.after(0)) return interrupted();
  if (!source.complaint[0])
    return fail(ErrorCode::OutOfMemory, "the picture does not fit in memory");
  return invalid(printable(fmt::format("the PNG is broken: {}", source.complaint)));
}

Result<Picture> read_picture(std::string_view bytes, const StopRequest& should_stop) {
  const auto head = read_head(bytes);
  if (!head) return fail(head.error());
  return decode(bytes, *head, should_stop);
}

}  // namespace

double Picture::at(double u, double v) const {
  // Counted from the centre of the first pixel.
  const double x = std::clamp(std::clamp(u, 0.0, 1.0) * width - 0.5, 0.0, width - 1.0);
  const double y = std::clamp((1 - std::clamp(v, 0.0, 1.0)) * height - 0.5, 0.0, height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const int x1 = std::min(x0 + 1, width - 1), y1 = std::min(y0 + 1, height - 1);
  const auto value = [&](int column, int row) -> double {
    return values[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(column)];
  };
  const double right = x - x0, down = y - y0;
  const double upper = value(x0, y0) + right * (value(x1, y0) - value(x0, y0));
  const double lower = value(x0, y1) + right * (value(x1, y1) - value(x0, y1));
  return (upper + down * (lower - upper)) / white;
}

Result<std::size_t> bytes_of_png(std::string_view bytes) {
  const auto head = read_head(bytes);
  if (!head) return fail(head.error());
  return head->value_count() * sizeof(std::uint16_t);
}

Result<Picture> parse_png(std::string_view bytes, const std::string& name,
                          const StopRequest& should_stop) {
  try {
    auto picture = read_picture(bytes, should_stop);
    if (!picture) return fail(in_file(picture.error(), name));
    return picture;
  } catch (const std::bad_alloc&) {
    return fail(ErrorCode::OutOfMemory, "the picture does not fit in memory", name);
  }
}

}  // namespace pliant
