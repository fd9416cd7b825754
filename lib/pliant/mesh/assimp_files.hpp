#pragma once

#include <deque>
#include <filesystem>
#include <optional>
#include <string>

#include <assimp/IOSystem.hpp>

#include "pliant/core/result.hpp"

namespace pliant {

/// What assimp may open: one file whose bytes we hold, and regular files that it refers to, such as
/// the .bin of a .gltf, read whole. All of them together stay within a limit, and what could not be
/// had is remembered, because assimp's own message does not give the reason.
class AssimpFiles final : public Assimp::IOSystem {
 public:
  /// `bytes` are those of `file`. `max_bytes`: of all files together.
  AssimpFiles(std::filesystem::path file, std::string bytes, std::size_t max_bytes);

  /// The first file that the main one refers to and that could not be read.
  const std::optional<Error>& missing() const { return missing_; }

  // What assimp calls.
  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

 private:
  Result<std::string> read_reference(const std::filesystem::path& file) const;

  std::filesystem::path file_;
  std::string bytes_;
  std::deque<std::string> references_;  // not the streams': assimp loses those when it gives up
  std::size_t bytes_left_;
  std::optional<Error> missing_;
};

}  // namespace pliant
