# usage: cmake -DPYTHON=… -DEXAMPLES=… -DSCRIPT=… -DFILE=… -DWORK=… -P made_by_script.cmake
execute_process(COMMAND "${PYTHON}" "${EXAMPLES}/${SCRIPT}" -o "${WORK}/${FILE}"
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${WORK}/${FILE}" "${EXAMPLES}/${FILE}"
  COMMAND_ERROR_IS_FATAL ANY)
cmake_path(REPLACE_EXTENSION FILE pc2 OUTPUT_VARIABLE cache)
if(EXISTS "${EXAMPLES}/${cache}")
  execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${WORK}/${cache}" "${EXAMPLES}/${cache}"
    COMMAND_ERROR_IS_FATAL ANY)
endif()
