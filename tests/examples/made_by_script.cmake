# usage: cmake -DPYTHON=… -DEXAMPLES=… -DSCRIPT=… -DFILE=… -DWORK=… -P made_by_script.cmake
execute_process(COMMAND "${PYTHON}" "${EXAMPLES}/${SCRIPT}" -o "${WORK}/${FILE}"
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${WORK}/${FILE}" "${EXAMPLES}/${FILE}"
  COMMAND_ERROR_IS_FATAL ANY)
if(EXISTS "${EXAMPLES}/${MESH}.pc2")
  execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${WORK}/${MESH}.pc2" "${EXAMPLES}/${MESH}.pc2"
    COMMAND_ERROR_IS_FATAL ANY)
endif()
