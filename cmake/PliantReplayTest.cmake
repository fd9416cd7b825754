# pliant_add_replay_test(NAME scene log): a test that simulates a scene and compares every frame with
# its log, bit for bit. Paths are relative to the current source folder. docs/replay.md.
function(pliant_add_replay_test name scene log)
  if(NOT TARGET pliant::cli)
    message(FATAL_ERROR "pliant_add_replay_test: this pliant was built without its command "
                        "(PLIANT_BUILD_CLI)")
  endif()
  foreach(file scene log)
    cmake_path(ABSOLUTE_PATH ${file} NORMALIZE)
  endforeach()
  add_test(NAME "${name}" COMMAND pliant::cli replay verify "${log}" "${scene}")
endfunction()
