cmake_minimum_required(VERSION 3.25)
# A script: writes a header with a digest of everything that affects the bits of a state, so that no
# version number must be raised by hand when the engine changes. Runs at each build, and writes the
# header only if the digest has changed.
#   cmake -DROOMS=<folders> -DLIBRARIES=<headers and library files> -DARCHITECTURE=<name>
#         -DCOMPILER=<name and version> -DFLAGS=<words> -DVERSIONS=<words> -DOUT=<header>
#         -P EngineDigest.cmake
# The digest is part of the keys of stored states (docs/caching.md), not of replay logs, which are
# compared across compilers.
if(NOT -ffp-contract=off IN_LIST FLAGS)
  message(FATAL_ERROR "the engine must be compiled with -ffp-contract=off, but its flags are: ${FLAGS}")
endif()
set(digests "${ARCHITECTURE}\n${COMPILER}\n${VERSIONS}\n")
foreach(flag IN LISTS FLAGS)
  # Warning flags and the project's path do not affect bits.
  if(NOT flag MATCHES "^(-W|SHELL:-include)")
    string(APPEND digests "${flag}\n")
  endif()
endforeach()
foreach(room IN LISTS ROOMS)
  file(GLOB_RECURSE sources LIST_DIRECTORIES false "${room}/*.cpp" "${room}/*.hpp"
       "${room}/CMakeLists.txt")
  list(SORT sources)
  # A folder with a CMakeLists.txt of its own is a room of its own.
  file(GLOB_RECURSE inner LIST_DIRECTORIES false "${room}/CMakeLists.txt")
  list(REMOVE_ITEM inner "${room}/CMakeLists.txt")
  foreach(file IN LISTS inner)
    cmake_path(GET file PARENT_PATH folder)
    list(FILTER sources EXCLUDE REGEX "^${folder}/")
  endforeach()
  foreach(source IN LISTS sources)
    file(SHA256 "${source}" digest)
    cmake_path(RELATIVE_PATH source BASE_DIRECTORY "${room}" OUTPUT_VARIABLE name)
    string(APPEND digests "${name} ${digest}\n")
  endforeach()
endforeach()
foreach(file IN LISTS LIBRARIES)
  if(EXISTS "${file}")
    file(SHA256 "${file}" digest)
    string(APPEND digests "${digest}\n")
  endif()
endforeach()
string(SHA256 digest "${digests}")
set(text "#pragma once\n\n#define PLIANT_ENGINE_DIGEST \"${digest}\"\n")
set(before)
if(EXISTS "${OUT}")
  file(READ "${OUT}" before)
endif()
if(NOT before STREQUAL text)
  file(WRITE "${OUT}" "${text}")
endif()
