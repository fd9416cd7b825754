# Generates random scenes, by KIND_scenes.py, and compares a half of them, 1 or 2. KIND.finds has what the search for them
# found; if scenes are drawn in another way, compare.py says that they are not well posed any more, and
# KIND_scenes.py --finds makes the file anew.
# usage: cmake -DPYTHON=… -DREFERENCE=… -DKIND=… -DPLIANT=… -DWORK=… -DSEED=… -DCOUNT=… -DHALF=… [-DNOISE=--noise] -P run_random.cmake
file(REMOVE_RECURSE "${WORK}")
file(MAKE_DIRECTORY "${WORK}")
execute_process(COMMAND "${PYTHON}" "${REFERENCE}/${KIND}_scenes.py"
  --seed ${SEED} --count ${COUNT} --finds "${REFERENCE}/${KIND}.finds" -o "${WORK}" COMMAND_ERROR_IS_FATAL ANY)
file(GLOB scenes "${WORK}/*.xml")
list(LENGTH scenes count)
if(NOT count EQUAL COUNT)
  message(FATAL_ERROR "${count} scenes of ${COUNT} were made")
endif()
math(EXPR middle "${count} / 2")
if(HALF EQUAL 1)
  list(SUBLIST scenes 0 ${middle} scenes)
else()
  list(SUBLIST scenes ${middle} -1 scenes)
endif()
execute_process(COMMAND "${PYTHON}" "${REFERENCE}/compare.py" "${PLIANT}" ${scenes} --well-posed ${NOISE}
  COMMAND_ERROR_IS_FATAL ANY)
