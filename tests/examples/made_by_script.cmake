# usage: cmake -DPYTHON=… -DEXAMPLES=… -DWORK=… -P made_by_script.cmake
execute_process(COMMAND "${PYTHON}" "${EXAMPLES}/make_head.py" -o "${WORK}/head.obj"
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND "${CMAKE_COMMAND}" -E compare_files "${WORK}/head.obj" "${EXAMPLES}/head.obj"
  COMMAND_ERROR_IS_FATAL ANY)
