#include "support/places.hpp"

namespace pliant::testing {

std::filesystem::path source_folder() { return PLIANT_SOURCE_FOLDER; }

std::filesystem::path misbehaving_program() { return PLIANT_MISBEHAVING; }

}  // namespace pliant::testing
