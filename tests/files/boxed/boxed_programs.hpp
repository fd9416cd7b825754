#pragma once

#include <string>
#include <string_view>

#include "pliant/files/boxed/boxed_reader.hpp"
#include "pliant/files/read_file.hpp"
#include "support/places.hpp"

namespace pliant::testing {

/// The program of boxed/misbehave.cpp; its second argument selects its behaviour.
inline const std::string& misbehaving() {
  static const std::string program = read_file(misbehaving_program()).value();
  return program;
}

/// The program that reads FBX and Collada.
inline std::string_view reader() {
  return {reinterpret_cast<const char*>(mesh_reader_program.data()), mesh_reader_program.size()};
}

}  // namespace pliant::testing
