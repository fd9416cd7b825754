# Configures the project in a folder named as that of its public headers, and checks that nothing is
# searched outside of it.
# usage: cmake -DSOURCE=… -DWORK=… -DCOMPILER=… -P folder.cmake
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
file(CREATE_LINK "${SOURCE}" "${WORK}/pliant" SYMBOLIC)
execute_process(
  COMMAND "${CMAKE_COMMAND}" -G Ninja -S "${WORK}/pliant" -B "${WORK}/build" "-DCMAKE_CXX_COMPILER=${COMPILER}"
          -DCMAKE_BUILD_TYPE=Release -DCMAKE_EXPORT_COMPILE_COMMANDS=ON -DPLIANT_BUILD_TESTS=OFF
  RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
if(NOT result EQUAL 0)
  message(FATAL_ERROR "${output}")
endif()
file(READ "${WORK}/build/compile_commands.json" commands)
if(NOT commands MATCHES "-I${WORK}/pliant/lib ")
  message(FATAL_ERROR "no file is compiled with the include path ${WORK}/pliant/lib")
endif()
if(commands MATCHES "-I${WORK} ")
  message(FATAL_ERROR "a file is compiled with an include path outside of the project: ${WORK}")
endif()
