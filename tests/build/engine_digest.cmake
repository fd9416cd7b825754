# A change that affects the bits of a state changes the digest, and so the keys; other changes do
# not.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}/room")
file(WRITE "${WORK}/room/a.cpp" "1\n")
file(WRITE "${WORK}/room/part/b.cpp" "2\n")
file(WRITE "${WORK}/room/CMakeLists.txt" "flags of a file\n")
file(WRITE "${WORK}/library.h" "version 1\n")

# digest_of(OUT ARGUMENT=VALUE...): with these instead of the defaults below.
function(digest_of out)
  set(ROOMS "${WORK}/room")
  set(LIBRARIES "${WORK}/library.h")
  set(ARCHITECTURE x86_64)
  set(COMPILER "GNU 12.2.0")
  set(FLAGS -ffp-contract=off -O3 "-Wall" "SHELL:-include \"/here/strict_math.hpp\"" Release)
  set(VERSIONS "Eigen 3.4.0")
  foreach(argument IN LISTS ARGN)
    string(REGEX MATCH "^([A-Z]+)=(.*)$" matched "${argument}")
    string(REPLACE "|" ";" ${CMAKE_MATCH_1} "${CMAKE_MATCH_2}")
  endforeach()
  execute_process(COMMAND "${CMAKE_COMMAND}" "-DROOMS=${ROOMS}" "-DLIBRARIES=${LIBRARIES}"
    "-DARCHITECTURE=${ARCHITECTURE}" "-DCOMPILER=${COMPILER}" "-DFLAGS=${FLAGS}"
    "-DVERSIONS=${VERSIONS}" "-DOUT=${WORK}/digest.hpp" -P "${SOURCE}/cmake/EngineDigest.cmake"
    COMMAND_ERROR_IS_FATAL ANY)
  file(READ "${WORK}/digest.hpp" text)
  if(NOT text MATCHES "#define PLIANT_ENGINE_DIGEST \"[0-9a-f]+\"")
    message(SEND_ERROR "no digest in: ${text}")
  endif()
  set(${out} "${text}" PARENT_SCOPE)
endfunction()

digest_of(before)
set(all "${before}")
foreach(change ARCHITECTURE=aarch64 "COMPILER=GNU 12.2.1" "COMPILER=Clang 12.2.0" "FLAGS=-ffp-contract=off|-O2|Release"
               "FLAGS=-ffp-contract=off|-O3|-march=native|Release"
               "FLAGS=-ffp-contract=off|-O3|Debug" "VERSIONS=Eigen 3.4.1"
               "VERSIONS=Eigen 3.4.0|CHOLMOD ON" "LIBRARIES=")
  digest_of(after "${change}")
  if(after IN_LIST all)
    message(SEND_ERROR "${change} gives the digest of another engine")
  endif()
  list(APPEND all "${after}")
endforeach()
foreach(file room/a.cpp room/part/b.cpp room/CMakeLists.txt library.h)
  file(READ "${WORK}/${file}" text)
  file(WRITE "${WORK}/${file}" "another\n")
  digest_of(after)
  if(after IN_LIST all)
    message(SEND_ERROR "another ${file} gives the same digest")
  endif()
  file(WRITE "${WORK}/${file}" "${text}")
endforeach()
foreach(change "FLAGS=-ffp-contract=off|-O3|-Wall|-Werror|Release"
               "FLAGS=-ffp-contract=off|-O3|SHELL:-include \"/there/x.hpp\"|Release")
  digest_of(after "${change}")
  if(NOT after STREQUAL before)
    message(SEND_ERROR "${change} gives another digest")
  endif()
endforeach()

# Editing curves computes no state: a change of it keeps the digest, and nothing that computes one may
# use it.
file(COPY "${SOURCE}/timeline/pliant/timeline" DESTINATION "${WORK}")
digest_of(before "ROOMS=${WORK}/timeline")
file(APPEND "${WORK}/timeline/edit/edit.cpp" "// a comment\n")
digest_of(after "ROOMS=${WORK}/timeline")
if(NOT after STREQUAL before)
  message(SEND_ERROR "another edit/edit.cpp gives another digest")
endif()
file(APPEND "${WORK}/timeline/curve.cpp" "// a comment\n")
digest_of(after "ROOMS=${WORK}/timeline")
if(after STREQUAL before)
  message(SEND_ERROR "another curve.cpp gives the same digest")
endif()
file(GLOB_RECURSE sources "${SOURCE}/lib/*.[ch]pp" "${SOURCE}/forces/*.[ch]pp" "${SOURCE}/timeline/*.[ch]pp")
list(FILTER sources EXCLUDE REGEX "/timeline/edit/|/lib/pliant/(document|exchange)/")
foreach(source IN LISTS sources)
  file(STRINGS "${source}" includes REGEX "#include \"pliant/timeline/edit/")
  if(includes)
    message(SEND_ERROR "${source} uses the editing of curves, which is not part of the digest")
  endif()
endforeach()

# Flags without the one that every build has are rejected.
execute_process(COMMAND "${CMAKE_COMMAND}" -DFLAGS=-O3 "-DOUT=${WORK}/refused.hpp"
  -P "${SOURCE}/cmake/EngineDigest.cmake" RESULT_VARIABLE result ERROR_QUIET)
if(result EQUAL 0)
  message(SEND_ERROR "a digest without the engine's flags")
endif()

# The project passes all arguments.
file(READ "${SOURCE}/lib/pliant/states/CMakeLists.txt" text)
if(text MATCHES "timeline/edit")
  message(SEND_ERROR "the digest contains the editing of curves")
endif()
foreach(word "CMAKE_CXX_COMPILER_ID} \${CMAKE_CXX_COMPILER_VERSION}" "CMAKE_CXX_FLAGS" "CHOLMOD_LIBRARY"
             "Sleef_LIBRARY" "Eigen3_VERSION" "-DCOMPILER=" "-DFLAGS=" "-DVERSIONS=")
  string(FIND "${text}" "${word}" place)
  if(place EQUAL -1)
    message(SEND_ERROR "the build does not hand over ${word}")
  endif()
endforeach()
