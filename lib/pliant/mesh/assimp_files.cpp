#include "pliant/mesh/assimp_files.hpp"

#include <algorithm>
#include <charconv>
#include <cstring>
#include <string_view>
#include <utility>

#include <assimp/IOStream.hpp>

#include "pliant/core/read_file.hpp"

namespace pliant {
namespace {

// assimp's own MemoryIOStream divides by the size of an item, which a broken file makes 0.
class MemoryStream final : public Assimp::IOStream {
 public:
  explicit MemoryStream(std::string_view bytes) : bytes_(bytes) {}

  std::size_t Read(void* place, std::size_t item_size, std::size_t item_count) override {
    if (item_size == 0) return 0;
    const std::size_t count = std::min(item_count, (bytes_.size() - at_) / item_size);
    if (count > 0) std::memcpy(place, bytes_.data() + at_, count * item_size);
    at_ += count * item_size;
    return count;
  }

  std::size_t Write(const void*, std::size_t, std::size_t) override { return 0; }

  aiReturn Seek(std::size_t offset, aiOrigin origin) override {
    const std::size_t base = origin == aiOrigin_SET   ? 0
                             : origin == aiOrigin_CUR ? at_
                                                      : bytes_.size();
    const std::size_t target = base + offset;  // wraps around where the offset stands for a minus
    if (target > bytes_.size()) return aiReturn_FAILURE;
    at_ = target;
    return aiReturn_SUCCESS;
  }

  std::size_t Tell() const override { return at_; }
  std::size_t FileSize() const override { return bytes_.size(); }
  void Flush() override {}

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

// A glTF names its files by URI, in which a blank is %20; assimp takes the URI as it is.
std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    unsigned char byte = 0;
    const char* digits = uri.data() + k + 1;
    if (uri[k] == '%' && uri.size() - k > 2 &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      text += static_cast<char>(byte);
      k += 2;
    } else {
      text += uri[k];
    }
  }
  return text;
}

bool is_regular(const std::filesystem::path& file) {
  std::error_code ignored;
  return std::filesystem::is_regular_file(file, ignored);
}

}  // namespace

AssimpFiles::AssimpFiles(std::filesystem::path file, std::string bytes, std::size_t max_bytes)
    : file_(std::move(file)),
      bytes_(std::move(bytes)),
      bytes_left_(max_bytes - std::min(max_bytes, bytes_.size())) {}

bool AssimpFiles::Exists(const char* file) const {
  return file == file_.string() || is_regular(file) || is_regular(percent_decoded(file));
}

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode) {
  if (std::string_view(mode).find('w') != std::string_view::npos) return nullptr;
  if (file == file_.string()) return new MemoryStream(bytes_);
  auto bytes = read_reference(is_regular(file) ? file : percent_decoded(file));
  if (!bytes) {
    if (!missing_) missing_ = bytes.error();
    return nullptr;
  }
  bytes_left_ -= bytes->size();
  return new MemoryStream(references_.emplace_back(*std::move(bytes)));
}

void AssimpFiles::Close(Assimp::IOStream* stream) { delete stream; }

// A pipe or a device would make us wait, or never end.
Result<std::string> AssimpFiles::read_reference(const std::filesystem::path& file) const {
  std::error_code ignored;
  if (std::filesystem::exists(file, ignored) && !is_regular(file)) {
    return fail(ErrorCode::Unreadable, "cannot read the file: it is not a regular file",
                file.string());
  }
  return read_file(file, bytes_left_);
}

}  // namespace pliant
