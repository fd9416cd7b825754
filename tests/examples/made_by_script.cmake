# usage: cmake -DPYTHON=… -DEXAMPLES=… -DMESH=… -DWORK=… -P made_by_script.cmake
execute_process(COMMAND "${PYTHON}" "${EXAMPLES}/make_${MESH}.py" -o "${WORK}/${MESH}.obj"
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${WORK}/${MESH}.obj" "${EXAMPLES}/${MESH}.obj"
  COMMAND_ERROR_IS_FATAL ANY)
