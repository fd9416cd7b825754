#include "pliant/sampling/read_files.hpp"

#include <utility>

#include "pliant/files/open_file.hpp"

namespace pliant {
namespace {

std::vector<std::string> stamps_of(const std::vector<SceneInput>& files) {
  std::vector<std::string> stamps;
  for (const SceneInput& input : files) {
    const auto opened = OpenFile::open(input.file, input.root);
    stamps.push_back(opened ? opened->stamp() : std::string());
  }
  return stamps;
}

}  // namespace

ReadFiles::ReadFiles(std::vector<SceneInput> files)
    : files_(std::move(files)), stamps_(stamps_of(files_)) {}

bool ReadFiles::are_unchanged() const { return stamps_of(files_) == stamps_; }

}  // namespace pliant
