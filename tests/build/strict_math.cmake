# A build with -ffast-math, or a part of it, is refused: at configuration, with a message that names
# the word and its place, and when a source is compiled.
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")

# check(WORDS): the words are refused, the last one by name; check(WORDS taken): they are not.
function(check words)
  file(WRITE "${WORK}/check.cmake"
    "cmake_minimum_required(VERSION 3.25)\ninclude(\"${SOURCE}/cmake/StrictMath.cmake\")\n"
    "pliant_refuse_fast_math(HERE ${words})\n")
  execute_process(COMMAND "${CMAKE_COMMAND}" -P "${WORK}/check.cmake" RESULT_VARIABLE result
                  ERROR_VARIABLE message)
  if(ARGN STREQUAL "taken")
    if(NOT result EQUAL 0)
      message(SEND_ERROR "${words}: refused: ${message}")
    endif()
    return()
  endif()
  string(REGEX REPLACE "[ \n]+" " " message "${message}")
  string(REGEX REPLACE ".*[ \";]([^ ]+)$" "\\1" word "${words}")
  string(REGEX REPLACE "[\"]|^SHELL:" "" word "${word}")
  string(FIND "${message}" "cannot be built with ${word}, which is in HERE" place)
  if(result EQUAL 0 OR place EQUAL -1)
    message(SEND_ERROR "${words}: taken, or not named: ${message}")
  endif()
endfunction()

foreach(word -Ofast -ffast-math -funsafe-math-optimizations -fassociative-math -freciprocal-math
             -fno-signed-zeros -ffinite-math-only -ffp-contract=fast -ffp-contract=on -ffp-model=fast
             -mrecip -mrecip=all -fexcess-precision=fast -fdenormal-fp-math=preserve-sign)
  check(${word})
endforeach()
check("-O2 -g -ffast-math")
check("\"-O2 -g -Ofast\"")
check("-O2 SHELL:-ffast-math")
check("-O2 -march=native -fno-fast-math -ffp-contract=off -ffp-model=strict -fno-math-errno" taken)
check("" taken)

# The project's configuration refuses it.
foreach(flag -DCMAKE_CXX_FLAGS=-fassociative-math -DCMAKE_CXX_FLAGS_RELEASE=-Ofast
             -DCMAKE_EXE_LINKER_FLAGS=-ffast-math)
  execute_process(COMMAND "${CMAKE_COMMAND}" -S "${SOURCE}" -B "${WORK}/project" --fresh
                          -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_COMPILER=${COMPILER}" ${flag}
                  RESULT_VARIABLE result ERROR_VARIABLE message OUTPUT_QUIET)
  string(REGEX REPLACE "[ \n]+" " " message "${message}")
  string(REGEX REPLACE "^-D([A-Z_]+)=(.*)$" "cannot be built with \\2, which is in \\1" words "${flag}")
  string(FIND "${message}" "${words}" place)
  if(result EQUAL 0 OR place EQUAL -1)
    message(SEND_ERROR "${flag}: the project is configured all the same: ${message}")
  endif()
endforeach()

# Compiling a source refuses it.
file(WRITE "${WORK}/empty.cpp" "int main() {}\n")
function(compile is_refused)
  execute_process(COMMAND "${COMPILER}" -std=c++20 -include "${SOURCE}/cmake/strict_math.hpp" ${ARGN}
                          -fsyntax-only "${WORK}/empty.cpp"
                  RESULT_VARIABLE result ERROR_VARIABLE message)
  if(is_refused)
    string(FIND "${message}" "build it without -ffast-math" place)
    if(result EQUAL 0 OR place EQUAL -1)
      message(SEND_ERROR "compiled with ${ARGN}: ${message}")
    endif()
  elseif(NOT result EQUAL 0)
    message(SEND_ERROR "not compiled with ${ARGN}: ${message}")
  endif()
endfunction()
compile(FALSE -O3)
compile(FALSE -O2 -ffp-contract=off)
compile(TRUE -ffast-math)
compile(TRUE -O3 -Ofast)
