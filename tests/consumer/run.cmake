# Installs the build to a scratch prefix, builds the consumer against it alone, and runs it. If PREFIX
# is given, the consumer is built against the installation there.
# The C++ of the README is built with it, so that it stays true.
# usage: cmake {-DBUILD=… | -DPREFIX=…} -DSOURCE=… -DREADME=… -DWORK=… -DCOMPILER=… -P run.cmake
function(run)
  execute_process(COMMAND ${ARGV} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGV}\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE "${WORK}")
if(NOT PREFIX)
  set(PREFIX "${WORK}/prefix")
  run("${CMAKE_COMMAND}" --install "${BUILD}" --prefix "${PREFIX}")
  foreach(completion bash-completion/completions/pliant zsh/site-functions/_pliant
                     fish/vendor_completions.d/pliant.fish)
    if(NOT EXISTS "${PREFIX}/share/${completion}")
      message(FATAL_ERROR "there is no share/${completion}")
    endif()
  endforeach()
endif()

file(READ "${README}" readme)
string(REGEX MATCH "```cpp\n(#include[^\n]*\n)([^`]*)```" code "${readme}")
if(NOT code)
  message(FATAL_ERROR "${README} shows no C++")
endif()
file(WRITE "${WORK}/readme.cpp" "${CMAKE_MATCH_1}\nint main() {\n${CMAKE_MATCH_2}}\n")

set(flags "-DCMAKE_CXX_COMPILER=${COMPILER}")
# A replay that holds, and one of another scene.
set(pliant "${PREFIX}/bin/pliant")
file(READ "${SOURCE}/scene.xml" scene)
string(REPLACE "4000" "4001" scene "${scene}")
file(WRITE "${WORK}/other.xml" "${scene}")
run("${pliant}" replay record "${SOURCE}/scene.xml" -o "${WORK}/scene.replay")
run("${pliant}" replay record "${WORK}/other.xml" -o "${WORK}/other.replay")

# Pages, if the build has the viewer's.
set(pages OFF)
if(EXISTS "${PREFIX}/share/pliant/viewer.html")
  set(pages ON)
  run("${CMAKE_COMMAND}" -E chdir "${SOURCE}" "${pliant}" view scene.xml -o "${WORK}/page_1_12.html")
  run("${CMAKE_COMMAND}" -E chdir "${SOURCE}" "${pliant}" view scene.xml --frames 3:7 -o "${WORK}/page_3_7.html")
endif()

run("${CMAKE_COMMAND}" -G Ninja -S "${SOURCE}" -B "${WORK}/build"
    "-DCMAKE_PREFIX_PATH=${PREFIX}" "-DREADME_CODE=${WORK}/readme.cpp" "-DLOGS=${WORK}" -DPAGES=${pages}
    ${flags})
run("${CMAKE_COMMAND}" --build "${WORK}/build")
run("${WORK}/build/consumer")
run("${pliant}" --version)
run("${CMAKE_CTEST_COMMAND}" --test-dir "${WORK}/build" --no-tests=error --output-on-failure)
