#include "pliant/files/boxed/program/assimp_files.hpp"

#include <algorithm>
#include <cstring>
#include <string_view>
#include <utility>

#include <assimp/IOStream.hpp>

namespace pliant {
namespace {

// assimp's own MemoryIOStream divides by the size of an item, which is 0 in a broken file.
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
    const std::size_t target = base + offset;  // wraps around if `offset` is negative
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

}  // namespace

AssimpFiles::AssimpFiles(std::string name, std::string bytes)
    : name_(std::move(name)), bytes_(std::move(bytes)) {}

bool AssimpFiles::Exists(const char* file) const { return file == name_; }

Assimp::IOStream* AssimpFiles::Open(const char* file, const char* mode) {
  const bool writes = std::string_view(mode).find('w') != std::string_view::npos;
  return writes || file != name_ ? nullptr : new MemoryStream(bytes_);
}

void AssimpFiles::Close(Assimp::IOStream* stream) { delete stream; }

}  // namespace pliant
