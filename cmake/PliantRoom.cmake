# The settings of every target of the project, and the function that makes a room: one folder, one
# library.

include("${CMAKE_CURRENT_LIST_DIR}/StrictMath.cmake")
pliant_refuse_fast_math_of_the_build()

# Without the sanitizers, for programs that run with restricted system calls and memory.
add_library(pliant_plain_settings INTERFACE)
add_library(pliant::plain_settings ALIAS pliant_plain_settings)
target_compile_features(pliant_plain_settings INTERFACE cxx_std_20)
# -ffp-contract=off: a fused multiply-add would change the bits on machines that have it.
target_compile_options(pliant_plain_settings INTERFACE
  -ffp-contract=off -Wall -Wextra -Wpedantic
  # In a unity build, names of one file shadow those of another, and GCC treats the unnamed
  # namespace of a source file as that of a header.
  $<$<NOT:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>>:-Wshadow>
  $<$<AND:$<BOOL:$<TARGET_PROPERTY:UNITY_BUILD>>,$<CXX_COMPILER_ID:GNU>>:-Wno-subobject-linkage>
  -Wnon-virtual-dtor -Wold-style-cast
  -Wcast-qual -Woverloaded-virtual -Wconversion -Wno-sign-conversion
  $<$<BOOL:${PLIANT_WERROR}>:-Werror>
  "SHELL:-include \"${CMAKE_CURRENT_LIST_DIR}/strict_math.hpp\""
  # GCC looks for memory to reuse only beyond 600 MB: a tenth of the time of a build.
  "$<$<CXX_COMPILER_ID:GNU>:SHELL:--param ggc-min-heapsize=600000>")
# GCC 12 warns of impossible overlaps in std::string's operator+ (GCC bug 105651).
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
  target_compile_options(pliant_plain_settings INTERFACE -Wno-restrict)
endif()
target_compile_definitions(pliant_plain_settings INTERFACE
  $<$<BOOL:${PLIANT_CHECKS}>:PLIANT_CHECKS>)

add_library(pliant_settings INTERFACE)
add_library(pliant::settings ALIAS pliant_settings)
target_link_libraries(pliant_settings INTERFACE pliant::plain_settings)
if(PLIANT_SANITIZE)
  target_compile_options(pliant_settings INTERFACE
    -fsanitize=${PLIANT_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  target_link_options(pliant_settings INTERFACE -fsanitize=${PLIANT_SANITIZE})
  # Checks of every access take a quarter of a build. A null pointer ends in the address sanitizer as
  # well, Clang warns of casts to larger alignments, and fuzzers that run for hours have all checks.
  if(PLIANT_SANITIZE MATCHES undefined AND NOT PLIANT_SANITIZE MATCHES fuzzer)
    target_compile_options(pliant_settings INTERFACE -fno-sanitize=null,alignment,vptr
      -Wcast-align)
  endif()
  find_program(PLIANT_LLD ld.lld)  # links these large programs in a fifth of the time
  if(PLIANT_LLD)
    target_link_options(pliant_settings INTERFACE -fuse-ld=lld)
  endif()
endif()

# The cache serves every copy of the project, whatever its folder. Unity files have absolute names,
# so that only the preprocessed text of copies is the same: CCACHE_DEPEND would find nothing.
find_program(PLIANT_CCACHE ccache)
if(PLIANT_CCACHE AND NOT CMAKE_CXX_COMPILER_LAUNCHER)
  set(CMAKE_CXX_COMPILER_LAUNCHER ${CMAKE_COMMAND} -E env "CCACHE_BASEDIR=${PROJECT_SOURCE_DIR}" CCACHE_NOHASHDIR=1 ${PLIANT_CCACHE})
  if(CMAKE_CXX_COMPILER_ID MATCHES "GNU|Clang")
    add_compile_options("-ffile-prefix-map=${PROJECT_SOURCE_DIR}=.")
  endif()
endif()

# pliant_sanitize_fast(TARGET): for rooms that need little of the tests' time. Optimising UBSan's
# checks takes longer than running them unoptimised, but for fuzzers that run for hours.
function(pliant_sanitize_fast target)
  if(PLIANT_SANITIZE AND NOT PLIANT_SANITIZE MATCHES fuzzer)
    target_compile_options(${target} PRIVATE -O0)
  endif()
endfunction()

# pliant_build_fast(TARGET): for targets with little computation of their own. Full optimisation
# takes half of their build time, more than all their runs gain.
function(pliant_build_fast target)
  pliant_sanitize_fast(${target})
  target_compile_options(${target} PRIVATE
    $<$<CONFIG:Release>:-O1 $<$<CXX_COMPILER_ID:GNU>:-fno-tree-pta>>)
endfunction()

# pliant_make_early(NAME file...): makes sources by custom commands before anything is linked. Commands
# of a library's sources alone wait for all that it links, and so does all that uses the library.
function(pliant_make_early name)
  add_custom_target(${name} DEPENDS ${ARGN})
endfunction()

# pliant_room(NAME [LAYERS folder ...] SOURCES a.cpp ... HEADERS a.hpp ... [PUBLIC lib ...] [PRIVATE lib ...])
# makes the library pliant_NAME, alias pliant::NAME. Paths are relative to the room's own folder,
# which is <include root>/pliant/NAME, with a slash for an underscore. LAYERS: see
# script/check_rooms.
function(pliant_room name)
  cmake_parse_arguments(PARSE_ARGV 1 room "" "" "LAYERS;SOURCES;HEADERS;PUBLIC;PRIVATE")
  set(target pliant_${name})
  string(REPLACE "_" "/" folder "${name}")
  # Within the project, whose own folder may be named pliant.
  file(RELATIVE_PATH root "${PROJECT_SOURCE_DIR}" "${CMAKE_CURRENT_SOURCE_DIR}")
  string(REGEX REPLACE "/pliant/${folder}$" "" root "/${root}")
  set(include_root "${PROJECT_SOURCE_DIR}${root}")
  add_library(${target})
  add_library(pliant::${name} ALIAS ${target})
  target_sources(${target}
    PRIVATE ${room_SOURCES}
    PUBLIC FILE_SET HEADERS BASE_DIRS ${include_root} FILES ${room_HEADERS})
  # $<BUILD_INTERFACE>: the settings are ours, and install(EXPORT) must not look for them.
  target_link_libraries(${target} PUBLIC ${room_PUBLIC}
                        PRIVATE ${room_PRIVATE} $<BUILD_INTERFACE:pliant::settings>)
  target_compile_features(${target} PUBLIC cxx_std_20)
  if(PLIANT_BUILD_FUZZ AND NOT PLIANT_SANITIZE MATCHES fuzzer)
    # For fuzzers beside the tests, which tracing of comparisons, as the preset fuzz has it, would slow.
    target_compile_options(${target} PRIVATE -fsanitize-coverage=inline-8bit-counters,pc-table)
  endif()
  set_target_properties(${target} PROPERTIES
    EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON CXX_EXTENSIONS OFF)
  install(TARGETS ${target} EXPORT pliant FILE_SET HEADERS)
endfunction()
