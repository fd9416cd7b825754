#pragma once

#include <string>

#include <assimp/IOSystem.hpp>

namespace pliant {

/// The files that assimp may open: one file, whose bytes are in memory, and none that it refers to.
class AssimpFiles final : public Assimp::IOSystem {
 public:
  /// `name` is assimp's name of the file.
  AssimpFiles(std::string name, std::string bytes);

  // Functions that assimp calls.
  bool Exists(const char* file) const override;
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override;
  void Close(Assimp::IOStream* stream) override;

 private:
  std::string name_;
  std::string bytes_;
};

}  // namespace pliant
