# pliant_refuse_fast_math(WHERE WORD...): stops configuring if a word for the compiler or linker
# would change bits or disable checks for NaN. strict_math.hpp, which every source includes, detects
# most of them too. But Clang defines no macro for some parts of -ffast-math, and start-up code
# added by the linker flushes denormal numbers.
function(pliant_refuse_fast_math where)
  set(refused
    -Ofast -ffast-math -funsafe-math-optimizations -fassociative-math -freciprocal-math
    -fno-signed-zeros -ffinite-math-only -fno-honor-nans -fno-honor-infinities -fapprox-func
    -fcx-fortran-rules -fcx-limited-range -fsingle-precision-constant -mrecip -mdaz-ftz)
  # A word may be a list, or several in one string.
  string(REGEX MATCHALL "[^; \t\"']+" words "${ARGN}")
  foreach(word IN LISTS words)
    string(REGEX REPLACE "^(SHELL|LINKER):" "" word "${word}")
    if(word IN_LIST refused OR word MATCHES "^-mrecip="
        OR (word MATCHES "^-ffp-contract=" AND NOT word STREQUAL "-ffp-contract=off")
        OR (word MATCHES "^-ffp-model=" AND NOT word STREQUAL "-ffp-model=strict")
        OR (word MATCHES "^-fexcess-precision=" AND NOT word STREQUAL "-fexcess-precision=standard")
        OR (word MATCHES "^-fdenormal-fp-math" AND NOT word MATCHES "=ieee(,ieee)?$"))
      message(FATAL_ERROR "pliant must give the same bits everywhere: it cannot be built with "
                          "${word}, which is in ${where}")
    endif()
  endforeach()
endfunction()

# Checks the flags of the whole build, which are added to each target's own.
function(pliant_refuse_fast_math_of_the_build)
  set(configurations ${CMAKE_BUILD_TYPE} ${CMAKE_CONFIGURATION_TYPES})
  foreach(kind CXX C EXE_LINKER SHARED_LINKER MODULE_LINKER)
    pliant_refuse_fast_math(CMAKE_${kind}_FLAGS ${CMAKE_${kind}_FLAGS})
    foreach(configuration IN LISTS configurations)
      string(TOUPPER "CMAKE_${kind}_FLAGS_${configuration}" flags)
      pliant_refuse_fast_math(${flags} ${${flags}})
    endforeach()
  endforeach()
  foreach(property COMPILE_OPTIONS LINK_OPTIONS)
    get_directory_property(words ${property})
    pliant_refuse_fast_math("the ${property} of the folder" ${words})
  endforeach()
endfunction()
